"""Smoke and fire on the road."""

from oodscen.numerics._exact import cos, sin
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.fire import flames, smoke_column
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._types import Point

_GREY: Point = (0.56, 0.56, 0.57)
_DARK: Point = (0.25, 0.24, 0.24)
"""Colours of the smoke of embers and of a fire."""
_EMBERS_M, _EMBERS_STEP_M = 0.25, 0.05
"""Distance of the first heap of embers from the middle, m, and of each further one from the one before."""
_COLUMNS = ((0.0, 0.4), (-1.0, -0.15), (1.1, -0.2))
"""y of the columns of a bank of smoke, m, and their drift."""
_SEATS: tuple[Point, ...] = (
    (0.0, 0.0, 0.4),
    (0.35, 0.25, 0.2),
    (-0.35, 0.2, 0.22),
    (0.1, -0.4, 0.2),
    (-0.25, -0.3, 0.2),
)
"""Feet of the flames."""


def smoke(mesh: MeshBuilder, shown: Appearance) -> None:
    """A bank of grey smoke that drifts over the lane from a smouldering heap."""
    for index in range(12):
        turn, reach = index * 2.4, _EMBERS_M + _EMBERS_STEP_M * index
        at = (reach * cos(turn), reach * sin(turn), 0.0)
        colour = "char" if index % 2 else "ash"
        mesh.ball(
            at, (0.26, 0.24, 0.055), colour, around=6, down=4, jitter=0.2, key=601 + index
        )  # fmt: skip
    mesh.flatten(0.0)
    for y, drift in _COLUMNS:
        smoke_column(
            mesh, shown, (0.2 * y, y, 0.75), 1.05, 2.4,
            colour=_GREY, drift=drift, density=0.95, count=6,
        )  # fmt: skip


def fire(mesh: MeshBuilder, shown: Appearance) -> None:
    """A burning heap of wood and tyres."""
    for index in range(7):
        turn = index * 0.9
        x, y = cos(turn), sin(turn)
        colour = "char" if index % 2 else "bark_dark"
        mesh.beam((0.75 * x, 0.75 * y, 0.05), (-0.2 * x, -0.2 * y, 0.55), 0.12, colour)
    mesh.ball((0, 0, 0.0), (0.8, 0.8, 0.2), "ash", around=9, down=6, jitter=0.15, key=621)
    mesh.flatten(0.0)
    flames(mesh, shown, _SEATS, 0.32)
    smoke_column(mesh, shown, (0, 0, 1.5), 0.5, 3.0, density=0.65, colour=_DARK, count=7)
    mesh.lamp((0, 0, 0.9), (1.0, 0.6, 0.2), (0, 0, 0), 5.0)


VARIED = (smoke, fire)
