"""Meshes of things made to order, which scenes bring along."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

from oodscen.data._designs import shapes
from oodscen.data._designs.prop import Prop, sizes_of
from oodscen.data._designs.shapes import Part
from oodscen_pybullet._catalogue import load_catalogue
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.designs import heaps, surfaces  # noqa: F401  # register their shapes
from oodscen_pybullet._meshes.designs.parts import Holder, Placing, add, placed_parts
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._meshes.shapes import rotation
from oodscen_pybullet._types import Point

_SEPARATOR = "@"
"""Between a design's name and its digest; ids of the catalogue hold none."""
_DESIGNS: dict[str, Prop] = {}
"""Every design that a scene of this process has brought along, by name and content."""


def register_design(prop: Prop) -> str:
    """Keep a design, and return the id under which `design_mesh` knows it: its name and content."""
    key = f"{prop.id}{_SEPARATOR}{prop.digest()[:24]}"
    _DESIGNS.setdefault(key, prop)
    return key


def is_registered(asset: str) -> bool:
    """Return whether an id is that of a registered design."""
    return _SEPARATOR in asset


def design_mesh(asset: str, state: str, find_mesh: Callable[[str, str], Mesh]) -> Mesh:
    """Return the mesh of a registered design; its box's footprint is centred on the origin.

    Args:
        asset: The id from `register_design`.
        state: One of its states.
        find_mesh: Returns the mesh of a thing of the catalogue in a state.
    """
    prop = _DESIGNS[asset]
    mesh = MeshBuilder()
    _add_parts(prop.parts, mesh, Appearance(state), Placing(), find_mesh)
    low, high, _ = prop.space(_sizes())
    x, y = (low[0] + high[0]) / 2, (low[1] + high[1]) / 2
    if mesh.is_empty:
        # Dust alone has no surface; a speck on the road stands for it.
        mesh.box((x, y, 0.005), (0.06, 0.06, 0.01), "earth")
    return mesh.flatten(0.0).shift((-x, -y, 0.0)).build()


@lru_cache(maxsize=1)
def _sizes() -> dict[str, Point]:
    return sizes_of(load_catalogue().assets)


def _add_parts(
    parts: tuple[Part, ...],
    mesh: MeshBuilder,
    shown: Appearance,
    place: Placing,
    find_mesh: Callable[[str, str], Mesh],
) -> None:
    """Add parts; those that hold others are opened here, since a thing of the catalogue may be among them."""
    for part in parts:
        if isinstance(part, Holder):
            for inner, placing in placed_parts(part, place, lambda word, _: word == shown.state):
                _add_parts((inner,), mesh, shown, placing, find_mesh)
        elif isinstance(part, shapes.TurnedOf):
            group = MeshBuilder()
            _add_parts(part.turned, group, shown, Placing(), find_mesh)
            insert_turned(mesh, group.build(), part, place)
        elif isinstance(part, shapes.AssetPart):
            insert_turned(mesh, find_mesh(part.asset, part.state), part, place)
        else:
            add(part, mesh, shown, place)


def insert_turned(
    mesh: MeshBuilder, inner: Mesh, part: shapes.TurnedOf | shapes.AssetPart, place: Placing
) -> None:
    """Add a finished mesh as a part says: scaled, turned about x, then about z, moved, then placed."""
    scale = part.scale if isinstance(part, shapes.AssetPart) else 1.0
    turn = rotation(roll=math.radians(part.roll), yaw=math.radians(part.yaw))
    turn[1] *= place.side
    placed = inner.moved(turn, to=place.point(part.to), scale=scale)
    mesh.insert(placed if place.side > 0 else replace(placed, triangles=placed.triangles[:, ::-1]))
