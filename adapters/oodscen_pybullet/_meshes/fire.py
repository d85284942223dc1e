"""Flames and smoke, animated in a cycle of eight frames."""

import math
from collections.abc import Sequence

from oodscen.numerics._exact import cos, sin
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._types import Point

BLACK_SMOKE: Point = (0.12, 0.115, 0.11)


def flames(mesh: MeshBuilder, shown: Appearance, seats: Sequence[Point], size: float) -> None:
    """Add flames that flicker in height, lean, and never exceed `size`.

    Args:
        mesh: The builder to add to.
        shown: Gives the animation frame.
        seats: Base points of the flames.
        size: Radius at the base, m; flames are about three times as high.
    """
    for index, (x, y, z) in enumerate(seats):
        turn = 2 * math.pi * (shown.cycle + 0.37 * index)
        for part, (colour, width, height) in enumerate((("ember", 1.0, 2.3), ("flame", 0.6, 1.6))):
            rise = size * height * (0.88 + 0.12 * sin(turn + part))
            lean = 0.25 * size * cos(turn + 2.0 * part)
            foot = (x, y, z - 0.1)
            middle = (x + 0.5 * lean, y, z + 0.3 * rise)
            tip = (x + lean, y + 0.3 * lean, z + rise)
            mesh.cylinder(
                foot, middle, 0.55 * size * width, colour, sides=6, end_radius=size * width * 0.62
            )
            mesh.cylinder(middle, tip, size * width * 0.62, colour, sides=6, end_radius=0.01)
        mesh.puff((x, y, z + 0.9 * size), 1.7 * size, (1.0, 0.62, 0.18), 0.55, is_bright=True)


def smoke_column(
    mesh: MeshBuilder,
    shown: Appearance,
    foot: Point,
    radius: float,
    height: float,
    *,
    colour: Point = BLACK_SMOKE,
    drift: float = 0.25,
    density: float = 0.9,
    count: int = 9,
) -> None:
    """Add puffs that rise, widen and thin out.

    Args:
        mesh: The builder to add to.
        shown: Gives the animation frame.
        foot: Origin of the smoke.
        radius: Radius of the lowest puff, m.
        height: Height of the column, m.
        colour: Colour of the smoke.
        drift: Lean to the left per metre of height.
        density: Density of the lowest puff.
        count: Number of puffs.
    """
    x, y, z = foot
    for index in range(count):
        share = (index + shown.cycle) / count
        wide = radius * (1.0 + 1.6 * share)
        sway = 0.35 * radius * sin(2.4 * index + 1.0)
        place = (x + sway, y + drift * height * share + sway, z + height * share)
        fade = density * (1.0 - share * share)
        tint = (colour[0] + 0.14 * share, colour[1] + 0.14 * share, colour[2] + 0.14 * share)
        mesh.puff(place, wide, tint, fade)
