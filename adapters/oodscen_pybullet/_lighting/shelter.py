"""Tunnels, which keep out sun, rain and snow."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from oodscen.driving._roads.corridor import Corridor, Structure
from oodscen_pybullet._rendering.view import CameraView
from oodscen_pybullet._scenery.structures import CEILING_M
from oodscen_pybullet._types import F32, Array, Mask, Point

_WALL_M = 0.6
"""Distance by which walls extend beyond the cross-section, m."""
_AROUND_M = 60.0
"""Margin around the bounding box of the road's line beyond which no point is in a tunnel, m."""
_BELOW_M, _SHELL_M = 0.5, 0.2
"""Heights below the road and above the ceiling that still belong to a tunnel, m."""
_FACING = 1e-4
"""Least change of distance to the portal per metre of depth at which a ray meets it."""
_NEAREST_M = 0.01
"""Least distance of a portal that is told, m: one that is nearer, or passed around a bend, counts as this far ahead."""
_USED_M = 25.0
"""Distance into a tunnel after which a camera has adapted to the light there, m."""


@dataclass(frozen=True)
class Portal:
    """The end of a tunnel ahead of a camera: a plane across the road."""

    is_inside: bool
    """True if the camera is in the tunnel and looks out, False if it looks in."""
    adaptation: float
    """The camera's adaptation to the tunnel's light: 0 outside and at its ends, 1 well inside."""
    distance: float
    """Distance from the camera to the plane along its normal, m."""
    normal: Point
    """Normal of the plane away from the camera, as components along the camera's right, up and forward."""

    def depths(self, across: NDArray[np.floating], upwards: NDArray[np.floating]) -> F32:
        """Return the depth of the plane on rays, m; infinity on rays that do not meet it.

        Args:
            across: x / depth of each ray.
            upwards: y / depth.
        """
        towards = self.normal[0] * across + self.normal[1] * upwards + self.normal[2]
        meets = towards > _FACING
        depth = self.distance / np.where(meets, towards, 1.0)
        return np.where(meets, depth, np.inf).astype(np.float32)


@dataclass(frozen=True, eq=False)
class Shelter:
    """The tunnels of a road."""

    corridor: Corridor

    @cached_property
    def _tunnels(self) -> list[Structure]:
        return [structure for structure in self.corridor.structures if structure.kind == "tunnel"]

    def covers(self, points: Array) -> Mask:
        """Return which points, [n, 3] m, lie in a tunnel, including its walls and ceiling."""
        is_covered = np.zeros(len(points), bool)
        if not self._tunnels or not len(points):
            return is_covered
        road = self.corridor
        low = np.array([road.x.min(), road.y.min()]) - _AROUND_M
        high = np.array([road.x.max(), road.y.max()]) + _AROUND_M
        near = np.flatnonzero(((points[:, :2] > low) & (points[:, :2] < high)).all(axis=1))
        s, t = road.locate_all(points[near, 0], points[near, 1])
        above = points[near, 2] - np.interp(s, road.s, road.z)
        right = np.interp(s, road.s, road.strips[0].right) - _WALL_M
        left = np.interp(s, road.s, road.strips[-1].left) + _WALL_M
        within = (t > right) & (t < left) & (above > -_BELOW_M) & (above < CEILING_M + _SHELL_M)
        for tunnel in self._tunnels:
            is_covered[near] |= within & (s > tunnel.start) & (s < tunnel.end)
        return is_covered

    def portal(self, view: CameraView) -> Portal | None:
        """Return the end of a tunnel that a camera looks at; `None` if there is none ahead."""
        if not self._tunnels:
            return None
        s, _ = self.corridor.locate(view.eye[0], view.eye[1])
        sign = 1.0 if _along(view.forward, self._direction(s)) >= 0.0 else -1.0
        is_inside = bool(self.covers(np.array([view.eye]))[0])
        end = self._exit(s, sign) if is_inside else self._next_entrance(s, sign)
        if end is None:
            return None
        adaptation = self._adaptation(s) if is_inside else 0.0
        distance, normal = self._plane(view, end, sign)
        return Portal(is_inside, adaptation, max(distance, _NEAREST_M), normal)

    def _plane(self, view: CameraView, s: float, sign: float) -> tuple[float, Point]:
        """Return a camera's distance from the plane across the road at s, and that plane's `Portal.normal`.

        The normal points along the road, or against it if the sign is -1.
        """
        x, y, _, _ = self.corridor.point(s, 0.0)
        along = self._direction(s)
        normal = (sign * along[0], sign * along[1])
        distance = (x - view.eye[0]) * normal[0] + (y - view.eye[1]) * normal[1]
        right, up, forward = (_along(axis, normal) for axis in (view.right, view.up, view.forward))
        return distance, (right, up, forward)

    def _exit(self, s: float, sign: float) -> float:
        """Return s of the exit of the tunnel around a place."""
        tunnel = self._around(s)
        return tunnel.end if sign > 0.0 else tunnel.start

    def _next_entrance(self, s: float, sign: float) -> float | None:
        """Return s of the next entrance; `None` if no tunnel lies ahead."""
        entrances = (tunnel.start if sign > 0.0 else tunnel.end for tunnel in self._tunnels)
        ahead = (entrance for entrance in entrances if (entrance - s) * sign > 0.0)
        return min(ahead, key=lambda entrance: abs(entrance - s), default=None)

    def _adaptation(self, s: float) -> float:
        """Return how far eyes in a tunnel are used to the dark, from 0 at its ends to 1."""
        tunnel = self._around(s)
        return min(1.0, min(s - tunnel.start, tunnel.end - s) / _USED_M)

    def _around(self, s: float) -> Structure:
        """Return the tunnel around a place."""
        return next(tunnel for tunnel in self._tunnels if tunnel.start < s < tunnel.end)

    def _direction(self, s: float) -> tuple[float, float]:
        """Return the cosine and the sine of the road's heading at s."""
        road = self.corridor
        return float(np.interp(s, road.s, road.cos)), float(np.interp(s, road.s, road.sin))


def _along(vector: Point, direction: tuple[float, float]) -> float:
    """Return the component of a vector along a level direction."""
    return vector[0] * direction[0] + vector[1] * direction[1]
