"""A person in a wheelchair, facing x, who turns its wheels by hand."""

from oodscen.numerics._exact import TAU, sin
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.designs import add_design
from oodscen_pybullet._meshes.designs.parts import Placing
from oodscen_pybullet._meshes.designs.rings import add_spoked_wheel
from oodscen_pybullet._meshes.living.limbs import joint, limb
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._types import Point

_SIDE, _SEAT = "_wheelchair_side", "_wheelchair_seat"
"""Designs of its parts that do not move."""
_WHEEL: Point = (-0.1, 0.31, 0.31)
"""Centre of the left wheel, m."""
_WHEEL_RADIUS, _TYRE, _SPOKE = 0.30, 0.04, 0.012
"""Radius of the middle of a wheel's tyre, and widths of tyre and spokes, m."""
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
    push = _PUSH * sin(TAU * phase)
    for side in (-1.0, 1.0):
        add_spoked_wheel(
            mesh, _on(side, _WHEEL), _WHEEL_RADIUS, tyre=_TYRE, spoke=_SPOKE, turned=phase
        )
        add_design(mesh, _SIDE, place=Placing(side=side))
        _add_leg(mesh, side)
        _add_arm(mesh, side, push)
    add_design(mesh, _SEAT)


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
