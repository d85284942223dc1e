"""Objects flat enough to drive over."""

import math
from collections.abc import Sequence

from oodscen.numerics._exact import cos, sin
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.shapes import GOLDEN_ANGLE
from oodscen_pybullet._types import Point


def _wavy_outline(
    radii: tuple[float, float], z: float, waves: Sequence[tuple[int, float, float]], count: int = 24
) -> list[Point]:
    """Return a wavy outline; `waves` holds number, amplitude as a fraction of the radius, and phase."""
    outline = []
    for index in range(count):
        turn = 2 * math.pi * index / count
        wave = 1.0 + sum(share * sin(n * turn + phase) for n, share, phase in waves)
        outline.append((radii[0] * wave * cos(turn), radii[1] * wave * sin(turn), z))
    return outline


def _fill(
    mesh: MeshBuilder, outline: list[Point], colour: str, middle: tuple[float, float] = (0.0, 0.0)
) -> None:
    """Fill an outline from a point inside; it need not be convex."""
    centre = (*middle, outline[0][2])
    for start, end in zip(outline, outline[1:] + outline[:1], strict=True):
        mesh.polygon([centre, start, end], colour)


def _fill_around_centre(mesh: MeshBuilder, outline: list[Point], colour: str) -> None:
    """Fill an outline around its own centre."""
    x, y, _ = (sum(values) / len(outline) for values in zip(*outline, strict=True))
    _fill(mesh, outline, colour, (x, y))


def _add_foot(mesh: MeshBuilder, colour: str) -> None:
    """Extend the mesh down to the ground, to give it a thickness."""
    mesh.polygon([(0.1, 0, 0), (0, 0.1, 0), (-0.1, 0, 0)], colour)


def puddle(mesh: MeshBuilder) -> None:
    """A wide, shallow puddle that nothing collides with."""
    waves = ((3, 0.10, 0.6), (5, 0.05, 0.0))
    _fill(mesh, _wavy_outline((1.25, 1.6), 0.02, waves), "water")
    _fill(mesh, _wavy_outline((0.9, 1.15), 0.026, waves), "water_light")
    _fill(mesh, _wavy_outline((0.62, 0.8), 0.032, waves), "water")
    _add_foot(mesh, "water")


def oil_spill(mesh: MeshBuilder) -> None:
    """A black, reflective pool of oil with streaks of purple sheen."""
    waves = ((2, 0.12, 0.2), (5, 0.08, 1.0), (9, 0.04, 0.0))
    _fill(mesh, _wavy_outline((1.8, 1.35), 0.012, waves, 36), "oil")
    streaks = (
        (0.5, -0.3, 0.75, 0.22, "oil_sheen"),
        (-0.5, 0.35, 0.6, 0.2, "oil_sheen"),
        (0.35, -0.2, 0.4, 0.09, "oil_teal"),
        (-0.75, 0.3, 0.28, 0.08, "oil_teal"),
        (-0.2, -0.6, 0.5, 0.12, "oil_sheen"),
        (0.7, 0.5, 0.35, 0.12, "oil_sheen"),
    )
    for index, (x, y, long, wide, colour) in enumerate(streaks):
        outline = _wavy_outline(
            (long, wide), 0.016 + 0.002 * index, ((2, 0.15, 0.5), (3, 0.1, 1.0)), 16
        )
        c, s = cos(0.5 + 0.25 * index), sin(0.5 + 0.25 * index)
        _fill_around_centre(
            mesh, [(x + c * a - s * b, y + s * a + c * b, h) for a, b, h in outline], colour
        )
    for x, y, r in ((-2.1, 0.5, 0.2), (1.9, -0.9, 0.26), (0.6, 1.55, 0.16), (-1.2, -1.4, 0.22)):
        mesh.polygon([(x + a, y + b, h) for a, b, h in _wavy_outline((r, r), 0.012, (), 12)], "oil")
    _add_foot(mesh, "oil")


def broken_glass(mesh: MeshBuilder) -> None:
    """Glittering glass shards and lamp fragments, spread over the lane."""
    for index in range(130):
        turn, reach = index * GOLDEN_ANGLE, math.sqrt((index + 0.5) / 130)
        x, y = 1.2 * reach * cos(turn), 1.5 * reach * sin(turn)
        size, spin = 0.035 + 0.012 * (index % 5), 1.7 * index
        colour = ("plastic", "white", "glass_light", "sky_blue", "plastic")[index % 5]
        if index % 31 == 30:
            colour = "tail"
        z = 0.008 + 0.002 * (index % 7)
        points = [
            (x + size * cos(spin + a), y + 1.3 * size * sin(spin + a), z + 0.012 * k)
            for k, a in enumerate((0.0, 2.0, 4.3))
        ]
        mesh.polygon(points, colour)
    _add_foot(mesh, "glass_light")


def pothole(mesh: MeshBuilder) -> None:
    """A deep hole in the asphalt, with a pale broken rim, dark walls and a puddle at the bottom."""
    waves = ((3, 0.10, 0.3), (7, 0.07, 0.9))
    rings = (
        ((1.0, 1.3), 0.006, "asphalt_dark", 0.0),
        ((0.86, 1.12), 0.010, "rubble", 0.0),
        ((0.74, 0.98), 0.014, "hole", 0.04),
        ((0.60, 0.80), 0.017, "mud", 0.10),
        ((0.46, 0.62), 0.020, "water_light", 0.12),
    )
    for radii, z, colour, shift in rings:
        _fill_around_centre(
            mesh, [(x + shift, y, h) for x, y, h in _wavy_outline(radii, z, waves, 28)], colour
        )
    for index in range(26):
        turn = index * GOLDEN_ANGLE
        reach = 1.0 + 0.16 * (index % 5)
        x, y = 0.9 * reach * cos(turn), 1.15 * reach * sin(turn)
        size = 0.045 + 0.02 * (index % 3)
        mesh.box((x, y, 0.02), (2 * size, 1.6 * size, 0.04), "asphalt" if index % 2 else "rubble")
    for index in range(7):
        turn = 0.9 * index + 0.2
        x, y = 0.95 * cos(turn), 1.25 * sin(turn)
        tip = (1.45 * cos(turn + 0.12), 1.8 * sin(turn + 0.12), 0.008)
        crack = [(x - 0.03, y - 0.03, 0.008), tip, (x + 0.03, y + 0.03, 0.008)]
        mesh.polygon(crack, "hole").polygon(crack[::-1], "hole")


def flood_water(mesh: MeshBuilder) -> None:
    """Brown flood water across the whole lane, with ripples and drifting twigs."""
    waves = ((2, 0.05, 0.0), (5, 0.04, 0.7))
    _fill(mesh, _wavy_outline((4.5, 3.4), 0.015, waves, 36), "flood")
    for index in range(26):
        turn, reach = index * GOLDEN_ANGLE, math.sqrt((index + 0.5) / 28)
        x, y = 3.7 * reach * cos(turn), 2.8 * reach * sin(turn)
        wide = 0.3 + 0.12 * (index % 3)
        points = [
            (x + a, y + b, z)
            for a, b, z in _wavy_outline((0.07, wide), 0.022, ((1, 0.2, 0.4),), 10)
        ]
        mesh.polygon(points, "flood_light" if index % 3 else "water_light")
    for x, y, turn in ((1.6, -1.0, 0.4), (-1.5, 1.2, 2.0), (0.2, 2.1, 1.1), (-2.6, -1.4, 0.2)):
        dx, dy = 0.4 * cos(turn), 0.4 * sin(turn)
        mesh.beam((x - dx, y - dy, 0.03), (x + dx, y + dy, 0.04), 0.05, "bark_dark", end_width=0.02)
    _add_foot(mesh, "flood")


def zebra_crossing(mesh: MeshBuilder) -> None:
    """The stripes of a zebra crossing over one lane, painted on the road."""
    for index in range(4):
        y = -1.22 + 0.81 * index
        corners = ((-1.6, y - 0.2), (1.6, y - 0.2), (1.6, y + 0.2), (-1.6, y + 0.2))
        mesh.polygon([(x, y, 0.012) for x, y in corners], "white")
    _add_foot(mesh, "white")


STILL = (puddle, oil_spill, broken_glass, pothole, flood_water, zebra_crossing)
