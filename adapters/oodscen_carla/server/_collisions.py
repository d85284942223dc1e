"""Collisions: everything that vehicles touch after a movement, and its effect on them."""

import math
from collections.abc import Iterable, Mapping, Sequence, Set

import numpy as np
from numpy.typing import NDArray

from oodscen_carla.server._actors import ServerActor
from oodscen_carla.server._values import Transform, Vector
from oodscen_carla.server._vehicles import MASS_KG

Pair = tuple[ServerActor, ServerActor]
"""A vehicle and what it touches."""


def collide(
    actors: Iterable[ServerActor], before: Mapping[int, Transform], touched: Set[str]
) -> dict[Pair, Vector]:
    """Stop every vehicle that has run into something by itself: driven, or with a velocity.

    Args:
        actors: All actors.
        before: Places before they moved, by the ids of the actors that did.
        touched: The bodies of a staged scene that its ego touches.

    Returns:
        The impulse of every contact, N s: the momentum that the vehicle has relative to the other as they meet.
    """
    solid = [actor for actor in actors if actor.is_obstacle and not actor.parent]
    contacts: dict[Pair, Vector] = {}
    moving = {actor for actor in solid if actor.id in before and actor.moves_itself}
    while True:
        met = _contacts(solid, touched)
        contacts = {
            (car, other): _impulse(car, other) for car in met for other in met[car]
        } | contacts
        hit = {car for car in moving if {other.id for other in met[car]} - car.touching}
        for car in hit:
            car.place = before[car.id]
            car.stop()
        # Where they stand now, something else may have run into them.
        moving -= hit
        if not hit:
            break
    for car, others in met.items():
        car.touching = {other.id for other in others}
    return contacts


def _impulse(car: ServerActor, other: ServerActor) -> Vector:
    x, y, z = (MASS_KG * (a - b) for a, b in zip(car.velocity, other.velocity, strict=True))
    return x, y, z


def _contacts(
    solid: Sequence[ServerActor], touched: Set[str]
) -> dict[ServerActor, list[ServerActor]]:
    """Return the bodies that each vehicle touches."""
    cars = [row for row, actor in enumerate(solid) if actor.is_vehicle]
    is_ego = np.array([actor.staged == "ego" for actor in solid], bool)
    is_touched = np.array([actor.staged in touched for actor in solid], bool)
    is_near = _near(solid, cars)
    is_near |= is_ego[cars, None] & is_touched | is_touched[cars, None] & is_ego
    found = {}
    for row, is_rival in zip(cars, is_near, strict=True):
        car = solid[row]
        rivals = [solid[index] for index in np.flatnonzero(is_rival).tolist() if index != row]
        found[car] = [other for other in rivals if _touch(car, other, touched)]
    return found


def _near(solid: Sequence[ServerActor], cars: Sequence[int]) -> NDArray[np.bool_]:
    """Return which bodies may touch which cars, by their distance: [cars, bodies]."""
    places = np.array([actor.place.location for actor in solid]).reshape(-1, 3)
    radii = np.array([math.hypot(*actor.blueprint.extent[:2]) for actor in solid])
    distances = np.hypot(*(places[cars, None, axis] - places[None, :, axis] for axis in (0, 1)))
    return np.asarray(distances <= radii[cars][:, None] + radii[None, :])


def _touch(car: ServerActor, other: ServerActor, touched: Set[str]) -> bool:
    """Return whether two bodies touch; in a scene, the scene says what the ego touches."""
    if car.staged and other.staged and "ego" in (car.staged, other.staged):
        return bool({car.staged, other.staged} & touched)
    return car.box.overlaps(other.box)
