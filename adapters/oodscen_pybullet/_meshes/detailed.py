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
from oodscen_pybullet._meshes.vehicles.damage import damaged
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
    offers = load_catalogue().asset(asset).offers or AssetDetails()
    at_rest = replace(shown, state="", running=False, frame=0)
    (x0, y0, z0), (x1, y1, _) = _bounds_over_pose(asset, at_rest, make)
    mesh = damaged(make(asset, shown), shown)
    mesh.shift((-(x0 + x1) / 2, -(y0 + y1) / 2, -z0))
    if details.holds:
        _hold(mesh, details, offers, find, half_length=(x1 - x0) / 2)
    if details.cargo and offers.bed is not None:
        _load(mesh, find(details.cargo, ""), offers.bed.at)
    return mesh


def _hold(
    mesh: MeshBuilder,
    details: Details,
    offers: AssetDetails,
    find: FindMesh,
    *,
    half_length: float,
) -> None:
    """Put what a person holds into the hands, if the pose has a grip; the box around both is centred."""
    kinds = load_catalogue().details
    pose = kinds.pose(posed(details)) if kinds else None
    if pose is None or pose.grip is None:
        return
    thing = find(details.holds, "")
    place = held_place(pose.grip, offers.scale, thing.size)
    mesh.insert(_quarter_turned(thing, place.at, is_turned=place.is_turned))
    x, depth = place.at[0], thing.size[1 if place.is_turned else 0]
    front, back = max(half_length, x + depth / 2), max(half_length, depth / 2 - x)
    mesh.shift(((back - front) / 2, 0.0, 0.0))


def _load(mesh: MeshBuilder, thing: Mesh, bed: tuple[float, float]) -> None:
    """Put a thing on the bed of a vehicle, at x and z, with its longer side along the vehicle."""
    x, z = bed
    length, width, _ = thing.size
    mesh.insert(_quarter_turned(thing, (x, 0.0, z), is_turned=width > length))


def _quarter_turned(thing: Mesh, to: Point, *, is_turned: bool) -> Mesh:
    """Return a thing with its origin at a point, turned to the left by a quarter or not."""
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
    (x0, y0, z0), (x1, y1, z1) = np.min(lows, axis=0).tolist(), np.max(highs, axis=0).tolist()
    return (x0, y0, z0), (x1, y1, z1)
