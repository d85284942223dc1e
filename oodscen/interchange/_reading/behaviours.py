"""Behaviours of a scene for the actions of the entities of an OpenSCENARIO file."""

from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._scene import Behaviour, Trigger
from oodscen.interchange._reading.actions import Action
from oodscen.interchange._reading.tree import Element
from oodscen.interchange._reading.triggers import AT_ONCE, STANDING_MPS

_HARD_MPS2 = 3.0
"""Deceleration from which braking is hard, m/s^2."""
_WALKING_MPS, _DRIVING_MPS = 1.4, 8.0
"""Speeds on courses without one, m/s."""
_WALK_M = 12.0
"""Length of a walk without an end, m."""
_ORDER = ("lane_change", "brake", "course", "start")
"""Kinds of actions, the one that counts most first."""


def behaviour(
    entity: Element,
    asset: Asset,
    actions: list[Action],
    speed: float,
    is_against: bool,
    catalogue: Catalogue,
) -> tuple[Behaviour, float | None]:
    """Return an actor's one behaviour, and the direction of its course if it has one.

    The first kind of action in `_ORDER` counts; the others are recorded as left out.
    """
    is_driver = asset.category in ("vehicle", "cyclist")
    action = _main_action(actions, is_driver=is_driver)
    if action is None:
        name = _ordinary(asset, speed, is_against)
        if name == "stand" and speed >= STANDING_MPS:
            entity.note(f"its first speed, {speed:g} m/s, is left out: a {asset.category} stands")
        return _possible(entity, asset, catalogue, name, {"speed": speed}, AT_ONCE), None
    if is_driver and not _waits(asset, action, speed):
        name, parameters = _driving(action, speed)
    else:
        name, parameters = _walking(action, speed)
    trigger = AT_ONCE if name == "run_red" else action.trigger
    does = _possible(action.node, asset, catalogue, name, parameters, trigger)
    if does.name != name:
        return does, None
    if speed >= STANDING_MPS and not is_driver and action.trigger != AT_ONCE:
        action.node.note(f"its first speed, {speed:g} m/s, is left out: it stands until this")
    return does, action.heading


def _main_action(actions: list[Action], *, is_driver: bool) -> Action | None:
    """Return the one action of an actor that counts, after recording the others as left out."""
    possible = [action for action in actions if is_driver or action.kind in ("course", "start")]
    main = min(
        possible,
        key=lambda action: (_ORDER.index(action.kind), "speed" not in action.parameters),
        default=None,
    )
    for action in actions:
        if action is not main:
            action.node.note("an actor does one thing: this is left out")
    return main


def _possible(
    node: Element,
    asset: Asset,
    catalogue: Catalogue,
    name: str,
    parameters: dict[str, float],
    trigger: Trigger,
) -> Behaviour:
    """Return a behaviour with those of some parameters that it has, within their limits.

    In its place an asset that cannot behave so stands.
    """
    kind = next((kind for kind in catalogue.behaviours if kind.id == name), None)
    if kind is None or asset.category not in kind.categories:
        node.note(f"a {asset.category} cannot {name}: this is left out")
        return Behaviour(name="stand")
    limits = kind.parameters
    bounded = {
        key: round(node.bounded(value, limits[key].minimum, limits[key].maximum, f"a {key} of"), 3)
        for key, value in parameters.items()
        if key in limits
    }
    return Behaviour(name=name, parameters=bounded, trigger=trigger)


def _ordinary(asset: Asset, speed: float, is_against: bool) -> str:
    """Return the behaviour of an actor without actions."""
    if speed < STANDING_MPS:
        return "stand"
    if asset.category in ("vehicle", "cyclist"):
        return "wrong_way" if is_against else "follow_lane"
    return "walk_along" if asset.category in ("pedestrian", "animal") else "stand"


def _waits(asset: Asset, action: Action, speed: float) -> bool:
    """Return whether a cyclist stands until a course of its own begins."""
    is_later = action.kind == "course" and action.trigger != AT_ONCE
    return asset.category == "cyclist" and is_later and speed < STANDING_MPS


def _driving(action: Action, speed: float) -> tuple[str, dict[str, float]]:
    """Return the behaviour of a vehicle, with its parameters."""
    parameters = {"speed": speed, **action.parameters}
    if action.kind == "lane_change":
        return "cut_in", parameters
    if action.kind == "brake":
        is_hard = parameters["deceleration"] >= _HARD_MPS2
        return "hard_brake" if is_hard else "stall", parameters
    if action.kind == "start":
        return "pull_out", parameters
    if parameters["speed"] < STANDING_MPS:
        parameters["speed"] = _DRIVING_MPS
        action.node.note(f"the course has no speed; {_DRIVING_MPS:g} m/s is taken")
    if action.trigger != AT_ONCE:
        action.node.note(
            f"the course is driven from the start of the scene at {parameters['speed']:g} m/s: its own start, "
            f"a {action.trigger.kind} of {action.trigger.value:g}, and the first speed, {speed:g} m/s, are left out"
        )
    return "run_red", parameters


def _walking(action: Action, speed: float) -> tuple[str, dict[str, float]]:
    """Return the behaviour of a walker, or of a cyclist that has waited, with its parameters."""
    parameters = {"speed": speed, **action.parameters}
    if parameters["speed"] < STANDING_MPS:
        parameters["speed"] = _WALKING_MPS
        action.node.note(f"the course has no speed; {_WALKING_MPS:g} m/s is taken")
    if "distance" not in parameters:
        parameters["distance"] = _WALK_M
        action.node.note(f"the way has no end; {_WALK_M:g} m are taken")
    return "cross_road", parameters
