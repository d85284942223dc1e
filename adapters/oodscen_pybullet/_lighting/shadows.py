"""Shadow maps of scenery and actors.

The map lies on the ground. Each cell holds the height of the topmost object on the sun's ray that
ends there; everything lower on the same ray is in shadow. Scenery is drawn once and reused while the
sun and the camera's neighbourhood stay the same; actors are drawn over it for every picture.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from oodscen.numerics._kernels import Kernel, part
from oodscen_pybullet._rendering.triangles import SHELTERED, Triangles
from oodscen_pybullet._rendering.view import CameraView
from oodscen_pybullet._types import F32, Array, Point

CELLS = 1024
"""Cells along a side of the map."""
SIDE_M = 96.0
"""Length of a side of the map, m."""
TILE = 16
"""Cells along a side of a tile; points above everything in a tile are lit without a closer look."""
_SNAP_M = 16.0
"""Step by which the map moves, m, so that scenery is not redrawn for every picture."""
_AHEAD_M = 38.0
"""Distance from the camera forward to the map's centre, m."""
_LOWEST = 0.25
"""Smallest slope of the sun's rays: the shadows of a lower sun would leave the map."""
FAR_CELLS = 512
"""Cells along a side of the coarse map, which extends the fine one."""
FAR_SIDE_M = 448.0
"""Length of a side of the coarse map, m."""
_FAR_SNAP_M, _FAR_AHEAD_M = 64.0, 150.0
"""The same step and distance of the coarse map, m."""
_NOTHING_M = -1e6
"""Height of an empty cell, m."""
_MARGIN = 0.5
"""Cells by which objects on the fine map are widened, so that thin ones are not lost."""
_EDGE_ON = 1e-9
"""Twice the area below which the sun sees a triangle edge-on, cells^2."""


@dataclass(frozen=True, eq=False)
class Shade:
    """A shadow map in the layout that the postprocessing kernel reads."""

    heights: F32
    """[CELLS, CELLS] rows by y, columns by x: m above `level`."""
    tiles: F32
    """[CELLS / TILE, CELLS / TILE] maximum of each tile and its neighbouring cells."""
    corner: tuple[float, float]
    """x and y of the map's lowest corner on the ground, m."""
    level: float
    """z of the ground, m."""
    far: F32
    """[FAR_CELLS, FAR_CELLS] heights of the coarse map, scenery only."""
    far_corner: tuple[float, float]
    """The lowest corner of the coarse map, m."""
    lean: tuple[float, float]
    """Shift of a shadow against x and y per metre of height."""


@Kernel
def cast(
    objects: Triangles,
    sun: Array,
    frame: Array,
    skipped: int,
    heights: F32,
    tiles: F32,
) -> None:
    """Draw the shadows of objects into a map.

    Only faces turned away from the sun are drawn: they cast the same shadow as the faces towards it,
    and cannot darken these by mistake.

    Args:
        objects: The objects.
        sun: [3] direction towards the sun.
        frame: [7] x and y of the map's corner, z of the ground, shift along x and y per metre of
            height, cells per metre, and the margin in cells by which all objects are widened.
        skipped: Kinds of triangles that cast no shadow.
        heights: [n, n] heights of the map, changed in place.
        tiles: [n / TILE, n / TILE] tiles of the map, changed in place.
    """
    spans, planes, kinds, places = objects.spans, objects.planes, objects.kinds, objects.places
    most = np.float64(heights.shape[0] - 1)
    corners = np.empty((3, 3))
    for index in range(spans.shape[0]):
        if not _is_near(objects, index, frame, most):
            continue
        c, s = places[index, 3], places[index, 4]
        sx, sy, sz = c * sun[0] + s * sun[1], c * sun[1] - s * sun[0], sun[2]
        for k in range(spans[index, 0], spans[index, 1]):
            if kinds[k] & skipped:
                continue
            if planes[k, 0] * sx + planes[k, 1] * sy + planes[k, 2] * sz >= 0.0:
                continue
            _drop(objects, index, k, frame, corners)
            _fill(corners, most, frame[6], heights, tiles)


@part
def _is_near(objects: Triangles, index: int, frame: Array, most: float) -> bool:
    """Return whether an object's sphere may cast a shadow on the map."""
    places, spheres = objects.places, objects.spheres
    x0, y0, level = frame[0], frame[1], frame[2]
    lean_x, lean_y, scale = frame[3], frame[4], frame[5]
    stretch = 1.0 + math.sqrt(lean_x * lean_x + lean_y * lean_y)
    c, s = places[index, 3], places[index, 4]
    bx = places[index, 0] + c * spheres[index, 0] - s * spheres[index, 1]
    by = places[index, 1] + s * spheres[index, 0] + c * spheres[index, 1]
    bz = places[index, 2] + spheres[index, 2] - level
    reach = spheres[index, 3] * stretch * scale
    at_x, at_y = (bx - lean_x * bz - x0) * scale, (by - lean_y * bz - y0) * scale
    return not (at_x < -reach or at_y < -reach or at_x > most + reach or at_y > most + reach)


@part
def _drop(objects: Triangles, index: int, k: int, frame: Array, corners: Array) -> None:
    """Write a triangle's shadow into `corners`: column, row and height of each."""
    places, points = objects.places, objects.corners
    x0, y0, level = frame[0], frame[1], frame[2]
    lean_x, lean_y, scale = frame[3], frame[4], frame[5]
    c, s = places[index, 3], places[index, 4]
    for j in range(3):
        a, b = np.float64(points[k, j, 0]), np.float64(points[k, j, 1])
        z = places[index, 2] + points[k, j, 2] - level
        corners[j, 0] = (places[index, 0] + c * a - s * b - lean_x * z - x0) * scale
        corners[j, 1] = (places[index, 1] + s * a + c * b - lean_y * z - y0) * scale
        corners[j, 2] = z


@part
def _fill(corners: Array, most: float, margin: float, heights: F32, tiles: F32) -> None:
    """Raise the map, and its tiles, to a triangle's shadow that is widened by a margin in cells."""
    cells = heights.shape[0]
    px, py, pz = corners[:, 0], corners[:, 1], corners[:, 2]
    low_x, high_x = min(px[0], px[1], px[2]), max(px[0], px[1], px[2])
    low_y, high_y = min(py[0], py[1], py[2]), max(py[0], py[1], py[2])
    if high_x < -0.5 or high_y < -0.5 or low_x > most + 0.5 or low_y > most + 0.5:
        return
    ux, uy, uz = px[1] - px[0], py[1] - py[0], pz[1] - pz[0]
    vx, vy, vz = px[2] - px[0], py[2] - py[0], pz[2] - pz[0]
    area = ux * vy - uy * vx
    if abs(area) < _EDGE_ON:
        return
    slope_x, slope_y = (uz * vy - uy * vz) / area, (ux * vz - uz * vx) / area
    # Lowered by the surface's rise within half a cell, so that it does not shade itself.
    give = 0.5 * (abs(slope_x) + abs(slope_y))
    first, last = int(max(math.floor(low_y), 0.0)), int(min(math.ceil(high_y), most))
    floor, top = np.float32(min(pz[0], pz[1], pz[2])), np.float32(max(pz[0], pz[1], pz[2]))
    west, east = float(most) + 1.0, -1.0
    for row in range(first, last + 1):
        at = min(max(np.float64(row), low_y), high_y)
        left, right = 1e30, -1e30
        for j in range(3):
            i = j + 1 if j < 2 else 0
            if (py[j] < at) != (py[i] < at) or py[j] == at:
                share = (at - py[j]) / (py[i] - py[j]) if py[j] != py[i] else 0.0
                x = px[j] + (px[i] - px[j]) * share
                left, right = min(left, x), max(right, x)
        # Wider on both sides, so that thin objects are not lost between cells.
        start = max(math.ceil(left - margin), 0.0)
        stop = min(math.floor(right + margin), most) + 1.0
        if not start < stop:
            continue
        west, east = min(west, float(start)), max(east, float(stop) - 1.0)
        begin = np.float32(pz[0] + slope_x * (start - px[0]) + slope_y * (row - py[0]) - give)
        slope = np.float32(slope_x)
        base = np.uint64(start)
        line = heights[row]
        for offset in range(np.uint64(int(stop) - int(start))):
            height = begin + slope * np.float32(np.int32(offset))
            height = min(max(height, floor), top)
            before = line[base + offset]
            line[base + offset] = height if height > before else before
    if east < 0.0 or last < first:
        return
    for tile_y in range(max(first - 1, 0) // TILE, min(last + 1, cells - 1) // TILE + 1):
        for tile_x in range(
            max(int(west) - 1, 0) // TILE, min(int(east) + 1, cells - 1) // TILE + 1
        ):
            tiles[tile_y, tile_x] = max(tiles[tile_y, tile_x], top)


class _Map(NamedTuple):
    """A map, and the highest of each tile's cells."""

    heights: F32
    tiles: F32

    @classmethod
    def empty(cls, cells: int) -> Self:
        """Return a map without shadows."""
        tiles = cells // TILE
        return cls(
            np.full((cells, cells), _NOTHING_M, np.float32),
            np.full((tiles, tiles), _NOTHING_M, np.float32),
        )

    def copy(self) -> Self:
        """Return the same map in memory of its own."""
        return self._replace(heights=self.heights.copy(), tiles=self.tiles.copy())


class _Rays(NamedTuple):
    """The light that casts shadows."""

    towards: Point
    """Direction towards the light, steep enough for the map."""
    skipped: int
    """Kinds of triangles that cast no shadow."""

    @property
    def lean(self) -> tuple[float, float]:
        """Shift of a shadow against x and y per metre of height."""
        x, y, z = self.towards
        return x / z, y / z


class _Scenery:
    """The shadows of scenery on one map, drawn once for a place and a direction of light."""

    def __init__(self, cells: int) -> None:
        self._cells = cells
        self._key: tuple[float, ...] | None = None
        self.map = _Map.empty(0)

    def forget(self) -> None:
        """Discard the map."""
        self._key = None

    def draw(self, scenery: Triangles, rays: _Rays, frame: Array) -> bool:
        """Draw the map if it is not that of this frame; return whether it was drawn."""
        key = (*frame.tolist(), *rays.towards, rays.skipped)
        if key == self._key:
            return False
        self._key = key
        self.map = _Map.empty(self._cells)
        cast(scenery, np.array(rays.towards), frame, rays.skipped, *self.map)
        return True


class ShadowMap:
    """Keeps the shadow map of one stage."""

    def __init__(self) -> None:
        """Start without a map."""
        self._near, self._far = _Scenery(CELLS), _Scenery(FAR_CELLS)
        self._map = _Map.empty(0)
        self._touched: list[tuple[slice, slice]] = []

    def forget(self) -> None:
        """Discard the map, for instance when the scenery changes."""
        self._near.forget()
        self._far.forget()

    def draw(
        self,
        view: CameraView,
        sun: Point,
        level: float,
        scenery: Triangles,
        actors: Triangles,
        *,
        is_inside: bool = False,
    ) -> Shade:
        """Return the shadow map for a picture.

        Args:
            view: The camera.
            sun: Direction towards the sun.
            level: Height of the ground near the camera, m.
            scenery: The static triangles; the same object until `forget` is called.
            actors: The moving triangles.
            is_inside: Whether the camera is in a tunnel, whose roof then casts no shadow.
        """
        rays = _Rays(_raised(sun), SHELTERED if is_inside else 0)
        level = math.floor(level)
        corner = _corner(view, _AHEAD_M, _SNAP_M, SIDE_M)
        frame = np.array([*corner, level, *rays.lean, CELLS / SIDE_M, _MARGIN])
        far_corner = _corner(view, _FAR_AHEAD_M, _FAR_SNAP_M, FAR_SIDE_M)
        far_frame = np.array([*far_corner, level, *rays.lean, FAR_CELLS / FAR_SIDE_M, 0.0])
        self._far.draw(scenery, rays, far_frame)
        if self._near.draw(scenery, rays, frame):
            self._map = self._near.map.copy()
            self._touched.clear()
        self._add_actors(actors, rays, frame)
        return Shade(
            heights=self._map.heights,
            tiles=self._map.tiles,
            corner=corner,
            level=level,
            far=self._far.map.heights,
            far_corner=far_corner,
            lean=rays.lean,
        )

    def _add_actors(self, actors: Triangles, rays: _Rays, frame: Array) -> None:
        """Draw actors over the scenery's shadows, in place of those of the last picture."""
        heights, tiles = self._map
        for rows, columns in self._touched:
            heights[rows, columns] = self._near.map.heights[rows, columns]
        np.copyto(tiles, self._near.map.tiles)
        self._touched = _areas(actors, frame)
        cast(actors, np.array(rays.towards), frame, 0, heights, tiles)


def _raised(sun: Point) -> Point:
    """Return the direction towards the sun, raised until its rays are steep enough."""
    rise = max(sun[2], _LOWEST)
    flat = math.sqrt(sun[0] * sun[0] + sun[1] * sun[1]) or 1.0
    cosine = math.sqrt(1.0 - rise * rise)
    return (sun[0] / flat * cosine, sun[1] / flat * cosine, rise)


def _corner(view: CameraView, ahead: float, snap: float, side: float) -> tuple[float, float]:
    """Return x and y of the lowest corner of a map centred some distance ahead of the camera."""
    x, y = (
        math.floor((view.eye[i] + ahead * view.forward[i]) / snap + 0.5) * snap - side / 2
        for i in range(2)
    )
    return (x, y)


def _areas(objects: Triangles, frame: Array) -> list[tuple[slice, slice]]:
    """Return the rows and columns of the map that objects may cover."""
    c, s = objects.places[:, 3], objects.places[:, 4]
    x = objects.places[:, 0] + c * objects.spheres[:, 0] - s * objects.spheres[:, 1]
    y = objects.places[:, 1] + s * objects.spheres[:, 0] + c * objects.spheres[:, 1]
    z = objects.places[:, 2] + objects.spheres[:, 2] - frame[2]
    reach = (
        objects.spheres[:, 3] * (1.0 + math.sqrt(frame[3] ** 2 + frame[4] ** 2)) * frame[5] + 2.0
    )
    column, row = (x - frame[3] * z - frame[0]) * frame[5], (y - frame[4] * z - frame[1]) * frame[5]
    edges = np.stack([row - reach, row + reach, column - reach, column + reach])
    edges = np.clip(np.floor(edges), 0, CELLS).astype(int)
    return [
        (slice(low, high + 1), slice(left, right + 1))
        for low, high, left, right in edges.T.tolist()
        if low < CELLS and left < CELLS and high > 0 and right > 0
    ]
