"""The scene: the machine-readable configuration of one scenario.

Positions are relative to the ego's start along its road: `ahead_m` forward, lanes and offsets to the
left, headings counter-clockwise (ISO 8855). Speeds are in m/s. Validation sorts mappings, as they are sorted in
JSON: nothing may depend on the order of keys.
"""

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, Literal, Self

from pydantic import Field, ValidationError, field_validator, model_validator

from oodscen._numbers import finite_number
from oodscen._words.wording import is_left_out
from oodscen.data._base import Data, LeanData
from oodscen.data._claim import Claim
from oodscen.data._designs.motion import Motion
from oodscen.data._designs.prop import Prop
from oodscen.data._details import Details
from oodscen.data._issues import IssuesError, issues_of
from oodscen.data._map_state import MapState
from oodscen.data._pairing import is_ordinary, is_twin, twin_id
from oodscen.data._scene_uses import SceneUses, fitting
from oodscen.data._weather import Weather
from oodscen.errors import Issue

Identifier = Field(pattern=r"^[a-z0-9][a-z0-9_-]{0,40}$")


_LONGEST_ID = 200
MAX_TRIGGER = 500
"""Largest value of a trigger, s or m."""
MAX_SPEED = 45
"""Highest speed of the ego, m/s."""
MAX_ACTORS = 400
"""Largest number of actors of a scene."""
SHORTEST_HORIZON_S, LONGEST_HORIZON_S = 0.1, 60.0
"""Least and greatest time for which an action is watched, s."""


class Trigger(Data):
    """When something starts."""

    kind: Literal["time", "distance", "ttc"] = "time"
    """`time` since the start, `distance` from the ego along the road, `ttc` time to collision."""
    value: float = Field(default=0.0, ge=0, le=MAX_TRIGGER)
    """Seconds for `time` and `ttc`, metres for `distance`: fires when at or below (time: at or after)."""
    actor: str | None = None
    """Measured to which actor; `None` is the actor that owns the trigger. A decision names it."""


class Placement(Data):
    """Where an actor starts, relative to the ego along the ego's road."""

    ahead_m: float = Field(ge=-150, le=300)
    """From the ego's centre to the actor's, along the road; negative is behind."""
    lane: int = Field(default=0, ge=-6, le=6)
    """Lanes to the left of the ego's lane (oncoming lanes count); negative is to the right."""
    offset_m: float = Field(default=0.0, ge=-150, le=150)
    """To the left of that lane's centre; roads that cross the ego's are reached by it."""
    heading_deg: float = Field(default=0.0, ge=-180, le=180)
    """Against that lane's driving direction, counter-clockwise."""


class Behaviour(Data):
    """What an actor does; the name and the parameters come from the catalogue's vocabulary."""

    name: str = "stand"
    trigger: Trigger = Trigger()
    """Until it fires the actor does what the behaviour's description says it does before."""
    parameters: dict[str, float] = {}
    """By name, in the units of the catalogue; what is left out has the catalogue's default."""
    other: str | None = None
    """The actor to which this one belongs while it behaves: what tows it, carries it, or its car."""

    @field_validator("parameters")
    @classmethod
    def _sorted(cls, parameters: dict[str, float]) -> dict[str, float]:
        return dict(sorted(parameters.items()))


class Actor(LeanData):
    """Anything placed in a scene: road user, animal, object, barrier, signal."""

    _left_out: ClassVar = ("details",)

    id: str = Identifier
    asset: str
    """An id of the catalogue."""
    placement: Placement
    behaviour: Behaviour = Behaviour()
    state: str = ""
    """One of the asset's states, such as lights on; empty is its first."""
    details: Details | None = None
    """Its pose, what it holds, open parts ...; left out of the JSON text if there are none."""

    @field_validator("id")
    @classmethod
    def _names_something(cls, name: str) -> str:
        if is_left_out(name):
            raise ValueError(f"{name!r} is a word for a missing value")
        return name

    @field_validator("details")
    @classmethod
    def _not_empty(cls, details: Details | None) -> Details | None:
        return details or None


class Ego(Data):
    """The vehicle under test."""

    speed: float = Field(ge=0, le=MAX_SPEED)
    """At the start, m/s."""
    lane: int = Field(default=0, ge=0, le=6)
    """Driving lanes of the ego's direction, counted from the right."""


class Hazard(Data):
    """What makes a scene OOD, with the ordinary counterpart of each part."""

    actors: dict[str, Actor | None] = {}
    """By id of the unusual actor: the ordinary actor in its place, or `None` for plain removal."""
    weather: Weather | None = None
    """The ordinary weather, where the weather is (part of) the hazard."""


class Visible(Data):
    """The visible part of one unusual thing, apart from its story."""

    what: str = Field(min_length=1, max_length=120)
    """The thing itself: `cardboard box`."""
    where: str = Field(default="", max_length=120)
    """Its place as seen from the ego: `in the ego's lane`, `beside the lane on the right` ..."""
    doing: str = Field(default="", max_length=120)
    """Its motion as a few frames can show it: `lying still`, `crossing from the right` ..."""


class StopLine(Data):
    """The stop line of a demand whose event is a red light."""

    ahead_m: float
    """From the ego's centre at its start, along its road, m."""
    red_from_s: float = 0.0
    """Time since the start from which the light is red, s; it stays red."""


BEFORE_LIGHT_M = 1.0
"""Distance from a stop line to the traffic light behind it, m."""
RED_LIGHT = "red_light"
"""The kind of demand whose event is a red light."""


class Demand(Data):
    """The ordinary event of a demand: what it is, and the text that tells it."""

    kind: str
    """The kind of demand: `queue`, `red_light`, `cyclist` ..."""
    text: str
    claims: tuple[Claim, ...] = ()
    """Claims of the text, which hold in the scene."""


class Scene(LeanData, SceneUses):
    """Everything a simulator needs to run one scenario."""

    _refuses_conversion: ClassVar = True
    _left_out: ClassVar = ("stands_for", "visible", "demand", "made", "motions", "map_state")

    schema_version: Literal[1] = 1
    id: str = Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.~-]*$", max_length=_LONGEST_ID + 10)
    """At most 200 characters, to which an ordinary drive of the scene adds a few."""
    scenario_id: str
    map: str
    """Id of a map in the catalogue, or the path of an OpenDRIVE file."""
    ego: Ego
    weather: Weather = Weather()
    actors: tuple[Actor, ...] = Field(default=(), max_length=MAX_ACTORS)
    hazard: Hazard
    decision: Trigger
    """The ego's moment of choice; a trigger by distance or time to collision must name its actor."""
    horizon_s: float = Field(default=8.0, ge=SHORTEST_HORIZON_S, le=LONGEST_HORIZON_S)
    """Duration for which an action is watched, s, counted from the decision."""
    stands_for: dict[str, tuple[str, ...]] = {}
    """Ids of the actors that show a thing of the text, by its name in the claims, where the words alone do not
    tell; `map` is the road itself. An empty mapping is left out of the JSON text."""
    visible: tuple[Visible, ...] = ()
    """Everything that can be seen of the hazard; left out of the JSON text if empty."""
    demand: Demand | None = None
    """The event of an ordinary demand; left out of the JSON text of other scenes."""
    made: tuple[Prop, ...] = Field(default=(), max_length=400)
    """Designs of the assets that no catalogue has; left out of the JSON text if empty."""
    motions: tuple[Motion, ...] = Field(default=(), max_length=400)
    """Designs of the behaviours that no catalogue has; left out of the JSON text if empty."""
    map_state: MapState | None = None
    """Faults of the map's own lamps, lights and signs; left out of the JSON text if nothing is."""

    @field_validator("hazard")
    @classmethod
    def _sorted(cls, hazard: Hazard) -> Hazard:
        return hazard.model_copy(update={"actors": dict(sorted(hazard.actors.items()))})

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        issues = _misfits(self)
        if issues:
            raise IssuesError(issues)
        return self

    @property
    def is_twin(self) -> bool:
        """Return whether `twin` created this scene."""
        return is_twin(self.id)

    @property
    def is_ordinary(self) -> bool:
        """Return whether this is an ordinary drive: a twin or a demand."""
        return is_ordinary(self.id)

    @property
    def stop_line(self) -> StopLine | None:
        """The line that the ego may not pass while the light is red; `None` unless that light is the scene's demand.

        A scene whose hazard is a broken or wrong signal has none: whether to obey it is open.
        """
        if self.demand is None or self.demand.kind != RED_LIGHT:
            return None
        lights = [actor for actor in self.actors if actor.state == "red"]
        if not lights:
            return None
        nearest = min(lights, key=lambda light: light.placement.ahead_m)
        trigger = nearest.behaviour.trigger
        return StopLine(
            ahead_m=round(nearest.placement.ahead_m - BEFORE_LIGHT_M, 3),
            red_from_s=trigger.value if trigger.kind == "time" else 0.0,
        )

    def misfits(self) -> list[Issue]:
        """Return the values that no scene can have: `model_copy` changes values without checking them."""
        try:
            valid = type(self).model_validate(_plain(self))
        except ValidationError as error:
            return issues_of(error)
        return [
            Issue(name, f"must be {value!r:.80}, not {held!r:.80}")
            for name in type(self).model_fields
            if (held := vars(self)[name]) != (value := vars(valid)[name])
            and not (isinstance(held, list) and tuple(held) == value)
        ]

    def to_json(self) -> str:
        """Return the canonical JSON text: sorted keys, no spaces.

        Raises:
            SceneError: If a value is one that no scene can have, since `model_copy` changed it without checking.
        """
        fitting(self)
        return super().to_json()

    def twin(self, decision_s: float) -> "Scene":
        """Return the same scene with its hazard replaced by the ordinary counterpart.

        Nothing else changes. Removing an actor does not shift any other, since every random stream is keyed by
        the actor's id.

        Args:
            decision_s: Time of the decision in the scene itself. The twin is judged at the same time, even if
                the actor that triggered the decision is gone.

        Raises:
            UsageError: If it is no time from 0 to 500 s.
            SceneError: If a value of the scene is one that no scene can have.
        """
        fitting(self)
        decision_s = finite_number("decision_s", decision_s, 0.0, MAX_TRIGGER)
        actors = (self.hazard.actors.get(actor.id, actor) for actor in self.actors)
        return Scene.model_validate(
            {
                **self.model_dump(),
                "id": twin_id(self.id),
                "actors": [actor.model_dump() for actor in actors if actor is not None],
                "weather": (self.hazard.weather or self.weather).model_dump(),
                "hazard": {},
                "decision": {"kind": "time", "value": decision_s},
                "stands_for": {},
                "visible": (),
                "map_state": None,
            }
        )


def _plain(value: object) -> Any:
    """Return a value without classes of this library, so that all in it is checked again; nothing is converted."""
    if isinstance(value, Data):
        return {name: _plain(vars(value)[name]) for name in type(value).model_fields}
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    return [_plain(item) for item in value] if isinstance(value, list | tuple) else value


def _misfits(scene: Scene) -> list[Issue]:
    """Return inconsistencies within the scene that do not depend on a catalogue."""
    issues = []
    if len(scene.id) > _LONGEST_ID and not scene.is_ordinary:
        issues.append(Issue("id", f"must have at most {_LONGEST_ID} characters"))
    for unfit in (_unfit_actors, _unfit_hazard, _unfit_map_state, _unfit_names, _unfit_decision):
        issues += unfit(scene)
    return issues


def _references(behaviour: Behaviour) -> list[tuple[str, str]]:
    """Return the actors that a behaviour refers to, each with the referring field."""
    named = (("trigger.actor", behaviour.trigger.actor), ("other", behaviour.other))
    return [(field, name) for field, name in named if name is not None]


def _lasting(scene: Scene) -> set[str]:
    """Return the ids of the actors that the ordinary twin has too."""
    hazards = scene.hazard.actors
    return {actor.id for actor in scene.actors if hazards.get(actor.id, ...) is not None}


def _unfit_actors(scene: Scene) -> Iterator[Issue]:
    ids, lasting = [actor.id for actor in scene.actors], _lasting(scene)
    for index, actor in enumerate(scene.actors):
        path = f"actors[{index}]"
        if actor.id in ids[:index]:
            yield Issue(f"{path}.id", f"{actor.id!r} occurs more than once")
        if actor.id == "ego":
            yield Issue(f"{path}.id", "'ego' is the ego's own id")
        for field, target in _references(actor.behaviour):
            if target not in ids:
                yield Issue(f"{path}.behaviour.{field}", f"there is no actor {target!r}")
            elif target not in lasting and actor.id not in scene.hazard.actors:
                fault = f"{target!r} is missing in the ordinary twin"
                yield Issue(f"{path}.behaviour.{field}", fault)
        if actor.behaviour.other == actor.id:
            yield Issue(f"{path}.behaviour.other", "an actor cannot be its own")


def _unfit_hazard(scene: Scene) -> Iterator[Issue]:
    ids, lasting = {actor.id for actor in scene.actors}, _lasting(scene)
    for key, ordinary in scene.hazard.actors.items():
        path = f"hazard.actors.{key}"
        if key not in ids:
            yield Issue(path, f"there is no actor {key!r}")
        if ordinary is None:
            continue
        if ordinary.id != key:
            yield Issue(f"{path}.id", f"must stay {key!r}")
        for field, target in _references(ordinary.behaviour):
            if target not in lasting:
                fault = f"there is no actor {target!r} in the ordinary twin"
                yield Issue(f"{path}.behaviour.{field}", fault)
    is_named = scene.hazard.actors or scene.hazard.weather is not None or scene.map_state
    if not is_named and not scene.is_ordinary:
        yield Issue("hazard", "name at least one actor, or the ordinary weather")


def _unfit_map_state(scene: Scene) -> Iterator[Issue]:
    if not scene.map_state:
        return
    if scene.map_state.street_lamps and scene.weather.sun_elevation_deg > 0.0:
        yield Issue("map_state.street_lamps", "street lamps are off by day anyway")
    if scene.is_ordinary:
        yield Issue("map_state", "in an ordinary scene the map is in order")


def _unfit_names(scene: Scene) -> Iterator[Issue]:
    """Yield things of the text that stand for no actor, and designs with one id."""
    known = {"map", *(actor.id for actor in scene.actors)}
    for thing, names in scene.stands_for.items():
        for name in names:
            if name not in known:
                yield Issue(f"stands_for.{thing}", f"there is no actor {name!r}")
    for member, designs in (("made", scene.made), ("motions", scene.motions)):
        given = [design.id for design in designs]
        for index, name in enumerate(given):
            if name in given[:index]:
                yield Issue(f"{member}[{index}].id", f"{name!r} occurs more than once")


def _unfit_decision(scene: Scene) -> Iterator[Issue]:
    kind, actor = scene.decision.kind, scene.decision.actor
    if kind == "time" or actor in {one.id for one in scene.actors}:
        return
    if actor is None:
        yield Issue("decision.actor", f"name the actor to which the {kind} is measured")
    else:
        yield Issue("decision.actor", f"there is no actor {actor!r}")
