"""Vehicles that are dirty or crushed: changes of a finished mesh."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from oodscen_pybullet._meshes.atlas import COLOURS, EMISSIVE, free_colours, swatch_uv
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._meshes.shapes import LEAST_LENGTH
from oodscen_pybullet._types import Array

_EDGE_M, _EDGE = 0.3, 0.06
"""Longest edge of the triangles of what is dirty or crushed: m, or as a share of a long vehicle's length."""
_MUD = (118, 96, 66)
_SHARES = (0.0, 0.25, 0.5, 0.75, 0.9)
"""Shares of mud in the colours of a dirty vehicle."""
_PLAIN = {
    tuple(swatch_uv(name).tolist()): colour
    for name, colour in COLOURS.items()
    if name not in EMISSIVE and name != "tyre"
}
"""Colours that get dirty, by their place in the atlas."""
_CRUSHED = 0.42
"""Share of its half that a crushed end of a vehicle loses, at most."""
_MOVED_M = 1e-9
"""Distance above which a point has moved, m."""
_LEAST_AREA = 1e-12
"""Least length of a normal by which it is divided, m^2."""


def altered(mesh: MeshBuilder, shown: Appearance) -> MeshBuilder:
    """Return a vehicle's mesh as its details change it."""
    changes: list[Callable[[Mesh], Mesh]] = []
    if shown.has("dirty"):
        changes.append(_dirtied)
    if shown.has("crushed_front"):
        changes.append(lambda whole: _crushed(whole, 1.0))
    if shown.has("crushed_rear"):
        changes.append(lambda whole: _crushed(whole, -1.0))
    if not changes:
        return mesh
    whole = mesh.build()
    for change in changes:
        whole = change(whole)
    return MeshBuilder().insert(whole)


def _split(mesh: Mesh) -> Mesh:
    """Return the mesh with every edge halved until it is short; neighbours stay joined."""
    rows = mesh.triangles.reshape(-1, 3)
    points, normals, uvs = mesh.vertices[rows], mesh.normals[rows], mesh.uvs[rows]
    low, high = mesh.bounds
    longest_m = max(_EDGE_M, _EDGE * float(high[0] - low[0]))
    for _ in range(24):
        ends = points[:, [1, 2, 0]]
        lengths = ((ends - points) ** 2).sum(axis=2)
        longest = lengths.argmax(axis=1)
        is_long = lengths.max(axis=1) > longest_m**2
        if not is_long.any():
            break
        # Every triangle is turned so that its longest edge comes first.
        order = (longest[is_long, None] + np.arange(3)) % 3
        halves = []
        for table in (points, normals, uvs):
            a, b, c = (
                np.take_along_axis(table[is_long], order[:, k, None, None], axis=1)[:, 0]
                for k in range(3)
            )
            middle = 0.5 * (a + b)
            halves.append(
                np.concatenate([np.stack([a, middle, c], 1), np.stack([middle, b, c], 1)])
            )
        points, normals, uvs = (
            np.concatenate([table[~is_long], half])
            for table, half in zip((points, normals, uvs), halves, strict=True)
        )
    flat = normals.reshape(-1, 3)
    flat /= np.maximum(np.sqrt((flat**2).sum(axis=1, keepdims=True)), LEAST_LENGTH)
    surface = Mesh.loose(points.reshape(-1, 3), flat, uvs.reshape(-1, 2))
    return replace(surface, lamps=mesh.lamps, puffs=mesh.puffs)


def _noise(points: Array, key: int) -> Array:
    """Return a value from 0 to 1 for every point, the same for the same place."""
    cells = np.rint(points * 1000.0).astype(np.int64)
    mixed = cells @ np.array([73_856_093, 19_349_663, 83_492_791], np.int64) + key * 7_919
    mixed = (mixed ^ (mixed >> 13)) * 1_274_126_177
    return np.asarray(((mixed ^ (mixed >> 16)) & 0xFFFF) / 65_535.0)


def _dirtied(mesh: Mesh) -> Mesh:
    """Return the mesh with mud that thins out upwards, on everything but lamps and prints."""
    mesh = _split(mesh)
    uvs = mesh.uvs.reshape(-1, 3, 2).copy()
    centres = mesh.vertices.reshape(-1, 3, 3).mean(axis=1)
    top = float(mesh.vertices[:, 2].max())
    share = 1.1 - 1.5 * centres[:, 2] / top + 0.3 * (_noise(centres, 1) - 0.5)
    level = np.clip(np.rint(share * 4.0), 0, 4).astype(np.int64)
    for place in np.unique(uvs.reshape(-1, 2), axis=0):
        colour = _PLAIN.get(tuple(place.tolist())) or _free(place)
        if colour is None:
            continue
        is_it = (uvs == place).all(axis=(1, 2))
        for number in np.unique(level[is_it]).tolist():
            if number:
                uvs[is_it & (level == number)] = swatch_uv(_mixed(colour, _SHARES[number]))
    return replace(mesh, uvs=uvs.reshape(-1, 2))


def _free(place: Array) -> tuple[int, int, int] | None:
    """Return a colour that the atlas lacks, `None` for prints and for what shines."""
    is_free, rows = free_colours(place[None])
    red, green, blue, is_lit = rows[0].tolist()
    return (red, green, blue) if is_free[0] and not is_lit else None


def _mixed(colour: tuple[int, int, int], share: float) -> str:
    rgb = [round(a + share * (b - a)) for a, b in zip(colour, _MUD, strict=True)]
    return "#" + "".join(f"{value:02x}" for value in rgb)


def _crushed(mesh: Mesh, end: float) -> Mesh:
    """Return the mesh with its front (1) or rear (-1) end pushed in, folded and askew."""
    mesh = _split(mesh)
    half, side = float(np.abs(mesh.vertices[:, 0]).max()), float(np.abs(mesh.vertices[:, 1]).max())

    def moved(points: Array) -> Array:
        ahead = np.maximum(end * points[:, 0] / half - 0.35, 0.0) / 0.65
        askew = 0.7 + 0.3 * points[:, 1] / side
        folds = [_noise(points, key) - 0.5 for key in (2, 3, 4)]
        depth = _CRUSHED * 0.65 * half * askew * ahead + 0.16 * ahead * folds[0]
        bulge = 4.0 * ahead * np.maximum(1.0 - ahead, 0.0)
        is_high = np.clip((points[:, 2] - 0.55) / 0.3, 0.0, 1.0)
        shift = np.stack(
            [
                -end * depth,
                0.12 * ahead * folds[1],
                is_high * (0.26 * bulge * askew + 0.14 * ahead * folds[2]),
            ],
            axis=1,
        )
        found = points + shift
        return np.stack([found[:, 0], found[:, 1], np.maximum(found[:, 2], 0.0)], axis=1)

    return _reshaped(mesh, moved)


def _reshaped(mesh: Mesh, moved: Callable[[Array], Array]) -> Mesh:
    """Return the mesh with its points moved, and flat normals where they moved."""
    points = moved(mesh.vertices)
    corners = points.reshape(-1, 3, 3)
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.sqrt((facing**2).sum(axis=1, keepdims=True))
    flat = np.repeat(facing / np.maximum(length, _LEAST_AREA), 3, axis=0)
    is_moved = np.repeat(
        np.abs(points - mesh.vertices).max(axis=1).reshape(-1, 3).max(axis=1) > _MOVED_M, 3
    ) & np.repeat(length[:, 0] > LEAST_LENGTH, 3)
    lamps = tuple(
        replace(lamp, position=tuple(moved(np.array([lamp.position]))[0].tolist()))
        for lamp in mesh.lamps
    )
    normals = np.where(is_moved[:, None], flat, mesh.normals)
    return replace(mesh, vertices=points, normals=normals, lamps=lamps)
