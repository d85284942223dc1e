"""Scenes from the elements of OpenSCENARIO files of other tools, as far as the vocabulary goes."""

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import Actor, Hazard, Scene
from oodscen.driving._roads.building import load_corridor, read_map
from oodscen.driving._roads.opendrive import read_network
from oodscen.errors import Issue
from oodscen.interchange._reading.actions import ActionReader
from oodscen.interchange._reading.assets import nearest_asset, state_of
from oodscen.interchange._reading.behaviours import behaviour
from oodscen.interchange._reading.ego import ego_of, likely_ego, no_entity
from oodscen.interchange._reading.ego_road import (
    EgoRoad,
    ego_road_on_map,
    ego_road_on_own,
)
from oodscen.interchange._reading.hazards import decision_for, hazard_actors
from oodscen.interchange._reading.identifiers import identifiers, scene_identifier
from oodscen.interchange._reading.positions import MappedRoads, Positions, StraightRoad
from oodscen.interchange._reading.starts import centre_of, read_starts
from oodscen.interchange._reading.tree import Element, OpenScenarioFile
from oodscen.interchange._reading.triggers import AT_ONCE, TriggerReader
from oodscen.interchange._reading.weather import weather_of

if TYPE_CHECKING:
    from oodscen.protocols import LLM

_MIRRORED = "CARLA:"
"""Beginning of the description of files with CARLA's left-handed axes."""
_NEAREST_M, _FARTHEST_M = -150.0, 300.0
"""Limits of an actor's place ahead of the ego, m."""
_FARTHEST_ASIDE_M = 150.0
_AGAINST_DEG = 135.0
"""Angle to its lane's direction from which an actor drives against it, degrees."""


class _Entities(NamedTuple):
    """The scenario objects of a file."""

    elements: dict[str, Element]
    """All of them by name."""
    ego: str
    ids: dict[str, str]
    """Ids of the others in the scene, by name."""


def assembled_scene(
    tree: OpenScenarioFile,
    catalogue: Catalogue,
    road: str | None,
    hazards: Sequence[str],
    ego: str | None,
    llm: "LLM | None",
) -> Scene:
    """Return the scene that a file describes; `read_openscenario` tells arguments and errors."""
    entities = _read_entities(tree, ego)
    roads: MappedRoads | StraightRoad
    if road is None:
        map_name = _own_map(tree)
        roads = MappedRoads(read_network(read_map(map_name), source=map_name))
    else:
        map_name = road
        roads = StraightRoad(is_left_hand=load_corridor(road, catalogue).keeps_left)
    is_mirrored = tree.header().get("description").startswith(_MIRRORED)
    positions = Positions(roads, is_mirrored=is_mirrored)
    read_starts(tree.root, positions)
    ego_element = entities.elements[entities.ego]
    start = centre_of(entities.ego, ego_element, positions)
    if start is None:
        raise tree.missing(Issue(ego_element.where, "the ego has no start that can be read"))
    triggers = TriggerReader(
        tree.root, positions, entities.elements, entities.ego, entities.ids.__getitem__
    )
    actions = ActionReader(tree.root, positions, triggers, entities.ego)
    actions.read()
    if isinstance(roads, MappedRoads):
        ego_road = ego_road_on_own(ego_element, start, roads, map_name, catalogue)
    else:
        ego_road = ego_road_on_map(ego_element, start, map_name, catalogue)
    actors = _read_actors(entities, positions, actions, ego_road, catalogue)
    actors = _with_present_triggers(tree, actors)
    hazard_ids = hazard_actors(tree, actors, hazards, entities.ids, catalogue, llm)
    ego_speed = actions.speeds.get(entities.ego, 0.0)
    ego_of_scene = ego_of(ego_element, ego_speed, ego_road.corridor, ego_road.strip)
    decision = decision_for(next(actor for actor in actors if actor.id == hazard_ids[0]))
    scene_id = scene_identifier(tree.path.stem)
    return Scene.parse(
        {
            "id": scene_id,
            "scenario_id": scene_id,
            "map": map_name,
            "ego": ego_of_scene.model_dump(),
            "weather": weather_of(tree.root).model_dump(),
            "actors": [actor.model_dump() for actor in actors],
            "hazard": Hazard(actors=dict.fromkeys(hazard_ids)).model_dump(),
            "decision": decision.model_dump(),
        },
        source=str(tree.path),
    )


def _read_entities(tree: OpenScenarioFile, ego: str | None) -> _Entities:
    elements: dict[str, Element] = {}
    for element in tree.root.all("Entities", "ScenarioObject"):
        name = element.get("name")
        if name in elements:
            raise element.fault(f"the name {name!r} occurs more than once")
        elements[name] = element
    if ego is None:
        ego = likely_ego(tree.root, elements)
    elif ego not in elements:
        raise tree.missing(no_entity(ego, elements))
    return _Entities(elements, ego, identifiers(name for name in elements if name != ego))


def _own_map(tree: OpenScenarioFile) -> str:
    """Return the path of the OpenDRIVE file that a file names."""
    node = tree.root.first("RoadNetwork", "LogicFile")
    if node is None:
        raise tree.root.fault("names no OpenDRIVE file; give a map instead")
    path = tree.path.parent / node.get("filepath")
    # Unlike `Path.is_file`, this is false for a name that is too long.
    if path.suffix != ".xodr" or not os.path.isfile(path):
        raise node.fault(f"there is no OpenDRIVE file {node.get('filepath')!r}; give a map instead")
    return str(path.resolve())


def _read_actors(
    entities: _Entities,
    positions: Positions,
    actions: ActionReader,
    ego_road: EgoRoad,
    catalogue: Catalogue,
) -> list[Actor]:
    """Return the actors for all entities that a scene can hold."""
    actors = [
        _read_actor(name, entities, positions, actions, ego_road, catalogue)
        for name in entities.ids
    ]
    return [actor for actor in actors if actor is not None]


def _read_actor(
    name: str,
    entities: _Entities,
    positions: Positions,
    actions: ActionReader,
    ego_road: EgoRoad,
    catalogue: Catalogue,
) -> Actor | None:
    """Return the actor for an entity, or `None` after recording why a scene cannot hold it."""
    entity = entities.elements[name]
    asset = nearest_asset(entity, catalogue)
    place = centre_of(name, entity, positions)
    if asset is None:
        return None
    if place is None:
        entity.leave_out("has no start that can be read")
        return None
    placement = ego_road.placement(place)
    is_near = _NEAREST_M <= placement.ahead_m <= _FARTHEST_M
    if not is_near or abs(placement.offset_m) > _FARTHEST_ASIDE_M:
        entity.leave_out(f"starts {placement.ahead_m:g} m ahead, too far for a scene")
        return None
    is_against = abs(placement.heading_deg) > _AGAINST_DEG
    speed = actions.speeds.get(name, 0.0)
    own_actions = actions.actions.get(name, [])
    does, heading = behaviour(entity, asset, own_actions, speed, is_against, catalogue)
    if heading is not None:
        placement = ego_road.placement(place._replace(heading=heading))
    if does.name == "wrong_way":
        placement = placement.model_copy(update={"heading_deg": 0.0})
    return Actor(
        id=entities.ids[name],
        asset=asset.id,
        placement=placement,
        behaviour=does,
        state=state_of(entity, asset),
    )


def _with_present_triggers(tree: OpenScenarioFile, actors: Sequence[Actor]) -> list[Actor]:
    """Return the actors, without triggers by those that are not in the scene."""
    present = {None, *(actor.id for actor in actors)}
    triggered = []
    for actor in actors:
        does = actor.behaviour
        if does.trigger.actor not in present:
            tree.root.note(f"{actor.id} acts at once: {does.trigger.actor} is not in the scene")
            does = does.model_copy(update={"trigger": AT_ONCE})
        triggered.append(actor.model_copy(update={"behaviour": does}))
    return triggered
