"""The knowledge base: what the built-in author knows of hazards, and how it is read and checked."""

import tomllib
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from functools import cache, cached_property
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, ConfigDict, Field

from oodscen._data import Data
from oodscen.errors import DataError, Issue
from oodscen.scene import Weather
from oodscen.tree import MAX_LABEL


def _as_range(value: Any) -> Any:
    return (value, value) if isinstance(value, (int, float)) else value


def _as_choice(value: Any) -> Any:
    return (value,) if isinstance(value, (int, str)) else value


Range = Annotated[tuple[float, float], BeforeValidator(_as_range)]
"""Low and high; one number stands for both."""
Names = Annotated[tuple[str, ...], BeforeValidator(_as_choice)]
"""One or several names to choose from."""
Lanes = Annotated[tuple[int, ...], BeforeValidator(_as_choice)]
"""One or several lanes to choose from, counted to the left of the ego's."""

ClassName = Literal["environmental", "interactional"]


class Needs(Data):
    """What a simulator must offer for a hazard."""

    assets: tuple[str, ...] = ()
    """Ids of assets, or a plain name where no catalogue is known to have one."""
    behaviours: tuple[str, ...] = ()
    weather: tuple[str, ...] = ()
    """`night`, `fog`, `rain`, `snow`, `ice`; other words name what no weather range expresses."""
    traits: tuple[str, ...] = ()
    """Traits of one map."""


class RecipeTrigger(Data):
    """A trigger with a range of values."""

    kind: Literal["time", "distance", "ttc"] = "time"
    value: Range = (0.0, 0.0)
    """s or m."""
    actor: str | None = None


class Counterpart(Data):
    """How the ordinary actor differs from the unusual one."""

    asset: Names | None = None
    ahead: Range | None = None
    lane: int | None = None
    offset: Range | None = None
    heading_deg: Range | None = None
    behaviour: str | None = None
    parameters: dict[str, Range] | None = None
    trigger: RecipeTrigger | None = None
    state: str | None = None


class RecipeActor(Data):
    """One actor, or a row of equal actors, with ranges to draw from."""

    id: str
    asset: Names
    ahead: Range
    """m ahead of the ego's start."""
    lane: Lanes = (0,)
    offset: Range = (0.0, 0.0)
    """m to the left of the lane's centre."""
    heading_deg: Range = (0.0, 0.0)
    behaviour: str = "stand"
    parameters: dict[str, Range] = {}
    trigger: RecipeTrigger = RecipeTrigger()
    state: str = ""
    hazard: bool = True
    """Whether it is part of what is unusual."""
    ordinary: Literal["remove"] | Counterpart = "remove"
    count: int = Field(default=1, ge=1, le=40)
    """How many; more than one are called `<id>-1`, `<id>-2` ..."""
    spread_ahead: float = 0.0
    """m from one to the next along the road."""
    spread_offset: float = 0.0
    """m from one to the next to the left."""

    @property
    def names(self) -> tuple[str, ...]:
        """Ids of the actors that it becomes."""
        if self.count == 1:
            return (self.id,)
        return tuple(f"{self.id}-{number}" for number in range(1, self.count + 1))


class Recipe(Data):
    """How a hazard is staged."""

    speed: Range
    """Of the ego, m/s."""
    decision: RecipeTrigger
    horizon: float = 8.0
    weather: dict[str, Range | str] = {}
    """Fields of `oodscen.scene.Weather`, where the weather is the hazard."""
    ordinary_weather: dict[str, float | str] = {}
    """What these fields are in the ordinary twin."""
    actors: tuple[RecipeActor, ...] = ()

    @property
    def is_static(self) -> bool:
        """Whether nothing but the ego moves."""
        return all(actor.behaviour == "stand" for actor in self.actors)

    @property
    def assets(self) -> tuple[tuple[str, ...], ...]:
        """For each actor the assets that would do."""
        return tuple(actor.asset for actor in self.actors)

    @property
    def behaviours(self) -> tuple[str, ...]:
        """Every behaviour that it uses, the twin's included."""
        twins = [a.ordinary for a in self.actors if isinstance(a.ordinary, Counterpart)]
        named = [actor.behaviour for actor in self.actors]
        named += [twin.behaviour for twin in twins if twin.behaviour]
        return tuple(dict.fromkeys(named))


class Hazard(Data):
    """One kind of out-of-distribution scenario."""

    model_config = ConfigDict(populate_by_name=True)
    noun: ClassVar[str] = "hazard"

    id: str = Field(pattern=r"^[a-z0-9][a-z0-9-]*$")
    """Internal: it occurs in no prompt and in no answer."""
    class_name: ClassName = Field(alias="class")
    family: str = Field(min_length=3, max_length=MAX_LABEL)
    label: str = Field(min_length=3, max_length=MAX_LABEL)
    wider: str = Field(default="", max_length=MAX_LABEL)
    """The label once the leaf is broadened to cover its kin."""
    kin: tuple[str, ...] = ()
    """Ids of hazards that the wider label covers as well."""
    words: tuple[str, ...] = ()
    """Distinctive words."""
    places: tuple[str, ...] = Field(min_length=1)
    conditions: tuple[str, ...] = ()
    """Conditions that agree with the hazard; none where its events tell the weather themselves."""
    events: tuple[str, ...] = Field(min_length=1)
    """Full clauses that start with a capital and end without a stop; `{where}` is filled in."""
    details: tuple[str, ...] = ()
    """Sentences about the consequence, added now and then."""
    traffic: bool = False
    """Whether ordinary traffic may be mentioned beside it."""
    ordinary: str
    """The ordinary counterpart as a clause."""
    needs: Needs = Needs()
    source: str = ""
    stage: Recipe | None = None


class Place(Data):
    """A kind of road."""

    key: str
    traits: tuple[str, ...]
    """Of the map that shows it."""
    speed: Range = (8.0, 12.0)
    """Usual speed of the ego, m/s."""
    words: tuple[str, ...] = ()
    phrases: tuple[str, ...] = Field(min_length=1)
    """Adverbials: `on a two-lane residential street`."""


class Condition(Data):
    """Weather and time of day."""

    key: str
    phrases: tuple[str, ...] = Field(min_length=1)
    """Adverbials: `in light rain`."""
    statements: tuple[str, ...] = ()
    """Clauses: `It is raining`."""
    words: tuple[str, ...] = ()
    weather: dict[str, Range | str] = {}


class TrafficActor(Data):
    """The ordinary road user that belongs to a traffic phrase."""

    id: str
    asset: Names
    side: Literal["oncoming", "left"]
    ahead: Range
    behaviour: str = "follow_lane"
    parameters: dict[str, Range | Literal["ego"]] = {}
    """`ego` stands for the ego's speed."""


class Traffic(Data):
    """What else is on the road."""

    key: str
    traits: tuple[str, ...] = ()
    """Of the maps on which it can be met."""
    phrases: tuple[str, ...] = Field(min_length=1)
    actor: TrafficActor | None = None


class Wording(Data):
    """Words for who moves and how far away something is."""

    openings: tuple[str, ...] = Field(min_length=1)
    near: tuple[str, ...] = Field(min_length=1)
    metres: tuple[str, ...] = Field(min_length=1)
    near_ego: tuple[str, ...] = Field(min_length=1)
    metres_ego: tuple[str, ...] = Field(min_length=1)


class Paper(Data):
    """The scenarios of the paper, described in a few words each."""

    simulated: tuple[str, ...] = ()
    mentioned: tuple[str, ...] = ()


class Knowledge(Data):
    """All that the author knows."""

    noun: ClassVar[str] = "knowledge base"

    hazards: tuple[Hazard, ...]
    places: tuple[Place, ...]
    conditions: tuple[Condition, ...]
    traffic: tuple[Traffic, ...] = ()
    wording: Wording
    paper: Paper = Paper()

    @cached_property
    def by_id(self) -> dict[str, Hazard]:
        """Hazards by id."""
        return {hazard.id: hazard for hazard in self.hazards}

    @cached_property
    def place_keys(self) -> dict[str, tuple[Place, ...]]:
        """Places by key; one key may stand for several kinds of road."""
        keys = dict.fromkeys(place.key for place in self.places)
        return {key: tuple(p for p in self.places if p.key == key) for key in keys}

    @cached_property
    def condition_keys(self) -> dict[str, Condition]:
        """Conditions by key."""
        return {condition.key: condition for condition in self.conditions}

    @cached_property
    def families(self) -> dict[str, tuple[Hazard, ...]]:
        """Hazards by the label of their family."""
        labels = dict.fromkeys(hazard.family for hazard in self.hazards)
        return {label: tuple(h for h in self.hazards if h.family == label) for label in labels}

    def of_class(self, class_name: str) -> tuple[Hazard, ...]:
        """Return the hazards of one class."""
        return tuple(h for h in self.hazards if h.class_name == class_name)

    def kin(self, hazard: Hazard) -> tuple[Hazard, ...]:
        """Return the hazards that the wider label of a hazard covers besides it."""
        return tuple(self.by_id[name] for name in hazard.kin if name in self.by_id)


# ------------------------------------------------------------------ reading

_TABLES: dict[str, type[Data]] = {
    "hazard": Hazard,
    "place": Place,
    "condition": Condition,
    "traffic": Traffic,
}
_SINGLE: dict[str, type[Data]] = {"wording": Wording, "paper": Paper}


class _Shelf:
    """What the files read so far contain, and what is wrong with them."""

    def __init__(self) -> None:
        self.entries: dict[str, list[Any]] = {name: [] for name in _TABLES}
        self.single: dict[str, Any] = {}
        self.issues: list[Issue] = []

    def read(self, name: str, text: str) -> None:
        try:
            content = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            self.issues.append(Issue(name, str(error)))
            return
        for key, value in content.items():
            if key in _TABLES and isinstance(value, list):
                for index, item in enumerate(value):
                    self._add(name, key, index, item)
            elif key in _SINGLE:
                self._parse(f"{name}: {key}", _SINGLE[key], value, key)
            else:
                known = ", ".join((*_TABLES, *_SINGLE))
                self.issues.append(Issue(f"{name}: {key}", f"unknown table; known are {known}"))

    def _add(self, name: str, key: str, index: int, item: Any) -> None:
        title = item.get("id") or item.get("key") if isinstance(item, Mapping) else None
        where = f"{name}: {key}[{index}]" + (f" {title}" if title else "")
        self._parse(where, _TABLES[key], item, key)

    def _parse(self, where: str, kind: type[Data], item: Any, key: str) -> None:
        try:
            value = kind.parse(item)
        except DataError as error:
            self.issues += [
                Issue(f"{where}: {i.path}".strip(": "), i.message) for i in error.issues
            ]
            return
        if key in _TABLES:
            self.entries[key].append((where, value))
        else:
            self.single[key] = value

    def knowledge(self) -> Knowledge | None:
        """Put everything together; a later hazard replaces an earlier one with the same id."""
        if "wording" not in self.single:
            self.issues.append(Issue("wording", "no file has this table"))
            return None
        hazards = {hazard.id: hazard for _, hazard in self.entries["hazard"]}
        conditions = {condition.key: condition for _, condition in self.entries["condition"]}
        return Knowledge(
            hazards=tuple(hazards.values()),
            places=tuple(place for _, place in self.entries["place"]),
            conditions=tuple(conditions.values()),
            traffic=tuple(traffic for _, traffic in self.entries["traffic"]),
            wording=self.single["wording"],
            paper=self.single.get("paper", Paper()),
        )


def _shipped() -> list[tuple[str, str]]:
    folder = resources.files("oodscen.llms") / "knowledge"
    files = sorted((f for f in folder.iterdir() if f.name.endswith(".toml")), key=lambda f: f.name)
    return [(file.name, file.read_text(encoding="utf-8")) for file in files]


def _own(path: Path) -> list[tuple[str, str]]:
    files = sorted(path.glob("*.toml")) if path.is_dir() else [path]
    if not files:
        raise DataError("knowledge base", [Issue("", "no .toml file in it")], source=str(path))
    try:
        return [(file.name, file.read_text(encoding="utf-8")) for file in files]
    except (OSError, UnicodeDecodeError) as error:
        raise DataError("knowledge base", [Issue("", str(error))], source=str(path)) from None


def _gather(path: str | Path | None) -> tuple[_Shelf, Knowledge | None]:
    shelf = _Shelf()
    for name, text in _shipped():
        shelf.read(name, text)
    if path is not None:
        for name, text in _own(Path(path)):
            shelf.read(name, text)
    return shelf, shelf.knowledge()


def load_knowledge(path: str | Path | None = None) -> Knowledge:
    """Read the shipped knowledge base, and on top of it a user's own.

    Args:
        path: A TOML file, or a folder of them, that adds hazards, places, conditions or traffic;
            a hazard with the id of a shipped one replaces it.

    Raises:
        DataError: With every entry that cannot be used, each with its file and path.
    """
    return _cached(None if path is None else str(Path(path)), stamp_of(path))


def stamp_of(path: str | Path | None) -> tuple[tuple[str, int, int], ...]:
    """Return what changes when a user's files change: path, time and size of each."""
    if path is None:
        return ()
    files = sorted(Path(path).glob("*.toml")) if Path(path).is_dir() else [Path(path)]
    return tuple((str(f), f.stat().st_mtime_ns, f.stat().st_size) for f in files if f.exists())


@cache
def _cached(path: str | None, stamp: tuple[Any, ...]) -> Knowledge:
    del stamp
    shelf, knowledge = _gather(path)
    if shelf.issues or knowledge is None:
        raise DataError("knowledge base", shelf.issues, source=path or "shipped")
    return knowledge


# ------------------------------------------------------------------ checking


def validate_knowledge(path: str | Path | None = None) -> list[Issue]:
    """Find everything that is wrong with the shipped knowledge base and a user's own.

    Besides what keeps an entry from being read these are references to nothing, labels that occur
    twice, phrasings that break the rules of composition, and recipes that cannot be staged.

    Args:
        path: As for `load_knowledge`.

    Returns:
        One issue per fault, with file and path; empty where all is well.
    """
    try:
        shelf, knowledge = _gather(path)
    except DataError as error:
        return list(error.issues)
    issues = list(shelf.issues)
    if knowledge is None:
        return issues
    entries: list[tuple[str, Hazard]] = shelf.entries["hazard"]
    issues += _repetitions(entries)
    for where, hazard in entries:
        issues += [Issue(f"{where}: {i.path}", i.message) for i in _faults(hazard, knowledge)]
    return issues


def _repetitions(entries: Sequence[tuple[str, Hazard]]) -> list[Issue]:
    issues = []
    latest = {hazard.id: hazard for _, hazard in entries}
    labels = Counter(
        label.casefold() for h in latest.values() for label in (h.label, h.wider) if label
    )
    classes: dict[str, str] = {}
    for where, hazard in entries:
        issues += [
            Issue(f"{where}: {field}", "another hazard has the same")
            for field in ("label", "wider")
            if labels[getattr(hazard, field).casefold()] > 1
        ]
        if labels[hazard.family.casefold()]:
            issues.append(Issue(f"{where}: family", "is the label of a hazard as well"))
        if classes.setdefault(hazard.family, hazard.class_name) != hazard.class_name:
            issues.append(Issue(f"{where}: family", "belongs to the other class elsewhere"))
    return issues


def _faults(hazard: Hazard, knowledge: Knowledge) -> Iterable[Issue]:
    """Find what is wrong with one hazard that could be read."""
    for index, key in enumerate(hazard.places):
        if key not in knowledge.place_keys:
            yield Issue(f"places[{index}]", f"there is no place {key!r}")
    for index, key in enumerate(hazard.conditions):
        if key not in knowledge.condition_keys:
            yield Issue(f"conditions[{index}]", f"there is no condition {key!r}")
    for index, name in enumerate(hazard.kin):
        other = knowledge.by_id.get(name)
        if other is None:
            yield Issue(f"kin[{index}]", f"there is no hazard {name!r}")
        elif other.class_name != hazard.class_name:
            yield Issue(f"kin[{index}]", f"{name!r} belongs to the other class")
    if hazard.kin and not hazard.wider:
        yield Issue("wider", "kin can be covered only by a wider label")
    if len(hazard.events) < 5:
        yield Issue("events", f"{len(hazard.events)} phrasings; at least 5 are wanted")
    for index, event in enumerate(hazard.events):
        for message in _phrasing(event):
            yield Issue(f"events[{index}]", message)
    if len(set(hazard.events)) < len(hazard.events):
        yield Issue("events", "a phrasing occurs twice")
    if hazard.stage is not None:
        yield from _recipe_faults(hazard.stage)


def _phrasing(event: str) -> Iterable[str]:
    if not event[:1].isupper():
        yield "start with a capital"
    if event.rstrip()[-1:] in ".!?":
        yield "end without a stop"
    if event.count("{where}") > 1 or "{" in event.replace("{where}", ""):
        yield "the only placeholder is {where}, at most once"
    if not 20 <= len(event) <= 260:
        yield "use 20 to 260 characters"


def _recipe_faults(recipe: Recipe) -> Iterable[Issue]:
    names = [name for actor in recipe.actors for name in actor.names]
    unusual = [a for a in recipe.actors if a.hazard]
    if len(set(names)) < len(names):
        yield Issue("stage.actors", "two actors have the same id")
    if not unusual and not recipe.ordinary_weather:
        yield Issue("stage", "name a hazard actor, or the ordinary weather")
    if recipe.decision.actor is not None and recipe.decision.actor not in names:
        yield Issue("stage.decision.actor", f"there is no actor {recipe.decision.actor!r}")
    if recipe.decision.kind != "time" and recipe.decision.actor is None and not unusual:
        yield Issue("stage.decision.actor", "say to which actor it is measured")
    for index, actor in enumerate(recipe.actors):
        target = actor.trigger.actor
        if target is not None and target not in names:
            yield Issue(f"stage.actors[{index}].trigger.actor", f"there is no actor {target!r}")
    for field in ("weather", "ordinary_weather"):
        for key in getattr(recipe, field):
            if key not in Weather.model_fields:
                yield Issue(f"stage.{field}.{key}", "is no field of the weather")
    for path, low, high in _ranges(recipe):
        if low > high:
            yield Issue(f"stage.{path}", f"{low:g} is more than {high:g}")


def _ranges(recipe: Recipe) -> Iterable[tuple[str, float, float]]:
    yield ("speed", *recipe.speed)
    yield ("decision.value", *recipe.decision.value)
    for index, actor in enumerate(recipe.actors):
        for field in ("ahead", "offset", "heading_deg"):
            yield (f"actors[{index}].{field}", *getattr(actor, field))
        yield (f"actors[{index}].trigger.value", *actor.trigger.value)
        for name, limits in actor.parameters.items():
            yield (f"actors[{index}].parameters.{name}", *limits)
