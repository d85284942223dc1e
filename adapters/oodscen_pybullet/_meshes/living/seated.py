"""A person with a helmet on a saddle, facing x. All numbers are metres."""

from dataclasses import dataclass

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.living.body import Clothes
from oodscen_pybullet._meshes.living.limbs import joint, limb
from oodscen_pybullet._types import Point

_CHEST = 0.47
"""Height of the shoulders above the saddle."""
_HIP_ASIDE, _SHOULDER_ASIDE = 0.1, 0.19
_LEG, _ARM = 0.44, 0.29
"""Lengths of a thigh and a shin, and of an upper arm and a forearm."""
_LEG_RADII, _ARM_RADII = (0.09, 0.065, 0.045), (0.06, 0.048, 0.036)
"""Radii of limbs at the body, at the joint and at the end."""


@dataclass(frozen=True)
class Riding:
    """The posture of a rider."""

    saddle: Point
    """Middle of the hips."""
    grip: Point
    """Position of the left hand."""
    lean: float = 0.28
    """Distance by which the shoulders are ahead of the hips."""


def add_rider(
    mesh: MeshBuilder, clothes: Clothes, riding: Riding, feet: tuple[Point, Point]
) -> None:
    """Add a rider; `feet` are the right and the left ankle."""
    _add_trunk(mesh, clothes, riding)
    _add_head(mesh, clothes, riding)
    for side, foot in ((-1.0, feet[0]), (1.0, feet[1])):
        _add_leg(mesh, clothes, riding, side, foot)
        _add_arm(mesh, clothes, riding, side)


def _add_trunk(mesh: MeshBuilder, clothes: Clothes, riding: Riding) -> None:
    (x, _, z), lean = riding.saddle, riding.lean
    mesh.column(
        [
            ((x - 0.02, 0.0, z - 0.06), 0.15, 0.17),
            ((x + 0.25 * lean, 0.0, z + 0.14), 0.13, 0.16),
            ((x + 0.75 * lean, 0.0, z + 0.36), 0.13, 0.19),
            ((x + lean, 0.0, z + _CHEST + 0.03), 0.10, 0.19),
            ((x + lean + 0.03, 0.0, z + _CHEST + 0.10), 0.05, 0.07),
        ],
        [clothes.legs, clothes.top, clothes.top, clothes.top],
    )


def _add_head(mesh: MeshBuilder, clothes: Clothes, riding: Riding) -> None:
    """Add the neck, the face and the helmet."""
    x, z = riding.saddle[0] + riding.lean, riding.saddle[2] + _CHEST
    head = (x + 0.09, 0.0, z + 0.24)
    mesh.cylinder((x + 0.03, 0.0, z + 0.06), head, 0.05, clothes.skin, sides=6)
    mesh.ball(head, (0.105, 0.085, 0.125), clothes.skin)
    mesh.ball((head[0] - 0.02, 0.0, head[2] + 0.05), (0.15, 0.115, 0.105), clothes.hat)


def _add_leg(mesh: MeshBuilder, clothes: Clothes, riding: Riding, side: float, foot: Point) -> None:
    """Add the right (-1) or left (1) leg."""
    x, _, z = riding.saddle
    hip = (x, side * _HIP_ASIDE, z)
    knee, ankle = joint(hip, foot, _LEG, _LEG, (1.0, side * 0.1, 0.3))
    limb(mesh, (hip, knee, ankle), _LEG_RADII, (clothes.legs, clothes.legs))
    mesh.box((ankle[0] + 0.07, ankle[1], ankle[2] - 0.04), (0.25, 0.09, 0.08), clothes.shoes)


def _add_arm(mesh: MeshBuilder, clothes: Clothes, riding: Riding, side: float) -> None:
    """Add the right (-1) or left (1) arm."""
    (x, _, z), grip = riding.saddle, riding.grip
    shoulder = (x + riding.lean, side * _SHOULDER_ASIDE, z + _CHEST)
    bend = (-0.3, side * 0.6, -0.6)
    elbow, hand = joint(shoulder, (grip[0], side * grip[1], grip[2]), _ARM, _ARM, bend)
    sleeve = clothes.sleeves or clothes.top
    limb(mesh, (shoulder, elbow, hand), _ARM_RADII, (clothes.top, sleeve))
