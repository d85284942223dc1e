"""The parts of a person's body and what all people wear, facing x. All numbers are metres."""

import math
from dataclasses import dataclass
from typing import ClassVar

from pydantic import ConfigDict

from oodscen.numerics._exact import cos
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.living.limbs import joint, limb, stride
from oodscen_pybullet._meshes.look import Gait
from oodscen_pybullet._types import Point

HIP_M = 0.90
"""Height of the hip joints of an adult 1.75 m tall, m."""
SHOULDER_M = 1.40
"""The same of the shoulder joints, m."""


@dataclass(frozen=True)
class Clothes:
    """A person's clothes: colours by name."""

    __pydantic_config__: ClassVar = ConfigDict(extra="forbid")

    top: str
    legs: str
    hair: str = "hair"
    skin: str = "skin"
    hat: str = ""
    shoes: str = "shoe"
    sleeves: str = ""
    """Colour of the forearms below short sleeves."""
    shins: str = ""
    """Colour of the shins below short trousers."""
    has_long_hair: bool = False
    skirt: str = ""
    gesture_gloves: str = ""
    """Colour of the hands in a gesture, if they are gloved."""


def drop_of(gait: Gait | None) -> float:
    """Return the distance by which bent knees lower the hips in motion, m."""
    return 0.0 if gait is None else 0.05 if gait.runs else 0.03


def add_trunk(
    mesh: MeshBuilder, clothes: Clothes, hip: float, shoulder: float, lean: float
) -> None:
    """Add hips, waist and chest; the shoulders are `lean` ahead of the hips, m."""
    waist = (0.4 * lean, 0.0, hip + 0.20)
    mesh.column(
        [
            ((0.0, 0.0, hip - 0.08), 0.105, 0.155),
            ((0.0, 0.0, hip + 0.06), 0.115, 0.165),
            (waist, 0.105, 0.15),
            ((0.8 * lean, 0.0, hip + 0.38), 0.125, 0.19),
            ((lean, 0.0, shoulder + 0.02), 0.10, 0.215),
            ((lean, 0.0, shoulder + 0.08), 0.055, 0.09),
        ],
        [clothes.legs, clothes.legs, clothes.top, clothes.top, clothes.top],
    )


def add_skirt(mesh: MeshBuilder, clothes: Clothes, hip: float) -> None:
    """Add a skirt, if the person wears one."""
    if clothes.skirt:
        mesh.column(
            [((0, 0, 0.48), 0.2, 0.26), ((0, 0, hip + 0.1), 0.12, 0.165)], clothes.skirt, caps="b"
        )


def add_neck(mesh: MeshBuilder, clothes: Clothes, shoulder: float, lean: float) -> Point:
    """Add the neck, and return the centre of the head."""
    head = (lean + 0.02, 0.0, shoulder + 0.215)
    mesh.cylinder((lean, 0, shoulder + 0.05), (head[0], 0, head[2]), 0.05, clothes.skin, sides=6)
    return head


def add_leg(
    mesh: MeshBuilder,
    clothes: Clothes,
    side: float,
    hip: float,
    gait: Gait | None,
    half_stride_m: float,
) -> None:
    """Add a leg that stands, walks or runs.

    Args:
        mesh: Receives the leg.
        clothes: The colours.
        side: -1 for the right leg, 1 for the left one.
        hip: Height of the hip.
        gait: The moment of this leg's stride; `None` if it stands.
        half_stride_m: Distance ahead of the hip at which a walking foot lands; a running one lands farther.
    """
    y, ankle = side * 0.095, 0.09
    if gait is None:
        ahead, up = side * -0.03, 0.0
    elif gait.runs:
        ahead, up = stride(gait.phase, 1.3 * half_stride_m, 0.42, 0.42)
    else:
        ahead, up = stride(gait.phase, half_stride_m, 0.13, 0.6)
    foot = (ahead - 0.03, y, ankle + up)
    knee, foot = joint((0.0, y, hip), foot, 0.425, 0.41, (1.0, side * 0.05, 0.1))
    shin = clothes.shins or clothes.legs
    limb(mesh, ((0.0, y, hip), knee, foot), (0.09, 0.065, 0.045), (clothes.legs, shin))
    x, z = foot[0], foot[2] - ankle
    tip = 0.6 * up
    if tip < 0.03:
        sole = (x - 0.08, x + 0.19, y - 0.048, y + 0.048, z)
        mesh.hull(sole, (x - 0.07, x + 0.11, y - 0.04, y + 0.04, z + 0.1), clothes.shoes)
    else:
        toe = (x + 0.15, y, z + 0.08 - min(tip, 0.06))
        mesh.beam((x - 0.02, y, z + 0.1), toe, 0.095, clothes.shoes)


def add_arm(
    mesh: MeshBuilder,
    clothes: Clothes,
    side: float,
    shoulder: Point,
    hand: Point | None,
    gait: Gait | None,
) -> None:
    """Add an arm that reaches for a point; without one it hangs, or swings with the gait."""
    x, _, z = shoulder
    if hand is None:
        swing = -cos(2 * math.pi * gait.phase) if gait else 0.0
        if gait and gait.runs:
            hand = (x + 0.14 + 0.26 * swing, side * 0.2, z - 0.26 + 0.16 * swing)
        else:
            hand = (x + 0.05 + 0.26 * swing, side * 0.27, z - 0.51 + 0.06 * abs(swing))
    elbow, hand = joint(shoulder, hand, 0.28, 0.27, (-1.0, side * 0.5, -0.2))
    lower = clothes.sleeves or clothes.top
    limb(mesh, (shoulder, elbow, hand), (0.062, 0.048, 0.034), (clothes.top, lower))
    mesh.ball(hand, (0.045, 0.04, 0.06), clothes.skin, around=6, down=4)


def add_head(mesh: MeshBuilder, clothes: Clothes) -> None:
    """Add the head with face, hair or hat around the origin."""
    mesh.ball((0.0, 0.0, 0.0), (0.10, 0.082, 0.125), clothes.skin)
    mesh.box((0.10, 0.0, -0.015), (0.03, 0.025, 0.04), clothes.skin, caps="b")
    for side in (-1.0, 1.0):
        eye = side * 0.036
        mesh.polygon(
            [
                (0.094, eye - 0.014, 0.012),
                (0.094, eye + 0.014, 0.012),
                (0.092, eye + 0.014, 0.034),
                (0.092, eye - 0.014, 0.034),
            ],
            "hair",
        )
    if clothes.hat:
        mesh.ball((-0.01, 0.0, 0.055), (0.125, 0.11, 0.105), clothes.hat)
        mesh.box((0.10, 0.0, 0.05), (0.10, 0.17, 0.02), clothes.hat)
        return
    mesh.ball((-0.025, 0.0, 0.045), (0.105, 0.095, 0.105), clothes.hair)
    if clothes.has_long_hair:
        mesh.hull(
            (-0.13, -0.02, -0.09, 0.09, -0.2),
            (-0.12, 0.02, -0.095, 0.095, 0.06),
            clothes.hair,
        )
