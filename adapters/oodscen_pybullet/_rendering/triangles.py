"""Meshes in the rasteriser's layout: flat arrays of corners, in chunks with bounding spheres."""

from collections.abc import Callable, Sequence
from functools import cache
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from oodscen_pybullet._meshes.atlas import (
    COLOURS,
    EMISSIVE,
    REGIONS,
    SIZE,
    SWATCH,
    Snow,
    draw_atlas,
    free_colours,
    swatch_uv,
)
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._meshes.tags import SURFACES
from oodscen_pybullet._types import F32, I32, U8, Array, Ints, Mask

LEVELS = 9
"""Number of levels of a texture, each half the size of the one before."""
CHUNK = 256
"""Largest number of triangles that are culled together."""
_CELL_M = 24.0
"""Side of the squares from which chunks are gathered, m."""
PLAIN, SHINING, MIRROR, GROUND, SHELTERED, SOFT = 0, 1, 2, 4, 8, 16
"""Surface flags of a triangle, added up: lamps shine in the dark, water reflects, ground gets wet,
surfaces in a tunnel get neither rain nor sun, and grass and soil absorb what falls on them."""
_SOFT_GROUND = frozenset(
    {"grass", "grass_dark", "field", "crop", "earth", "soil", "turf", "hedge", "hill"}
)
"""Colours and textures of soft ground."""
_LEVEL = 0.6
"""Upward component of the normal above which ground counts as ground, not as a kerb or a bank's side."""
_WATER = frozenset({"water", "water_light", "flood", "flood_light"})
"""Colours of reflective surfaces."""
GREEN_SHIFT, BLUE_SHIFT = 21, 42
"""Bits by which green and blue are shifted in a texel."""
_GRID = 2.0**14
"""Grid lines per metre for the corners: their differences are exact in any chunk."""
_LEAST_AREA = 1e-9
"""Twice the area up to which a triangle is left out, m^2."""
_ROUNDING_M = 1e-3
"""Amount by which spheres are larger than their content, m."""
_SAME_TEXEL = 1e-6
"""Difference of texture coordinates up to which a triangle has a single colour, texels."""


class Textures(NamedTuple):
    """The regions of the atlas, each at every level."""

    texels: NDArray[np.uint64]
    """All levels, row by row: red, and green and blue by `GREEN_SHIFT` and `BLUE_SHIFT` bits to the left.

    Each level has one extra column and row, which repeat the last ones.
    """
    sizes: I32
    """[regions, LEVELS, 3] start, width and height of each level."""


class Triangles(NamedTuple):
    """Triangles in chunks."""

    corners: F32
    """[n, 3, 8] x, y, z relative to the chunk's origin, normal, texel column and row."""
    planes: F32
    """[n, 4] normal and offset of each triangle's plane."""
    colours: F32
    """[n, 3] colours of triangles without texture."""
    regions: I32
    """[n] textures, -1 for none."""
    kinds: U8
    """[n] sums of surface flags, SHINING and so on; `shelter` changes them."""
    tags: U8
    """[n] semantic classes: `oodscen_pybullet._meshes.tags.Tag`; 0 for actors and the unknown."""
    spans: I32
    """[m, 3] first triangle, end (exclusive), and label of each chunk."""
    places: Array
    """[m, 5] origin of each chunk, and the cosine and sine of its yaw."""
    spheres: F32
    """[m, 4] bounding sphere of each chunk: centre relative to the origin, and radius, m."""

    @classmethod
    def of(cls, mesh: Mesh, atlas: U8, *, is_chunked: bool) -> "Triangles":
        """Convert a mesh.

        Args:
            mesh: Its faces have places in the atlas.
            atlas: The texture atlas with its colours.
            is_chunked: Whether to cut it into chunks, for scenery; otherwise it is one chunk around
                the mesh's origin, which a new row in `places` moves.
        """
        faces = _Faces.of(mesh)
        starts = np.zeros(1, np.int64)
        if is_chunked:
            order, starts = _chunks(faces.points)
            faces = faces.rows(order)
        ends = np.append(starts[1:], len(faces.points))
        spheres = _spheres(faces.points, starts, ends)
        origins = np.round(spheres[:, :3]) if is_chunked else np.zeros((len(starts), 3))
        spheres[:, :3] -= origins
        points = faces.points - np.repeat(origins, ends - starts, axis=0)[:, None]
        paint = _Paint.of(faces.uvs, atlas)
        tags = faces.tags
        if is_chunked:
            tags = np.where(tags > 0, tags, paint.table(_tag))
        offsets = (faces.facing * points[:, 0]).sum(axis=1, keepdims=True)
        turns = np.tile(np.array([1.0, 0.0]), (len(starts), 1))
        return cls(
            corners=np.concatenate([points, faces.normals, paint.texels], axis=2).astype(
                np.float32
            ),
            planes=np.concatenate([faces.facing, offsets], axis=1).astype(np.float32),
            colours=paint.colours,
            regions=paint.regions,
            kinds=_kinds(paint, is_level_ground=mesh.is_ground & (faces.facing[:, 2] > _LEVEL)),
            tags=tags,
            spans=np.stack([starts, ends, np.full(len(starts), -1)], axis=1).astype(np.int32),
            places=np.concatenate([origins, turns], axis=1),
            spheres=spheres.astype(np.float32),
        )

    def shelter(self, is_sheltered: Mask) -> None:
        """Mark the triangles, [n], that are in a tunnel."""
        self.kinds[:] = np.where(
            is_sheltered, self.kinds | np.uint8(SHELTERED), self.kinds & np.uint8(255 - SHELTERED)
        )

    def middles(self) -> Array:
        """Return the centre of each triangle in the world, [n, 3] m."""
        lengths = self.spans[:, 1] - self.spans[:, 0]
        place = np.repeat(self.places, lengths, axis=0)
        middle = self.corners[:, :, :3].astype(np.float64).mean(axis=1)
        c, s = place[:, 3], place[:, 4]
        return np.stack(
            [
                place[:, 0] + c * middle[:, 0] - s * middle[:, 1],
                place[:, 1] + s * middle[:, 0] + c * middle[:, 1],
                place[:, 2] + middle[:, 2],
            ],
            axis=1,
        )

    @classmethod
    def joined(cls, parts: Sequence["Triangles"]) -> "Triangles":
        """Merge several sets of triangles, in order."""
        shifts = np.cumsum([0, *(len(part.corners) for part in parts)])
        spans = [
            part.spans + np.array([shift, shift, 0], np.int32)
            for part, shift in zip(parts, shifts[:-1].tolist(), strict=True)
        ]
        merged = cls._make(np.concatenate(arrays) for arrays in zip(*parts, strict=True))
        return merged._replace(spans=np.concatenate(spans).astype(np.int32))


class _Faces(NamedTuple):
    """The triangles of a mesh that have an area."""

    points: Array
    """[n, 3, 3] corners, m."""
    normals: Array
    """[n, 3, 3] normals at the corners."""
    uvs: Array
    """[n, 3, 2] atlas coordinates."""
    facing: Array
    """[n, 3] normals of the triangles themselves."""
    tags: U8
    """[n] semantic classes."""

    @classmethod
    def of(cls, mesh: Mesh) -> Self:
        """Return a mesh's triangles, on the grid of corners."""
        points = np.round(mesh.vertices[mesh.triangles] * _GRID) / _GRID
        normals = np.round(mesh.normals[mesh.triangles] * _GRID) / _GRID
        facing = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
        size = np.sqrt((facing * facing).sum(axis=1))
        whole = cls(points, normals, mesh.uvs[mesh.triangles], facing, mesh.classes)
        has_area = size > _LEAST_AREA
        faces = whole.rows(has_area)
        return faces._replace(facing=faces.facing / size[has_area, None])

    def rows(self, rows: Ints | Mask) -> Self:
        """Return some of the triangles."""
        return self._replace(
            points=self.points[rows],
            normals=self.normals[rows],
            uvs=self.uvs[rows],
            facing=self.facing[rows],
            tags=self.tags[rows],
        )


class _Paint(NamedTuple):
    """The surface of triangles by their places in the atlas."""

    regions: I32
    """[n] textures, -1 for none."""
    texels: Array
    """[n, 3, 2] column and row of the corners in the texture."""
    colours: F32
    """[n, 3] colours of triangles without texture."""
    swatches: Ints
    """[n] colours of the atlas, by their order there."""
    is_free: Mask
    """[n] True for colours that the atlas lacks."""
    is_lit: Mask
    """[n] True for those of them that shine."""

    @classmethod
    def of(cls, uvs: Array, atlas: U8) -> Self:
        """Look triangles up in the atlas, by the middle of each one's coordinates, [n, 3, 2]."""
        is_free, free = free_colours(uvs.mean(axis=1))
        uvs = np.where(is_free[:, None, None], swatch_uv("grey"), uvs)
        middle = np.where(is_free[:, None], swatch_uv("grey"), uvs.mean(axis=1))
        column = np.clip((middle[:, 0] * SIZE).astype(np.int64), 0, SIZE - 1)
        row = np.clip(((1.0 - middle[:, 1]) * SIZE).astype(np.int64), 0, SIZE - 1)
        regions, texels = _regions(uvs)
        return cls(
            regions=regions,
            texels=texels,
            colours=np.where(is_free[:, None], free[:, :3], atlas[row, column]).astype(np.float32),
            swatches=(row // SWATCH) * (SIZE // SWATCH) + column // SWATCH,
            is_free=is_free,
            is_lit=free[:, 3] > 0,
        )

    def table(self, value_of: Callable[[str], int]) -> U8:
        """Return each triangle's value: that of its texture, or that of its colour in the atlas."""
        by_swatch = np.zeros(SIZE * SIZE // SWATCH**2, np.uint8)
        by_swatch[: len(COLOURS)] = [value_of(name) for name in COLOURS]
        by_region = np.array([value_of(name) for name in REGIONS], np.uint8)
        textured = by_region[np.maximum(self.regions, 0)]
        return np.where(self.regions >= 0, textured, by_swatch[self.swatches])


def _kinds(paint: _Paint, *, is_level_ground: Mask) -> U8:
    """Return the sums of surface flags."""
    kinds = np.where(paint.is_free, paint.is_lit * SHINING, paint.table(_flags))
    return (kinds + np.where(is_level_ground, GROUND, 0)).astype(np.uint8)


def _spheres(points: Array, starts: Ints, ends: Ints) -> Array:
    """Return the middle and the radius of a sphere around each chunk, [chunks, 4]."""
    spheres = np.zeros((len(starts), 4))
    for index, (start, end) in enumerate(zip(starts.tolist(), ends.tolist(), strict=True)):
        corners = points[start:end].reshape(-1, 3)
        middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
        radius = np.sqrt(((corners - middle) ** 2).sum(axis=1).max()) + _ROUNDING_M
        spheres[index] = (*middle, radius)
    return spheres


def _chunks(points: Array) -> tuple[Ints, Ints]:
    """Return an order of triangles that groups neighbours, and the starts of the chunks."""
    cells = np.floor(points.mean(axis=1)[:, :2] / _CELL_M).astype(np.int64)
    rank = np.lexsort((cells[:, 1], cells[:, 0]))
    sorted_cells = cells[rank]
    is_new = np.ones(len(rank), bool)
    is_new[1:] = (sorted_cells[1:] != sorted_cells[:-1]).any(axis=1)
    first = np.flatnonzero(is_new)
    within = np.arange(len(rank)) - np.repeat(first, np.diff(np.append(first, len(rank))))
    return rank, np.flatnonzero(within % CHUNK == 0)


def _regions(uvs: Array) -> tuple[I32, Array]:
    """Return each triangle's region, and its corners' texel columns and rows there."""
    texels = np.stack([uvs[..., 0] * SIZE, (1.0 - uvs[..., 1]) * SIZE], axis=2)
    middle = texels.mean(axis=1)
    regions = np.full(len(uvs), -1, np.int32)
    is_flat = (np.abs(texels - texels[:, :1]) < _SAME_TEXEL).all(axis=(1, 2))
    for index, (x, y, width, height) in enumerate(REGIONS.values()):
        inside = (
            (middle[:, 0] > x)
            & (middle[:, 0] < x + width)
            & (middle[:, 1] > y)
            & (middle[:, 1] < y + height)
            & ~is_flat
        )
        regions[inside] = index
        texels[inside] -= np.array([x, y])
    return regions, texels


def _flags(name: str) -> int:
    """Return the surface flags of a colour or texture."""
    if name in EMISSIVE:
        return SHINING
    if name in _WATER:
        return MIRROR
    return SOFT if name in _SOFT_GROUND else PLAIN


def _tag(name: str) -> int:
    """Return the semantic class of a colour or texture."""
    return SURFACES.get(name, 0)


@cache
def textures(snow: Snow = Snow.NONE) -> Textures:
    """Return every region of the atlas at every level."""
    atlas = draw_atlas(snow)
    texels: list[NDArray[np.uint64]] = []
    sizes: list[tuple[int, int, int]] = []
    start = 0
    for x, y, width, height in REGIONS.values():
        image = atlas[y : y + height, x : x + width]
        for _ in range(LEVELS):
            sizes.append((start, image.shape[1], image.shape[0]))
            padded = np.pad(image, ((0, 1), (0, 1), (0, 0)), mode="edge")
            red, green, blue = padded.reshape(-1, 3).astype(np.uint64).T
            texels.append(red + (green << GREEN_SHIFT) + (blue << BLUE_SHIFT))
            start += len(red)
            image = _halved(image)
    return Textures(np.concatenate(texels), np.array(sizes, np.int32).reshape(-1, LEVELS, 3))


def _halved(image: U8) -> U8:
    """Return an image of half the width and height, rounded up; integer arithmetic only."""
    height, width = image.shape[:2]
    padded = np.pad(image, ((0, height % 2), (0, width % 2), (0, 0)), mode="edge").astype(np.int32)
    four = padded[::2, ::2] + padded[1::2, ::2] + padded[::2, 1::2] + padded[1::2, 1::2]
    return ((four + 2) // 4).astype(np.uint8)
