"""Scenes from OpenSCENARIO XML files: our own exactly, those of others as far as the vocabulary goes."""

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from oodscen._arguments import checked
from oodscen._display import Brief
from oodscen._files import file_sha256
from oodscen._wording import is_left_out
from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import MAX_TRIGGER, Actor, Hazard, Placement, Scene, Trigger
from oodscen.driving._motion.behaviours import USUAL
from oodscen.driving._roads.building import find_map, load_corridor, read_map
from oodscen.driving._roads.opendrive import read_network
from oodscen.driving._sight.placement import staging_issues
from oodscen.errors import DataError, Issue, OodscenError, UsageError
from oodscen.interchange._reading.actions import ActionReader, behaviour
from oodscen.interchange._reading.assets import nearest_asset, weather
from oodscen.interchange._reading.ego import (
    corridor_from,
    ego_of,
    keeps_left,
    likely_ego,
    no_entity,
    note_start,
    strip_of,
)
from oodscen.interchange._reading.leftovers import leftovers
from oodscen.interchange._reading.positions import (
    LANE_M,
    EntityPlace,
    MappedRoads,
    Positions,
    Roads,
    StraightRoad,
)
from oodscen.interchange._reading.tree import NOUN, Element, OpenScenarioFile
from oodscen.interchange._reading.triggers import AT_ONCE, TriggerReader
from oodscen.interchange._writing.properties import DIGEST, SCENE, content_digest
from oodscen.interchange._writing.roads import ROAD_DIGEST, road_file

if TYPE_CHECKING:
    from oodscen.protocols import LLM

_MAJOR, _MINORS = "1", ("0", "1", "2", "3")
"""Versions of OpenSCENARIO XML that are read."""
_MIRRORED = "CARLA:"
"""Beginning of the description of files with CARLA's left-handed axes."""
_DECISION_TTC_S = 3.0
_LONGEST_TITLE = 500
_NEAR_M, _FAR_M = -150.0, 300.0
"""Limits of an actor's place ahead of the ego, m."""
_LANES = 6
"""Limit of the lanes between the ego and an actor."""


@dataclass(frozen=True, repr=False)
class ImportedScene(Brief):
    """A scene that was read from a file of another tool, with what it lacks."""

    scene: Scene
    omissions: tuple[Issue, ...] = ()
    """The parts of the file that are not in the scene, with line and element, and the faults of the scene."""


@checked
def read_openscenario(
    path: str | Path,
    catalogue: Catalogue,
    *,
    road: str | None = None,
    hazards: Sequence[str] = (),
    ego: str | None = None,
    llm: "LLM | None" = None,
) -> ImportedScene:
    """Read an OpenSCENARIO XML 1.x file.

    An unchanged file of `Scene.to_openscenario` gives back its scene, unless the road file beside it was changed. Of other
    files come the road, the
    entities, where and how fast they start, the weather, and one behaviour for each entity; what is left out is
    listed.

    Args:
        path: The file.
        catalogue: The catalogue whose assets and behaviours the scene uses.
        road: A map of the catalogue or an `.xodr` file, in place of the file's own; not for an unchanged export.
        hazards: Names of the entities that are unusual; without them, `llm` is asked. Not for an unchanged export.
        ego: Name of the entity that is the ego; without it, its name tells. Not for an unchanged export.
        llm: The model that names the unusual entities; without one, the first that acts is taken.

    Raises:
        DataError: If the file is malformed or not version 1.x, with the line and the element, or has no such entity.
        UsageError: If a map, hazards or an ego are named for an unchanged export.
        UnknownComponent: If there is no such map.
        LLMError: If the model cannot be reached, or its answer cannot be used.
    """
    tree = OpenScenarioFile(path)
    is_known = _check_version(tree)
    if is_known and (own := _own_scene(tree, catalogue)) is not None:
        if road is not None or hazards or ego is not None:
            raise UsageError(
                f"{path} is an unchanged export, which gives back its scene with its own map, hazard and ego: name "
                "none of them, or change them in the scene"
            )
        return ImportedScene(own)
    scene = _Assembly(tree, catalogue, road, hazards, ego, llm).scene()
    issues = [*tree.omissions, *leftovers(tree), *staging_issues(scene, catalogue)]
    return ImportedScene(scene, tuple(issues))


def foresee(path: str | Path, catalogue: Catalogue) -> tuple[str, bool]:
    """Return the id of the scene that a file gives, and whether the file is an unchanged export.

    Raises:
        DataError: If the file is malformed or not version 1.x.
    """
    tree = OpenScenarioFile(path)
    own = _own_scene(tree, catalogue) if _check_version(tree) else None
    return _identifier(tree.path.stem) if own is None else own.id, own is not None


def _header(tree: OpenScenarioFile) -> Element:
    header = tree.root.first("FileHeader")
    if header is None:
        raise tree.root.fault("has no FileHeader")
    return header


def _check_version(tree: OpenScenarioFile) -> bool:
    """Refuse another major version, note an unknown minor one, and return whether it is known.

    Raises:
        DataError: If the file is not OpenSCENARIO XML 1.x.
    """
    header = _header(tree)
    major, minor = (header.get(name).strip() for name in ("revMajor", "revMinor"))
    if major != _MAJOR:
        raise header.fault(f"version {major[:20]!r} is not read; 1.0 to 1.3 are", "revMajor")
    if minor not in _MINORS:
        header.note(f"version 1.{minor[:20]} is unknown and read as 1.3")
    return minor in _MINORS


def _own_scene(tree: OpenScenarioFile, catalogue: Catalogue) -> Scene | None:
    """Return the scene that a file says it is, unless the file or the road file beside it was changed."""
    header = _header(tree)
    said = {
        element.element.get("name"): element.element.get("value", "")
        for element in header.all("Properties", "Property")
    }
    if SCENE not in said:
        return None
    if said.get(DIGEST) != content_digest(tree.root.element, said[SCENE]):
        header.note("the file was changed after its export and is read by its elements")
        return None
    scene = Scene.parse(said[SCENE], source=str(tree.path))
    road = tree.root.first("RoadNetwork", "LogicFile")
    if road is None or _is_own_road(tree.path.parent / road.get("filepath"), scene, catalogue):
        return scene
    road.note("the road file was changed after the export, and the file is read by its elements")
    return None


def _is_own_road(path: Path, scene: Scene, catalogue: Catalogue) -> bool:
    """Return whether a road file is missing, or is the one that an export of the scene writes."""
    if not path.is_file():
        return True
    try:
        return read_map(str(path)) == road_file(scene, catalogue).content
    except (
        OodscenError
    ):  # The map is not on this machine; names of users' roads hold their digests.
        digest = file_sha256(path).hex()[:ROAD_DIGEST]
        return not scene.map.endswith(".xodr") or path.stem.endswith(f"-{digest}")


class _Assembly:
    """Puts a scene together from a file of others."""

    def __init__(
        self,
        tree: OpenScenarioFile,
        catalogue: Catalogue,
        road: str | None,
        hazards: Sequence[str],
        ego: str | None,
        llm: "LLM | None",
    ) -> None:
        self.llm = llm
        self.tree = tree
        self.root = tree.root
        self.catalogue = catalogue
        self.hazards = hazards
        self.entities: dict[str, Element] = {}
        for element in self.root.all("Entities", "ScenarioObject"):
            if element.get("name") in self.entities:
                raise element.fault(f"the name {element.get('name')!r} occurs more than once")
            self.entities[element.get("name")] = element
        if ego is not None and ego not in self.entities:
            raise self._refused(no_entity(ego, self.entities))
        self.ego = likely_ego(self.root, self.entities) if ego is None else ego
        self.ids = _identifiers(name for name in self.entities if name != self.ego)
        self.map = road or self._own_map()
        is_mapped = road is None
        is_left_hand = not is_mapped and keeps_left(self.map, catalogue)
        roads: Roads = StraightRoad(is_left_hand=is_left_hand)
        if is_mapped:
            roads = MappedRoads(read_network(read_map(self.map), source=self.map))
        is_mirrored = _header(tree).get("description").startswith(_MIRRORED)
        self.positions = Positions(roads, is_mirrored=is_mirrored)
        self._place_entities()
        start = self._centre(self.ego)
        if start is None:
            raise self._no_start()
        self.triggers = TriggerReader(
            self.root, self.positions, self.entities, self.ego, self.ids.__getitem__
        )
        self.actions = ActionReader(self.root, self.positions, self.triggers, self.ego)
        self.actions.read()
        self.start = start
        self.is_mapped = is_mapped
        body = self.entities[self.ego]
        if isinstance(roads, MappedRoads):
            self.corridor = corridor_from(body, start, roads, find_map(self.map, catalogue))
        else:
            self.corridor = load_corridor(self.map, catalogue)
        if not self.corridor.ego_lanes:
            raise body.fault("the ego does not start beside a driving lane")
        if is_mapped:
            self.strip = strip_of(start, self.corridor)
            note_start(body, start, self.corridor, self.strip)
        else:
            self.strip = self.corridor.ego_lanes[-1 if is_left_hand else 0]

    def scene(self) -> Scene:
        """Return the scene.

        Raises:
            DataError: If no actor is left to be the hazard.
        """
        actors = [
            actor
            for name, entity in self.entities.items()
            if name != self.ego and (actor := self._actor(name, entity)) is not None
        ]
        actors = self._with_known_triggers(actors)
        unusual = self._unusual(actors)
        name = _identifier(self.tree.path.stem)
        speed = self.actions.speeds.get(self.ego, 0.0)
        ego = ego_of(self.entities[self.ego], speed, self.corridor, self.strip)
        decision = self._decision(next(one for one in actors if one.id == unusual[0]))
        return Scene.parse(
            {
                "id": name,
                "scenario_id": name,
                "map": self.map,
                "ego": ego.model_dump(),
                "weather": weather(self.root).model_dump(),
                "actors": [one.model_dump() for one in actors],
                "hazard": Hazard(actors=dict.fromkeys(unusual)).model_dump(),
                "decision": decision.model_dump(),
            },
            source=str(self.tree.path),
        )

    def _with_known_triggers(self, actors: list[Actor]) -> list[Actor]:
        """Return the actors, without triggers by those that are not in the scene."""
        names = {None, *(one.id for one in actors)}
        kept = []
        for actor in actors:
            does = actor.behaviour
            if does.trigger.actor not in names:
                self.root.note(f"{actor.id} acts at once: {does.trigger.actor} is not in the scene")
                does = does.model_copy(update={"trigger": AT_ONCE})
            kept.append(actor.model_copy(update={"behaviour": does}))
        return kept

    def _unusual(self, actors: Sequence[Actor]) -> list[str]:
        """Return the actors that are the hazard: the given ones, those that a model names, or the first that acts."""
        unusual = [self.ids.get(name) or _identifier(name) for name in self.hazards]
        if unknown := set(unusual).difference(actor.id for actor in actors):
            first = next(name for name in unusual if name in unknown)
            raise self._no_hazard(f"there is no entity {first!r} in the scene")
        if not actors:
            raise self._no_hazard("the file has no entity that can be the hazard")
        if unusual:
            return unusual
        if self.llm is not None and len(actors) > 1:
            return self._asked(self.llm, actors)
        acting = [actor for actor in actors if actor.behaviour.name not in USUAL]
        first = (acting or actors)[0].id
        self.root.note(f"no hazard was named; {first} is taken to be it")
        return [first]

    def _no_hazard(self, message: str) -> DataError:
        return self._refused(Issue("hazard", message))

    def _no_start(self) -> DataError:
        where = self.entities[self.ego].where
        return self._refused(Issue(where, "the ego has no start that can be read"))

    def _refused(self, issue: Issue) -> DataError:
        """Return the error for what a scene must have, with all that was left out and may be its cause."""
        return DataError(NOUN, [issue, *self.tree.omissions], source=str(self.tree.path))

    def _asked(self, llm: "LLM", actors: Sequence[Actor]) -> list[str]:
        """Return the unusual actors as a model names them."""
        from oodscen.llm._ask import ask
        from oodscen.prompts._scenario.mark_hazard import ActorLine, MarkHazard

        title = f"{self.tree.path.stem}. {_header(self.tree).get('description')}"
        lines = tuple(
            ActorLine(
                id=actor.id,
                what=self.catalogue.asset(actor.asset).description,
                does=f"{actor.behaviour.name}: {self.catalogue.behaviour(actor.behaviour.name).description}",
                ahead_m=actor.placement.ahead_m,
                left_m=actor.placement.offset_m + LANE_M * actor.placement.lane,
            )
            for actor in actors
        )
        answer = ask(llm, MarkHazard(title=title[:_LONGEST_TITLE], actors=lines))
        self.root.note(
            f"no hazard was named; {llm.name} takes {', '.join(answer.actors)} to be it: {answer.reasoning[:200]}"
        )
        return answer.actors

    # ------------------------------------------------------------------ the road and the starts

    def _own_map(self) -> str:
        node = self.root.first("RoadNetwork", "LogicFile")
        if node is None:
            raise self.root.fault("names no OpenDRIVE file; give a map instead")
        path = self.tree.path.parent / node.get("filepath")
        if path.suffix != ".xodr" or not path.is_file():
            raise node.fault(
                f"there is no OpenDRIVE file {node.get('filepath')!r}; give a map instead"
            )
        return str(path.resolve())

    def _place_entities(self) -> None:
        """Read the starts, each after that of the entity to which it is relative."""
        waiting: dict[str, list[tuple[str, list[Element]]]] = {}
        for name, places in self._starts().items():
            reference = self.positions.reference(places[0])
            waiting.setdefault(reference, []).append((name, places))
        ready = waiting.pop("", [])
        for name, places in ready:  # It grows by those that wait for an entity.
            for holder in places:
                if (pose := self.positions.read(holder)) is not None:
                    self.positions.known[name] = pose
            if name in self.positions.known:
                ready.extend(waiting.pop(name, []))
        for held in waiting.values():
            for _, places in held:
                self.positions.read(places[0])  # Records why it cannot be read.

    def _starts(self) -> dict[str, list[Element]]:
        """Return for each entity the `Position` at which it starts, and later ones that are relative to itself.

        The last place counts, as the actions are taken in order.
        """
        found: dict[str, list[Element]] = {}
        for private in self.root.all("Storyboard", "Init", "Actions", "Private"):
            name = private.get("entityRef")
            for holder in private.all("PrivateAction", "TeleportAction", "Position"):
                places = found.setdefault(name, [])
                if self.positions.reference(holder) != name:
                    for place in places:
                        place.leave_out(f"{name[:40]!r} is placed again later, which counts")
                    places.clear()
                places.append(holder)
        return found

    def _centre(self, name: str) -> EntityPlace | None:
        """Return the pose of an entity's centre, which is ahead of a vehicle's reference point."""
        pose = self.positions.known.get(name)
        middle = next(self.entities[name].within("Center"), None)
        if pose is None or middle is None:
            return pose
        ahead, left = middle.number("x", 0.0), middle.number("y", 0.0)
        centre = pose.moved(ahead, left)
        return centre._replace(road=pose.road, direction=pose.direction)

    # ------------------------------------------------------------------ actors

    def _actor(self, name: str, entity: Element) -> Actor | None:
        asset = nearest_asset(entity, self.catalogue)
        pose = self._centre(name)
        if asset is None:
            return None
        if pose is None:
            entity.leave_out("has no start that can be read")
            return None
        placed = self._placement(pose)
        if not _NEAR_M <= placed.ahead_m <= _FAR_M or abs(placed.offset_m) > 150.0:
            entity.leave_out(f"starts {placed.ahead_m:g} m ahead, too far for a scene")
            return None
        is_against = abs(placed.heading_deg) > 135.0
        speed = self.actions.speeds.get(name, 0.0)
        actions = self.actions.actions.get(name, [])
        does, heading = behaviour(entity, asset, actions, speed, is_against, self.catalogue)
        if heading is not None:
            placed = self._placement(pose._replace(heading=heading))
        if does.name == "wrong_way":
            placed = placed.model_copy(update={"heading_deg": 0.0})
        return Actor(id=self.ids[name], asset=asset.id, placement=placed, behaviour=does)

    def _placement(self, pose: EntityPlace) -> Placement:
        """Return a pose relative to the ego along the road."""
        road, own = self.corridor, self.strip
        if self.is_mapped:
            s, t = road.locate(pose.x, pose.y)
            turn = pose.heading - road.heading(s)
        else:
            ahead, left = pose.offset_from(self.start)
            s = road.start + ahead
            t, turn = road.centre(own, s) + left, pose.heading - self.start.heading
        strip = road.strip_at(s, t)
        if strip is None or strip not in road.driving:
            strip = own
        if road.strips[strip].direction < 0:
            turn += math.pi
        here = road.driving.index(own)
        lanes = min(max(road.driving.index(strip) - here, -_LANES), _LANES)
        strip = road.driving[here + lanes]
        # Its distances are checked later.
        return Placement.model_construct(
            ahead_m=round(s - road.start, 3),
            lane=lanes,
            offset_m=round(t - road.centre(strip, s), 3),
            heading_deg=round(math.degrees(math.remainder(turn, math.tau)), 3),
        )

    def _decision(self, hazard: Actor) -> Trigger:
        """Return the moment of choice: soon after the hazard acts, or when it is near."""
        trigger = hazard.behaviour.trigger
        if trigger.kind == "time" and trigger.value > 0.0:
            return Trigger(kind="time", value=min(trigger.value + 0.5, MAX_TRIGGER))
        if trigger.kind == "time":
            return Trigger(kind="ttc", value=_DECISION_TTC_S, actor=hazard.id)
        value = round(0.9 * trigger.value, 3)
        return Trigger(kind=trigger.kind, value=value, actor=trigger.actor or hazard.id)


def _identifiers(names: Iterable[str]) -> dict[str, str]:
    """Return an id for every entity; none is the ego's, and no two are the same."""
    found: dict[str, str] = {}
    taken = {"ego"}
    for name in names:
        plain = one = _identifier(name)
        number = 2
        while one in taken or is_left_out(one):
            one = f"{plain[:34]}-{number}"
            number += 1
        found[name] = one
        taken.add(one)
    return found


def _identifier(name: str) -> str:
    """Return an id that a scene accepts."""
    plain = re.sub(r"[^a-z0-9_-]+", "-", name.lower()).strip("-_")[:40]
    return plain or "entity"
