"""Scenes as OpenSCENARIO XML 1.0 for CARLA's ScenarioRunner, with the named actions that it plays.

ScenarioRunner follows no trajectory in time. A scene can be expressed only if each of its actors stands, drives in its
lane, brakes, changes lanes, or walks straight on. Speed changes take effect instantly.
"""

from collections.abc import Iterable

from oodscen._registry import make_catalogue
from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._scene import Actor, Scene
from oodscen.driving._motion.behaviours.table import BUILT_IN
from oodscen.driving._roads.corridor import Corridor, ego_strip, neighbour_strip
from oodscen.errors import Issue, SceneError
from oodscen.interchange._writing.elements import Element, Value, child, within
from oodscen.interchange._writing.entities import (
    AXLE_SHARE,
    MASS_KG,
    Entity,
    Kind,
    classified,
    write_body,
    write_chassis,
)
from oodscen.interchange._writing.environment import write_environment
from oodscen.interchange._writing.reactions import Reactions
from oodscen.interchange._writing.reactive import followers
from oodscen.interchange._writing.storyboard import event, maneuver_group, write_speed
from oodscen.interchange._writing.triggers import at_time, of_entity

BLUEPRINTS = "carla-0.9.16"
"""The catalogue whose ids are CARLA's blueprints."""
_ACTIONS = {name: row.plain_action for name, row in BUILT_IN.items() if row.plain_action}
"""Behaviours for which ScenarioRunner has actions."""
_EGO_BLUEPRINT = "vehicle.lincoln.mkz_2017"
_END_S = 60.0
"""Time at which the storyboard ends, s."""
_SHORTEST_CHANGE_M = 5.0
"""Least distance over which an actor changes lanes, m."""


def unplayable(scene: Scene, run: Reactions) -> list[Issue]:
    """Return why ScenarioRunner cannot play a scene, by actor; empty if it can."""
    issues = []
    following = followers(run)
    for index, actor in enumerate(scene.actors):
        name, where = run.behaviours[actor.id].name, f"actors[{index}].behaviour"
        if name not in _ACTIONS:
            fault = f"ScenarioRunner has no action for {actor.behaviour.name!r}"
            issues.append(Issue(where, fault))
        elif actor.id in following:
            issues.append(Issue(where, f"ScenarioRunner cannot make {actor.id!r} follow the ego"))
        elif _ACTIONS[name] == "walk" and actor.behaviour.other is not None:
            message = f"{actor.id!r} is attached to another actor, which ScenarioRunner cannot play"
            issues.append(Issue(where, message))
    return issues


def write_for_scenario_runner(
    root: Element, scene: Scene, entities: list[Entity], run: Reactions, corridor: Corridor
) -> None:
    """Complete a document with entities and storyboard.

    Raises:
        SceneError: If the scene cannot be expressed.
    """
    if issues := unplayable(scene, run):
        raise SceneError(scene.id, issues)
    holder = child(root, "Entities")
    catalogue = make_catalogue(BLUEPRINTS)
    for entity in entities:
        _write_entity(holder, entity, catalogue)
    board = child(root, "Storyboard")
    actions = within(board, "Init", "Actions")
    write_environment(actions, scene.weather, minor=0)
    act = child(child(board, "Story", name="scene"), "Act", name="act")
    actions_by_name = {name: _ACTIONS[does.name] for name, does in run.behaviours.items()}
    starts = zip(entities, run.nominal.poses[0], run.nominal.speeds[0], strict=True)
    for entity, pose, speed in starts:
        private = child(actions, "Private", entityRef=entity.name)
        _write_position(within(private, "PrivateAction", "TeleportAction"), pose)
        if actions_by_name.get(entity.name) != "walk" and speed > 0.0:
            write_speed(child(private, "PrivateAction"), float(speed))
    for actor in scene.actors:
        if actions_by_name[actor.id] != "none":
            _write_actor(act, actor, scene, run, corridor)
    if not len(act):
        maneuver_group(act, "ego")  # An Act must have a group.
    at_time(act, "StartTrigger", "act_start", 0.0, "greaterThan")
    at_time(board, "StopTrigger", "end", _END_S, "greaterThan")


def _write_entity(parent: Element, entity: Entity, catalogue: Catalogue) -> None:
    """Append a scenario object, whose reference point is its centre."""
    blueprint = _EGO_BLUEPRINT if entity.name == "ego" else _blueprint(entity.asset, catalogue)
    attributes: dict[Kind, dict[str, Value]] = {
        "Vehicle": {},
        "Pedestrian": {"model": blueprint, "mass": MASS_KG["Pedestrian"]},
        "MiscObject": {"mass": MASS_KG["MiscObject"]},
    }
    body = write_body(parent, entity, blueprint, attributes[entity.kind], 0.0)
    if entity.kind == "Vehicle":
        axle_m = AXLE_SHARE * entity.asset.length
        write_chassis(body, entity.asset, front_m=axle_m, rear_m=-axle_m)
    role = "ego_vehicle" if entity.name == "ego" else "simulation"
    child(child(body, "Properties"), "Property", name="type", value=role)


def _blueprint(asset: Asset, catalogue: Catalogue) -> str:
    """Return the blueprint of an asset, or else the one that is nearest to it in kind and size."""
    ids = {candidate.id for candidate in catalogue.assets}
    for name in (asset.id, *asset.names):
        if name in ids:
            return name
    kind, category = classified(asset)
    candidates = [other for other in catalogue.assets if classified(other)[0] == kind]
    nearest = min(
        candidates,
        key=lambda other: (
            classified(other)[1] != category,
            abs(other.length - asset.length) + abs(other.width - asset.width),
            other.id,
        ),
    )
    return nearest.id


def _write_actor(
    act: Element, actor: Actor, scene: Scene, run: Reactions, corridor: Corridor
) -> None:
    """Append the group of one actor: its action at its trigger, and a stop after the distance that it walks."""
    behaviour = run.behaviours[actor.id]
    action_name = _ACTIONS[behaviour.name]
    maneuver = child(maneuver_group(act, actor.id), "Maneuver", name=f"maneuver_{actor.id}")
    reaction, action = _event(maneuver, f"react_{actor.id}_0")
    if action_name == "lane_change":
        lane = neighbour_strip(corridor, ego_strip(corridor, scene.ego.lane), actor.placement.lane)
        direction = corridor.strips[lane].direction
        _write_lane_change(action, actor, run, direction)
    else:
        target = 0.0 if action_name == "stop" else behaviour.parameters.get("speed", 0.0)
        write_speed(child(action, "PrivateAction"), target)
    _write_trigger(reaction, actor, run, corridor)
    if action_name == "walk" and "distance" in behaviour.parameters:
        rest, action = _event(maneuver, f"rest_{actor.id}_0")
        write_speed(child(action, "PrivateAction"), 0.0)
        condition = of_entity(rest, f"there_{actor.id}", actor.id)
        child(condition, "TraveledDistanceCondition", value=behaviour.parameters["distance"])


def _event(maneuver: Element, name: str) -> tuple[Element, Element]:
    """Append an event that ends its actor's others, in the word of version 1.0; return it and its action."""
    new, action = event(maneuver, name)
    new.set("priority", "overwrite")
    return new, action


def _initial_speed(run: Reactions, name: str) -> float:
    return float(run.nominal.speeds[0, run.nominal.ids.index(name)])


def _write_lane_change(action: Element, actor: Actor, run: Reactions, direction: int) -> None:
    """Append a change of lanes over the distance that the actor drives at its speed in that time.

    A scene counts lanes to the left of the ego, a file to the left in the direction of the actor's lane: +1 if that is
    the ego's, -1 if it is oncoming.
    """
    parameters, speed = run.behaviours[actor.id].parameters, _initial_speed(run, actor.id)
    distance_m = max(_SHORTEST_CHANGE_M, speed * parameters.get("duration", 0.0))
    change = within(action, "PrivateAction", "LateralAction", "LaneChangeAction")
    child(
        change,
        "LaneChangeActionDynamics",
        dynamicsShape="linear",
        dynamicsDimension="distance",
        value=distance_m,
    )
    target = child(change, "LaneChangeTarget")
    lanes = direction * round(parameters.get("lanes", 0.0))
    child(target, "RelativeTargetLane", entityRef=actor.id, value=lanes)


def _write_trigger(parent: Element, actor: Actor, run: Reactions, corridor: Corridor) -> None:
    """Append the start trigger of an actor: a time, or a distance or time to collision of the ego."""
    trigger, name = actor.behaviour.trigger, f"trigger_{actor.id}"
    if trigger.kind == "time":
        at_time(parent, "StartTrigger", name, trigger.value, "greaterThan")
        return
    measured = trigger.actor or actor.id
    condition = of_entity(parent, name, "ego")
    if trigger.kind == "distance":
        child(
            condition,
            "RelativeDistanceCondition",
            entityRef=measured,
            relativeDistanceType="longitudinal",
            value=trigger.value,
            freespace=False,
            rule="lessThan",
        )
        return
    ttc = child(
        condition,
        "TimeToCollisionCondition",
        value=trigger.value,
        freespace=False,
        alongRoute=False,
        rule="lessThan",
    )
    target = child(ttc, "TimeToCollisionConditionTarget")
    if _initial_speed(run, measured) > 0.0:
        child(target, "EntityRef", entityRef=measured)
    else:
        s, t = map(float, run.nominal.places[0, run.nominal.ids.index(measured)])
        _write_position(target, corridor.point(s, t))


def _write_position(parent: Element, pose: Iterable[float]) -> None:
    """Append a position in the world: x, y, z, m, and the heading, rad."""
    x, y, z, heading = map(float, pose)
    child(child(parent, "Position"), "WorldPosition", x=x, y=y, z=z, h=heading)
