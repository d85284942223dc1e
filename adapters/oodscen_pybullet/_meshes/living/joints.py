"""The joints of people in poses, as they follow from the angles."""

from typing import NamedTuple

import numpy as np

from oodscen.numerics._exact import PI, cos, sin
from oodscen_pybullet._meshes.living.poses import Arm, KeyFrame, Leg
from oodscen_pybullet._meshes.shapes import rotated, rotation
from oodscen_pybullet._types import Array, Point

UPPER_ARM, FOREARM = 0.28, 0.27
THIGH, SHIN = 0.425, 0.41
"""Lengths of bones, m."""
SHOULDER_Y, HIP_Y = 0.225, 0.095
"""Distance of the joints from the middle of the body, m."""


class Chain(NamedTuple):
    """A limb: its three joints, and the direction of the hand or of the foot."""

    start: Point
    middle: Point
    end: Point
    way: Point


def arm_joints(angles: Arm, side: float, shoulder: Point) -> Chain:
    """Return the joints of an arm; `side` is 1 for the left one."""
    lift, aside, elbow, twist = (PI * value / 180.0 for value in angles)
    # The hanging arm, with the forearm's bend forward, is swung up in the plane at the azimuth `aside`.
    azimuth = side * aside
    swing = _product(rotation(yaw=azimuth), _product(rotation(pitch=-lift), rotation(yaw=-azimuth)))
    down, forward = (0.0, 0.0, -1.0), (cos(twist), -side * sin(twist), 0.0)
    bent = _sum(down, forward, cos(elbow), sin(elbow))
    upper, lower = _turned(swing, down), _turned(swing, bent)
    middle = point_along(shoulder, upper, UPPER_ARM)
    return Chain(shoulder, middle, point_along(middle, lower, FOREARM), lower)


def leg_joints(angles: Leg, side: float, hip: Point, lean: float) -> Chain:
    """Return the joints of a leg; a foot without an angle is level although the body leans, in degrees."""
    thigh, out, knee = (PI * value / 180.0 for value in angles[:3])
    sideways = rotation(roll=side * out)
    shin = thigh - knee
    ankle = PI * angles[3] / 180.0 if len(angles) == 4 else shin - PI * lean / 180.0
    foot = shin + PI / 2 - ankle

    def down(turn: float) -> Point:
        return _turned(sideways, (sin(turn), 0.0, -cos(turn)))

    middle = point_along(hip, down(thigh), THIGH)
    return Chain(hip, middle, point_along(middle, down(shin), SHIN), down(foot))


def trunk_rotation(frame: KeyFrame) -> Array:
    """Return the rotation of the trunk about the hips."""
    return _product(
        rotation(pitch=PI * frame.lean / 180.0), rotation(roll=-PI * frame.roll / 180.0)
    )


def _product(left: Array, right: Array) -> Array:
    """Return the product of two rotations, which applies the right one first."""
    return rotated(right.T, left).T


def _turned(rows: Array, way: Point) -> Point:
    """Return a direction after a rotation."""
    x, y, z = rotated(np.array([way]), rows)[0].tolist()
    return x, y, z


def _sum(one: Point, two: Point, a: float, b: float) -> Point:
    """Return a weighted sum of two vectors."""
    return a * one[0] + b * two[0], a * one[1] + b * two[1], a * one[2] + b * two[2]


def point_along(start: Point, way: Point, length: float) -> Point:
    """Return the point at a distance from another in a direction."""
    return _sum(start, way, 1.0, length)
