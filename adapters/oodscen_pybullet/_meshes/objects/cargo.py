"""Lost cargo and windblown objects that take arithmetic to describe."""

import math

from oodscen.numerics._exact import cos, sin
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.shapes import GOLDEN_ANGLE
from oodscen_pybullet._types import Point

_LOGS: tuple[tuple[Point, Point, float], ...] = (
    ((-0.9, -2.0, 0.24), (-0.7, 2.0, 0.24), 0.24),
    ((-0.3, -2.1, 0.22), (-0.2, 1.8, 0.22), 0.22),
    ((0.3, -1.7, 0.25), (0.3, 2.2, 0.25), 0.25),
    ((0.9, -2.2, 0.2), (0.8, 1.6, 0.2), 0.2),
    ((-0.6, -1.8, 0.62), (-0.3, 1.9, 0.64), 0.22),
    ((0.1, -1.9, 0.62), (0.2, 1.5, 0.62), 0.2),
    ((-1.2, 1.2, 0.85), (1.3, -0.7, 0.92), 0.18),
)
"""The thick and the thin end of each trunk, and its radius, m."""
_TAPER = 0.88
"""Radius of the thin end relative to the thick one."""
_HEARTWOOD, _HEARTWOOD_M = 0.55, 0.006
"""Radius of the darker wood in the middle of a cut relative to the trunk's, and its thickness, m."""
_STONES, _STONE_TURN = 24, 2.4
"""Stones around a heap of gravel, and the angle between neighbours, rad."""
_COLUMNS, _ROWS = 9, 8
"""Corners of a tarpaulin along x and y."""
_SHEET = (1.1, 1.3)
"""Half its length and half its width, m."""
_TWIGS = 44
"""Twigs of a tumbleweed."""
_WEED_Z, _WEED_RADIUS = 0.42, 0.40


def spilled_logs(mesh: MeshBuilder) -> None:
    """Tree trunks that rolled off a lorry, lying across each other."""
    for index, (start, end, radius) in enumerate(_LOGS):
        bark, thin = ("bark", "bark_dark")[index % 2], _TAPER * radius
        mesh.cylinder(start, end, radius, bark, sides=10, end_radius=thin, cap_colour="wood_fresh")
        _add_heartwood(mesh, start, end, radius)
        _add_heartwood(mesh, end, start, thin)


def _add_heartwood(mesh: MeshBuilder, point: Point, other: Point, radius: float) -> None:
    """Add the middle of a trunk's cut at a point; the other end is at another."""
    x, y, z = (
        p + _HEARTWOOD_M * (p - q) / math.dist(point, other)
        for p, q in zip(point, other, strict=True)
    )
    mesh.cylinder(point, (x, y, z), _HEARTWOOD * radius, "wood", sides=8)


def spilled_gravel(mesh: MeshBuilder) -> None:
    """A heap of gravel with stones around it."""
    mesh.ball((0, 0, 0), (1.3, 1.6, 0.62), "gravel", around=12, down=8, jitter=0.13, key=401)
    mesh.ball((-0.5, 0.7, 0), (0.8, 0.7, 0.36), "gravel", around=10, down=6, jitter=0.1, key=402)
    for index in range(_STONES):
        turn, reach = index * _STONE_TURN, 1.0 + 0.05 * (index % 5)
        x, y = 1.25 * reach * cos(turn), 1.6 * reach * sin(turn)
        size = 0.07 + 0.03 * (index % 3)
        radii = (size, size, 0.8 * size)
        mesh.ball((x, y, 0.6 * size), radii, "rock", around=5, down=4, jitter=0.2, key=410 + index)
    mesh.flatten(0.0)


def tarpaulin(mesh: MeshBuilder) -> None:
    """A crumpled blue tarpaulin."""
    corners = [[_crease(i, j) for j in range(_ROWS)] for i in range(_COLUMNS)]
    for i in range(_COLUMNS - 1):
        for j in range(_ROWS - 1):
            one, two, three, four = (
                corners[i][j], corners[i + 1][j], corners[i + 1][j + 1], corners[i][j + 1],
            )  # fmt: skip
            mesh.polygon([one, two, three], "blue" if (i + j) % 3 else "sky_blue")
            mesh.polygon([one, three, four], "blue")
    length, width = _SHEET
    for x, y in ((-length, -width), (length, -width), (length, width), (-length, width)):
        mesh.cylinder((x, y, 0.0), (0.97 * x, 0.97 * y, 0.04), 0.05, "silver", sides=6)


def _crease(i: int, j: int) -> Point:
    """Return a corner of the tarpaulin, which lies flat only at its edges."""
    bump = sin(1.7 * i + 0.8 * j) * cos(1.1 * j - 0.6 * i) + 0.6 * sin(2.9 * j + i)
    inwards = min(i, _COLUMNS - 1 - i, j, _ROWS - 1 - j)
    lying = 0.02 + 0.05 * (bump > 0.6)
    height = max(0.02, 0.08 + 0.12 * bump + 0.07 * inwards) if inwards else lying
    wave = 0.12 * sin(2.1 * j) if i in (0, _COLUMNS - 1) else 0.0
    length, width = _SHEET
    x = -length + 2 * length * i / (_COLUMNS - 1) + wave
    return x, -width + 2 * width * j / (_ROWS - 1), height


def tumbleweed(mesh: MeshBuilder) -> None:
    """A ball of dry twigs."""
    for index in range(_TWIGS):
        turn, rise = index * GOLDEN_ANGLE, -1 + 2 * (index + 0.5) / _TWIGS
        x, y, z = _on_sphere(turn, rise)
        start = (x, y, _WEED_Z + z)
        x, y, z = _on_sphere(turn + 1.5 + 0.3 * (index % 3), 0.6 * rise)
        end = (x, y, _WEED_Z - 0.9 * z)
        colour = ("straw", "wood_dark", "bark")[index % 3]
        mesh.beam(start, end, 0.022, colour, end_width=0.012)
    mesh.ball(
        (0, 0, _WEED_Z), (0.26, 0.26, 0.26), "straw",
        around=7, down=5, jitter=0.3, key=511, second_colour="wood_dark",
    )  # fmt: skip


def _on_sphere(turn: float, rise: float) -> Point:
    """Return a point of the tumbleweed's surface from its heading and its height, -1 to 1."""
    flat = math.sqrt(1 - rise * rise)
    x, y = cos(turn), sin(turn)
    return _WEED_RADIUS * flat * x, _WEED_RADIUS * flat * y, _WEED_RADIUS * rise


STILL = (spilled_logs, spilled_gravel, tarpaulin, tumbleweed)
