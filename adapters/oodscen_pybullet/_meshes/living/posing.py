"""People in the poses of `poses.toml`: the body is built upright, and turned about the hips."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from oodscen.numerics._exact import PI
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.living import body
from oodscen_pybullet._meshes.living.body import HIP_M, SHOULDER_M, Clothes
from oodscen_pybullet._meshes.living.joints import (
    HIP_Y,
    SHOULDER_Y,
    Chain,
    arm_joints,
    leg_joints,
    point_along,
    trunk_rotation,
)
from oodscen_pybullet._meshes.living.limbs import limb
from oodscen_pybullet._meshes.living.poses import Arm, KeyFrame, Pose
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._meshes.shapes import rotated, rotation
from oodscen_pybullet._types import Point

_ROPE = "#c8a86a"
_GLOW = (0.75, 0.85, 1.0)
"""Colour of a lit screen."""
_HANGING: Arm = (6.0, 60.0, 4.0, 0.0)
"""Angles of an arm whose hand is beside the hip, degrees."""
_Extras = Sequence[Callable[[MeshBuilder, Point], None] | None]


def posed_figure(
    mesh: MeshBuilder,
    clothes: Clothes,
    shown: Appearance,
    pose: Pose,
    half_step: float,
    extras: _Extras,
) -> None:
    """Add an adult of 1.75 m in a pose.

    Args:
        mesh: Receives the adult.
        clothes: The colours.
        shown: The step and the beat of the pose's cycle.
        pose: Angles of the joints.
        half_step: Distance ahead of the hip at which a walking foot lands, m.
        extras: Functions that add to the trunk, and to the head.
    """
    frame = pose.at(shown.beat)
    gait = shown.gait if pose.is_walking else None
    bends_legs = pose.bends_legs and gait is None
    worn, on_head = extras
    dressed = replace(clothes, legs=clothes.skirt or clothes.legs) if bends_legs else clothes
    drop = body.drop_of(gait)
    person, upper, hip = MeshBuilder(), MeshBuilder(), HIP_M - drop
    for side in (-1.0, 1.0):
        step = gait and gait.of(side, backwards=pose.backwards)
        if bends_legs:
            angles = frame.left_leg if side > 0 else frame.right_leg
            assert angles is not None
            joints = leg_joints(angles, side, (0.0, side * HIP_Y, hip), frame.lean)
            _add_leg(upper, dressed, joints)
        else:
            body.add_leg(person, clothes, side, hip, step, half_step)
        shoulder = (0.0, side * SHOULDER_Y, SHOULDER_M - drop)
        arm_angles = frame.left_arm if side > 0 else frame.right_arm
        if arm_angles is None:
            body.add_arm(upper, dressed, side, shoulder, None, step)
        else:
            _add_arm(upper, dressed, arm_joints(arm_angles, side, shoulder), pose.hands)
    body.add_trunk(upper, dressed, hip, SHOULDER_M - drop, 0.0)
    head = body.add_neck(upper, clothes, SHOULDER_M - drop, 0.0)
    face = MeshBuilder()
    body.add_head(face, clothes)
    if on_head is not None:
        on_head(face, (0.0, 0.0, 0.0))
    nod, turn = frame.head
    look = rotation(pitch=PI * nod / 180.0, yaw=PI * turn / 180.0)
    upper.add_surface(face.build().moved(look, to=head))
    if worn is not None:
        worn(upper, head)
    middle = (0.0, 0.0, hip)
    person.add_surface(upper.build().moved(trunk_rotation(frame), about=middle, to=middle))
    if not bends_legs:
        body.add_skirt(person, clothes, hip)
    _add_things(mesh, pose, frame)
    mesh.add_surface(person.build(), yaw=PI if pose.backwards else 0.0)


def _add_leg(mesh: MeshBuilder, clothes: Clothes, joints: Chain) -> None:
    shin = clothes.shins or clothes.legs
    limb(mesh, joints[:3], (0.09, 0.065, 0.045), (clothes.legs, shin))
    heel = point_along(joints.end, joints.way, -0.07)
    toe = point_along(joints.end, joints.way, 0.19)
    mesh.beam(heel, toe, 0.105, clothes.shoes, end_width=0.07)


def _add_arm(mesh: MeshBuilder, clothes: Clothes, joints: Chain, hand: str) -> None:
    lower = clothes.sleeves or clothes.top
    limb(mesh, joints[:3], (0.062, 0.048, 0.034), (clothes.top, lower))
    colour = clothes.gesture_gloves or clothes.skin
    mesh.ball(joints.end, (0.045, 0.045, 0.06), colour, around=6, down=4)
    tip = point_along(joints.end, joints.way, 0.2)
    if hand == "flat":
        mesh.beam(joints.end, tip, 0.11, colour, end_width=0.08)
    elif hand == "finger":
        mesh.beam(joints.end, tip, 0.035, colour)


def hands(frame: KeyFrame) -> tuple[Point, Point]:
    """Return the right and the left hand of a person who stands; those without angles hang."""
    hip, points = np.array([0.0, 0.0, HIP_M]), []
    for side, angles in ((-1.0, frame.right_arm), (1.0, frame.left_arm)):
        shoulder = (0.0, side * SHOULDER_Y, SHOULDER_M)
        points.append(arm_joints(angles or _HANGING, side, shoulder).end)
    right, left = (rotated(np.array(points) - hip, trunk_rotation(frame)) + hip).tolist()
    return tuple(right), tuple(left)


def _add_things(mesh: MeshBuilder, pose: Pose, frame: KeyFrame) -> None:
    """Add what a pose has in its hands by itself."""
    if not (pose.rope or pose.phone):
        return
    right, left = hands(frame)
    if pose.rope:
        mesh.beam(left, right, 0.05, _ROPE)
        end = (right[0] + 1.5, 0.0, 0.5)
        mesh.beam(right, end, 0.05, _ROPE)
    if pose.phone:
        x, y, z = right
        mesh.box((x + 0.02, y, z + 0.07), (0.03, 0.08, 0.15), "black")
        mesh.box((x - 0.002, y, z + 0.07), (0.012, 0.07, 0.13), "screen_lit")
        mesh.lamp((x - 0.05, y, z + 0.08), _GLOW, (-1.0, 0.0, 0.0), 0.4)
