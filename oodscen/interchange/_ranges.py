"""Logical scenarios: the parameters of a scene with ranges, and variants drawn from them."""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from typing import Any

from oodscen._arguments import checked
from oodscen._numbers import seed_number, whole_number
from oodscen._seeding import stream
from oodscen.claims._checking import check_claims, mismatches
from oodscen.data._base import Data
from oodscen.data._catalogue import Catalogue
from oodscen.data._claim import Claim
from oodscen.data._scene import MAX_SPEED, MAX_TRIGGER, Actor, Scene
from oodscen.data._weather import CLEAR_AIR_M
from oodscen.driving._sight.placement import check_scene
from oodscen.errors import DataError

Path = tuple[str | int, ...]
"""Keys that lead to a value in a scene's JSON value."""

_SPREAD = 0.2
"""Widest range of a parameter, as a share of its value to either side."""
_TRIES = 3
"""Number of ends that are tried to either side, each half as far from the value as the one before."""
_DRAWS_PER_VARIANT = 20
_MAX_VARIANTS = 100_000
_DECIMALS = 3
_NEAREST_M, _FARTHEST_M = -150.0, 300.0
"""Limits of an actor's place ahead of the ego, m."""


class ParameterRange(Data):
    """One parameter of a scene, with the range within which its text stays true."""

    name: str
    """Name in OpenSCENARIO files, e.g. `trigger_child`; no two parameters of a scene have the same."""
    path: tuple[str | int, ...]
    """Place in the scene's JSON value."""
    value: float
    low: float
    high: float


def ranges(
    scene: Scene, catalogue: Catalogue, claims: Sequence[Claim] = ()
) -> tuple[ParameterRange, ...]:
    """Return the ranges of a scene's distances, speeds, triggers, friction and visual range.

    Each end of a range is tried alone: the scene must pass every check there and contradict no claim of its text. An end
    that fails is halved towards the scene's own value. A parameter without a range is left out.
    """

    def is_sound_at(path: Path, value: float) -> bool:
        return is_sound(changed(scene, {path: value}), catalogue, claims)

    if not is_sound(scene, catalogue, claims):
        return ()
    narrowed = (
        _narrowed(widest, partial(is_sound_at, widest.path))
        for widest in _widest_ranges(scene, catalogue)
        if widest.low < widest.high
    )
    return tuple(parameter for parameter in narrowed if parameter.low < parameter.high)


@checked
def vary(
    scene: Scene,
    catalogue: Catalogue,
    count: int,
    *,
    claims: Sequence[Claim] = (),
    seed: int = 0,
) -> list[Scene]:
    """Draw checked variants of a scene; `Scene.vary` tells arguments and result."""
    count = whole_number("count", count, 1, _MAX_VARIANTS)
    draws = stream(seed_number(seed), "vary", scene.id)
    parameters = ranges(scene, catalogue, claims)
    if not parameters:
        return []
    stem, mark, kind = scene.id.partition("~")  # The mark of an ordinary drive stays at the end.
    variants: list[Scene] = []
    for _ in range(count * _DRAWS_PER_VARIANT):
        if len(variants) == count:
            break
        values = {
            parameter.path: round(float(draws.uniform(parameter.low, parameter.high)), _DECIMALS)
            for parameter in parameters
        }
        scene_id = f"{stem}.v{len(variants) + 1:03d}{mark}{kind}"
        variant = changed(scene, values)
        if variant is not None and is_sound(variant, catalogue, claims):
            variants.append(Scene.parse({**variant.model_dump(mode="json"), "id": scene_id}))
    return variants


def is_sound(scene: Scene | None, catalogue: Catalogue, claims: Sequence[Claim]) -> bool:
    """Return whether a scene can be staged and contradicts no claim."""
    if scene is None or check_scene(scene, catalogue):
        return False
    return not claims or not mismatches(check_claims(claims, scene, catalogue))


def changed(scene: Scene, values: dict[Path, float]) -> Scene | None:
    """Return a scene with some values replaced, or `None` if that is not a scene."""
    data: dict[str, Any] = scene.model_dump(mode="json")
    for path, value in values.items():
        container: Any = data
        for key in path[:-1]:
            container = container[key]
        container[path[-1]] = value
    try:
        return Scene.parse(data)
    except DataError:
        return None


def _narrowed(widest: ParameterRange, is_sound_at: Callable[[float], bool]) -> ParameterRange:
    """Return a range whose ends are drawn in until the scene is sound there."""
    low, high = (_sound_end(widest.value, end, is_sound_at) for end in (widest.low, widest.high))
    return widest.model_copy(update={"low": low, "high": high})


def _sound_end(value: float, end: float, is_sound_at: Callable[[float], bool]) -> float:
    for _ in range(_TRIES):
        if end == value or is_sound_at(end):
            return end
        end = round(0.5 * (value + end), _DECIMALS)
    return value


def _widest(name: str, path: Path, value: float, least: float, most: float) -> ParameterRange:
    """Return a range by shares of a parameter's value, within its limits."""
    reach = _SPREAD * abs(value)
    low, high = max(least, value - reach), min(most, value + reach)
    return ParameterRange(
        name=name, path=path, value=value, low=round(low, _DECIMALS), high=round(high, _DECIMALS)
    )


def _widest_ranges(scene: Scene, catalogue: Catalogue) -> Iterator[ParameterRange]:
    if scene.ego.speed > 0.0:
        yield _widest("ego_speed", ("ego", "speed"), scene.ego.speed, 0.0, MAX_SPEED)
    weather, limits = scene.weather, catalogue.weather
    if weather.friction < 1.0:
        path = ("weather", "friction")
        yield _widest("friction", path, weather.friction, limits.min_friction, 1.0)
    if weather.fog_visual_range_m < CLEAR_AIR_M:
        path = ("weather", "fog_visual_range_m")
        least_m, range_m = limits.min_fog_visual_range_m, weather.fog_visual_range_m
        yield _widest("fog_visual_range", path, range_m, least_m, CLEAR_AIR_M)
    suffixes = _suffixes(actor.id for actor in scene.actors)
    for index, (actor, suffix) in enumerate(zip(scene.actors, suffixes, strict=True)):
        yield from _widest_of_actor(actor, ("actors", index), suffix, catalogue)


def _widest_of_actor(
    actor: Actor, path: Path, suffix: str, catalogue: Catalogue
) -> Iterator[ParameterRange]:
    ahead_m, behaviour = actor.placement.ahead_m, actor.behaviour
    ahead_path = (*path, "placement", "ahead_m")
    yield _widest(f"ahead_{suffix}", ahead_path, ahead_m, _NEAREST_M, _FARTHEST_M)
    speed = behaviour.parameters.get("speed", 0.0)
    if speed > 0.0:
        limit = catalogue.behaviour(behaviour.name).parameters["speed"]
        speed_path = (*path, "behaviour", "parameters", "speed")
        yield _widest(f"speed_{suffix}", speed_path, speed, limit.minimum, limit.maximum)
    if behaviour.trigger.value > 0.0:
        trigger_path = (*path, "behaviour", "trigger", "value")
        yield _widest(f"trigger_{suffix}", trigger_path, behaviour.trigger.value, 0.0, MAX_TRIGGER)


def _suffixes(actor_ids: Iterable[str]) -> list[str]:
    """Return a different suffix for the parameters of every actor, of the characters that their names may have."""
    suffixes: list[str] = []
    for actor_id in actor_ids:
        plain = suffix = re.sub(r"[^A-Za-z0-9_]", "_", actor_id)
        number = 2
        while suffix in suffixes:
            suffix = f"{plain}_{number}"
            number += 1
        suffixes.append(suffix)
    return suffixes
