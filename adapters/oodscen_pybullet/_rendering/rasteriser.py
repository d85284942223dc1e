"""The rasteriser's stage: scenery and actors as triangles, and pictures of them."""

import math
from collections import OrderedDict
from collections.abc import Sequence

import numpy as np

from oodscen.numerics import _exact as exact
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._lighting.shadows import Shade, ShadowMap
from oodscen_pybullet._lighting.shelter import Shelter
from oodscen_pybullet._meshes import Mesh
from oodscen_pybullet._meshes.atlas import Snow, draw_atlas
from oodscen_pybullet._rendering import depth_kernel as raster
from oodscen_pybullet._rendering.appearance import Look, mesh_of
from oodscen_pybullet._rendering.painting import Planes
from oodscen_pybullet._rendering.records import LABELS_WIDTH, RECORD_WIDTH, DrawnTriangles
from oodscen_pybullet._rendering.shading import gather
from oodscen_pybullet._rendering.stage import Shot
from oodscen_pybullet._rendering.triangles import Triangles, textures
from oodscen_pybullet._rendering.view import FAR_M, NEAR_M, CameraView
from oodscen_pybullet._types import F32, I32, Array, Pose

_CEILING_LAMPS = (0.06, 0.08, 0.995)
"""Direction towards the light that casts shadows in tunnels."""
_MOST_LOOKS = 256
"""Number of actors' looks kept as triangles, at most."""


class Rasteriser:
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
        self._snow = Snow.NONE
        self._scenery: Triangles | None = None
        self._actors: Triangles | None = None
        self._looks: OrderedDict[Look, Triangles] = OrderedDict()
        self._samples: raster.Samples | None = None
        self._drawn = DrawnTriangles(
            np.empty((0, RECORD_WIDTH), np.float32), np.empty((0, LABELS_WIDTH), np.int32)
        )
        self._shadows = ShadowMap()
        self._shelter: Shelter | None = None

    def close(self) -> None:
        """Discard everything; calling it twice is allowed."""
        self._scenery = self._actors = self._samples = None
        self._looks.clear()
        self._shadows.forget()

    def show_scenery(
        self, meshes: Sequence[Mesh], *, snow: Snow = Snow.NONE, shelter: Shelter | None = None
    ) -> None:
        """Replace everything shown by new scenery, with the road's tunnels."""
        self.close()
        self._snow = snow
        atlas = draw_atlas(snow)
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

    def pose_actors(self, poses: Sequence[Pose]) -> None:
        """Move every actor to its x, y, z, yaw."""
        assert self._actors is not None
        for place, (x, y, z, yaw) in zip(self._actors.places, poses, strict=True):
            sine, cosine = exact.sincos(yaw)
            place[:] = (x, y, z, cosine, sine)
        if self._shelter is not None:
            middles = np.array([(x, y, z + 0.1) for x, y, z, _ in poses])
            lengths = self._actors.spans[:, 1] - self._actors.spans[:, 0]
            self._actors.shelter(np.repeat(self._shelter.covers(middles), lengths))

    def render(
        self,
        view: CameraView,
        light: Light,
        *,
        ground: float | None = None,
        is_inside: bool = False,
    ) -> Shot:
        """Take a picture."""
        shade = None
        if ground is not None:
            assert self._scenery is not None
            assert self._actors is not None
            shade = self._shadows.draw(
                view, _CEILING_LAMPS if is_inside else light.towards_caster, ground, self._scenery, self._actors,
                is_inside=is_inside,
            )  # fmt: skip
        return self._render(view, light, shade)

    def _render(self, view: CameraView, light: Light, shade: Shade | None) -> Shot:
        """Draw actors and scenery, and shade what is in front."""
        assert self._scenery is not None
        assert self._actors is not None
        shape = (view.height, view.width)
        count = view.width * view.height * self._detail
        samples = self._empty_samples(count + raster.BLOCK)
        sun = np.array([*light.sun, light.ambient, light.diffuse], np.float64)
        triangles = self._room_for(len(self._scenery.corners) + len(self._actors.corners))
        shutter = _shutter(view, (0, 0, view.width, view.height), sun, self._detail)
        drawn = raster.scatter(self._actors, shutter, samples, triangles, 0)
        raster.scatter(self._scenery, shutter, samples, triangles, drawn)
        planes = Planes(
            rgb=np.empty((3, *shape), np.uint8),
            depth=np.empty(shape, np.float32),
            rows=np.empty(shape, np.int32),
            reach=np.empty(shape, np.float32),
            sky=np.empty(shape, np.uint8),
            lit=np.empty(shape, np.uint8),
            kinds=np.empty(shape, np.uint8),
            tags=np.empty(shape, np.uint8),
        )
        rows = (view.height * self._detail, view.width)
        sheets = raster.Samples(
            samples.nearness[:count].reshape(rows), samples.shown[:count].reshape(rows)
        )
        lights = sun[3:].astype(np.float32)
        gather(sheets, triangles, textures(self._snow), lights, self._detail, planes)
        fields = planes._asdict() | {"rgb": np.moveaxis(planes.rgb, 0, 2)}
        return Shot(**fields, shade=shade)

    def unhidden(self, view: CameraView) -> I32 | None:
        """Return the number of pixels that each actor would fill without occlusion, [actors]."""
        actors = self._actors
        assert actors is not None
        triangles = self._room_for(len(actors.corners))
        sun = np.array([0.0, 0.0, 1.0, 1.0, 0.0])
        pixels = np.zeros(len(actors.spans), np.int32)
        for row in range(len(pixels)):
            window = _window(view, actors.places[row], actors.spheres[row])
            _, _, width, height = window
            if width * height == 0:
                continue
            size = width * height + raster.BLOCK
            samples = raster.Samples(
                np.full(size, 1.0 / FAR_M, np.float32), np.full(size, -1, np.int32)
            )
            rows = slice(row, row + 1)
            alone = actors._replace(
                spans=actors.spans[rows], places=actors.places[rows], spheres=actors.spheres[rows]
            )
            raster.scatter(alone, _shutter(view, window, sun, 1), samples, triangles, 0)
            pixels[row] = np.count_nonzero(samples.shown >= 0)
        return pixels

    def _triangles(self, look: Look | Mesh) -> Triangles:
        """Return an actor's triangles; those of looks are kept."""
        atlas = draw_atlas(self._snow)
        if isinstance(look, Mesh):
            return Triangles.of(look, atlas, is_chunked=False)
        if look not in self._looks:
            if len(self._looks) >= _MOST_LOOKS:
                self._looks.popitem(last=False)
            self._looks[look] = Triangles.of(mesh_of(look), atlas, is_chunked=False)
        return self._looks[look]

    def _empty_samples(self, size: int) -> raster.Samples:
        """Return empty sample buffers, reusing those of the last picture."""
        if self._samples is None or len(self._samples.shown) != size:
            self._samples = raster.Samples(np.empty(size, np.float32), np.empty(size, np.int32))
        self._samples.nearness.fill(1.0 / FAR_M)
        self._samples.shown.fill(-1)
        return self._samples

    def _room_for(self, count: int) -> DrawnTriangles:
        """Return room for the records of some triangles."""
        if len(self._drawn.records) < count:
            self._drawn = DrawnTriangles(
                np.empty((count, RECORD_WIDTH), np.float32),
                np.empty((count, LABELS_WIDTH), np.int32),
            )
        return self._drawn


def _shutter(
    view: CameraView, window: tuple[int, int, int, int], sun: Array, detail: int
) -> raster.Shutter:
    """Return the camera, the light and the samples of a window of the picture."""
    left, top, width, height = window
    axis = (view.width / 2 - left, view.height / 2 - top)
    camera = np.array(
        [*view.eye, *view.right, *view.up, *view.forward, view.focal, NEAR_M, FAR_M, *axis],
        np.float64,
    )
    return raster.Shutter(camera, sun, detail, width, height)


def _window(view: CameraView, place: Array, sphere: F32) -> tuple[int, int, int, int]:
    """Return the left column, top row, width and height of the pixels that a sphere may fill."""
    x, y, z, c, s = place.tolist()
    a, b, d, radius = sphere.astype(np.float64).tolist()
    across, upwards, ahead = view.to_camera((x + c * a - s * b, y + s * a + c * b, z + d))
    if ahead < NEAR_M - radius:
        return (0, 0, 0, 0)
    if ahead < radius + NEAR_M:
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
