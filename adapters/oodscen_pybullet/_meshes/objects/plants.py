"""Fallen trees and poles, stumps, leaves and hay."""

import math

from oodscen.numerics._exact import cos, sin
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.shapes import GOLDEN_ANGLE
from oodscen_pybullet._types import Point

_BOUGHS: tuple[tuple[Point, Point], ...] = (
    ((0.0, 0.2, 0.55), (1.2, 1.1, 1.5)),
    ((0.0, 0.4, 0.55), (-1.1, 1.5, 1.7)),
    ((0.1, 1.2, 0.65), (0.9, 2.4, 2.0)),
    ((0.1, 1.5, 0.7), (-0.8, 2.9, 1.9)),
    ((0.0, -0.9, 0.5), (-0.5, -0.3, 1.5)),
    ((0.0, -1.5, 0.5), (0.3, -1.2, 1.3)),
    ((0.0, 0.9, 0.6), (0.2, 1.2, 2.2)),
)
"""Boughs of the fallen tree, from the trunk to their ends, m."""
_CLUMPS = (
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
"""Clumps of its leaves: x, y, z of the middle and radius, m."""
_GREENS = ("leaf", "leaf_dark", "leaf_light")
_AUTUMN = ("leaf_autumn", "leaf_yellow", "burgundy", "rust", "straw")


def fallen_tree(mesh: MeshBuilder) -> None:
    """A tree lying along its y axis, with roots on the right and a leafy crown on the left."""
    middle = (0.0, 0.6, 0.56)
    _trunk(mesh, (0, -3.1, 0.42), middle, (0.40, 0.30))
    mesh.cylinder(middle, (0.2, 3.2, 0.95), 0.30, "bark", sides=7, end_radius=0.08)
    for index in range(11):
        turn = 2 * math.pi * index / 11
        reach = 0.85 + 0.25 * (index % 3)
        height = max(0.05, 0.5 + reach * sin(turn))
        end = (0.9 * reach * cos(turn), -3.5 - 0.2 * (index % 2), height)
        mesh.beam((0, -3.0, 0.44), end, 0.22, "bark_dark", end_width=0.05)
    mesh.ball((0, -3.2, 0.5), (0.62, 0.22, 0.6), "soil", around=9, down=6, jitter=0.2, key=5)
    for start, end in _BOUGHS:
        mesh.beam(start, end, 0.17, "bark_dark", end_width=0.04)
    for index, (x, y, z, size) in enumerate(_CLUMPS):
        radii, green = (size, size, size * 0.8), _GREENS[index % 3]
        mesh.ball((x, y, z), radii, green, around=8, down=6, jitter=0.24, key=50 + index)
    mesh.flatten(0.0)


def _trunk(mesh: MeshBuilder, start: Point, end: Point, radii: tuple[float, float]) -> None:
    """Add a tapering trunk with bark and fresh wood at its ends."""
    first, last = radii
    mesh.cylinder(start, end, first, "bark", sides=9, end_radius=last, cap_colour="wood_fresh")


def fallen_pole(mesh: MeshBuilder) -> None:
    """A wooden power pole lying across the lane, with cross arms, insulators and slack wires."""
    _trunk(mesh, (0, -3.6, 0.17), (0.1, 3.4, 0.24), (0.17, 0.12))
    for k in range(5):
        turn = 1.3 * k
        splinter = (0.16 * cos(turn), -3.9, 0.2 + 0.16 * sin(turn))
        mesh.beam((0, -3.5, 0.2), splinter, 0.07, "wood_fresh", end_width=0.01)
    for y in (2.3, 2.9):
        mesh.beam((-0.95, y, 0.3), (1.1, y, 0.42), 0.13, "wood_dark")
        for x in (-0.8, -0.4, 0.5, 0.95):
            mesh.cylinder((x, y, 0.36), (x, y, 0.56), 0.05, "teal", sides=6, end_radius=0.035)
    mesh.cylinder((0.36, 1.5, 0.36), (0.36, 2.1, 0.38), 0.2, "grey", sides=10)
    for x, y in ((-0.8, 2.3), (0.95, 2.9), (-0.4, 2.9), (0.5, 2.3)):
        _wire(mesh, (x, y, 0.5))
    mesh.flatten(0.0)


def _wire(mesh: MeshBuilder, start: Point) -> None:
    """Add a wire that comes down from an insulator, away from the pole, and lies on the ground."""
    pieces, before, side = 6, start, math.copysign(1.0, start[0])
    for k in range(1, pieces + 1):
        share = k / pieces
        point = (
            start[0] + side * 1.3 * share,
            start[1] - 4.6 * share + 0.3 * sin(7 * share),
            max(0.02, 0.5 * (1 - 1.8 * share) + 0.05 * (k % 2)),
        )
        mesh.beam(before, point, 0.03, "black")
        before = point


def leaves_pile(mesh: MeshBuilder) -> None:
    """A heap of autumn leaves."""
    mesh.ball(
        (0, 0, 0), (0.85, 1.0, 0.34), "leaf_autumn",
        around=12, down=8, jitter=0.12, key=701, second_colour="leaf_yellow",
    )  # fmt: skip
    mesh.ball(
        (0.3, 0.5, 0), (0.55, 0.6, 0.28), "leaf_yellow",
        around=10, down=6, jitter=0.15, key=702, second_colour="burgundy",
    )  # fmt: skip
    for index in range(70):
        turn, reach = index * GOLDEN_ANGLE, 0.55 + 0.65 * ((index * 7) % 10) / 10
        x, y = 1.05 * reach * cos(turn), 1.2 * reach * sin(turn)
        dome = max(0.0, 1 - (x / 0.85) * (x / 0.85) - y * y)
        z, spin = 0.36 * math.sqrt(dome) + 0.02, 1.3 * index
        leaf = [
            (x + 0.09 * cos(spin + a) * r, y + 0.09 * sin(spin + a) * r, z + 0.02 * k)
            for k, (a, r) in enumerate(((0.0, 1.0), (1.57, 0.6), (3.14, 1.0), (4.71, 0.6)))
        ]
        colour = _AUTUMN[index % 5]
        mesh.polygon(leaf, colour).polygon(leaf[::-1], colour)
    mesh.flatten(0.0)


def stump(mesh: MeshBuilder) -> None:
    """A tree stump with roots and rings."""
    waist, top = (0, 0, 0.28), (0.02, 0, 0.58)
    mesh.cylinder((0, 0, 0), waist, 0.44, "bark", sides=12, end_radius=0.34)
    mesh.cylinder(waist, top, 0.34, "bark", sides=12, end_radius=0.32, cap_colour="wood_fresh")
    for radius, z, colour in (
        (0.25, 0.582, "wood"),
        (0.19, 0.586, "wood_fresh"),
        (0.12, 0.59, "wood"),
        (0.06, 0.594, "wood_dark"),
    ):
        mesh.cylinder((0.02, 0, 0.57), (0.02, 0, z), radius, colour, sides=12)
    for k in range(7):
        x, y = cos(0.9 * k), sin(0.9 * k)
        end = (0.72 * x, 0.72 * y, 0.03)
        mesh.beam((0.3 * x, 0.3 * y, 0.2), end, 0.2, "bark_dark", end_width=0.05)
    mesh.flatten(0.0)


def hay_bale(mesh: MeshBuilder) -> None:
    """A big round bale of straw."""
    front, back = (0, -0.6, 0.65), (0, 0.6, 0.65)
    mesh.cylinder(front, back, 0.65, "straw", sides=18, cap_colour="leaf_yellow")
    for radius, colour in ((0.5, "straw"), (0.34, "leaf_yellow"), (0.18, "straw")):
        y = 0.6 + 0.01 / radius
        mesh.cylinder((0, -y, 0.65), (0, y, 0.65), radius, colour, sides=14)
    for y in (-0.4, -0.13, 0.13, 0.4):
        mesh.cylinder((0, y - 0.01, 0.655), (0, y + 0.01, 0.655), 0.655, "white", sides=18)
    mesh.flatten(0.0)


STILL = (fallen_tree, fallen_pole, leaves_pile, stump, hay_bale)
