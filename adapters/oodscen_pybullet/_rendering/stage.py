"""The interface of the cameras: the bodies that they show, and the raw pictures that they take."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from oodscen.data._weather import Weather
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._lighting.shadows import Shade
from oodscen_pybullet._lighting.shelter import Portal, Shelter
from oodscen_pybullet._meshes import Mesh
from oodscen_pybullet._meshes.atlas import Snow
from oodscen_pybullet._meshes.mesh import Lamp, Puff
from oodscen_pybullet._rendering.appearance import Look
from oodscen_pybullet._rendering.view import CameraView
from oodscen_pybullet._types import F32, I32, U8, Pose


@dataclass(frozen=True, eq=False)
class Shot:
    """A camera's raw picture before light and weather."""

    rgb: U8
    """[height, width, 3]; in pixels that are partly sky, the colour of the rest."""
    depth: F32
    """[height, width] metres along the optical axis at the pixel's centre; infinity for sky."""
    rows: I32
    """[height, width] row of the actor, -1 for scenery and sky."""
    reach: F32
    """[height, width] mean depth of the part that is not sky; light and weather use it."""
    sky: U8
    """[height, width] fraction of sky, 0 to 255."""
    lit: U8
    """[height, width] incidence of the sun on the surface, 0 (grazing) to 255 (perpendicular)."""
    kinds: U8 | None
    """[height, width] surface flags: `triangles.SHINING` and so on; `None` if unknown."""
    tags: U8 | None = None
    """[height, width] semantic class of scenery and sky, 0 for actors; `None` if unknown."""
    shade: Shade | None = None
    """The shadow map; `None` if it was not requested, or is part of `rgb` already."""


class PlacedPuff(NamedTuple):
    """A puff in world coordinates."""

    puff: Puff
    row: int
    """Row of the body it belongs to."""


@dataclass(frozen=True, eq=False)
class RawPicture:
    """A raw picture and everything that determines its postprocessing."""

    shot: Shot
    """The raw picture; pixels filled by smoke become those of the body it belongs to."""
    view: CameraView
    weather: Weather
    light: Light
    lamps: Sequence[Lamp]
    """All lit lamps in world coordinates, without the ego's if the camera is in it or sees by them."""
    time: float
    """Time since the start, s; rain and snow change over time."""
    seed: int
    road_height: float
    """Height of the ground below the camera, m."""
    portal: Portal | None = None
    """The end of a tunnel that the camera looks at."""
    balls: Sequence[PlacedPuff] = ()
    """Smoke, fire and dust."""
    threads: int = 1
    """Number of threads that develop it."""


class Stage(Protocol):
    """The bodies of a picture: scenery, which stays as long as the road does, and actors."""

    def close(self) -> None:
        """Release all resources; calling it twice is allowed."""

    def show_scenery(
        self, meshes: Sequence[Mesh], *, snow: Snow = Snow.NONE, shelter: Shelter | None = None
    ) -> None:
        """Replace everything shown by new scenery, with the road's tunnels."""

    def show_actors(self, looks: Sequence[Look | Mesh]) -> None:
        """Replace the actors; row i of `pose_actors` is look i."""

    def pose_actors(self, poses: Sequence[Pose]) -> None:
        """Move every actor to its x, y, z, yaw."""

    def render(
        self,
        view: CameraView,
        light: Light,
        *,
        ground: float | None = None,
        is_inside: bool = False,
    ) -> Shot:
        """Take a picture.

        Args:
            view: The camera.
            light: The light of the scene.
            ground: Height of the road below the camera, m, if shadows are requested.
            is_inside: Whether the camera is in a tunnel, whose roof then casts no shadow.
        """
        ...

    def unhidden(self, view: CameraView) -> I32 | None:
        """Return the number of pixels that each actor would fill without occlusion, [actors].

        `None` if the renderer cannot tell.
        """
        ...
