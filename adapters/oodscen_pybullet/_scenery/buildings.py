"""Houses and city blocks; their fronts face -y and their depth extends along y."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._meshes.shapes import upright
from oodscen_pybullet._meshes.tags import Tag, tagged

STOREY_M = 3.2
"""Height of one storey of a city block, m."""
BAY_M = 6.0
"""Width of one facade tile, m."""
BLOCK_DEPTH_M = 12.0
"""Depth of a city block, m."""
HOUSE_M = (9.0, 8.0)
"""Width and depth of a house, m."""
STYLES = 6
"""Number of facades of city blocks."""
_LIT_SHARE = 0.36
"""Share of the windows of dwellings that are lit at night."""
_ROOFS = ("roof_red", "roof_brown", "roof_grey")
_HOUSE_WALLS = ("wall_brick", "wall_cream", "wall_white")
_STYLE_WALLS = ("wall_brick", "wall_cream", "wall_grey", "wall_white", "sand", "wall_brick")
_AWNINGS = ("awning_red", "awning_green", "navy", "wall_ochre")


class _Block(NamedTuple):
    """A town building."""

    half: float
    """Half its width, m."""
    depth: float
    """Half its depth, m."""
    floors: int
    style: int
    look: int
    has_shop: bool
    is_night: bool

    @property
    def top(self) -> float:
        """Height of its walls, m."""
        return self.floors * STOREY_M


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
    block = _Block(width / 2, BLOCK_DEPTH_M / 2, floors, style, look, has_shop, is_night)
    half, depth = block.half, block.depth
    mesh = MeshBuilder()
    _add_front(mesh, block, rng)
    _add_side(mesh, block, 1.0, rng)
    _add_side(mesh, block, -1.0, rng)
    back = upright((half, depth), (-half, depth), 0, block.top)
    mesh.polygon(back, _STYLE_WALLS[style])
    _add_foundation(mesh, half, depth, "concrete_dark", 0.0)
    _add_roof(mesh, half, depth, block.top, look)
    return tagged(mesh.build(), Tag.BUILDINGS)


def _add_front(mesh: MeshBuilder, block: _Block, rng: np.random.Generator) -> None:
    """Add the front tile by tile: a facade or a shop each, with an entrance, awnings and balconies."""
    half, y, look = block.half, -block.depth, block.look
    bays = round(2 * half / BAY_M)
    door = int(rng.integers(0, bays))
    has_balconies = block.floors > 3 and rng.uniform() < 0.45
    for floor in range(block.floors):
        low, high = floor * STOREY_M, (floor + 1) * STOREY_M
        is_shop = floor == 0 and block.has_shop
        has_entrance = floor == 0 and not block.has_shop
        for bay in range(bays):
            x0, x1 = -half + bay * BAY_M, -half + (bay + 1) * BAY_M
            shop = (block.style + look + bay) % 4
            tile = f"shop_{shop}" if is_shop else f"facade_{block.style}"
            mesh.textured_quad(upright((x0, y), (x1, y), low, high), tile)
            if block.is_night:
                _light_windows(mesh, x0, y, low, rng, is_shop=is_shop)
            if is_shop and rng.uniform() < 0.6:
                _add_awning(mesh, x0, x1, y, _AWNINGS[shop])
            if has_entrance and bay == door:
                _add_entrance(mesh, x0 + BAY_M / 2, y)
            if has_balconies and 0 < floor < block.floors - 1 and bay % 2 == look % 2:
                _add_balcony(mesh, x0 + 0.5, x1 - 0.5, y, low)


def _add_side(mesh: MeshBuilder, block: _Block, sign: float, rng: np.random.Generator) -> None:
    """Add the right (1) or left (-1) wall with two windows on every upper floor."""
    x, y = sign * block.half, sign * block.depth
    mesh.polygon(upright((x, -y), (x, y), 0, block.top), _STYLE_WALLS[block.style])
    for floor in range(1, block.floors):
        z = floor * STOREY_M
        for middle in (-2.6, 2.6):
            out, half_pane = x + sign * 0.02, sign * 0.6
            ends = (out, middle - half_pane), (out, middle + half_pane)
            is_lit = block.is_night and rng.uniform() < _LIT_SHARE
            mesh.polygon(upright(*ends, z + 0.8, z + 2.3), "lit_window" if is_lit else "glass")


def _light_windows(
    mesh: MeshBuilder, x0: float, y: float, low: float, rng: np.random.Generator, *, is_shop: bool
) -> None:
    """Light some of the two windows of a tile."""
    panes = ((0.05, 0.32), (0.68, 0.95)) if is_shop else ((0.12, 0.42), (0.58, 0.88))
    bottom, top = (0.08, 0.62) if is_shop else (0.22, 0.80)
    lit_share = 0.75 if is_shop else _LIT_SHARE
    for left, right in panes:
        is_warm = rng.uniform() < 0.75
        if rng.uniform() < lit_share:
            start, end = (x0 + left * BAY_M, y - 0.03), (x0 + right * BAY_M, y - 0.03)
            pane = upright(start, end, low + bottom * STOREY_M, low + top * STOREY_M)
            mesh.polygon(pane, "lit_window" if is_warm else "lit_window_cool")


def _add_awning(mesh: MeshBuilder, x0: float, x1: float, y: float, colour: str) -> None:
    left, right, front, back = x0 + 0.3, x1 - 0.3, y - 1.2, y - 0.02
    mesh.polygon(
        [(left, front, 2.25), (right, front, 2.25), (right, back, 2.75), (left, back, 2.75)],
        colour,
    )
    mesh.polygon(upright((left, front), (right, front), 2.05, 2.25), colour)


def _add_entrance(mesh: MeshBuilder, x: float, y: float) -> None:
    y -= 0.04
    mesh.polygon(upright((x - 0.8, y), (x + 0.8, y), 0, 2.5), "light_grey")
    y -= 0.02
    mesh.polygon(upright((x - 0.6, y), (x + 0.6, y), 0, 2.3), "door")


def _add_balcony(mesh: MeshBuilder, x0: float, x1: float, y: float, low: float) -> None:
    mesh.hull(
        (x0, x1, y - 1.1, y, low - 0.08), (x0, x1, y - 1.1, y, low + 0.95), "light_grey",
        caps="b", sides=("light_grey", "", "light_grey", "light_grey"),
    )  # fmt: skip


def _add_roof(mesh: MeshBuilder, half: float, depth: float, top: float, look: int) -> None:
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
        for index in range(max(1, int(half * 2 / BAY_M))):
            x = -half + BAY_M * (index + 0.5)
            mesh.box((x, -depth + 0.75, top + 1.2), (1.5, 1.3, 1.6), "wall_white", caps="t")
            y = -depth + 0.08
            mesh.polygon(upright((x - 0.5, y), (x + 0.5, y), top + 0.6, top + 1.8), "glass")
    else:
        _add_gable(mesh, half, depth, top, 3.2, ("roof_red", "roof_brown")[look % 2], "wall_cream")


def _add_foundation(mesh: MeshBuilder, half: float, depth: float, colour: str, top: float) -> None:
    """Add walls from below the ground, which may slope, up to a height."""
    sides = (-half, half, -depth, depth)
    mesh.hull((*sides, -2.5), (*sides, top), colour, caps="")


def _add_gable(
    mesh: MeshBuilder, half: float, depth: float, eaves: float, rise: float, tile: str, wall: str
) -> None:
    """Add a roof with its ridge along x."""
    over, out, ridge = half + 0.4, depth + 0.5, eaves + rise
    for sign in (1, -1):
        low, high = (sign * over, -sign * out, eaves - 0.2), (sign * over, 0, ridge)
        mesh.polygon([(-low[0], *low[1:]), low, high, (-high[0], *high[1:])], tile)
    mesh.polygon([(half, -depth, eaves), (half, depth, eaves), (half, 0, ridge - 0.2)], wall)
    mesh.polygon([(-half, depth, eaves), (-half, -depth, eaves), (-half, 0, ridge - 0.2)], wall)


def any_house(rng: np.random.Generator, *, is_night: bool) -> Mesh:
    """Return one of the detached houses by chance."""
    kind, roof, look = (int(rng.integers(0, n)) for n in (len(_HOUSE_WALLS), len(_ROOFS), 12))
    return _house(kind, roof, look, is_night=is_night)


@lru_cache(maxsize=128)
def _house(kind: int, roof: int, look: int, *, is_night: bool) -> Mesh:
    """Return a detached house with a pitched roof.

    Args:
        kind: One of three walls.
        roof: One of three roofs.
        look: Determines the storeys, the direction of the ridge, and the lit windows.
        is_night: Whether some windows are lit.
    """
    rng = np.random.Generator(np.random.PCG64(9500 + look))
    mesh = MeshBuilder()
    half, depth, storey = HOUSE_M[0] / 2, HOUSE_M[1] / 2, 2.7
    floors = 1 if look % 4 == 3 else 2
    wall, tile = _HOUSE_WALLS[kind], f"house_{kind}"
    eaves = floors * storey
    corners = [(-half, -depth), (half, -depth), (half, depth), (-half, depth)]
    for floor in range(floors):
        low, high = floor * storey, (floor + 1) * storey
        front = f"door_{kind}" if floor == 0 else tile
        mesh.textured_quad(upright(corners[0], corners[1], low, high), front)
        for start, end in zip(corners[1:], [*corners[2:], corners[0]], strict=True):
            mesh.textured_quad(upright(start, end, low, high), tile)
        if is_night:
            _light_front(mesh, floor, storey, rng)
    _add_foundation(mesh, half, depth, "concrete_dark", 0.0)
    if look % 3 == 1:
        _add_cross_gable(mesh, half, depth, eaves, _ROOFS[roof], wall)
    else:
        _add_gable(mesh, half, depth, eaves, 3.0, _ROOFS[roof], wall)
    mesh.box((-2.2, 0.9, eaves + 2.6), (0.7, 0.7, 1.9), "wall_brick", caps="t")
    mesh.box((0.9, -depth - 0.5, 2.45), (1.8, 1.0, 0.12), "concrete")
    mesh.box((0.9, -depth - 0.4, 0.08), (1.8, 0.8, 0.16), "concrete", caps="t")
    return tagged(mesh.build(), Tag.BUILDINGS)


def _light_front(mesh: MeshBuilder, floor: int, storey: float, rng: np.random.Generator) -> None:
    """Light some of the two windows of a floor of a house; the lower right one is the door."""
    width, y, low = HOUSE_M[0], -HOUSE_M[1] / 2 - 0.03, floor * storey
    for left, right in ((0.10, 0.36), (0.62, 0.88))[: 1 if floor == 0 else 2]:
        if rng.uniform() < 0.5:
            start, end = (-width / 2 + left * width, y), (-width / 2 + right * width, y)
            pane = upright(start, end, low + 0.24 * storey, low + 0.78 * storey)
            mesh.polygon(pane, "lit_window")


def _add_cross_gable(
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
    y = -depth - 0.02
    mesh.polygon(upright((-0.6, y), (0.6, y), eaves + 0.5, eaves + 1.7), "glass")


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
    top = floors * STOREY_M
    wall = _STYLE_WALLS[style]
    mesh.hull(
        (-half, half, -half, half, -4),
        (-half, half, -half, half, top),
        wall,
        caps="t",
        cap_colour="roof_grey",
    )
    for floor in range(1, floors):
        z0, z1, y = floor * STOREY_M + 0.9, floor * STOREY_M + 2.5, -half - 0.04
        x = -half + 1.0
        if is_night:
            while x < half - 2.5:
                if rng.uniform() < 0.22:
                    pane = upright((x, y - 0.03), (x + 1.6, y - 0.03), z0, z1)
                    mesh.polygon(pane, "lit_window")
                x += 3.0
        mesh.polygon(upright((-half + 0.8, y), (half - 0.8, y), z0, z1), "glass_light")
    return tagged(mesh.build(), Tag.BUILDINGS)


@lru_cache(maxsize=4)
def barn(colour: str) -> Mesh:
    """Return a barn eighteen metres long."""
    mesh = MeshBuilder()
    _add_foundation(mesh, 9, 5, colour, 4.2)
    _add_gable(mesh, 9.0, 5.0, 4.2, 3.2, "roof_grey", colour)
    mesh.polygon(upright((-2, -5.03), (2, -5.03), 0, 3.6), "white")
    mesh.polygon(upright((-1.8, -5.06), (1.8, -5.06), 0, 3.4), "door")
    return tagged(mesh.build(), Tag.BUILDINGS)
