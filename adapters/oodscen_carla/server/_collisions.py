"""Collisions: everything that vehicles touch in one tick, and its effect on them."""

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from oodscen_carla.server._actors import ServerActor
from oodscen_carla.server._values import Transform


def collide(
    actors: Iterable[ServerActor], before: Mapping[int, Transform], touched: frozenset[str]
) -> list[tuple[ServerActor, ServerActor]]:
    """Stop every driven vehicle that has run into something, and return every vehicle with each thing that it touches.

    Args:
        actors: All actors.
        before: Places before this tick, by the ids of the actors that moved in it.
        touched: The bodies of a staged scene that its ego touches.
    """
    solid = [actor for actor in actors if actor.is_obstacle and not actor.parent]
    if len(solid) < 2:
        return []
    contacts: dict[tuple[ServerActor, ServerActor], None] = {}
    driven = {actor for actor in solid if _is_driven(actor, before)}
    while True:
        met = _contacts(solid, touched)
        contacts |= dict.fromkeys((car, other) for car in met for other in met[car])
        hit = {car for car in driven if {other.id for other in met[car]} - car.touching}
        for car in hit:
            car.place = before[car.id]
            car.stop()
        # Where they stand now, something else may have run into them.
        driven -= hit
        if not hit:
            break
    for car, others in met.items():
        car.touching = {other.id for other in others}
    return list(contacts)


def _is_driven(actor: ServerActor, before: Mapping[int, Transform]) -> bool:
    return (
        actor.is_vehicle and actor.control is not None and actor.has_physics and actor.id in before
    )


def _contacts(
    solid: Sequence[ServerActor], touched: frozenset[str]
) -> dict[ServerActor, list[ServerActor]]:
    """Return the bodies that each vehicle touches."""
    cars = [row for row, actor in enumerate(solid) if actor.is_vehicle]
    found = {}
    for row, is_near in zip(cars, _near(solid, cars), strict=True):
        car = solid[row]
        if car.staged == "ego":
            is_near |= [actor.staged in touched for actor in solid]
        rivals = [solid[index] for index in np.flatnonzero(is_near).tolist() if index != row]
        found[car] = [other for other in rivals if _touch(car, other, touched)]
    return found


def _near(solid: Sequence[ServerActor], cars: Sequence[int]) -> NDArray[np.bool_]:
    """Return which bodies may touch which cars, by their distance: [cars, bodies]."""
    places = np.array([actor.place.location for actor in solid])
    radii = np.array([math.hypot(*actor.blueprint.extent[:2]) for actor in solid])
    distances = np.hypot(*(places[cars, None, axis] - places[None, :, axis] for axis in (0, 1)))
    return np.asarray(distances <= radii[cars][:, None] + radii[None, :])


def _touch(car: ServerActor, other: ServerActor, touched: frozenset[str]) -> bool:
    """Return whether two bodies touch; in a scene, the scene says what the ego touches."""
    if car.staged and other.staged and "ego" in (car.staged, other.staged):
        return bool({car.staged, other.staged} & touched)
    return car.box.overlaps(other.box)
