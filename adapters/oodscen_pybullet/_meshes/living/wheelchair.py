"""A person in a wheelchair, facing x, who turns its wheels by hand."""

import math

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.designs import add_design
from oodscen_pybullet._meshes.designs.parts import Placing
from oodscen_pybullet._meshes.living.limbs import joint, limb
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._types import Point

_SIDE, _SEAT = "_wheelchair_side", "_wheelchair_seat"
"""Designs of its parts that do not move."""
_WHEEL: Point = (-0.1, 0.31, 0.31)
"""Centre of the left wheel, m."""
_WHEEL_RADIUS = 0.30
_SPOKES = 14
"""Corners of a wheel's rim; every second one has a spoke."""
_PUSH = 0.1
"""Distance by which hands move ahead and back on the rims, m."""
_HIP: Point = (-0.18, 0.1, 0.58)
_ANKLE: Point = (0.36, 0.11, 0.24)
_SHOE: Point = (0.43, 0.11, 0.17)
_SHOULDER: Point = (-0.2, 0.2, 1.06)
_HAND: Point = (0.02, 0.33, 0.58)
"""Places on the left side, m; of the hand in the middle of its push."""


def wheelchair_user(mesh: MeshBuilder, shown: Appearance) -> None:
    """A person in a wheelchair, turning the wheels by hand."""
    phase, _ = shown.gait or (0.0, False)
    push = _PUSH * math.sin(2 * math.pi * phase)
    for side in (-1.0, 1.0):
        _add_wheel(mesh, _on(side, _WHEEL), phase)
        add_design(mesh, _SIDE, place=Placing(side=side))
        _add_leg(mesh, side)
        _add_arm(mesh, side, push)
    add_design(mesh, _SEAT)


def _add_wheel(mesh: MeshBuilder, centre: Point, phase: float) -> None:
    """Add an upright spoked wheel, rotated by a fraction of a turn."""
    x, y, z = centre
    turns = [2 * math.pi * (corner / _SPOKES - phase) for corner in range(_SPOKES)]
    rim = [
        (x + _WHEEL_RADIUS * math.cos(turn), y, z + _WHEEL_RADIUS * math.sin(turn))
        for turn in turns
    ]
    for corner, point in enumerate(rim):
        mesh.beam(point, rim[(corner + 1) % _SPOKES], 0.04, "tyre")
        if corner % 2 == 0:
            mesh.beam(centre, point, 0.012, "silver")


def _add_leg(mesh: MeshBuilder, side: float) -> None:
    """Add the right (-1) or left (1) leg, bent over the edge of the seat."""
    hip = _on(side, _HIP)
    knee, ankle = joint(hip, _on(side, _ANKLE), 0.42, 0.38, (0.5, 0, 1.0))
    limb(mesh, (hip, knee, ankle), (0.085, 0.065, 0.045), ("jeans", "jeans"))
    mesh.box(_on(side, _SHOE), (0.25, 0.1, 0.09), "shoe")


def _add_arm(mesh: MeshBuilder, side: float, push: float) -> None:
    """Add the right (-1) or left (1) arm, its hand `push` metres ahead of the middle of its push."""
    shoulder, (x, y, z) = _on(side, _SHOULDER), _on(side, _HAND)
    elbow, hand = joint(shoulder, (x + push, y, z), 0.27, 0.26, (-1, side * 0.5, 0))
    limb(mesh, (shoulder, elbow, hand), (0.06, 0.048, 0.036), ("shirt", "skin"))
    mesh.ball(hand, (0.05, 0.04, 0.05), "skin", around=6, down=4)


def _on(side: float, left: Point) -> Point:
    """Return a place of the left side on the right (-1) or left (1) one."""
    x, y, z = left
    return x, side * y, z


VARIED = (wheelchair_user,)
