"""Attitudes, mounts and boxes in CARLA's left-handed axes."""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from oodscen_carla.server._values import Transform, Vector

_UPRIGHT = 1e-9
"""Length of a direction's part on the ground, of 1, up to which it points straight up or down."""

Matrix = NDArray[np.float64]


class OrientedBox(NamedTuple):
    """An upright box that stands on its place."""

    place: Transform
    extent: Vector
    """Half of its length, width and height, m."""

    def footprint(self) -> list[tuple[float, float]]:
        """Return the corners on the ground."""
        yaw = math.radians(self.place.rotation[1])
        c, s = math.cos(yaw), math.sin(yaw)
        x, y, _ = self.place.location
        length, width, _ = self.extent
        return [
            (x + c * a * length - s * b * width, y + s * a * length + c * b * width)
            for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))
        ]

    def overlaps(self, other: "OrientedBox") -> bool:
        """Return whether two boxes touch: footprints by separating axes, then heights."""
        reach = math.hypot(*self.extent[:2]) + math.hypot(*other.extent[:2])
        if math.dist(self.place.location[:2], other.place.location[:2]) > reach:
            return False
        bottom, other_bottom = self.place.location[2], other.place.location[2]
        if (
            bottom > other_bottom + 2 * other.extent[2]
            or other_bottom > bottom + 2 * self.extent[2]
        ):
            return False
        corners = self.footprint(), other.footprint()
        yaws = self.place.rotation[1], other.place.rotation[1]
        for yaw in (yaws[0], yaws[0] + 90, yaws[1], yaws[1] + 90):
            c, s = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
            (low_a, high_a), (low_b, high_b) = (_span(corner, c, s) for corner in corners)
            if high_a < low_b or high_b < low_a:
                return False
        return True


def _span(corners: Sequence[tuple[float, float]], c: float, s: float) -> tuple[float, float]:
    """Return the ends of a footprint along a direction, given by its cosine and sine."""
    along = [x * c + y * s for x, y in corners]
    return min(along), max(along)


def matrix(place: Transform) -> Matrix:
    """Return the 4 x 4 matrix of a transform: CARLA's `Transform.get_matrix`, left-handed.

    Roll turns about x first, then pitch about y, then yaw about z.
    """
    x, y, z = place.location
    (sp, cp), (sy, cy), (sr, cr) = (
        (math.sin(angle), math.cos(angle)) for angle in map(math.radians, place.rotation)
    )
    return np.array(
        [
            [cp * cy, cy * sp * sr - sy * cr, -cy * sp * cr - sy * sr, x],
            [cp * sy, sy * sp * sr + cy * cr, -sy * sp * cr + cy * sr, y],
            [sp, -cp * sr, cp * cr, z],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )


def transform_of(m: Matrix) -> Transform:
    """Return the transform of a matrix; straight up or down, where yaw and roll are one turn, the roll is 0."""
    level = math.hypot(m[0, 0], m[1, 0])
    pitch = math.atan2(m[2, 0], level)
    if level > _UPRIGHT:
        yaw, roll = math.atan2(m[1, 0], m[0, 0]), math.atan2(-m[2, 1], m[2, 2])
    else:
        yaw, roll = math.atan2(-m[0, 1], m[1, 1]), 0.0
    x, y, z = m[:3, 3].tolist()
    return Transform((x, y, z), (math.degrees(pitch), math.degrees(yaw), math.degrees(roll)))


@lru_cache(maxsize=1024)
def mounted(parent: Transform, mount: Transform) -> Transform:
    """Return the place in the world of something that is attached to a parent."""
    return transform_of(matrix(parent) @ matrix(mount))


def rotated(v: Vector, yaw_deg: float) -> Vector:
    """Return a vector turned about the vertical axis."""
    c, s = math.cos(math.radians(yaw_deg)), math.sin(math.radians(yaw_deg))
    return v[0] * c - v[1] * s, v[0] * s + v[1] * c, v[2]
