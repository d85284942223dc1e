"""People in unusual roles."""

import math
from dataclasses import replace

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.living.body import Clothes
from oodscen_pybullet._meshes.living.limbs import joint, limb
from oodscen_pybullet._meshes.living.people import (
    UPRIGHT,
    Posture,
    figure,
    has_free_hands,
    yellow_vest,
)
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._meshes.objects.signs import face
from oodscen_pybullet._meshes.shapes import upright
from oodscen_pybullet._types import Point

_SPOKES = 14
"""Corners of a wheel's rim; every second one has a spoke."""
_PROTESTERS = (
    ("shirt_green", "jeans", "skin", True),
    ("burgundy", "trousers", "skin_dark", False),
    ("black", "navy", "skin", False),
)
"""Top, trousers and skin, and whether the hair is long."""


def jogger(mesh: MeshBuilder, shown: Appearance) -> None:
    """A runner in shorts and a bright shirt."""
    tops = ("fluor_yellow", "orange", "teal")
    top, skin = tops[shown.index % 3], ("skin", "skin_dark")[shown.index % 2]
    clothes = Clothes(top, "black", skin=skin, sleeves=skin, shins=skin, shoes="fluor_orange")

    def headband(body: MeshBuilder, head: Point) -> None:
        x, _, z = head
        rings = [((x - 0.01, 0.0, z + 0.05), 0.115, 0.1), ((x - 0.01, 0.0, z + 0.09), 0.11, 0.096)]
        body.column(rings, "white")

    figure(mesh, clothes, shown, replace(UPRIGHT, half_step=0.36), on_head=headband)
    mesh.grounded()


def elderly_person(mesh: MeshBuilder, shown: Appearance) -> None:
    """An elderly person, bent forward, with grey hair and a stick."""
    is_woman = bool(shown.index % 2)
    clothes = Clothes(
        "shirt_green" if is_woman else "coat",
        "trousers",
        hair="light_grey",
        has_long_hair=is_woman,
        skirt="navy" if is_woman else "",
    )
    posture = Posture(right_hand=(0.38, -0.26, 0.86), lean=0.2, half_step=0.2, crouch=0.06)
    figure(mesh, clothes, shown, posture)
    if has_free_hands(shown):
        mesh.cylinder((0.40, -0.26, 0.02), (0.39, -0.26, 0.86), 0.018, "wood_dark", sides=6)
        mesh.beam((0.33, -0.26, 0.88), (0.44, -0.26, 0.88), 0.035, "wood_dark")
    mesh.grounded().shift((0, 0, 0), scale=0.95)


def wheelchair_user(mesh: MeshBuilder, shown: Appearance) -> None:
    """A person in a wheelchair, turning the wheels by hand."""
    phase, _ = shown.gait or (0.0, False)
    push = 0.1 * math.sin(2 * math.pi * phase)
    for side in (-1.0, 1.0):
        _side_of_wheelchair(mesh, side, phase)
        _seated_limbs(mesh, side, push)
    mesh.box((-0.05, 0, 0.5), (0.5, 0.5, 0.06), "black")
    mesh.box((-0.33, 0, 0.74), (0.05, 0.5, 0.44), "black")
    mesh.box((0.45, 0, 0.11), (0.2, 0.4, 0.03), "silver")
    _seated_trunk(mesh)


def _side_of_wheelchair(mesh: MeshBuilder, side: float, phase: float) -> None:
    """Add the wheels and the frame of the right (-1) or left (1) side, its wheel turned by a fraction of a turn."""
    y = side * 0.31
    _ring(mesh, (-0.1, y, 0.31), 0.30, "tyre", phase)
    mesh.cylinder((0.42, side * 0.24, 0.09), (0.42, side * 0.29, 0.09), 0.09, "tyre", sides=10)
    mesh.beam((-0.3, side * 0.26, 0.5), (-0.36, side * 0.26, 0.98), 0.03, "silver")
    mesh.beam((-0.36, side * 0.26, 0.96), (-0.5, side * 0.26, 0.98), 0.04, "black")
    mesh.beam((0.2, side * 0.26, 0.5), (0.44, side * 0.2, 0.14), 0.03, "silver")
    mesh.beam((-0.3, side * 0.26, 0.5), (0.2, side * 0.26, 0.5), 0.03, "silver")


def _seated_limbs(mesh: MeshBuilder, side: float, push: float) -> None:
    """Add the right (-1) or left (1) leg and arm, the hand `push` metres ahead of the wheel's middle."""
    hip, foot = (-0.18, side * 0.1, 0.58), (0.36, side * 0.11, 0.24)
    knee, ankle = joint(hip, foot, 0.42, 0.38, (0.5, 0, 1.0))
    limb(mesh, (hip, knee, ankle), (0.085, 0.065, 0.045), ("jeans", "jeans"))
    mesh.box((0.43, side * 0.11, 0.17), (0.25, 0.1, 0.09), "shoe")
    shoulder = (-0.2, side * 0.2, 1.06)
    elbow, hand = joint(shoulder, (0.02 + push, side * 0.33, 0.58), 0.27, 0.26, (-1, side * 0.5, 0))
    limb(mesh, (shoulder, elbow, hand), (0.06, 0.048, 0.036), ("shirt", "skin"))
    mesh.ball(hand, (0.05, 0.04, 0.05), "skin", around=6, down=4)


def _seated_trunk(mesh: MeshBuilder) -> None:
    """Add the body, neck and head of a seated person."""
    mesh.column(
        [
            ((-0.2, 0, 0.54), 0.13, 0.17),
            ((-0.22, 0, 0.8), 0.12, 0.17),
            ((-0.2, 0, 1.06), 0.11, 0.21),
            ((-0.19, 0, 1.13), 0.05, 0.08),
        ],
        "shirt",
    )
    mesh.cylinder((-0.19, 0, 1.1), (-0.17, 0, 1.24), 0.05, "skin", sides=6)
    mesh.ball((-0.16, 0, 1.29), (0.10, 0.082, 0.125), "skin")
    mesh.ball((-0.185, 0, 1.335), (0.105, 0.095, 0.105), "hair")


def _ring(mesh: MeshBuilder, centre: Point, radius: float, colour: str, phase: float) -> None:
    """Add an upright spoked wheel, rotated by a fraction of a turn."""
    x, y, z = centre
    rim = []
    for i in range(_SPOKES):
        turn = 2 * math.pi * (i / _SPOKES - phase)
        rim.append((x + radius * math.cos(turn), y, z + radius * math.sin(turn)))
    for i, one in enumerate(rim):
        mesh.beam(one, rim[(i + 1) % _SPOKES], 0.04, colour)
        if i % 2 == 0:
            mesh.beam((x, y, z), one, 0.012, "silver")


def person_with_stroller(mesh: MeshBuilder, shown: Appearance) -> None:
    """A parent pushing a pram."""
    posture = Posture((0.40, 0.2, 1.04), (0.40, -0.2, 1.04), lean=0.06, half_step=0.28)
    clothes = Clothes("shirt_white", "jeans", "hair_fair", has_long_hair=True)
    figure(mesh, clothes, shown, posture)
    mesh.grounded().shift((-0.45, 0, 0))
    for x, radius in ((0.15, 0.14), (0.72, 0.11)):
        for side in (-1.0, 1.0):
            start, end = (x, side * 0.22, radius), (x, side * 0.26, radius)
            mesh.cylinder(start, end, radius, "tyre", sides=12)
            mesh.cylinder(end, (x, side * 0.265, radius), radius * 0.55, "silver", sides=8)
    for side in (-1.0, 1.0):
        mesh.beam((-0.04, side * 0.2, 1.05), (0.5, side * 0.2, 0.4), 0.03, "silver")
        mesh.beam((0.15, side * 0.22, 0.14), (0.5, side * 0.2, 0.5), 0.03, "silver")
        mesh.beam((0.72, side * 0.22, 0.11), (0.3, side * 0.2, 0.5), 0.03, "silver")
    mesh.beam((-0.04, -0.22, 1.05), (-0.04, 0.22, 1.05), 0.04, "black")
    mesh.hull((0.16, 0.7, -0.17, 0.17, 0.46), (0.08, 0.82, -0.2, 0.2, 0.78), "navy")
    mesh.cylinder((0.62, -0.2, 0.78), (0.62, 0.2, 0.78), 0.24, "navy", sides=12)
    mesh.box((0.3, 0, 0.8), (0.34, 0.3, 0.04), "shirt_white")


def construction_flagger(mesh: MeshBuilder, shown: Appearance) -> None:
    """A road worker holding a STOP paddle on a staff."""
    clothes = Clothes("fluor_orange", "navy", hat="white")
    posture = Posture(right_hand=(0.30, -0.28, 1.22), half_step=0.25)
    figure(mesh, clothes, shown, posture, worn=yellow_vest)
    if has_free_hands(shown):
        mesh.cylinder((0.32, -0.28, 0.1), (0.32, -0.28, 1.75), 0.018, "white", sides=6)
        face(mesh, (0.308, -0.28, 1.98), 0.3, "sign_stop", corners=8)
        face(mesh, (0.332, -0.28, 1.98), 0.3, "sign_stop", corners=8, is_forward=True)
    mesh.grounded()


def person_in_costume(mesh: MeshBuilder, shown: Appearance) -> None:
    """A person dressed up as a big yellow chicken."""
    clothes = Clothes("yellow", "orange", hair="yellow", skin="yellow", shoes="orange")
    figure(mesh, clothes, shown, replace(UPRIGHT, half_step=0.26), worn=_plumage)
    mesh.grounded()


def _plumage(body: MeshBuilder, head: Point) -> None:
    """Add the parts of a chicken around a person."""
    x, _, z = head
    body.ball((-0.04, 0, 1.08), (0.36, 0.36, 0.42), "yellow", around=12, down=8)
    body.ball((x, 0, z + 0.03), (0.19, 0.18, 0.21), "yellow", around=10, down=7)
    body.cylinder((x + 0.14, 0, z), (x + 0.40, 0, z - 0.04), 0.08, "orange", end_radius=0.01)
    for side in (-1.0, 1.0):
        body.ball(
            (x + 0.13, side * 0.09, z + 0.09), (0.045, 0.045, 0.06), "white", around=6, down=4
        )
        body.ball(
            (x + 0.165, side * 0.095, z + 0.09), (0.02, 0.02, 0.03), "black", around=6, down=4
        )
        body.ball((-0.06, side * 0.36, 1.12), (0.2, 0.07, 0.26), "machine", around=8, down=5)
        body.box((0.08, side * 0.1, 0.03), (0.42, 0.2, 0.05), "orange")
    for index in range(3):
        body.ball(
            (x - 0.1 + 0.1 * index, 0, z + 0.27), (0.08, 0.035, 0.09), "red", around=7, down=4
        )
        body.beam(
            (-0.3, 0.1 * (index - 1), 1.05),
            (-0.62, 0.14 * (index - 1), 1.36),
            0.14,
            "machine",
            end_width=0.04,
        )


def protester(mesh: MeshBuilder, shown: Appearance) -> None:
    """A demonstrator with a placard on a stick."""
    top, trousers, skin, has_long_hair = _PROTESTERS[shown.index % len(_PROTESTERS)]
    clothes = Clothes(top, trousers, skin=skin, has_long_hair=has_long_hair)
    posture = Posture((0.24, 0.12, 1.12), (0.24, -0.04, 1.42), half_step=0.26)
    figure(mesh, clothes, shown, posture)
    if has_free_hands(shown):
        _placard(mesh)
    mesh.grounded()


def _placard(mesh: MeshBuilder) -> None:
    """Add a placard on a stick, which can be read from the front and the back."""
    mesh.cylinder((0.25, 0.13, 0.98), (0.25, -0.05, 1.95), 0.018, "wood", sides=6)
    y, low, high = -0.08, 1.8, 2.36
    for x, sign in ((0.235, -1.0), (0.265, 1.0)):
        left, right = (x, y - sign * 0.38), (x, y + sign * 0.38)
        mesh.textured_quad(upright(left, right, low, high), "sign_placard")


def person_lying(mesh: MeshBuilder) -> None:
    """A person lying on their back on the road, arms and legs apart."""
    body = MeshBuilder()
    clothes = Clothes("shirt", "jeans", sleeves="skin")
    figure(body, clothes, Appearance(), Posture((0.06, 0.62, 1.5), (0.06, -0.62, 1.08)))
    facing_left = MeshBuilder().add_surface(body.build(), yaw=math.pi / 2).build()
    mesh.add_surface(facing_left, (0.0, 0.0, 0.14), roll=math.pi / 2).flatten(0.0)


STILL = (person_lying,)
VARIED = (
    jogger, elderly_person, wheelchair_user, person_with_stroller, construction_flagger,
    person_in_costume, protester,
)  # fmt: skip
