"""Meshes of actors with details: people in poses, vehicles with open parts, things held and loaded."""

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from oodscen.data._details import AssetDetails, Details, held_place, posed
from oodscen.numerics._exact import PI
from oodscen_pybullet._catalogue import load_catalogue
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.living.poses import pose_of
from oodscen_pybullet._meshes.look import BEATS, Appearance, beating
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._meshes.shapes import rotation
from oodscen_pybullet._meshes.vehicles.damage import altered
from oodscen_pybullet._types import Point

MakeAsset = Callable[[str, Appearance], MeshBuilder]
FindMesh = Callable[[str, str], Mesh]


def build_detailed(asset: str, shown: Appearance, make: MakeAsset, find: FindMesh) -> MeshBuilder:
    """Return a builder that holds an asset with its details; its box's footprint is centred on the origin.

    Args:
        asset: An id of the catalogue.
        shown: The look, with details.
        make: Builds the asset by itself.
        find: Returns the mesh of what is held or loaded.
    """
    details = shown.details or Details()
    low, high = _bounds_over_pose(asset, replace(shown, state="", running=False, frame=0), make)
    mesh = altered(make(asset, shown), shown)
    mesh.shift((-(low[0] + high[0]) / 2, -(low[1] + high[1]) / 2, -low[2]))
    offers = load_catalogue().asset(asset).offers or AssetDetails()
    kinds = load_catalogue().details
    pose = kinds.pose(posed(details)) if kinds else None
    if details.holds and pose is not None and pose.grip is not None:
        held = find(details.holds, "")
        place = held_place(pose.grip, offers.scale, held.size)
        mesh.insert(_quarter_turned(held, place.at, is_turned=place.is_turned))
        x, depth = place.at[0], held.size[1 if place.is_turned else 0]
        half = (high[0] - low[0]) / 2
        front, back = max(half, x + depth / 2), max(half, depth / 2 - x)
        mesh.shift(((back - front) / 2, 0.0, 0.0))  # the centre of body and load together
    if details.cargo and offers.bed is not None:
        load = find(details.cargo, "")
        x, z = offers.bed.at
        length, width, _ = load.size
        mesh.insert(_quarter_turned(load, (x, 0.0, z), is_turned=width > length))
    return mesh


def _quarter_turned(thing: Mesh, to: Point, *, is_turned: bool) -> Mesh:
    return thing.moved(rotation(yaw=PI / 2 if is_turned else 0.0), to=to)


@lru_cache(maxsize=512)
def _bounds_over_pose(asset: str, shown: Appearance, make: MakeAsset) -> tuple[Point, Point]:
    """Return the lowest and the highest corner of an asset over the beats of its pose."""
    frames = [0]
    pose = pose_of(shown.details)
    if pose is not None and pose.second is not None:
        # Both key frames, and halfway there and back, where limbs that swing may reach farther.
        frames = [beating(0, beat) for beat in range(0, BEATS, BEATS // 4)]
    bounds = [make(asset, replace(shown, frame=frame)).bounds for frame in frames]
    lows, highs = zip(*bounds, strict=True)
    (a, b, c), (d, e, f) = np.min(lows, axis=0).tolist(), np.max(highs, axis=0).tolist()
    return (a, b, c), (d, e, f)
