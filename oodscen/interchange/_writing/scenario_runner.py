"""Scenes as OpenSCENARIO XML 1.0 for CARLA's ScenarioRunner, with the named actions that it plays.

ScenarioRunner follows no trajectory in time. A scene can be expressed only if each of its actors stands, drives in its
lane, brakes, changes lanes, or walks straight on. Speed changes take effect instantly.
"""

import math

from oodscen._registry import make_catalogue
from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._scene import Actor, Scene, Weather
from oodscen.driving._motion.behaviours import BUILT_IN
from oodscen.driving._roads.corridor import Corridor
from oodscen.errors import Issue, SceneError
from oodscen.interchange._recording import Reactions
from oodscen.interchange._writing.elements import Element, Value, child, within
from oodscen.interchange._writing.entities import MASS_KG, Entity, Kind, classified
from oodscen.interchange._writing.storyboard import event, followers, write_speed

BLUEPRINTS = "carla-0.9.16"
"""The catalogue whose ids are CARLA's blueprints."""
_ACTIONS = {name: row.plain_action for name, row in BUILT_IN.items() if row.plain_action}
"""Behaviours for which ScenarioRunner has actions."""
_EGO_BLUEPRINT = "vehicle.lincoln.mkz_2017"
_CLOUDS = ((0.25, "free"), (0.75, "cloudy"), (1.01, "overcast"))
"""Cloud states by the cloud cover below which they hold."""
_HEAVIEST_MM_H = 50.0
"""Precipitation that version 1.0 calls an intensity of 1, mm/h."""
_END_S = 60.0
"""Time at which the storyboard ends, s."""
_WALK_M_S = 1.4
"""Speed of an actor whose behaviour gives none, m/s."""


def unplayable(scene: Scene, run: Reactions) -> list[Issue]:
    """Return why ScenarioRunner cannot play a scene, by actor; empty if it can."""
    issues = []
    behind = followers(scene, run)
    for index, actor in enumerate(scene.actors):
        name, where = actor.behaviour.name, f"actors[{index}].behaviour"
        if name not in _ACTIONS:
            issues.append(Issue(where, f"ScenarioRunner has no action for {name!r}"))
        elif actor.id in behind:
            issues.append(Issue(where, f"ScenarioRunner cannot make {actor.id!r} follow the ego"))
        elif _ACTIONS[name] == "walk" and actor.behaviour.other is not None:
            message = f"{actor.id!r} is attached to another actor, which ScenarioRunner cannot play"
            issues.append(Issue(where, message))
    return issues


def write_for_scenario_runner(
    root: Element,
    scene: Scene,
    entities: list[Entity],
    run: Reactions,
    corridor: Corridor,
) -> None:
    """Complete a document with entities and storyboard.

    Raises:
        SceneError: If the scene cannot be expressed.
    """
    if issues := unplayable(scene, run):
        raise SceneError(scene.id, issues)
    holder = child(root, "Entities")
    known = make_catalogue(BLUEPRINTS)
    for entity in entities:
        _write_entity(holder, entity, known)
    board = child(root, "Storyboard")
    actions = within(board, "Init", "Actions")
    _write_environment(actions, scene.weather)
    act = child(child(board, "Story", name="scene"), "Act", name="act")
    walkers = {actor.id for actor in scene.actors if _ACTIONS[actor.behaviour.name] == "walk"}
    starts = zip(entities, run.nominal.poses[0], run.nominal.speeds[0], strict=True)
    for entity, pose, speed in starts:
        x, y, z, heading = map(float, pose)
        private = child(actions, "Private", entityRef=entity.name)
        place = within(private, "PrivateAction", "TeleportAction", "Position")
        child(place, "WorldPosition", x=x, y=y, z=z, h=heading)
        if entity.name not in walkers and speed > 0.0:
            write_speed(child(private, "PrivateAction"), float(speed))
    for actor in scene.actors:
        if _ACTIONS[actor.behaviour.name] != "none":
            _write_actor(act, actor, run, corridor)
    if not len(act):
        # An Act must have a group.
        _maneuver_group(act, "ego")
    _at_time(act, "StartTrigger", "act_start", 0.0)
    _at_time(board, "StopTrigger", "end", _END_S)


# ------------------------------------------------------------------ entities and environment


def _write_entity(parent: Element, entity: Entity, known: Catalogue) -> None:
    category = f"{entity.kind[0].lower()}{entity.kind[1:]}Category"
    blueprint = _EGO_BLUEPRINT if entity.name == "ego" else _blueprint(entity.asset, known)
    further: dict[Kind, dict[str, Value]] = {
        "Vehicle": {},
        "Pedestrian": {"model": blueprint, "mass": MASS_KG["Pedestrian"]},
        "MiscObject": {"mass": MASS_KG["MiscObject"]},
    }
    attributes = {category: entity.category, **further[entity.kind]}
    holder = child(parent, "ScenarioObject", name=entity.name)
    body = child(holder, entity.kind, name=blueprint, **attributes)
    size = entity.asset
    box = child(body, "BoundingBox")
    child(box, "Center", x=0.0, y=0.0, z=0.5 * size.height)
    child(box, "Dimensions", width=size.width, length=size.length, height=size.height)
    if entity.kind == "Vehicle":
        child(body, "Performance", maxSpeed=70.0, maxAcceleration=12.0, maxDeceleration=12.0)
        axles, half = child(body, "Axles"), 0.3 * size.length
        for tag, steering, x in (("FrontAxle", 0.6, half), ("RearAxle", 0.0, -half)):
            child(
                axles,
                tag,
                maxSteering=steering,
                wheelDiameter=0.6,
                trackWidth=max(0.3, size.width - 0.2),
                positionX=x,
                positionZ=0.3,
            )
    properties = child(body, "Properties")
    role = "ego_vehicle" if entity.name == "ego" else "simulation"
    child(properties, "Property", name="type", value=role)


def _blueprint(asset: Asset, known: Catalogue) -> str:
    """Return the blueprint that is an asset, or is nearest to it in kind and size."""
    ids = {candidate.id for candidate in known.assets}
    for name in (asset.id, *asset.names):
        if name in ids:
            return name
    kind, category = classified(asset)
    candidates = [other for other in known.assets if classified(other)[0] == kind]
    nearest = min(
        candidates,
        key=lambda other: (
            classified(other)[1] != category,
            abs(other.length - asset.length) + abs(other.width - asset.width),
            other.id,
        ),
    )
    return nearest.id


def _write_environment(actions: Element, weather: Weather) -> None:
    """Append the environment in the terms of version 1.0."""
    action = within(actions, "GlobalAction", "EnvironmentAction")
    environment = child(action, "Environment", name="environment")
    elevation = math.radians(weather.sun_elevation_deg)
    hour = 12 if weather.sun_elevation_deg > 0.0 else 0
    child(environment, "TimeOfDay", animation=False, dateTime=f"2026-06-21T{hour:02d}:00:00")
    clouds = next(name for below, name in _CLOUDS if weather.cloud_cover < below)
    sky = child(environment, "Weather", cloudState=clouds)
    child(sky, "Sun", azimuth=0.0, elevation=elevation, intensity=max(0.0, math.sin(elevation)))
    child(sky, "Fog", visualRange=weather.fog_visual_range_m)
    kind = "dry" if weather.precipitation == "none" else weather.precipitation
    amount = min(1.0, weather.precipitation_mm_h / _HEAVIEST_MM_H)
    child(sky, "Precipitation", precipitationType=kind, intensity=amount)
    child(environment, "RoadCondition", frictionScaleFactor=weather.friction)


# ------------------------------------------------------------------ what actors do


def _maneuver_group(act: Element, name: str) -> Element:
    group = child(act, "ManeuverGroup", name=f"group_{name}", maximumExecutionCount=1)
    actors = child(group, "Actors", selectTriggeringEntities=False)
    child(actors, "EntityRef", entityRef=name)
    return group


def _write_actor(act: Element, actor: Actor, run: Reactions, corridor: Corridor) -> None:
    """Append the group of one actor: its action at its trigger, and its rest where it has one."""
    behaviour, action_name = actor.behaviour, _ACTIONS[actor.behaviour.name]
    maneuver = child(_maneuver_group(act, actor.id), "Maneuver", name=f"maneuver_{actor.id}")
    starting, action = event(maneuver, f"react_{actor.id}_0")
    starting.set("priority", "overwrite")
    if action_name == "lane_change":
        speed = float(run.nominal.speeds[0, run.nominal.ids.index(actor.id)])
        _write_lane_change(action, actor, speed)
    else:
        target = 0.0 if action_name == "stop" else behaviour.parameters.get("speed", _WALK_M_S)
        write_speed(child(action, "PrivateAction"), target)
    _write_trigger(starting, actor, run, corridor)
    if action_name == "walk" and "distance" in behaviour.parameters:
        resting, action = event(maneuver, f"rest_{actor.id}_0")
        resting.set("priority", "overwrite")
        write_speed(child(action, "PrivateAction"), 0.0)
        condition = _entity_condition(resting, f"there_{actor.id}", actor.id)
        child(condition, "TraveledDistanceCondition", value=behaviour.parameters["distance"])


def _write_lane_change(action: Element, actor: Actor, speed: float) -> None:
    lanes = round(actor.behaviour.parameters.get("lanes", 1.0))
    distance_m = max(5.0, speed * actor.behaviour.parameters.get("duration", 2.0))
    change = within(action, "PrivateAction", "LateralAction", "LaneChangeAction")
    child(
        change,
        "LaneChangeActionDynamics",
        dynamicsShape="linear",
        dynamicsDimension="distance",
        value=distance_m,
    )
    target = child(change, "LaneChangeTarget")
    child(target, "RelativeTargetLane", entityRef=actor.id, value=lanes)


def _write_trigger(parent: Element, actor: Actor, run: Reactions, corridor: Corridor) -> None:
    trigger = actor.behaviour.trigger
    name = f"trigger_{actor.id}"
    if trigger.kind == "time":
        _at_time(parent, "StartTrigger", name, trigger.value)
        return
    measured = trigger.actor or actor.id
    condition = _entity_condition(parent, name, "ego")
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
    row = run.nominal.ids.index(measured)
    s, t = map(float, run.nominal.places[0, row])
    if run.nominal.speeds[0, row] > 0.0:
        child(target, "EntityRef", entityRef=measured)
        return
    x, y, z, heading = corridor.point(s, t)
    child(child(target, "Position"), "WorldPosition", x=x, y=y, z=z, h=heading)


def _entity_condition(parent: Element, name: str, entity: str) -> Element:
    holder = child(_condition(parent, "StartTrigger", name), "ByEntityCondition")
    triggering = child(holder, "TriggeringEntities", triggeringEntitiesRule="any")
    child(triggering, "EntityRef", entityRef=entity)
    return child(holder, "EntityCondition")


def _condition(parent: Element, tag: str, name: str) -> Element:
    group = within(parent, tag, "ConditionGroup")
    return child(group, "Condition", name=name, delay=0.0, conditionEdge="none")


def _at_time(parent: Element, tag: str, name: str, time_s: float) -> None:
    holder = child(_condition(parent, tag, name), "ByValueCondition")
    child(holder, "SimulationTimeCondition", value=time_s, rule="greaterThan")
