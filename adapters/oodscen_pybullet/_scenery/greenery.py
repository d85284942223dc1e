"""Standing trees and bushes with few triangles, made to look round by their normals."""

import math
from functools import lru_cache

import numpy as np

from oodscen_pybullet._meshes.atlas import swatch_uv
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._meshes.tags import Tag, tagged
from oodscen_pybullet._types import Point

_GOLDEN_RATIO = (1.0 + math.sqrt(5.0)) / 2.0
_ICOSAHEDRON = np.array(
    [
        (-1, _GOLDEN_RATIO, 0), (1, _GOLDEN_RATIO, 0), (-1, -_GOLDEN_RATIO, 0), (1, -_GOLDEN_RATIO, 0),
        (0, -1, _GOLDEN_RATIO), (0, 1, _GOLDEN_RATIO), (0, -1, -_GOLDEN_RATIO), (0, 1, -_GOLDEN_RATIO),
        (_GOLDEN_RATIO, 0, -1), (_GOLDEN_RATIO, 0, 1), (-_GOLDEN_RATIO, 0, -1), (-_GOLDEN_RATIO, 0, 1),
    ]
) / math.sqrt(1.0 + _GOLDEN_RATIO * _GOLDEN_RATIO)  # fmt: skip
_ICOSAHEDRON_FACES = np.array(
    [
        (0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11),
        (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8),
        (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9),
        (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1),
    ]
)  # fmt: skip
_TREES = 10
"""Number of different plants of a kind."""
_GREENS = (("leaf", "leaf_dark"), ("leaf_light", "leaf"), ("leaf_dark", "leaf_dark"))
_WOOD_GREENS = (("leaf", "leaf_dark"), ("leaf_dark", "leaf_dark"), ("needle", "needle"))
"""Upper and lower colours of broad-leaved trees, and of those at the edge of a wood."""


def _clump(centre: Point, radii: Point, colours: tuple[str, str], rng: np.random.Generator) -> Mesh:
    """Return a clump of leaves: a distorted icosahedron, dark at the bottom."""
    dents = 1.0 + 0.22 * rng.uniform(-1.0, 1.0, (12, 1))
    points = _ICOSAHEDRON * dents * np.array(radii) + np.array(centre)
    faces = points[_ICOSAHEDRON_FACES]
    flat = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    flat /= np.sqrt((flat * flat).sum(axis=1, keepdims=True))
    normals = 0.5 * _ICOSAHEDRON[_ICOSAHEDRON_FACES] + 0.5 * flat[:, None, :]
    normals /= np.sqrt((normals * normals).sum(axis=2, keepdims=True))
    is_low = (flat[:, 2] < -0.1)[:, None, None]
    uvs = np.where(is_low, swatch_uv(colours[1]), swatch_uv(colours[0]))
    uvs = np.broadcast_to(uvs, (20, 3, 2)).reshape(-1, 2)
    return Mesh.loose(faces.reshape(-1, 3), normals.reshape(-1, 3), uvs)


def _trunk(height: float, radius: float) -> MeshBuilder:
    """Return a builder with a tapering trunk of square cross-section."""
    mesh = MeshBuilder()
    corners = ((1, 0), (0, 1), (-1, 0), (0, -1))
    for (a, b), (c, d) in zip(corners, corners[1:] + corners[:1], strict=True):
        low, high = radius, 0.55 * radius
        mesh.polygon(
            [
                (a * low, b * low, -0.3), (c * low, d * low, -0.3),
                (c * high, d * high, height), (a * high, b * high, height),
            ],
            "bark",
        )  # fmt: skip
    return mesh


@lru_cache(maxsize=64)
def broad_tree(
    key: int, *, is_tall: bool = False, is_far: bool = False, is_pruned: bool = False
) -> Mesh:
    """Return a broad-leaved tree of six to eight metres.

    Args:
        key: Selects one of ten trees.
        is_tall: Whether it is a quarter larger.
        is_far: Whether it is simplified for long distances.
        is_pruned: Whether its crown is pruned so high that one sees signals and people below it.
    """
    rng = np.random.Generator(np.random.PCG64(4000 + key % _TREES))
    scale = float(rng.uniform(0.85, 1.15)) * (1.25 if is_tall else 1.0)
    trunk = (4.1 if is_pruned else 2.5) * scale
    mesh = _trunk(trunk + 1.2 * scale, 0.2 * scale)
    colours = _GREENS[key % len(_GREENS)]
    lumps = [((0.0, 0.0, trunk + 2.1 * scale), 1.75 * scale)]
    for x, y in ((1.15, 0.4), (-0.75, 1.0), (-0.35, -1.15)):
        size = float(rng.uniform(0.95, 1.35)) * scale
        z = trunk + float(rng.uniform(0.7, 1.9)) * scale
        lumps.append(((x * scale, y * scale, z), size))
    if is_far:
        lumps = [(lumps[0][0], 1.25 * lumps[0][1]), lumps[2]]
    parts = [_clump(at, (r, r, 0.85 * r), colours, rng) for at, r in lumps]
    return tagged(Mesh.joined([mesh.build(), *parts]), Tag.VEGETATION)


@lru_cache(maxsize=16)
def conifer(key: int) -> Mesh:
    """Return a fir of seven to eleven metres."""
    rng = np.random.Generator(np.random.PCG64(5000 + key % _TREES))
    scale = float(rng.uniform(0.8, 1.2))
    mesh = _trunk(1.5 * scale, 0.17 * scale)
    for z0, z1, radius in ((1.0, 4.3, 2.0), (3.1, 6.4, 1.5), (5.2, 9.0, 1.0)):
        start, end = (0.0, 0.0, z0 * scale), (0.0, 0.0, z1 * scale)
        mesh.cylinder(
            start, end, radius * scale, "needle", sides=7, end_radius=0.03, phase=key + z0
        )
    return tagged(mesh.build(), Tag.VEGETATION)


@lru_cache(maxsize=16)
def bush(key: int) -> Mesh:
    """Return a bush about one metre high."""
    rng = np.random.Generator(np.random.PCG64(6000 + key % _TREES))
    size = float(rng.uniform(0.6, 0.95))
    colours = ("leaf_dark", "leaf_dark") if key % 2 else ("leaf", "leaf_dark")
    leaves = _clump((0.0, 0.0, 0.4 * size), (size, 0.9 * size, 0.75 * size), colours, rng)
    return tagged(leaves, Tag.VEGETATION)


@lru_cache(maxsize=16)
def thicket(key: int) -> Mesh:
    """Return a section of a wood's edge, some sixteen metres long, for long distances."""
    rng = np.random.Generator(np.random.PCG64(7000 + key % _TREES))
    parts = []
    for index in range(3):
        height = float(rng.uniform(3.5, 6.5))
        at = (-5.5 + 5.5 * index, float(rng.uniform(-2.0, 2.0)), 0.5 * height)
        colours = _WOOD_GREENS[int(rng.integers(0, len(_WOOD_GREENS)))]
        parts.append(_clump(at, (4.2, 3.4, height), colours, rng))
    return tagged(Mesh.joined(parts), Tag.VEGETATION)
