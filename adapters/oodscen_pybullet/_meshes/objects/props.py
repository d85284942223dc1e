"""Objects that lie on roads and that take arithmetic to describe."""

import itertools
import math

from oodscen.numerics._exact import cos, sin
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.designs import add_design
from oodscen_pybullet._meshes.shapes import across
from oodscen_pybullet._types import Point

_LEAVES, _LEAF_TURN, _LEAF_M = 11, 2.4, 0.11
"""Leaves of a plant, the angle between neighbours, rad, and half the width of one, m."""
_MATTRESS = ((-1.0, 0.0), (-0.4, 0.0), (0.2, 0.0), (0.6, 0.12), (0.92, 0.42))
"""x and z of a mattress's underside from end to end, m."""
_HALF_M, _THICK_M, _STRIPES = 0.72, 0.24, 6
"""Half its width and its thickness, m, and the stripes across it."""
_FLOOR = ((-0.28, -0.2), (0.36, -0.2), (0.36, 0.2), (-0.28, 0.2))
_RIM = ((-0.42, -0.28), (0.46, -0.28), (0.46, 0.28), (-0.42, 0.28))
"""Corners of a trolley's basket, x and y, m."""
_FLOOR_Z, _RIM_Z = 0.42, 0.92
_UPRIGHTS, _HOOPS = 6, 4
"""Wires on each side of the basket."""


def plant_pot(mesh: MeshBuilder) -> None:
    """A big terracotta pot with a bushy plant."""
    mesh.cylinder((0, 0, 0), (0, 0, 0.46), 0.22, "terracotta", sides=14, end_radius=0.32)
    mesh.cylinder((0, 0, 0.44), (0, 0, 0.54), 0.36, "terracotta", sides=14, cap_colour="soil")
    for index in range(_LEAVES):
        turn = index * _LEAF_TURN
        reach, rise = 0.34 + 0.08 * (index % 3), 0.86 + 0.12 * (index % 4)
        tip = (reach * cos(turn), reach * sin(turn), rise)
        bend = (reach * 0.5 * cos(turn), reach * 0.5 * sin(turn), rise - 0.06)
        mesh.beam((0, 0, 0.52), bend, 0.035, "leaf_dark")
        _add_leaf(mesh, bend, tip, ("leaf", "leaf_light", "leaf_dark")[index % 3])
    mesh.ball(
        (0, 0, 0.86), (0.22, 0.22, 0.26), "leaf", jitter=0.2, key=3, second_colour="leaf_dark"
    )
    for index in range(5):
        turn = index * 1.3 + 0.4
        flower = (0.2 * cos(turn), 0.2 * sin(turn), 1.08)
        mesh.ball(flower, (0.055, 0.055, 0.05), "red", around=6, down=4)


def _add_leaf(mesh: MeshBuilder, start: Point, end: Point, colour: str) -> None:
    """Add a leaf visible from above and below."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = math.sqrt(dx * dx + dy * dy)
    ax, ay = -dy / length * _LEAF_M, dx / length * _LEAF_M
    mx, my, mz = (start[0] + end[0]) / 2, (start[1] + end[1]) / 2, (start[2] + end[2]) / 2 + 0.05
    outline = [start, (mx - ax, my - ay, mz), end, (mx + ax, my + ay, mz)]
    mesh.polygon(outline, colour).polygon(outline[::-1], colour)


def mattress(mesh: MeshBuilder) -> None:
    """A sagging mattress with striped sides and one end bent up."""
    for start, end in itertools.pairwise(_MATTRESS):
        _add_piece(mesh, start, end)
    (x0, z0), (x1, z1) = _MATTRESS[0], _MATTRESS[-1]
    mesh.polygon(across(x0, _HALF_M, z0, z0 + _THICK_M), "mattress_edge")
    mesh.polygon(across(x1, -_HALF_M, z1, z1 + _THICK_M), "mattress_edge")


def _add_piece(mesh: MeshBuilder, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Add the mattress between two points of its underside: stripes on top, then the bottom and the edges."""
    (x0, z0), (x1, z1) = start, end
    top0, top1 = z0 + _THICK_M, z1 + _THICK_M
    stripe = 2 * _HALF_M / _STRIPES
    for index in range(_STRIPES):
        y0, y1 = -_HALF_M + stripe * index, -_HALF_M + stripe * (index + 1)
        colour = "mattress_stripe" if index % 2 else "mattress"
        mesh.polygon([(x0, y0, top0), (x1, y0, top1), (x1, y1, top1), (x0, y1, top0)], colour)
    bottom = [(x0, -_HALF_M, z0), (x0, _HALF_M, z0), (x1, _HALF_M, z1), (x1, -_HALF_M, z1)]
    mesh.polygon(bottom, "mattress")
    for y in (-_HALF_M, _HALF_M):
        edge = [(x0, y, z0), (x1, y, z1), (x1, y, top1), (x0, y, top0)]
        mesh.polygon(edge if y < 0 else edge[::-1], "mattress_edge")


def debris(mesh: MeshBuilder) -> None:
    """A heap of broken planks, bent metal and rubble."""
    add_design(mesh, "_broken_planks")
    for turn in (0.3, 2.1, 4.0):
        _add_bent_sheet(mesh, 0.6 * cos(turn), 0.6 * sin(turn))
    for index in range(9):
        turn, reach = index * 0.7, 0.55 + 0.08 * (index % 5)
        at = (reach * cos(turn), reach * sin(turn), 0.08)
        colour = "concrete_dark" if index % 2 else "wall_brick"
        mesh.ball(at, (0.15, 0.13, 0.10), colour, around=6, down=4, jitter=0.25, key=20 + index)
    mesh.ball((0, 0, 0.1), (0.75, 0.7, 0.24), "earth", around=9, down=4, jitter=0.2, key=31)


def _add_bent_sheet(mesh: MeshBuilder, x: float, y: float) -> None:
    """Add a sheet of metal that is rusty above."""
    sheet = [
        (x - 0.4, y - 0.25, 0.05),
        (x + 0.3, y - 0.3, 0.12),
        (x + 0.35, y + 0.3, 0.36),
        (x - 0.35, y + 0.25, 0.22),
    ]
    mesh.polygon(sheet, "rust").polygon(sheet[::-1], "metal")


def shopping_cart(mesh: MeshBuilder) -> None:
    """A supermarket trolley."""
    for side in range(4):
        _add_wires(mesh, side, (side + 1) % 4)
    add_design(mesh, "_trolley")


def _add_wires(mesh: MeshBuilder, i: int, j: int) -> None:
    """Add the wires of the basket's side between two of its corners."""
    for k in range(_UPRIGHTS):
        low, high = (_between(rim[i], rim[j], k / (_UPRIGHTS - 1)) for rim in (_FLOOR, _RIM))
        mesh.beam((*low, _FLOOR_Z), (*high, _RIM_Z), 0.018, "silver")
    for k in range(_HOOPS):
        share = k / (_HOOPS - 1)
        z = _FLOOR_Z + (_RIM_Z - _FLOOR_Z) * share
        start, end = (_between(_FLOOR[corner], _RIM[corner], share) for corner in (i, j))
        mesh.beam((*start, z), (*end, z), 0.022, "silver" if share < 1.0 else "light_grey")


def _between(
    start: tuple[float, float], end: tuple[float, float], share: float
) -> tuple[float, float]:
    """Return the point at a share of the way."""
    return start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])


STILL = (plant_pot, mattress, debris, shopping_cart)
