"""Trees, standing and fallen."""

import math

import numpy as np

from oodscen_pybullet.meshes.bodywork import Lights
from oodscen_pybullet.meshes.builder import MeshBuilder


def fallen_tree(lights: Lights, paint: str) -> MeshBuilder:
    """A tree lying along its y axis: roots on the right, a leafy crown on the left."""
    mesh = MeshBuilder()
    mesh.cylinder(
        (0, -3.1, 0.42),
        (0.0, 0.6, 0.56),
        0.40,
        "bark",
        sides=9,
        end_radius=0.30,
        cap_colour="wood_fresh",
    )
    mesh.cylinder((0.0, 0.6, 0.56), (0.2, 3.2, 0.95), 0.30, "bark", sides=7, end_radius=0.08)
    for index in range(11):
        turn = 2 * math.pi * index / 11
        reach = 0.85 + 0.25 * (index % 3)
        end = (
            0.9 * reach * math.cos(turn),
            -3.5 - 0.2 * (index % 2),
            max(0.05, 0.5 + reach * math.sin(turn)),
        )
        mesh.beam((0, -3.0, 0.44), end, 0.22, "bark_dark", end_width=0.05)
    mesh.ball((0, -3.2, 0.5), (0.62, 0.22, 0.6), "soil", around=9, down=6, jitter=0.2, key=5)
    boughs = (
        ((0.0, 0.2, 0.55), (1.2, 1.1, 1.5)),
        ((0.0, 0.4, 0.55), (-1.1, 1.5, 1.7)),
        ((0.1, 1.2, 0.65), (0.9, 2.4, 2.0)),
        ((0.1, 1.5, 0.7), (-0.8, 2.9, 1.9)),
        ((0.0, -0.9, 0.5), (-0.5, -0.3, 1.5)),
        ((0.0, -1.5, 0.5), (0.3, -1.2, 1.3)),
        ((0.0, 0.9, 0.6), (0.2, 1.2, 2.2)),
    )
    for start, end in boughs:
        mesh.beam(start, end, 0.17, "bark_dark", end_width=0.04)
    clumps = (
        (1.15, 1.2, 1.2, 0.55),
        (-1.1, 1.6, 1.3, 0.55),
        (0.2, 1.4, 1.9, 0.5),
        (0.85, 2.4, 1.5, 0.7),
        (-0.7, 2.8, 1.4, 0.75),
        (0.2, 3.1, 1.0, 0.85),
        (0.9, 3.2, 0.6, 0.6),
        (-0.8, 3.5, 0.5, 0.55),
        (-0.9, 1.9, 0.5, 0.5),
        (0.9, 1.7, 0.4, 0.5),
        (-0.5, -0.3, 1.45, 0.25),
        (0.1, 3.8, 0.7, 0.55),
    )
    greens = ("leaf", "leaf_dark", "leaf_light")
    for index, (x, y, z, size) in enumerate(clumps):
        mesh.ball(
            (x, y, z),
            (size, size, size * 0.8),
            greens[index % 3],
            around=8,
            down=6,
            jitter=0.24,
            key=50 + index,
        )
    mesh.flatten(0.0)
    return (
        mesh.solid((0, -1.2, 0.45), (0.8, 4.4, 0.9)).solid((0, 2.4, 1.0), (2.6, 3.0, 2.0)).centred()
    )


def branch(lights: Lights, paint: str) -> MeshBuilder:
    """A broken bough with twigs and leaves, along its y axis."""
    mesh = MeshBuilder()
    mesh.cylinder(
        (0, -1.1, 0.09),
        (0.05, 0.3, 0.16),
        0.09,
        "bark",
        sides=7,
        end_radius=0.07,
        cap_colour="wood_fresh",
    )
    mesh.cylinder((0.05, 0.3, 0.16), (0.1, 1.1, 0.3), 0.07, "bark", sides=6, end_radius=0.03)
    for start, end in (
        ((0.0, -0.5, 0.12), (0.45, 0.0, 0.36)),
        ((0.0, -0.1, 0.14), (-0.45, 0.5, 0.4)),
        ((0.05, 0.4, 0.17), (0.4, 0.9, 0.45)),
        ((0.0, -0.7, 0.12), (-0.35, -0.4, 0.3)),
    ):
        mesh.beam(start, end, 0.05, "bark_dark", end_width=0.02)
    clumps = (
        (0.45, 0.05, 0.3, 0.24),
        (-0.42, 0.5, 0.32, 0.28),
        (0.4, 0.9, 0.36, 0.3),
        (0.05, 1.15, 0.3, 0.34),
        (-0.3, -0.35, 0.24, 0.18),
        (0.1, 0.7, 0.34, 0.26),
    )
    for index, (x, y, z, size) in enumerate(clumps):
        mesh.ball(
            (x, y, z),
            (size, size, size * 0.75),
            "leaf" if index % 2 else "leaf_light",
            around=7,
            down=5,
            jitter=0.25,
            key=70 + index,
            second_colour="leaf_dark",
        )
    mesh.flatten(0.0)
    return mesh.centred()


def broad_tree(key: int) -> MeshBuilder:
    """A broad-leaved tree of about seven metres."""
    mesh = MeshBuilder()
    rng = np.random.Generator(np.random.PCG64(1000 + key))
    mesh.cylinder((0, 0, 0), (0, 0, 2.9), 0.2, "bark", sides=7, end_radius=0.13)
    for turn in (0.4, 2.5, 4.4):
        mesh.beam(
            (0, 0, 2.3),
            (1.0 * math.cos(turn), 1.0 * math.sin(turn), 3.6),
            0.14,
            "bark",
            end_width=0.06,
        )
    greens = ("leaf", "leaf_dark", "leaf_light")
    for index in range(5):
        turn = index * 2.2 + key
        reach = 0.0 if index == 0 else 0.95 + 0.35 * float(rng.uniform())
        size = 1.75 if index == 0 else 1.05 + 0.3 * float(rng.uniform())
        z = 4.7 if index == 0 else 3.6 + 1.9 * float(rng.uniform())
        at = (reach * math.cos(turn), reach * math.sin(turn), z)
        mesh.ball(
            at,
            (size, size, size * 0.86),
            greens[(index + key) % 3],
            around=7,
            down=4,
            jitter=0.15,
            key=90 + key * 7 + index,
        )
    return mesh


def conifer(key: int) -> MeshBuilder:
    """A fir of about nine metres."""
    mesh = MeshBuilder()
    mesh.cylinder((0, 0, 0), (0, 0, 1.6), 0.18, "bark_dark", sides=6)
    for z0, z1, radius in ((1.0, 4.0, 2.0), (2.9, 5.8, 1.6), (4.7, 7.4, 1.2), (6.2, 9.0, 0.8)):
        mesh.cylinder(
            (0, 0, z0), (0, 0, z1), radius, "needle", sides=9, end_radius=0.02, phase=key + z0
        )
    return mesh


def bush(key: int) -> MeshBuilder:
    """A bush of about one metre."""
    mesh = MeshBuilder()
    mesh.ball(
        (0, 0, 0.5),
        (0.9, 0.8, 0.6),
        "leaf_dark" if key % 2 else "leaf",
        around=8,
        down=5,
        jitter=0.2,
        key=200 + key,
    )
    return mesh
