"""The figure of an adult, facing x, who stands, walks or runs, or is in a pose."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import ClassVar

from pydantic import ConfigDict

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.living.body import (
    HIP_M,
    SHOULDER_M,
    Clothes,
    add_arm,
    add_head,
    add_leg,
    add_neck,
    add_skirt,
    add_trunk,
    drop_of,
)
from oodscen_pybullet._meshes.living.poses import pose_of
from oodscen_pybullet._meshes.living.posing import posed_figure
from oodscen_pybullet._meshes.look import Appearance, Direction
from oodscen_pybullet._types import Point

_TURNS = {"left": 1.0, "right": -1.0}
"""Angle by which the head turns towards a vehicle, rad."""
_RAISED_HAND: Point = (0.14, 0.44, 1.76)
"""Position of the left hand that stops a vehicle, m."""


@dataclass(frozen=True)
class Posture:
    """The posture of a body."""

    __pydantic_config__: ClassVar = ConfigDict(extra="forbid")

    left_hand: Point | None = None
    """Position of the hand; `None` swings it with the legs."""
    right_hand: Point | None = None
    lean: float = 0.0
    """Distance by which the shoulders are ahead of the hips, m."""
    half_step: float = 0.33
    """Distance ahead of the hip at which a walking foot lands, m."""
    crouch: float = 0.0
    """Distance by which the hips are lowered, m."""


UPRIGHT = Posture()
Extra = Callable[[MeshBuilder, Point], None]
"""Adds something to a body whose head is at a point."""


def figure(
    mesh: MeshBuilder,
    clothes: Clothes,
    shown: Appearance,
    posture: Posture = UPRIGHT,
    *,
    worn: Extra | None = None,
    on_head: Extra | None = None,
) -> None:
    """Add an adult of 1.75 m who stands, walks or runs, or is in the pose of its details.

    Args:
        mesh: Receives the adult.
        clothes: The colours.
        shown: The step and the details.
        posture: The posture without a pose.
        worn: Adds what moves with the trunk.
        on_head: Adds what moves with the head.
    """
    pose = pose_of(shown.details)
    if pose is not None:
        posed_figure(mesh, clothes, shown, pose, posture.half_step, (worn, on_head))
        return
    gait = shown.gait
    if shown.warned:
        posture = _reacting(posture, shown.warned)
    lean = posture.lean + (0.10 if gait and gait.runs else 0.0)
    drop = posture.crouch + drop_of(gait)
    hip, shoulder = HIP_M - drop, SHOULDER_M - drop
    for side in (-1.0, 1.0):
        step = gait and gait.of(side)
        add_leg(mesh, clothes, side, hip, step, posture.half_step)
        hand = posture.left_hand if side > 0 else posture.right_hand
        add_arm(mesh, clothes, side, (lean, side * 0.225, shoulder), hand, step)
    add_trunk(mesh, clothes, hip, shoulder, lean)
    add_skirt(mesh, clothes, hip)
    head = add_neck(mesh, clothes, shoulder, lean)
    face = MeshBuilder()
    add_head(face, clothes)
    mesh.add_surface(face.build(), head, yaw=_TURNS.get(shown.warned or "", 0.0))
    for extra in (worn, on_head):
        if extra is not None:
            extra(mesh, head)


def _reacting(posture: Posture, direction: Direction) -> Posture:
    """Return a posture that reacts to a vehicle: free hands up, those that hold something stay."""
    left, right, lean = posture.left_hand, posture.right_hand, posture.lean
    x, y, z = _RAISED_HAND
    if direction in ("ahead", "left"):
        left = left or _RAISED_HAND
    if direction in ("ahead", "right"):
        right = right or (x, -y, z)
    if direction == "ahead":
        lean -= 0.1
    return replace(posture, left_hand=left, right_hand=right, lean=lean)
