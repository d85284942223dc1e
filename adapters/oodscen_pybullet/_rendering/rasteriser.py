"""The rasteriser's stage: scenery and actors as triangles, and pictures of them."""

import math
from collections import OrderedDict
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from oodscen.numerics import _exact as exact
from oodscen_pybullet._lighting.shadows import Shade, ShadowMap
from oodscen_pybullet._lighting.shelter import Shelter
from oodscen_pybullet._meshes import Mesh
from oodscen_pybullet._meshes.atlas import draw_atlas
from oodscen_pybullet._rendering import depth_kernel as raster
from oodscen_pybullet._rendering import shading
from oodscen_pybullet._rendering.appearance import Look, mesh_of
from oodscen_pybullet._rendering.bullet_camera import Shot
from oodscen_pybullet._rendering.triangles import Triangles, textures
from oodscen_pybullet._rendering.view import FAR, NEAR, Point, View

_LAMPS = (0.06, 0.08, 0.995)
"""Direction towards the light that casts shadows in tunnels."""
_LOOKS = 256
"""Number of actors' looks kept as triangles."""


class Canvas:
    """The bodies to draw: scenery, which stays as long as the road does, and actors.

    The first picture of a process may take some seconds while the kernels are compiled; they are then
    cached on disk.
    """

    def __init__(self, *, detail: int = 2) -> None:
        """Start with an empty stage.

        Args:
            detail: Samples per pixel: 2 gives smooth edges, 1 is faster.
        """
        self._detail = detail
        self._is_snowy = False
        self._scenery: Triangles | None = None
        self._actors: Triangles | None = None
        self._known: OrderedDict[Look, Triangles] = OrderedDict()
        self._sheets: tuple[NDArray[np.float32], NDArray[np.int32]] | None = None
        self._records = np.empty((0, raster.RECORD), np.float32)
        self._labels = np.empty((0, raster.LABELS), np.int32)
        self._shadows = ShadowMap()
        self._shelter: Shelter | None = None

    def close(self) -> None:
        """Discard everything; calling it twice is allowed."""
        self._scenery = self._actors = self._sheets = None
        self._known.clear()
        self._shadows.forget()

    def show_scenery(
        self, meshes: Sequence[Mesh], *, is_snowy: bool, shelter: Shelter | None = None
    ) -> None:
        """Replace everything shown by new scenery, with the road's tunnels."""
        self.close()
        self._is_snowy = is_snowy
        atlas = draw_atlas(is_snowy)
        self._scenery = Triangles.joined(
            [Triangles.of(mesh, atlas, is_chunked=True) for mesh in meshes]
        )
        self._shelter = shelter
        if shelter is not None:
            self._scenery.shelter(shelter.covers(self._scenery.middles()))

    def show_actors(self, looks: Sequence[Look | Mesh]) -> None:
        """Replace the actors; row i of `pose_actors` is look i."""
        parts = [self._triangles(look) for look in looks]
        self._actors = Triangles.joined(parts)
        self._actors.spans[:, 2] = np.arange(len(parts))

    def pose_actors(self, poses: Sequence[tuple[float, float, float, float]]) -> None:
        """Move every actor to its x, y, z, yaw."""
        assert self._actors is not None
        for place, (x, y, z, yaw) in zip(self._actors.places, poses, strict=True):
            sine, cosine = exact.sincos(yaw)
            place[:] = (x, y, z, cosine, sine)
        if self._shelter is not None:
            middles = np.array([(x, y, z + 0.1) for x, y, z, _ in poses])
            lengths = self._actors.spans[:, 1] - self._actors.spans[:, 0]
            self._actors.shelter(np.repeat(self._shelter.covers(middles), lengths))

    def photograph(
        self,
        view: View,
        *,
        sun: Point,
        ambient: float,
        diffuse: float,
        ground: float | None = None,
        shades: Point | None = None,
        is_inside: bool = False,
    ) -> Shot:
        """Take a picture."""
        shade = None
        if ground is not None:
            assert self._scenery is not None
            assert self._actors is not None
            towards = _LAMPS if is_inside else shades or sun
            shade = self._shadows.draw(
                view, towards, ground, self._scenery, self._actors, is_inside=is_inside
            )
        return self._photograph(view, sun, ambient, diffuse, shade)

    def _photograph(
        self, view: View, sun: Point, ambient: float, diffuse: float, shade: Shade | None
    ) -> Shot:
        assert self._scenery is not None
        assert self._actors is not None
        shape = (view.height, view.width)
        samples = view.width * view.height * self._detail
        nearness, shown = self._clean(samples + raster.BLOCK)
        light = np.array([*sun, ambient, diffuse], np.float64)
        kinds = np.empty(shape, np.uint8)
        self._reserve(len(self._scenery.corners) + len(self._actors.corners))
        window = (0, 0, view.width, view.height)
        count = 0
        for some in (self._actors, self._scenery):
            count = self._scatter(
                some, view, window, light, self._detail, nearness, shown, count=count
            )
        sheet = textures(self._is_snowy)
        planes = np.empty((3, *shape), np.uint8)
        shot = Shot(
            rgb=np.moveaxis(planes, 0, 2),
            depth=np.empty(shape, np.float32),
            rows=np.empty(shape, np.int32),
            reach=np.empty(shape, np.float32),
            sky=np.empty(shape, np.uint8),
            lit=np.empty(shape, np.uint8),
            kinds=kinds,
            shade=shade,
        )
        shading.gather(
            nearness[:samples].reshape(view.height * self._detail, -1),
            shown[:samples].reshape(view.height * self._detail, -1),
            self._records,
            self._labels,
            sheet.texels,
            sheet.sizes,
            np.array([ambient, diffuse], np.float32),
            self._detail,
            planes,
            shot.depth,
            shot.rows,
            shot.reach,
            shot.sky,
            shot.lit,
            kinds,
        )
        return shot

    def unhidden(self, view: View) -> NDArray[np.int32] | None:
        """Return the number of pixels that each actor would fill without occlusion, [actors]."""
        actors = self._actors
        assert actors is not None
        self._reserve(len(actors.corners))
        light = np.array([0.0, 0.0, 1.0, 1.0, 0.0])
        pixels = np.zeros(len(actors.spans), np.int32)
        for row in range(len(pixels)):
            window = _window(view, actors.places[row], actors.spheres[row])
            if window[2] * window[3] <= 0:
                continue
            size = window[2] * window[3] + raster.BLOCK
            nearness, shown = np.full(size, 1.0 / FAR, np.float32), np.full(size, -1, np.int32)
            self._scatter(actors, view, window, light, 1, nearness, shown, only=row)
            pixels[row] = np.count_nonzero(shown >= 0)
        return pixels

    def _scatter(
        self,
        some: Triangles,
        view: View,
        window: tuple[int, int, int, int],
        light: NDArray[np.float64],
        detail: int,
        nearness: NDArray[np.float32],
        shown: NDArray[np.int32],
        *,
        count: int = 0,
        only: int | None = None,
    ) -> int:
        """Draw all objects, or a single one, into a window of the picture."""
        left, top, width, height = window
        axis = (view.width / 2 - left, view.height / 2 - top)
        camera = np.array(
            [*view.eye, *view.right, *view.up, *view.forward, view.focal, NEAR, FAR, *axis],
            np.float64,
        )
        some_rows = slice(None) if only is None else slice(only, only + 1)
        return raster.scatter(
            some.corners,
            some.planes,
            some.colours,
            some.regions,
            some.kinds,
            some.spans[some_rows],
            some.places[some_rows],
            some.spheres[some_rows],
            camera,
            light,
            detail,
            width,
            height,
            nearness,
            shown,
            self._records,
            self._labels,
            count,
        )

    def _triangles(self, look: Look | Mesh) -> Triangles:
        atlas = draw_atlas(self._is_snowy)
        if isinstance(look, Mesh):
            return Triangles.of(look, atlas, is_chunked=False)
        if look not in self._known:
            if len(self._known) >= _LOOKS:
                self._known.popitem(last=False)
            self._known[look] = Triangles.of(mesh_of(look), atlas, is_chunked=False)
        return self._known[look]

    def _clean(self, samples: int) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
        """Return empty sample buffers, reusing those of the last picture."""
        if self._sheets is None or len(self._sheets[0]) != samples:
            self._sheets = (np.empty(samples, np.float32), np.empty(samples, np.int32))
        nearness, shown = self._sheets
        nearness.fill(1.0 / FAR)
        shown.fill(-1)
        return nearness, shown

    def _reserve(self, count: int) -> None:
        if len(self._records) < count:
            self._records = np.empty((count, raster.RECORD), np.float32)
            self._labels = np.empty((count, raster.LABELS), np.int32)


def _window(
    view: View, place: NDArray[np.float64], sphere: NDArray[np.float32]
) -> tuple[int, int, int, int]:
    """Return the left column, top row, width and height of the pixels that a sphere may fill."""
    x, y, z, c, s = place.tolist()
    a, b, d, radius = sphere.astype(np.float64).tolist()
    across, upwards, ahead = view.to_camera((x + c * a - s * b, y + s * a + c * b, z + d))
    if ahead < NEAR - radius:
        return (0, 0, 0, 0)
    if ahead < radius + NEAR:
        return (0, 0, view.width, view.height)
    edges = []
    for aside, size in ((across, view.width), (-upwards, view.height)):
        ends = [
            size / 2 + view.focal * (aside + sign * radius) / (ahead + reach)
            for sign in (-1.0, 1.0)
            for reach in (-radius, radius)
        ]
        low, high = max(math.floor(min(ends)), 0), min(math.ceil(max(ends)) + 1, size)
        edges.append((low, max(high - low, 0)))
    return (edges[0][0], edges[1][0], edges[0][1], edges[1][1])
