"""The rasteriser's stage: scenery and actors as triangles, and their picture."""

import math
from collections import OrderedDict
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from oodscen_pybullet import raster, shading
from oodscen_pybullet.cast import Look, mesh_of
from oodscen_pybullet.meshes import Mesh
from oodscen_pybullet.meshes.atlas import draw_atlas
from oodscen_pybullet.stage import Shot
from oodscen_pybullet.triangles import Triangles, textures
from oodscen_pybullet.view import FAR, NEAR, View

_LOOKS = 256
"""Actors' looks that stay converted."""


class Canvas:
    """Bodies to be drawn: scenery, which stays while the road does, and the actors.

    The first picture of a process may wait for some seconds while the kernels are compiled; they
    are then kept on disk.
    """

    def __init__(self, *, detail: int = 2) -> None:
        """Start with nothing on stage.

        Args:
            detail: Samples per pixel along a row and along a column: 2 gives smooth edges, 1 is
                quicker.
        """
        self._detail = detail
        self._is_snowy = False
        self._scenery: Triangles | None = None
        self._actors: Triangles | None = None
        self._known: OrderedDict[Look, Triangles] = OrderedDict()
        self._sheets: tuple[NDArray[np.float32], NDArray[np.int32]] | None = None
        self._records = np.empty((0, raster.RECORD), np.float32)
        self._labels = np.empty((0, 3), np.int32)

    def close(self) -> None:
        """Forget everything; may be called twice."""
        self._scenery = self._actors = self._sheets = None
        self._known.clear()

    def show_scenery(self, meshes: Sequence[Mesh], *, is_snowy: bool) -> None:
        """Put up scenery in place of everything that is there."""
        self.close()
        self._is_snowy = is_snowy
        atlas = draw_atlas(is_snowy)
        self._scenery = Triangles.joined(
            [Triangles.of(mesh, atlas, is_chunked=True) for mesh in meshes]
        )

    def show_actors(self, looks: Sequence[Look | Mesh]) -> None:
        """Put up the actors in place of earlier ones; row i of `pose_actors` is look i."""
        parts = [self._triangles(look) for look in looks]
        self._actors = Triangles.joined(parts)
        self._actors.spans[:, 2] = np.arange(len(parts))

    def pose_actors(self, poses: Sequence[tuple[float, float, float, float]]) -> None:
        """Move every actor: x, y, z, yaw."""
        assert self._actors is not None
        for place, (x, y, z, yaw) in zip(self._actors.places, poses, strict=True):
            place[:] = (x, y, z, math.cos(yaw), math.sin(yaw))

    def photograph(
        self, view: View, *, sun: tuple[float, float, float], ambient: float, diffuse: float
    ) -> Shot:
        """Take a picture."""
        assert self._scenery is not None
        assert self._actors is not None
        shape = (view.height, view.width)
        nearness, shown = self._clean(view.width * view.height * self._detail**2)
        camera = np.array(
            [*view.eye, *view.right, *view.up, *view.forward, view.focal, NEAR, FAR], np.float64
        )
        light = np.array([*sun, ambient, diffuse], np.float64)
        count = 0
        self._reserve(len(self._scenery.corners) + len(self._actors.corners))
        for some in (self._actors, self._scenery):
            count = raster.scatter(
                some.corners,
                some.planes,
                some.colours,
                some.regions,
                some.spans,
                some.places,
                some.spheres,
                camera,
                light,
                self._detail,
                view.width,
                view.height,
                nearness,
                shown,
                self._records,
                self._labels,
                count,
            )
        sheet = textures(self._is_snowy)
        shot = Shot(
            rgb=np.empty((*shape, 3), np.uint8),
            depth=np.empty(shape, np.float32),
            rows=np.empty(shape, np.int32),
            reach=np.empty(shape, np.float32),
            sky=np.empty(shape, np.uint8),
        )
        shading.gather(
            nearness.reshape(view.height * self._detail, -1),
            shown.reshape(view.height * self._detail, -1),
            self._records,
            self._labels,
            sheet.texels,
            sheet.sizes,
            np.array([ambient, diffuse], np.float32),
            self._detail,
            shot.rgb,
            shot.depth,
            shot.rows,
            shot.reach,
            shot.sky,
        )
        return shot

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
        """Return empty sheets of samples; those of the last picture are used again."""
        if self._sheets is None or len(self._sheets[0]) != samples:
            self._sheets = (np.empty(samples, np.float32), np.empty(samples, np.int32))
        nearness, shown = self._sheets
        nearness.fill(1.0 / FAR)
        shown.fill(-1)
        return nearness, shown

    def _reserve(self, count: int) -> None:
        if len(self._records) < count:
            self._records = np.empty((count, raster.RECORD), np.float32)
            self._labels = np.empty((count, 3), np.int32)
