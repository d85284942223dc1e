"""Logical scenarios: the parameters of a scene with ranges, and variants drawn from them."""

import re
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from oodscen._arguments import checked
from oodscen._numbers import seed_number, whole_number
from oodscen._seeding import stream
from oodscen.claims._checking import check_claims, mismatches
from oodscen.data._base import Data
from oodscen.data._catalogue import Catalogue
from oodscen.data._claim import Claim
from oodscen.data._scene import CLEAR_AIR_M, MAX_TRIGGER, Scene
from oodscen.driving._sight.placement import check_scene
from oodscen.errors import DataError

Path = tuple[str | int, ...]

_SPREAD = 0.2
"""Widest range of a parameter, as a share of its value to either side."""
_HALVINGS = 3
"""Number of times a range is halved before its parameter stays fixed."""
_TRIES = 20
_MOST = 100_000
"""Draws for each variant that is asked for."""
_DIGITS = 3


class ParameterRange(Data):
    """One parameter of a scene, with the range within which its text stays true."""

    name: str
    """Name in OpenSCENARIO files, e.g. `trigger_child`."""
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

    def holds(path: Path, value: float) -> bool:
        return is_sound(changed(scene, {path: value}), catalogue, claims)

    if not is_sound(scene, catalogue, claims):
        return ()
    parameter_ranges: list[ParameterRange] = []
    for name, path, value, low, high in _parameters(scene, catalogue):
        ends = [_end(value, end, partial(holds, path)) for end in (low, high)]
        if ends[0] < ends[1]:
            parameter_ranges.append(
                ParameterRange(name=name, path=path, value=value, low=ends[0], high=ends[1])
            )
    return tuple(parameter_ranges)


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
    count = whole_number("count", count, 1, _MOST)
    parameters = ranges(scene, catalogue, claims)
    own, mark, kind = scene.id.partition("~")  # The mark of an ordinary drive stays at the end.
    draws = stream(seed_number(seed), "vary", scene.id)
    scenes: list[Scene] = []
    for _ in range(count * _TRIES):
        if len(scenes) == count or not parameters:
            break
        values = {
            parameter.path: round(float(draws.uniform(parameter.low, parameter.high)), _DIGITS)
            for parameter in parameters
        }
        variant = changed(scene, values, f"{own}.v{len(scenes) + 1:03d}{mark}{kind}")
        if is_sound(variant, catalogue, claims):
            assert variant is not None
            scenes.append(variant)
    return scenes


def is_sound(scene: Scene | None, catalogue: Catalogue, claims: Sequence[Claim]) -> bool:
    """Return whether a scene can be staged and contradicts no claim."""
    if scene is None or check_scene(scene, catalogue):
        return False
    return not claims or not mismatches(check_claims(claims, scene, catalogue))


def changed(scene: Scene, values: dict[Path, float], name: str | None = None) -> Scene | None:
    """Return a scene with some values replaced, or `None` if that is not a scene."""
    data = scene.model_dump(mode="json")
    for path, value in values.items():
        place: Any = data
        for key in path[:-1]:
            place = place[key]
        place[path[-1]] = value
    if name is not None:
        data["id"] = name
    try:
        return Scene.parse(data)
    except DataError:
        return None


def _end(value: float, end: float, holds: Callable[[float], bool]) -> float:
    """Return the end of a range, drawn in until the scene holds there."""
    for _ in range(_HALVINGS):
        if end == value or holds(end):
            return end
        end = round(0.5 * (value + end), _DIGITS)
    return value


def _parameters(scene: Scene, catalogue: Catalogue) -> list[tuple[str, Path, float, float, float]]:
    """Return name, place, value and widest range of every parameter."""
    found: list[tuple[str, Path, float, float, float]] = []

    def add(name: str, path: Path, value: float, low: float, high: float) -> None:
        """Add a parameter with a range by shares of its value, within limits."""
        reach = _SPREAD * abs(value)
        ends = max(low, value - reach), min(high, value + reach)
        found.append((name, path, value, round(ends[0], _DIGITS), round(ends[1], _DIGITS)))

    if scene.ego.speed > 0.0:
        add("ego_speed", ("ego", "speed"), scene.ego.speed, 0.0, 45.0)
    weather, limits = scene.weather, catalogue.weather
    if weather.friction < 1.0:
        add("friction", ("weather", "friction"), weather.friction, limits.min_friction, 1.0)
    if weather.fog_visual_range_m < CLEAR_AIR_M:
        path: Path = ("weather", "fog_visual_range_m")
        least = limits.min_fog_visual_range_m
        add("fog_visual_range", path, weather.fog_visual_range_m, least, CLEAR_AIR_M)
    for index, actor in enumerate(scene.actors):
        here, own = ("actors", index), re.sub(r"[^A-Za-z0-9_]", "_", actor.id)
        add(f"ahead_{own}", (*here, "placement", "ahead_m"), actor.placement.ahead_m, -150, 300)
        does, trigger = actor.behaviour, actor.behaviour.trigger
        if does.parameters.get("speed", 0.0) > 0.0:
            limit = catalogue.behaviour(does.name).parameters["speed"]
            path = (*here, "behaviour", "parameters", "speed")
            add(f"speed_{own}", path, does.parameters["speed"], limit.minimum, limit.maximum)
        if trigger.value > 0.0:
            path = (*here, "behaviour", "trigger", "value")
            add(f"trigger_{own}", path, trigger.value, 0.0, MAX_TRIGGER)
    return [one for one in found if one[3] < one[4]]
