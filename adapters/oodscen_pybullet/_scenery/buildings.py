"""Houses and city blocks; their fronts face -y and their depth extends along y."""

from functools import lru_cache

import numpy as np

from oodscen_pybullet._meshes.builder import Mesh, MeshBuilder
from oodscen_pybullet._meshes.tags import Tag, tagged

STOREY = 3.2
"""Height of one storey of a city block, m."""
BAY = 6.0
"""Width of one facade tile, m."""
BLOCK_DEPTH = 12.0
"""Depth of a city block, m."""
HOUSE = (9.0, 8.0)
"""Width and depth of a house, m."""
STYLES = 6
"""Number of facades of city blocks."""
_LIT_SHARE = 0.36
_PANES = ((0.12, 0.42), (0.58, 0.88))
_STYLE_WALLS = ("wall_brick", "wall_cream", "wall_grey", "wall_white", "sand", "wall_brick")
_AWNINGS = ("awning_red", "awning_green", "navy", "wall_ochre")
_FOOTING = 2.5
"""Depth of walls below the ground, which may slope, m."""


@lru_cache(maxsize=256)
def city_block(
    width: int, floors: int, style: int, look: int, *, has_shop: bool, is_night: bool
) -> Mesh:
    """Return a town building.

    Args:
        width: Width along x, a multiple of six metres.
        floors: Number of storeys.
        style: One of six facades.
        look: Determines roof, balconies, awnings and lit windows.
        has_shop: Whether there are shop windows at street level.
        is_night: Whether some windows are lit.
    """
    rng = np.random.Generator(np.random.PCG64(9000 + look))
    mesh = MeshBuilder()
    half, depth = width / 2, BLOCK_DEPTH / 2
    wall, top = _STYLE_WALLS[style], floors * STOREY
    bays = round(width / BAY)
    door = int(rng.integers(0, bays))
    has_balconies = floors > 3 and rng.uniform() < 0.45
    for floor in range(floors):
        low, high = floor * STOREY, (floor + 1) * STOREY
        for bay in range(bays):
            x0, x1 = -half + bay * BAY, -half + (bay + 1) * BAY
            front = [(x0, -depth, low), (x1, -depth, low), (x1, -depth, high), (x0, -depth, high)]
            is_shop = floor == 0 and has_shop
            shop = (style + look + bay) % 4
            mesh.textured_quad(front, f"shop_{shop}" if is_shop else f"facade_{style}")
            if is_night:
                _light(mesh, x0, -depth, low, rng, is_shop=is_shop)
            if is_shop and rng.uniform() < 0.6:
                _awning(mesh, x0, x1, -depth, _AWNINGS[shop])
            if floor == 0 and not has_shop and bay == door:
                _entrance(mesh, x0 + BAY / 2, -depth)
            if has_balconies and 0 < floor < floors - 1 and bay % 2 == look % 2:
                _balcony(mesh, x0 + 0.5, x1 - 0.5, -depth, low)
    for x, sign in ((half, 1.0), (-half, -1.0)):
        a, b = (-depth, depth) if sign > 0 else (depth, -depth)
        mesh.polygon([(x, a, 0), (x, b, 0), (x, b, top), (x, a, top)], wall)
        for floor in range(1, floors):
            z = floor * STOREY
            for y in (-2.6, 2.6):
                ends = (y - 0.6, y + 0.6) if sign > 0 else (y + 0.6, y - 0.6)
                pane = [(x + sign * 0.02, e, z + h) for h in (0.8, 2.3) for e in ends]
                is_lit = is_night and rng.uniform() < _LIT_SHARE
                colour = "lit_window" if is_lit else "glass"
                mesh.polygon([pane[0], pane[1], pane[3], pane[2]], colour)
    mesh.polygon(
        [(half, depth, 0), (-half, depth, 0), (-half, depth, top), (half, depth, top)], wall
    )
    mesh.hull(
        (-half, half, -depth, depth, -_FOOTING), (-half, half, -depth, depth, 0.0), "concrete_dark",
        caps="",
    )  # fmt: skip
    _roof(mesh, half, depth, top, look)
    return tagged(mesh.build(), Tag.BUILDINGS)


def _light(
    mesh: MeshBuilder, x0: float, y: float, low: float, rng: np.random.Generator, *, is_shop: bool
) -> None:
    """Light some of the two windows of a tile."""
    panes = ((0.05, 0.32), (0.68, 0.95)) if is_shop else _PANES
    bottom, top = (0.08, 0.62) if is_shop else (0.22, 0.80)
    for a, b in panes:
        share = 0.75 if is_shop else _LIT_SHARE
        warm = rng.uniform() < 0.75
        if rng.uniform() < share:
            u0, u1 = x0 + a * BAY, x0 + b * BAY
            z0, z1 = low + bottom * STOREY, low + top * STOREY
            mesh.polygon(
                [(u0, y - 0.03, z0), (u1, y - 0.03, z0), (u1, y - 0.03, z1), (u0, y - 0.03, z1)],
                "lit_window" if warm else "lit_window_cool",
            )


def _awning(mesh: MeshBuilder, x0: float, x1: float, y: float, colour: str) -> None:
    a, b = x0 + 0.3, x1 - 0.3
    mesh.polygon(
        [(a, y - 1.2, 2.25), (b, y - 1.2, 2.25), (b, y - 0.02, 2.75), (a, y - 0.02, 2.75)], colour
    )
    mesh.polygon(
        [(a, y - 1.2, 2.05), (b, y - 1.2, 2.05), (b, y - 1.2, 2.25), (a, y - 1.2, 2.25)], colour
    )


def _entrance(mesh: MeshBuilder, x: float, y: float) -> None:
    y -= 0.04
    mesh.polygon(
        [(x - 0.8, y, 0), (x + 0.8, y, 0), (x + 0.8, y, 2.5), (x - 0.8, y, 2.5)], "light_grey"
    )
    y -= 0.02
    mesh.polygon([(x - 0.6, y, 0), (x + 0.6, y, 0), (x + 0.6, y, 2.3), (x - 0.6, y, 2.3)], "door")


def _balcony(mesh: MeshBuilder, x0: float, x1: float, y: float, low: float) -> None:
    mesh.hull(
        (x0, x1, y - 1.1, y, low - 0.08), (x0, x1, y - 1.1, y, low + 0.95), "light_grey",
        caps="b", sides=("light_grey", "", "light_grey", "light_grey"),
    )  # fmt: skip


def _roof(mesh: MeshBuilder, half: float, depth: float, top: float, look: int) -> None:
    """Add a flat roof with a cornice, a mansard roof, or a pitched roof."""
    kind = look % 3
    low = (-half, half, -depth, depth, top)
    if kind == 0:
        edge = (-half - 0.3, half + 0.3, -depth - 0.3, depth + 0.3)
        mesh.hull((*edge, top), (*edge, top + 0.5), "concrete", cap_colour="roof_grey", caps="t")
        mesh.box((half * 0.4, 1.0, top + 1.6), (2.6, 3.0, 2.2), "concrete_dark", caps="t")
    elif kind == 1:
        colour = ("roof_grey", "roof_red")[look % 2]
        mesh.hull(low, (-half, half, -depth + 1.4, depth - 1.4, top + 2.6), colour)
        for index in range(max(1, int(half * 2 / BAY))):
            x = -half + BAY * (index + 0.5)
            mesh.box((x, -depth + 0.75, top + 1.2), (1.5, 1.3, 1.6), "wall_white", caps="t")
            pane = [
                (x - 0.5, top + 0.6),
                (x + 0.5, top + 0.6),
                (x + 0.5, top + 1.8),
                (x - 0.5, top + 1.8),
            ]
            mesh.polygon([(u, -depth + 0.08, z) for u, z in pane], "glass")
    else:
        _gable(mesh, half, depth, top, 3.2, ("roof_red", "roof_brown")[look % 2], "wall_cream")


def _gable(
    mesh: MeshBuilder, half: float, depth: float, eaves: float, rise: float, tile: str, wall: str
) -> None:
    """Add a roof with its ridge along x."""
    over, out, ridge = half + 0.4, depth + 0.5, eaves + rise
    front = [
        (-over, -out, eaves - 0.2),
        (over, -out, eaves - 0.2),
        (over, 0, ridge),
        (-over, 0, ridge),
    ]
    back = [
        (over, out, eaves - 0.2),
        (-over, out, eaves - 0.2),
        (-over, 0, ridge),
        (over, 0, ridge),
    ]
    mesh.polygon(front, tile)
    mesh.polygon(back, tile)
    mesh.polygon([(half, -depth, eaves), (half, depth, eaves), (half, 0, ridge - 0.2)], wall)
    mesh.polygon([(-half, depth, eaves), (-half, -depth, eaves), (-half, 0, ridge - 0.2)], wall)


_ROOFS = ("roof_red", "roof_brown", "roof_grey")
_WALLS = ("wall_brick", "wall_cream", "wall_white")


@lru_cache(maxsize=128)
def house(kind: int, roof: int, look: int, *, is_night: bool) -> Mesh:
    """Return a detached house with a pitched roof.

    Args:
        kind: One of three walls.
        roof: One of three roofs.
        look: Determines the storeys, the direction of the ridge, and the lit windows.
        is_night: Whether some windows are lit.
    """
    rng = np.random.Generator(np.random.PCG64(9500 + look))
    mesh = MeshBuilder()
    half, depth, storey = HOUSE[0] / 2, HOUSE[1] / 2, 2.7
    floors = 1 if look % 4 == 3 else 2
    wall, tile = _WALLS[kind], f"house_{kind}"
    eaves = floors * storey
    for floor in range(floors):
        low, high = floor * storey, (floor + 1) * storey
        sides = (
            ((-half, -depth), (half, -depth), f"door_{kind}" if floor == 0 else tile),
            ((half, -depth), (half, depth), tile),
            ((half, depth), (-half, depth), tile),
            ((-half, depth), (-half, -depth), tile),
        )
        for (ax, ay), (bx, by), region in sides:
            mesh.textured_quad(
                [(ax, ay, low), (bx, by, low), (bx, by, high), (ax, ay, high)], region
            )
        if is_night:
            for index, (a, b) in enumerate(((0.10, 0.36), (0.62, 0.88))):
                is_door = floor == 0 and index == 1
                if not is_door and rng.uniform() < 0.5:
                    u0, u1 = -half + a * 2 * half, -half + b * 2 * half
                    z0, z1, y = low + 0.24 * storey, low + 0.78 * storey, -depth - 0.03
                    pane = [(u0, y, z0), (u1, y, z0), (u1, y, z1), (u0, y, z1)]
                    mesh.polygon(pane, "lit_window")
    mesh.hull(
        (-half, half, -depth, depth, -_FOOTING), (-half, half, -depth, depth, 0.0), "concrete_dark",
        caps="",
    )  # fmt: skip
    if look % 3 == 1:
        _cross_gable(mesh, half, depth, eaves, _ROOFS[roof], wall)
    else:
        _gable(mesh, half, depth, eaves, 3.0, _ROOFS[roof], wall)
    mesh.box((-2.2, 0.9, eaves + 2.6), (0.7, 0.7, 1.9), "wall_brick", caps="t")
    mesh.box((0.9, -depth - 0.5, 2.45), (1.8, 1.0, 0.12), "concrete")
    mesh.box((0.9, -depth - 0.4, 0.08), (1.8, 0.8, 0.16), "concrete", caps="t")
    return tagged(mesh.build(), Tag.BUILDINGS)


def _cross_gable(
    mesh: MeshBuilder, half: float, depth: float, eaves: float, tile: str, wall: str
) -> None:
    """Add a roof whose gable faces the street."""
    over, out, ridge = half + 0.4, depth + 0.4, eaves + 3.4
    mesh.polygon(
        [(over, -out, eaves - 0.2), (over, out, eaves - 0.2), (0, out, ridge), (0, -out, ridge)],
        tile,
    )
    mesh.polygon(
        [(-over, out, eaves - 0.2), (-over, -out, eaves - 0.2), (0, -out, ridge), (0, out, ridge)],
        tile,
    )
    mesh.polygon([(-half, -depth, eaves), (half, -depth, eaves), (0, -depth, ridge - 0.25)], wall)
    mesh.polygon([(half, depth, eaves), (-half, depth, eaves), (0, depth, ridge - 0.25)], wall)
    window = [(-0.6, eaves + 0.5), (0.6, eaves + 0.5), (0.6, eaves + 1.7), (-0.6, eaves + 1.7)]
    mesh.polygon([(x, -depth - 0.02, z) for x, z in window], "glass")


@lru_cache(maxsize=32)
def tower(style: int, look: int, *, is_night: bool) -> Mesh:
    """Return a building for the skyline, with few triangles because it is seen only from afar.

    Args:
        style: One of six facades.
        look: Determines the size.
        is_night: Whether some windows are lit.
    """
    rng = np.random.Generator(np.random.PCG64(9900 + look))
    mesh = MeshBuilder()
    half = float(rng.uniform(7.0, 13.0))
    floors = int(rng.integers(6, 14))
    top = floors * STOREY
    wall = _STYLE_WALLS[style]
    mesh.hull(
        (-half, half, -half, half, -4),
        (-half, half, -half, half, top),
        wall,
        caps="t",
        cap_colour="roof_grey",
    )
    for floor in range(1, floors):
        z0, z1, y = floor * STOREY + 0.9, floor * STOREY + 2.5, -half - 0.04
        x = -half + 1.0
        if is_night:
            while x < half - 2.5:
                if rng.uniform() < 0.22:
                    pane = [(x, z0), (x + 1.6, z0), (x + 1.6, z1), (x, z1)]
                    mesh.polygon([(u, y - 0.03, z) for u, z in pane], "lit_window")
                x += 3.0
        band = [(-half + 0.8, z0), (half - 0.8, z0), (half - 0.8, z1), (-half + 0.8, z1)]
        mesh.polygon([(u, y, z) for u, z in band], "glass_light")
    return tagged(mesh.build(), Tag.BUILDINGS)


@lru_cache(maxsize=4)
def barn(colour: str) -> Mesh:
    """Return a barn eighteen metres long."""
    mesh = MeshBuilder()
    mesh.hull((-9, 9, -5, 5, -_FOOTING), (-9, 9, -5, 5, 4.2), colour, caps="")
    _gable(mesh, 9.0, 5.0, 4.2, 3.2, "roof_grey", colour)
    mesh.polygon([(-2, -5.03, 0), (2, -5.03, 0), (2, -5.03, 3.6), (-2, -5.03, 3.6)], "white")
    mesh.polygon([(-1.8, -5.06, 0), (1.8, -5.06, 0), (1.8, -5.06, 3.4), (-1.8, -5.06, 3.4)], "door")
    return tagged(mesh.build(), Tag.BUILDINGS)
