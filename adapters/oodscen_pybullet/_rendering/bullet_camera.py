"""PyBullet's own camera: a world of visual shapes only."""

import math
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

import numpy as np

from oodscen._io.files import temporary_folder
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._lighting.shelter import Shelter
from oodscen_pybullet._meshes import Mesh
from oodscen_pybullet._meshes.atlas import Snow, draw_atlas
from oodscen_pybullet._meshes.wavefront import wavefront
from oodscen_pybullet._rendering.appearance import Look, mesh_of
from oodscen_pybullet._rendering.stage import Shot
from oodscen_pybullet._rendering.view import CameraView, metres
from oodscen_pybullet._types import F32, I32, U8, Ints, Pose

_MOST_TRIANGLES = 20_000
"""Triangles per shape; PyBullet accepts no more than about 130,000 corners."""


class BulletRenderer:
    """The stage of PyBullet's own software camera.

    Shapes and textures are created once; showing another scene moves the existing bodies where possible.
    """

    def __init__(self, engine: ModuleType, *, casts_shadows: bool = False) -> None:
        """Connect to the engine.

        Args:
            engine: PyBullet.
            casts_shadows: Whether pictures contain shadows, which is slower.
        """
        self._engine = engine
        self._casts_shadows = casts_shadows
        self._client: int = engine.connect(engine.DIRECT)
        self._folder = temporary_folder()
        self._files = 0
        self._textures: dict[Snow, int] = {}
        self._shapes: dict[object, int] = {}
        self._snow = Snow.NONE
        self._rows: dict[int, int] = {}
        self._actors: list[int] = []

    def close(self) -> None:
        """Disconnect; calling it twice is allowed."""
        if self._client >= 0:
            self._engine.disconnect(self._client)
            self._client = -1
            self._folder.cleanup()

    def clear(self) -> None:
        """Remove every body but keep shapes and textures."""
        self._engine.resetSimulation(physicsClientId=self._client)
        self._textures.clear()
        self._shapes.clear()
        self._rows.clear()
        self._actors.clear()

    def show_scenery(
        self, meshes: Sequence[Mesh], *, snow: Snow = Snow.NONE, shelter: Shelter | None = None
    ) -> None:
        """Replace everything shown by new scenery, with the road's tunnels."""
        self.clear()
        self._engine.setPhysicsEngineParameter(enableFileCaching=0, physicsClientId=self._client)
        self._snow = snow
        for mesh in meshes:
            for start in range(0, len(mesh.triangles), _MOST_TRIANGLES):
                self._body(self._shape(_piece(mesh, start)))
        self._engine.setPhysicsEngineParameter(enableFileCaching=1, physicsClientId=self._client)

    def show_actors(self, looks: Sequence[Look | Mesh]) -> None:
        """Replace the actors; row i of `pose_actors` is look i.

        Old actors are removed last in, first out, so the renderer's drawing order never depends on
        earlier scenes.
        """
        for body in reversed(self._actors):
            self._engine.removeBody(body, physicsClientId=self._client)
        self._actors.clear()
        self._rows.clear()
        for row, look in enumerate(looks):
            if isinstance(look, Mesh):
                shape = self._shape(look)
            else:
                if look not in self._shapes:
                    self._shapes[look] = self._shape(mesh_of(look))
                shape = self._shapes[look]
            body = self._body(shape)
            self._actors.append(body)
            self._rows[body] = row

    def pose_actors(self, poses: Sequence[Pose]) -> None:
        """Move every actor to its x, y, z, and yaw as the sine and cosine of half the angle."""
        for body, (x, y, z, yaw) in zip(self._actors, poses, strict=True):
            turn = (0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2))
            self._engine.resetBasePositionAndOrientation(
                body, (x, y, z), turn, physicsClientId=self._client
            )

    def unhidden(self, view: CameraView) -> I32 | None:
        """Return `None`: an answer would need one picture per actor."""
        return None

    def render(
        self,
        view: CameraView,
        light: Light,
        *,
        ground: float | None = None,
        is_inside: bool = False,
    ) -> Shot:
        """Take a picture; all shadows are those of the sun."""
        engine = self._engine
        _, _, rgba, buffer, bodies = engine.getCameraImage(
            view.width,
            view.height,
            view.view_matrix(),
            view.projection_matrix(),
            lightDirection=light.sun,
            lightColor=(1, 1, 1),
            lightAmbientCoeff=light.ambient,
            lightDiffuseCoeff=light.diffuse,
            lightSpecularCoeff=0.0,
            shadow=int(self._casts_shadows),
            renderer=engine.ER_TINY_RENDERER,
            physicsClientId=self._client,
        )
        shape = (view.height, view.width)
        rgb = np.ascontiguousarray(np.reshape(rgba, (*shape, 4))[..., :3], dtype=np.uint8)
        depth = metres(np.reshape(buffer, shape).astype(np.float32, copy=False))
        rows = self._actor_rows(np.reshape(bodies, shape))
        return Shot(
            rgb=_smooth(rgb, depth),
            depth=depth,
            rows=rows,
            reach=depth,
            sky=np.where(np.isinf(depth), np.uint8(255), np.uint8(0)),
            lit=np.zeros(shape, np.uint8),
            kinds=None,
        )

    def _actor_rows(self, bodies: Ints) -> I32:
        """Return the rows of actors by the engine's ids, -1 for scenery and sky."""
        rows = np.full(bodies.shape, -1, np.int32)
        for body, row in self._rows.items():
            rows[bodies == body] = row
        return rows

    def _shape(self, mesh: Mesh) -> int:
        """Create a shape from a temporary file: PyBullet never frees lists passed to it."""
        self._files += 1
        path = Path(self._folder.name) / f"{self._files}.obj"
        path.write_text(wavefront(mesh), encoding="ascii")
        shape: int = self._engine.createVisualShape(
            self._engine.GEOM_MESH,
            fileName=str(path),
            rgbaColor=(1, 1, 1, 1),
            physicsClientId=self._client,
        )
        return shape

    def _body(self, shape: int) -> int:
        """Create a body with a shape and the atlas."""
        body: int = self._engine.createMultiBody(0, -1, shape, physicsClientId=self._client)
        self._engine.changeVisualShape(
            body, -1, textureUniqueId=self._texture(), physicsClientId=self._client
        )
        return body

    def _texture(self) -> int:
        """Return the atlas under the snow that lies, loading it if necessary."""
        if self._snow not in self._textures:
            import cv2

            name = str(Path(self._folder.name) / f"atlas{int(self._snow)}.png")
            cv2.imwrite(name, draw_atlas(self._snow)[:, :, ::-1])
            self._textures[self._snow] = self._engine.loadTexture(
                name, physicsClientId=self._client
            )
        return self._textures[self._snow]


def _piece(mesh: Mesh, start: int) -> Mesh:
    """Return a part of a mesh's triangles as a mesh."""
    rows = mesh.triangles[start : start + _MOST_TRIANGLES].reshape(-1)
    return Mesh.loose(mesh.vertices[rows], mesh.normals[rows], mesh.uvs[rows])


def _smooth(rgb: U8, depth: F32) -> U8:
    """Smooth jagged silhouettes and distant texture."""
    import cv2

    grey = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
    edges = cv2.morphologyEx(grey, cv2.MORPH_GRADIENT, np.ones((3, 3), np.uint8)) > 22
    far = np.minimum(depth, np.float32(500.0)) > np.float32(40.0)
    soft = cv2.GaussianBlur(rgb, (3, 3), 0.65)
    return np.asarray(np.where((edges | far)[..., None], soft, rgb), np.uint8)
