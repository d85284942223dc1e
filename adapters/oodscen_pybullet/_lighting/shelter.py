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
_USED_M = 25.0
"""Distance into a tunnel after which a camera has adapted to the light there, m."""


@dataclass(frozen=True)
class Portal:
    """The end of a tunnel ahead of a camera: a plane across the road."""

    is_inside: bool
    """True if the camera is in the tunnel and looks out, False if it looks in."""
    deep: float
    """Adaptation of the camera to the tunnel's light: 0 outside and at its ends, 1 well inside."""
    distance: float
    """Distance from the camera to the plane along its normal, m."""
    normal: Point
    """Normal of the plane away from the camera, as components along the camera's right, up and forward."""

    def ahead(self, across: NDArray[np.floating], upwards: NDArray[np.floating]) -> F32:
        """Return the depth of the plane on rays, m; infinity on rays that do not meet it.

        Args:
            across: x / depth of each ray.
            upwards: y / depth.
        """
        towards = self.normal[0] * across + self.normal[1] * upwards + self.normal[2]
        meets = towards > 1e-4
        depth = self.distance / np.where(meets, towards, 1.0)
        return np.where(meets, depth, np.inf).astype(np.float32)


@dataclass(frozen=True, eq=False)
class Shelter:
    """The tunnels of a road."""

    corridor: Corridor

    @cached_property
    def _tunnels(self) -> list[Structure]:
        return [one for one in self.corridor.structures if one.kind == "tunnel"]

    def covers(self, points: Array) -> Mask:
        """Return which points, [n, 3] m, lie in a tunnel, including its walls and ceiling."""
        found = np.zeros(len(points), bool)
        if not self._tunnels or not len(points):
            return found
        road = self.corridor
        low = np.array([road.x.min(), road.y.min()]) - 60.0
        high = np.array([road.x.max(), road.y.max()]) + 60.0
        some = np.flatnonzero(((points[:, :2] > low) & (points[:, :2] < high)).all(axis=1))
        s, t = road.locate_all(points[some, 0].copy(), points[some, 1].copy())
        above = points[some, 2] - np.interp(s, road.s, road.z)
        right = np.interp(s, road.s, road.strips[0].right) - _WALL_M
        left = np.interp(s, road.s, road.strips[-1].left) + _WALL_M
        within = (t > right) & (t < left) & (above > -0.5) & (above < CEILING_M + 0.2)
        for one in self._tunnels:
            found[some] |= within & (s > one.start) & (s < one.end)
        return found

    def portal(self, view: CameraView) -> Portal | None:
        """Return the end of a tunnel that a camera looks at; `None` if there is none ahead."""
        if not self._tunnels:
            return None
        road = self.corridor
        s, _ = road.locate(view.eye[0], view.eye[1])
        is_inside = bool(self.covers(np.array([view.eye]))[0])
        way = self._direction(s)
        sign = 1.0 if view.forward[0] * way[0] + view.forward[1] * way[1] >= 0.0 else -1.0
        place = self._end_ahead(s, sign, is_inside)
        if place is None:
            return None
        deep = self._adaptation(s) if is_inside else 0.0
        x, y, _, _ = road.point(place, 0.0)
        along = self._direction(place)
        normal = (sign * along[0], sign * along[1])
        parts = [
            axis[0] * normal[0] + axis[1] * normal[1]
            for axis in (view.right, view.up, view.forward)
        ]
        distance = (x - view.eye[0]) * normal[0] + (y - view.eye[1]) * normal[1]
        return Portal(is_inside, deep, max(distance, 0.01), (parts[0], parts[1], parts[2]))

    def _end_ahead(self, s: float, sign: float, is_inside: bool) -> float | None:
        """Return s of the exit, or of the next entrance; `None` if no tunnel lies ahead."""
        if is_inside:
            tunnel = self._around(s)
            return tunnel.end if sign > 0.0 else tunnel.start
        entrances = (one.start if sign > 0.0 else one.end for one in self._tunnels)
        ahead = (at for at in entrances if (at - s) * sign > 0.0)
        return min(ahead, key=lambda at: abs(at - s), default=None)

    def _adaptation(self, s: float) -> float:
        """Return how far eyes in a tunnel are used to the dark, from 0 at its ends to 1."""
        tunnel = self._around(s)
        return min(1.0, min(s - tunnel.start, tunnel.end - s) / _USED_M)

    def _around(self, s: float) -> Structure:
        return next(one for one in self._tunnels if one.start < s < one.end)

    def _direction(self, s: float) -> tuple[float, float]:
        road = self.corridor
        return float(np.interp(s, road.s, road.cos)), float(np.interp(s, road.s, road.sin))
