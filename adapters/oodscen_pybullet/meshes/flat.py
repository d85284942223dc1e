"""What lies so flat on the road that one drives over it."""

import math
from collections.abc import Sequence

from oodscen_pybullet.meshes.builder import MeshBuilder, Point
from oodscen_pybullet.meshes.shown import Shown


def _blot(
    radii: tuple[float, float], z: float, waves: Sequence[tuple[int, float, float]], count: int = 24
) -> list[Point]:
    """Return a wavy outline; `waves` are number, share and phase."""
    outline = []
    for index in range(count):
        turn = 2 * math.pi * index / count
        wave = 1.0 + sum(share * math.sin(n * turn + phase) for n, share, phase in waves)
        outline.append((radii[0] * wave * math.cos(turn), radii[1] * wave * math.sin(turn), z))
    return outline


def _fan(mesh: MeshBuilder, outline: list[Point], colour: str) -> None:
    """Fill an outline that need not be convex, from its middle."""
    middle = (0.0, 0.0, outline[0][2])
    for one, two in zip(outline, outline[1:] + outline[:1], strict=True):
        mesh.polygon([middle, one, two], colour)


def _foot(mesh: MeshBuilder, colour: str) -> None:
    """Reach down to the ground, so that the mesh has a thickness."""
    mesh.polygon([(0.1, 0, 0), (0, 0.1, 0), (-0.1, 0, 0)], colour)


def puddle(shown: Shown) -> MeshBuilder:
    """A wide, shallow puddle; nothing that could be hit."""
    mesh = MeshBuilder()
    waves = ((3, 0.10, 0.6), (5, 0.05, 0.0))
    _fan(mesh, _blot((1.25, 1.6), 0.02, waves), "water")
    _fan(mesh, _blot((0.9, 1.15), 0.026, waves), "water_light")
    _fan(mesh, _blot((0.62, 0.8), 0.032, waves), "water")
    _foot(mesh, "water")
    return mesh


def oil_spill(shown: Shown) -> MeshBuilder:
    """A black pool of oil with a purple sheen."""
    mesh = MeshBuilder()
    waves = ((2, 0.12, 0.2), (5, 0.08, 1.0), (9, 0.04, 0.0))
    _fan(mesh, _blot((1.8, 1.35), 0.012, waves, 36), "oil")
    for radii, colour, z in (
        ((1.0, 0.7), "oil_sheen", 0.017),
        ((0.7, 0.46), "teal", 0.021),
        ((0.5, 0.3), "oil_sheen", 0.024),
        ((0.3, 0.17), "oil", 0.028),
    ):
        points = [(x + 0.35, y - 0.15, h) for x, y, h in _blot(radii, z, ((3, 0.1, 1.0),), 20)]
        mesh.polygon(points, colour)
    for x, y, r in ((-2.1, 0.5, 0.2), (1.9, -0.9, 0.26), (0.6, 1.55, 0.16), (-1.2, -1.4, 0.22)):
        mesh.polygon([(x + a, y + b, h) for a, b, h in _blot((r, r), 0.012, (), 12)], "oil")
    _foot(mesh, "oil")
    return mesh


def broken_glass(shown: Shown) -> MeshBuilder:
    """Glittering shards of glass and pieces of a lamp, spread over the lane."""
    mesh = MeshBuilder()
    for index in range(130):
        turn, reach = index * 2.399963, math.sqrt((index + 0.5) / 130)
        x, y = 1.2 * reach * math.cos(turn), 1.5 * reach * math.sin(turn)
        size, spin = 0.035 + 0.012 * (index % 5), 1.7 * index
        colour = ("plastic", "white", "glass_light", "sky_blue", "plastic")[index % 5]
        if index % 31 == 30:
            colour = "tail"
        z = 0.008 + 0.002 * (index % 7)
        points = [
            (x + size * math.cos(spin + a), y + 1.3 * size * math.sin(spin + a), z + 0.012 * k)
            for k, a in enumerate((0.0, 2.0, 4.3))
        ]
        mesh.polygon(points, colour)
    _foot(mesh, "glass_light")
    return mesh


def pothole(shown: Shown) -> MeshBuilder:
    """A deep hole in the asphalt with a broken rim."""
    mesh = MeshBuilder()
    waves = ((3, 0.10, 0.3), (7, 0.07, 0.9))
    for radii, z, colour in (
        ((0.78, 0.98), 0.008, "asphalt_light"),
        ((0.66, 0.84), 0.012, "asphalt_dark"),
        ((0.55, 0.70), 0.016, "hole"),
        ((0.40, 0.5), 0.019, "oil"),
    ):
        _fan(mesh, _blot(radii, z, waves, 28), colour)
    puddle_in = [
        (x + 0.1, y - 0.1, z) for x, y, z in _blot((0.22, 0.3), 0.022, ((2, 0.1, 0.0),), 14)
    ]
    mesh.polygon(puddle_in, "water")
    for index in range(16):
        turn = index * 0.77
        reach = 1.0 + 0.18 * (index % 4)
        x, y = 0.72 * reach * math.cos(turn), 0.92 * reach * math.sin(turn)
        size = 0.04 + 0.015 * (index % 3)
        mesh.box(
            (x, y, 0.015), (2 * size, 1.6 * size, 0.03), "asphalt_dark" if index % 2 else "rock"
        )
    return mesh


def flood_water(shown: Shown) -> MeshBuilder:
    """Brown flood water across the whole lane, with ripples and drifting twigs."""
    mesh = MeshBuilder()
    waves = ((2, 0.05, 0.0), (5, 0.04, 0.7))
    _fan(mesh, _blot((4.5, 3.4), 0.015, waves, 36), "flood")
    for index in range(26):
        turn, reach = index * 2.399963, math.sqrt((index + 0.5) / 28)
        x, y = 3.7 * reach * math.cos(turn), 2.8 * reach * math.sin(turn)
        wide = 0.3 + 0.12 * (index % 3)
        points = [(x + a, y + b, z) for a, b, z in _blot((0.07, wide), 0.022, ((1, 0.2, 0.4),), 10)]
        mesh.polygon(points, "flood_light" if index % 3 else "water_light")
    for x, y, turn in ((1.6, -1.0, 0.4), (-1.5, 1.2, 2.0), (0.2, 2.1, 1.1), (-2.6, -1.4, 0.2)):
        dx, dy = 0.4 * math.cos(turn), 0.4 * math.sin(turn)
        mesh.beam((x - dx, y - dy, 0.03), (x + dx, y + dy, 0.04), 0.05, "bark_dark", end_width=0.02)
    _foot(mesh, "flood")
    return mesh


def road_plate(shown: Shown) -> MeshBuilder:
    """A steel plate over a trench, with a chequered surface and striped edges."""
    mesh = MeshBuilder()
    mesh.box((0, 0, 0.015), (2.4, 1.8, 0.03), "rust")
    for i in range(6):
        for j in range(5):
            x, y = -0.95 + 0.38 * i, -0.64 + 0.32 * j
            dx, dy = (0.13, 0.025) if (i + j) % 2 else (0.025, 0.11)
            mesh.polygon(
                [
                    (x - dx, y - dy, 0.034),
                    (x + dx, y - dy, 0.034),
                    (x + dx, y + dy, 0.034),
                    (x - dx, y + dy, 0.034),
                ],
                "metal",
            )
    for side in (-1.0, 1.0):
        for k in range(8):
            colour = "yellow" if k % 2 else "black"
            y0 = -0.9 + 0.225 * k
            x0, x1 = sorted((side * 1.08, side * 1.2))
            mesh.polygon(
                [
                    (x0, y0, 0.033),
                    (x1, y0, 0.033),
                    (x1, y0 + 0.225, 0.033),
                    (x0, y0 + 0.225, 0.033),
                ],
                colour,
            )
    return mesh
