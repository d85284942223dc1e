"""Vehicles that are dirty or crushed: changes of a finished mesh."""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from oodscen_pybullet._meshes.atlas import COLOURS, EMISSIVE, free_colours, swatch_uv
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._meshes.shapes import LEAST_LENGTH
from oodscen_pybullet._types import Array, Ints, Mask

Colour = tuple[int, int, int]
"""Red, green and blue, 0 to 255."""
_EDGE_M, _EDGE = 0.3, 0.06
"""Longest edge of the triangles of what is dirty or crushed: m, or as a share of a long vehicle's length."""
_MOST_HALVINGS = 24
"""Rounds in which long edges are halved, at most."""
_MUD: Colour = (118, 96, 66)
_SHARES = (0.0, 0.25, 0.5, 0.75, 0.9)
"""Shares of mud in the colours of a dirty vehicle."""
_PLAIN = {
    tuple(swatch_uv(name).tolist()): colour
    for name, colour in COLOURS.items()
    if name not in EMISSIVE and name != "tyre"
}
"""Colours that get dirty, by their place in the atlas."""
_CRUSHED = 0.273
"""Share of its half that a crushed end of a vehicle loses, at most, but for its folds."""
_INTACT = 0.35
"""Share of its half that stays as it is."""
_MOVED_M = 1e-9
"""Distance above which a point has moved, m."""
_LEAST_AREA = 1e-12
"""Least length of a normal by which it is divided, m^2."""


def damaged(mesh: MeshBuilder, shown: Appearance) -> MeshBuilder:
    """Return a vehicle as its details show it: dirty, or crushed at either end."""
    if not any(shown.has(part) for part in ("dirty", "crushed_front", "crushed_rear")):
        return mesh
    vehicle = mesh.build()
    if shown.has("dirty"):
        vehicle = _dirtied(vehicle)
    if shown.has("crushed_front"):
        vehicle = _crushed(vehicle, 1.0)
    if shown.has("crushed_rear"):
        vehicle = _crushed(vehicle, -1.0)
    return MeshBuilder().insert(vehicle)


class _Loose(NamedTuple):
    """Triangles that share no corners."""

    points: Array
    """[n, 3, 3]"""
    normals: Array
    """[n, 3, 3]"""
    uvs: Array
    """[n, 3, 2]"""


def _divided(mesh: Mesh) -> Mesh:
    """Return the mesh with every edge halved until it is short; neighbours stay joined."""
    rows = mesh.triangles
    loose = _Loose(mesh.vertices[rows], mesh.normals[rows], mesh.uvs[rows])
    low, high = mesh.bounds
    longest_m = max(_EDGE_M, _EDGE * float(high[0] - low[0]))
    for _ in range(_MOST_HALVINGS):
        sides = loose.points[:, [1, 2, 0]] - loose.points
        squares = (sides**2).sum(axis=2)
        is_long = squares.max(axis=1) > longest_m**2
        if not is_long.any():
            break
        loose = _halved(loose, is_long, squares.argmax(axis=1))
    normals = loose.normals.reshape(-1, 3)
    lengths = np.sqrt((normals**2).sum(axis=1, keepdims=True))
    normals = normals / np.maximum(lengths, LEAST_LENGTH)
    surface = Mesh.loose(loose.points.reshape(-1, 3), normals, loose.uvs.reshape(-1, 2))
    return replace(surface, lamps=mesh.lamps, puffs=mesh.puffs)


def _halved(loose: _Loose, is_long: Mask, longest: Ints) -> _Loose:
    """Return triangles with some of them cut in two at the middle of their longest edges.

    Args:
        loose: The triangles.
        is_long: [n] which ones are cut.
        longest: [n] the first corner of the longest edge of each.
    """
    order = (longest[is_long, None] + np.arange(3)) % 3
    tables = []
    for table in loose:
        a, b, c = np.take_along_axis(table[is_long], order[:, :, None], axis=1).swapaxes(0, 1)
        middle = 0.5 * (a + b)
        halves = [np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)]
        tables.append(np.concatenate([table[~is_long], *halves]))
    return _Loose(*tables)


def _noise(points: Array, key: int) -> Array:
    """Return a value from 0 to 1 for every point, the same for the same place."""
    cells = np.rint(points * 1000.0).astype(np.int64)
    mixed = cells @ np.array([73_856_093, 19_349_663, 83_492_791], np.int64) + key * 7_919
    mixed = (mixed ^ (mixed >> 13)) * 1_274_126_177
    return np.asarray(((mixed ^ (mixed >> 16)) & 0xFFFF) / 65_535.0)


def _dirtied(mesh: Mesh) -> Mesh:
    """Return the mesh with mud that thins out upwards, on everything but lamps, prints and tyres."""
    mesh = _divided(mesh)
    uvs = mesh.uvs.reshape(-1, 3, 2).copy()
    centres = mesh.vertices.reshape(-1, 3, 3).mean(axis=1)
    top = float(mesh.vertices[:, 2].max())
    share = 1.1 - 1.5 * centres[:, 2] / top + 0.3 * (_noise(centres, 1) - 0.5)
    levels = np.clip(np.rint(share * 4.0), 0, 4).astype(np.int64)
    for uv in np.unique(uvs.reshape(-1, 2), axis=0):
        colour = _PLAIN.get(tuple(uv.tolist())) or _free_colour(uv)
        if colour is None:
            continue
        is_coloured = (uvs == uv).all(axis=(1, 2))
        for level in np.unique(levels[is_coloured]).tolist():
            if level:
                muddy = swatch_uv(_with_mud(colour, _SHARES[level]))
                uvs[is_coloured & (levels == level)] = muddy
    return replace(mesh, uvs=uvs.reshape(-1, 2))


def _free_colour(uv: Array) -> Colour | None:
    """Return a colour that the atlas lacks, `None` for prints and for what shines."""
    is_free, rows = free_colours(uv[None])
    red, green, blue, is_lit = rows[0].tolist()
    return (red, green, blue) if is_free[0] and not is_lit else None


def _with_mud(colour: Colour, share: float) -> str:
    """Return a colour with a share of mud, as `#rrggbb`."""
    red, green, blue = (round(a + share * (b - a)) for a, b in zip(colour, _MUD, strict=True))
    return f"#{red:02x}{green:02x}{blue:02x}"


def _crushed(mesh: Mesh, end: float) -> Mesh:
    """Return the mesh with its front (1) or rear (-1) end pushed in, folded and askew.

    The left side loses most. Wheels are squeezed like all else, and end at the ground.
    """
    mesh = _divided(mesh)
    half, side = float(np.abs(mesh.vertices[:, 0]).max()), float(np.abs(mesh.vertices[:, 1]).max())

    def crush(points: Array) -> Array:
        ahead = np.maximum(end * points[:, 0] / half - _INTACT, 0.0) / (1.0 - _INTACT)
        askew = 0.7 + 0.3 * points[:, 1] / side
        folds = [_noise(points, key) - 0.5 for key in (2, 3, 4)]
        depth = _CRUSHED * half * askew * ahead + 0.16 * ahead * folds[0]
        bulge = 4.0 * ahead * np.maximum(1.0 - ahead, 0.0)
        height = np.clip((points[:, 2] - 0.55) / 0.3, 0.0, 1.0)
        x = points[:, 0] - end * depth
        y = points[:, 1] + 0.12 * ahead * folds[1]
        z = points[:, 2] + height * (0.26 * bulge * askew + 0.14 * ahead * folds[2])
        return np.stack([x, y, np.maximum(z, 0.0)], axis=1)

    return _reshaped(mesh, crush)


def _reshaped(mesh: Mesh, move: Callable[[Array], Array]) -> Mesh:
    """Return the mesh with its points moved, and flat normals where they moved."""
    points = move(mesh.vertices)
    corners = points.reshape(-1, 3, 3)
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.sqrt((facing**2).sum(axis=1, keepdims=True))
    flat = facing / np.maximum(lengths, _LEAST_AREA)
    shifts = np.abs(points - mesh.vertices).max(axis=1).reshape(-1, 3)
    is_flat = (shifts.max(axis=1) > _MOVED_M) & (lengths[:, 0] > LEAST_LENGTH)
    normals = np.where(is_flat[:, None, None], flat[:, None], mesh.normals.reshape(-1, 3, 3))
    lamps = tuple(
        replace(lamp, position=tuple(move(np.array([lamp.position]))[0].tolist()))
        for lamp in mesh.lamps
    )
    return replace(mesh, vertices=points, normals=normals.reshape(-1, 3), lamps=lamps)
