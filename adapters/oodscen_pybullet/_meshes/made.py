"""Meshes of things made to order, which scenes bring along."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from oodscen.data import _shapes as shapes
from oodscen.data._prop import Prop, sizes_of
from oodscen.data._shapes import Part
from oodscen.numerics._exact import cos, sin
from oodscen_pybullet._catalogue import load_catalogue
from oodscen_pybullet._meshes.builder import Mesh, MeshBuilder, Point
from oodscen_pybullet._meshes.designs import heaps, surfaces
from oodscen_pybullet._meshes.designs.parts import Placing, add
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._meshes.shapes import rotated

__all__ = ["heaps", "insert_at", "is_made", "learned", "made_mesh", "rotated", "surfaces"]

_AS_IT_IS = Placing()
_MARK = "@"
_DESIGNS: dict[str, Prop] = {}
"""Every design that a scene of this process has brought along, by name and content."""


def learned(prop: Prop) -> str:
    """Keep a design, and return the id under which `made_mesh` knows it: its name and content."""
    key = f"{prop.id}{_MARK}{prop.digest()[:24]}"
    _DESIGNS.setdefault(key, prop)
    return key


def is_made(asset: str) -> bool:
    """Return whether an id is that of a learned design."""
    return _MARK in asset


def made_mesh(asset: str, state: str, shipped: Callable[[str, str], Mesh]) -> Mesh:
    """Return the mesh of a learned design; its box's footprint is centred on the origin.

    Args:
        asset: The id from `learned`.
        state: One of its states.
        shipped: Returns the mesh of a thing of the catalogue in a state.
    """
    prop = _DESIGNS[asset]
    mesh = MeshBuilder()
    _add_all(prop.parts, mesh, Appearance(state), Placing(), shipped)
    low, high, _ = prop.space(_sizes())
    x, y = (low[0] + high[0]) / 2, (low[1] + high[1]) / 2
    if mesh.is_empty:
        # Dust alone has no surface; a speck on the road stands for it.
        mesh.box((x, y, 0.005), (0.06, 0.06, 0.01), "earth")
    return mesh.flatten(0.0).shift((-x, -y, 0.0)).build()


@lru_cache(maxsize=1)
def _sizes() -> dict[str, Point]:
    return sizes_of(load_catalogue().assets)


def _add_all(
    parts: tuple[Part, ...],
    mesh: MeshBuilder,
    shown: Appearance,
    place: Placing,
    shipped: Callable[[str, str], Mesh],
) -> None:
    """Add parts; those that hold others are opened here, since a shipped thing may be among them."""

    def inside(inner: tuple[Part, ...], here: Placing) -> None:
        _add_all(inner, mesh, shown, here, shipped)

    for part in parts:
        match part:
            case shapes.BothSidesOf():
                for side in (place.mirrored(), place):
                    inside(part.both_sides, side)
            case shapes.RowOf():
                x, y, z = part.step
                for k in range(part.repeat):
                    inside(part.parts, place.moved((k * x, k * y, k * z)))
            case shapes.CopiesOf():
                for offset in part.at:
                    inside(part.parts, place.moved(offset))
            case shapes.ConditionOf():
                is_on = set(part.when.split()) <= {shown.state}
                inside(part.parts if is_on else part.otherwise, place)
            case shapes.TurnedOf():
                whole = MeshBuilder()
                _add_all(part.turned, whole, shown, Placing(), shipped)
                _insert(mesh, whole.build_or_none(), part, 1.0, place)
            case shapes.AssetPart():
                _insert(mesh, shipped(part.asset, part.state), part, part.scale, place)
            case _:
                add(part, mesh, shown, place)


def _insert(
    mesh: MeshBuilder,
    inner: Mesh | None,
    turn: shapes.TurnedOf | shapes.AssetPart,
    scale: float,
    place: Placing,
) -> None:
    if inner is not None:
        insert_at(
            mesh, inner, turn.to, roll_deg=turn.roll, yaw_deg=turn.yaw, scale=scale, place=place
        )


def insert_at(
    mesh: MeshBuilder,
    inner: Mesh,
    at: Point,
    *,
    roll_deg: float = 0.0,
    yaw_deg: float = 0.0,
    scale: float = 1.0,
    place: Placing = _AS_IT_IS,
) -> None:
    """Add a finished mesh with its lamps and puffs: scaled, turned, moved, then placed."""
    a, b = math.radians(roll_deg), math.radians(yaw_deg)
    c, s, k, m = cos(b), sin(b), cos(a), sin(a)
    rows = np.array([[c, -s * k, s * m], [s, c * k, -c * m], [0.0, m, k]])
    rows[1] *= place.side
    x, y, z = place.point(at)
    shift = np.array([x, y, z])
    order = inner.triangles if place.side > 0 else inner.triangles[:, ::-1]
    if len(order):
        mesh.add_surface(
            replace(
                inner,
                vertices=rotated(inner.vertices * scale, rows) + shift,
                normals=rotated(inner.normals, rows),
                triangles=order,
            )
        )
    for lamp in inner.lamps:
        position = rotated(np.array([lamp.position]) * scale, rows)[0] + shift
        facing = rotated(np.array([lamp.facing]), rows)[0]
        mesh.lamp(_point(position), lamp.colour, _point(facing), lamp.power, by_day=lamp.by_day)
    for puff in inner.puffs:
        position = rotated(np.array([puff.position]) * scale, rows)[0] + shift
        mesh.puff(
            _point(position),
            puff.radius * scale,
            puff.colour,
            puff.density,
            is_bright=puff.is_bright,
        )


def _point(values: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> Point:
    x, y, z = values.tolist()
    return x, y, z
