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
    """Return every vehicle with each thing that it touches; a driven one stops where it would run into something.

    Args:
        actors: All actors.
        before: Places before this tick, by the ids of the actors that moved in it.
        touched: The bodies of a staged scene that its ego touches.
    """
    solid = [actor for actor in actors if actor.is_obstacle and not actor.parent]
    if len(solid) < 2:
        return []
    cars = [row for row, actor in enumerate(solid) if actor.is_vehicle]
    near = _near(solid, cars)
    contacts: list[tuple[ServerActor, ServerActor]] = []
    # One car after the other: one that has stopped is no longer in the way of the next.
    for row, is_near in zip(cars, near, strict=True):
        car = solid[row]
        if car.staged == "ego":
            is_near |= [actor.staged in touched for actor in solid]
        others = [solid[index] for index in np.flatnonzero(is_near) if index != row]
        touching = [other for other in others if _touch(car, other, touched)]
        contacts += [(car, other) for other in touching]
        _react(car, {other.id for other in touching}, before)
    return contacts


def _near(solid: Sequence[ServerActor], cars: Sequence[int]) -> NDArray[np.bool_]:
    """Return which bodies may touch which cars, by their distance: [cars, bodies]."""
    places = np.array([actor.place.location for actor in solid])
    radii = np.array([math.hypot(*actor.blueprint.extent[:2]) for actor in solid])
    distances = np.hypot(*(places[cars, None, axis] - places[None, :, axis] for axis in (0, 1)))
    return np.asarray(distances <= radii[cars][:, None] + radii[None, :])


def _react(car: ServerActor, touching: set[int], before: Mapping[int, Transform]) -> None:
    """Put a driven vehicle that touches something new back to where it was, and stop it."""
    is_driven = car.control is not None and car.has_physics and car.id in before
    if touching - car.touching and is_driven:
        car.place = before[car.id]
        car.stop()
    else:
        car.touching = touching


def _touch(car: ServerActor, other: ServerActor, touched: frozenset[str]) -> bool:
    """Return whether two bodies touch; in a scene, the scene says what the ego touches."""
    if car.staged and other.staged and "ego" in (car.staged, other.staged):
        return bool({car.staged, other.staged} & touched)
    return car.box.overlaps(other.box)
