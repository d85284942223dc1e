"""Objects that are unexpected on a road."""

import itertools
import math

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.fire import flames, smoke_column
from oodscen_pybullet._meshes.living.body import Clothes
from oodscen_pybullet._meshes.living.figure import Posture, figure
from oodscen_pybullet._meshes.look import Appearance


def open_manhole(mesh: MeshBuilder) -> None:
    """An open manhole: a black hole with an iron rim and its lid beside it."""
    mesh.cylinder((0, 0, 0), (0, 0, 0.03), 0.46, "rust", sides=20, cap_colour="metal")
    mesh.cylinder((0, 0, 0.03), (0, 0, 0.034), 0.38, "black", sides=20)
    mesh.cylinder((0.3, 0.82, 0), (0.3, 0.82, 0.11), 0.42, "rust", sides=20, cap_colour="dirty_hub")
    for k in range(4):
        turn = math.pi * k / 4
        x, y = 0.34 * math.cos(turn), 0.34 * math.sin(turn)
        mesh.beam((0.3 - x, 0.82 - y, 0.105), (0.3 + x, 0.82 + y, 0.105), 0.03, "metal")


def mannequin(mesh: MeshBuilder) -> None:
    """A white, faceless shop-window dummy on a stand, facing -x."""
    doll = MeshBuilder()
    white = "plastic"
    clothes = Clothes("purple", white, sleeves=white, hair=white, skin=white, shoes=white)
    figure(doll, clothes, Appearance(), Posture((0.3, 0.36, 1.2), (0.1, -0.42, 0.98)))
    doll.grounded().shift((0, 0, 0.04))
    doll.ball((0.02, 0, 1.66), (0.112, 0.095, 0.135), white)
    doll.cylinder((0, 0, 0), (0, 0, 0.04), 0.26, "dark_grey", sides=14)
    doll.cylinder((-0.14, 0, 0.04), (-0.14, 0, 0.9), 0.02, "metal", sides=6)
    for z in (0.86, 1.2):
        doll.column([((0, 0, z), 0.125, 0.172), ((0, 0, z + 0.015), 0.125, 0.172)], "grey", caps="")
    mesh.add_surface(doll.build(), yaw=math.pi)


def drone(mesh: MeshBuilder) -> None:
    """A large quadcopter that has crashed on the road."""
    mesh.hull((-0.24, 0.24, -0.16, 0.16, 0.26), (-0.18, 0.18, -0.12, 0.12, 0.42), "white")
    mesh.box((0.26, 0, 0.3), (0.1, 0.12, 0.1), "black")
    mesh.cylinder((0.3, 0, 0.3), (0.34, 0, 0.3), 0.035, "glass_light", sides=8)
    mesh.ball((-0.2, 0, 0.4), (0.03, 0.03, 0.03), "red_lit", around=6, down=4)
    for sx, sy in itertools.product((-1.0, 1.0), (-1.0, 1.0)):
        x, y = sx * 0.46, sy * 0.46
        mesh.beam((sx * 0.14, sy * 0.1, 0.36), (x, y, 0.42), 0.05, "dark_grey")
        mesh.cylinder((x, y, 0.38), (x, y, 0.5), 0.055, "black", sides=8)
        spin = 0.7 * sx + 0.4 * sy
        a = (0.27 * math.cos(spin), 0.27 * math.sin(spin))
        mesh.beam((x - a[0], y - a[1], 0.52), (x + a[0], y + a[1], 0.52), 0.035, "orange")
        mesh.beam((sx * 0.12, sy * 0.14, 0.28), (sx * 0.16, sy * 0.24, 0.04), 0.03, "dark_grey")
    for sy in (-1.0, 1.0):
        mesh.beam((-0.3, sy * 0.24, 0.02), (0.3, sy * 0.24, 0.02), 0.04, "dark_grey")


def smoke(mesh: MeshBuilder, shown: Appearance) -> None:
    """A bank of grey smoke that drifts over the lane from a smouldering heap."""
    for index in range(12):
        turn = index * 2.4
        reach = 0.25 + 0.05 * index
        x, y = reach * math.cos(turn), reach * math.sin(turn)
        mesh.ball(
            (x, y, 0.0),
            (0.26, 0.24, 0.055),
            "char" if index % 2 else "ash",
            around=6,
            down=4,
            jitter=0.2,
            key=601 + index,
        )
    mesh.flatten(0.0)
    for y, key in ((0.0, 0.9), (-1.0, 0.35), (1.1, 0.3)):
        smoke_column(
            mesh,
            shown,
            (0.2 * y, y, 0.75),
            1.05,
            2.4,
            colour=(0.56, 0.56, 0.57),
            drift=key - 0.5,
            density=0.95,
            count=6,
        )


def fire(mesh: MeshBuilder, shown: Appearance) -> None:
    """A burning heap of wood and tyres."""
    for index in range(7):
        turn = index * 0.9
        a = (0.75 * math.cos(turn), 0.75 * math.sin(turn), 0.05)
        mesh.beam(
            a,
            (-0.2 * math.cos(turn), -0.2 * math.sin(turn), 0.55),
            0.12,
            "char" if index % 2 else "bark_dark",
        )
    mesh.ball((0, 0, 0.0), (0.8, 0.8, 0.2), "ash", around=9, down=6, jitter=0.15, key=621)
    mesh.flatten(0.0)
    seats = (
        (0.0, 0.0, 0.4),
        (0.35, 0.25, 0.2),
        (-0.35, 0.2, 0.22),
        (0.1, -0.4, 0.2),
        (-0.25, -0.3, 0.2),
    )
    flames(mesh, shown, seats, 0.32)
    smoke_column(
        mesh, shown, (0, 0, 1.5), 0.5, 3.0, density=0.65, colour=(0.25, 0.24, 0.24), count=7
    )
    mesh.lamp((0, 0, 0.9), (1.0, 0.6, 0.2), (0, 0, 0), 5.0)


STILL = (open_manhole, mannequin, drone)
VARIED = (smoke, fire)
