"""Meshes of actors with details: people in poses, vehicles with open parts, things held and loaded."""

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from oodscen.data import _shapes as shapes
from oodscen.data._details import AssetDetails, held_place, posed
from oodscen_pybullet._catalogue import load_catalogue
from oodscen_pybullet._meshes.builder import Mesh, MeshBuilder, Point
from oodscen_pybullet._meshes.designs.parts import Placing
from oodscen_pybullet._meshes.living.poses import pose_of
from oodscen_pybullet._meshes.look import BEATS, Appearance, beating
from oodscen_pybullet._meshes.made import insert
from oodscen_pybullet._meshes.vehicles.damage import altered

Make = Callable[[str, Appearance], MeshBuilder]
Shipped = Callable[[str, str], Mesh]


def detailed(asset: str, shown: Appearance, make: Make, shipped: Shipped) -> MeshBuilder:
    """Return a builder that holds an asset with its details; its box's footprint is centred on the origin.

    Args:
        asset: An id of the catalogue.
        shown: The look, with details.
        make: Builds the asset by itself.
        shipped: Returns the mesh of what is held or loaded.
    """
    details = shown.details
    assert details is not None
    low, high = _reach(asset, replace(shown, state="", running=False, frame=0), make)
    mesh = altered(make(asset, shown), shown)
    mesh.shift((-(low[0] + high[0]) / 2, -(low[1] + high[1]) / 2, -low[2]))
    offers = load_catalogue().asset(asset).offers or AssetDetails()
    kinds = load_catalogue().details
    pose = kinds.pose(posed(details)) if kinds else None
    if details.holds and pose is not None and pose.grip is not None:
        held = shipped(details.holds, "")
        size = held.bounds[1] - held.bounds[0]
        place = held_place(pose.grip, offers.scale, (size[0], size[1], size[2]))
        _insert(mesh, held, place.at, is_turned=place.is_turned)
        x, deep = place.at[0], float(size[1] if place.is_turned else size[0])
        half = (high[0] - low[0]) / 2
        mesh.shift((-(max(half, x + deep / 2) - max(half, deep / 2 - x)) / 2, 0.0, 0.0))
    if details.cargo and offers.bed is not None:
        load = shipped(details.cargo, "")
        size = load.bounds[1] - load.bounds[0]
        x, z = offers.bed.at
        _insert(mesh, load, (x, 0.0, z), is_turned=bool(size[1] > size[0]))
    return mesh


def _insert(mesh: MeshBuilder, thing: Mesh, at: Point, *, is_turned: bool) -> None:
    """Add a thing at a place, turned by a quarter or not."""
    turn = shapes.AssetPart(asset="thing", to=at, yaw=90.0 if is_turned else 0.0)
    insert(mesh, thing, turn, 1.0, Placing())


@lru_cache(maxsize=512)
def _reach(asset: str, shown: Appearance, make: Make) -> tuple[Point, Point]:
    """Return the lowest and the highest corner of an asset over the beats of its pose."""
    frames = [0]
    pose = pose_of(shown.details)
    if pose is not None and pose.second is not None:
        frames = [beating(0, beat) for beat in range(0, BEATS, BEATS // 4)]
    bounds = [make(asset, replace(shown, frame=frame)).bounds for frame in frames]
    lows, highs = zip(*bounds, strict=True)
    (a, b, c), (d, e, f) = np.min(lows, axis=0).tolist(), np.max(highs, axis=0).tolist()
    return (a, b, c), (d, e, f)
