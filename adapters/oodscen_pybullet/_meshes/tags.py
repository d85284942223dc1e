"""Semantic classes of scenery, with the numbers of `carla.CityObjectLabel` in CARLA 0.9.14 and later."""

from collections.abc import Mapping
from dataclasses import replace
from enum import IntEnum
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from oodscen_pybullet._meshes.atlas import swatch_uv
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._types import Mask


class Tag(IntEnum):
    """The class of a surface."""

    NONE = 0
    ROADS = 1
    SIDEWALKS = 2
    BUILDINGS = 3
    WALLS = 4
    FENCES = 5
    POLES = 6
    TRAFFIC_LIGHT = 7
    TRAFFIC_SIGNS = 8
    VEGETATION = 9
    TERRAIN = 10
    SKY = 11
    CAR = 14
    STATIC = 20
    DYNAMIC = 21
    OTHER = 22
    WATER = 23
    ROAD_LINES = 24
    GROUND = 25
    BRIDGE = 26
    RAIL_TRACK = 27
    GUARD_RAIL = 28


_SURFACES = {
    Tag.ROADS: (
        *("asphalt", "asphalt_worn", "asphalt_dark", "asphalt_light", "asphalt_patch"),
        "asphalt_tunnel",
    ),
    Tag.ROAD_LINES: ("mark", "mark_worn", "mark_tunnel"),
    Tag.SIDEWALKS: (
        *("paving", "pavement", "pavement_dark", "kerb", "kerb_side"),
        *("tunnel", "tunnel_light"),
    ),
    Tag.TERRAIN: ("turf", "grass", "grass_dark", "field", "crop", "earth", "hill", "gravel"),
    Tag.GROUND: ("concrete", "concrete_dark"),
    Tag.RAIL_TRACK: ("wood", "rail"),
}
SURFACES: Mapping[str, Tag] = MappingProxyType(
    {name: tag for tag, names in _SURFACES.items() for name in names}
)
"""Class of the roads and the land by colour or texture."""
_AXIS_M = 0.13
"""Distance from the axis above the foot of a sign or light within which grey parts are its post, m."""


def tagged(mesh: Mesh, tag: Tag) -> Mesh:
    """Return a mesh of one class."""
    return replace(mesh, tags=np.full(len(mesh.triangles), tag, np.uint8))


@lru_cache(maxsize=64)
def on_posts(mesh: Mesh, tag: Tag) -> Mesh:
    """Return a sign or light of a class, whose posts are poles."""
    corners = mesh.vertices[mesh.triangles]
    foot = mesh.vertices[mesh.vertices[:, 2] < mesh.vertices[:, 2].min() + 0.01].mean(axis=0)
    away = ((corners - foot)[:, :, :2] ** 2).sum(axis=2).max(axis=1)
    is_grey = _is_coloured(mesh, "grey") | _is_coloured(mesh, "dark_grey")
    is_post = _is_coloured(mesh, "post") | (is_grey & (away < _AXIS_M * _AXIS_M))
    return replace(mesh, tags=np.where(is_post, Tag.POLES, tag).astype(np.uint8))


def _is_coloured(mesh: Mesh, colour: str) -> Mask:
    return np.asarray((mesh.uvs[mesh.triangles[:, 0]] == swatch_uv(colour)).all(axis=1))
