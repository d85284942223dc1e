"""The knowledge base: what the built-in author knows of hazards. `shelf` reads it from files."""

import re
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, ConfigDict, Field

from oodscen.data._base import Data
from oodscen.data._catalogue import Category
from oodscen.tree._scenario_tree import MAX_LABEL


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


LandmarkName = Literal["junction", "roundabout", "tunnel", "bridge", "crest", "traffic_light"]
"""What a recipe can measure from along the road, besides the ego's start."""


class Counterpart(Data):
    """How the ordinary actor differs from the unusual one."""

    asset: Names | None = None
    ahead: Range | None = None
    lane: int | None = None
    offset: Range | None = None
    heading_deg: Range | None = None
    behaviour: str | None = None
    parameters: dict[str, Range | Literal["ego"]] | None = None
    """`ego` stands for the ego's speed."""
    trigger: RecipeTrigger | None = None
    state: str | None = None


Drawn = Range | Literal["ego"]
"""A range to draw from; `ego` stands for the ego's speed."""


class RecipeActor(Data):
    """One actor, or a row of equal actors, with ranges to draw from."""

    id: str
    asset: Names
    ahead: Range
    """m ahead of the ego's start, or of what `at` names."""
    at: str = "start"
    """A landmark: the middle of a junction or roundabout, the near end of a tunnel or bridge, a
    crest's highest point, or `traffic_light`, where every light that faces the ego becomes such an
    actor. Or the id of an actor listed before, from which `offset` is measured as well."""
    lane: Lanes = (0,)
    offset: Range = (0.0, 0.0)
    """m to the left of the lane's centre."""
    meets: Range | None = None
    """For traffic that crosses: s after the ego, going on as it does, by which it reaches the middle
    of the ego's lane. It stands in for `offset`, and the side follows from `heading_deg`."""
    heading_deg: Range = (0.0, 0.0)
    behaviour: str = "stand"
    parameters: dict[str, Drawn] = {}
    trigger: RecipeTrigger = RecipeTrigger()
    other: str | None = None
    """The actor to which this one belongs: what tows it, carries it, or its car."""
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


class Variant(Data):
    """What is different where a text says so."""

    words: Names
    """Any of these phrases."""
    actors: dict[str, Counterpart]
    """By id of an actor of the recipe: its fields that differ."""


class Recipe(Data):
    """How a hazard is staged."""

    speed: Range
    """Of the ego, m/s."""
    decision: RecipeTrigger
    horizon: float = 8.0
    ego_lane: Literal["right", "any", "mirror"] = "right"
    """In which lane the ego may start: in the rightmost, in any, or in the leftmost with everything
    mirrored. In another lane than the rightmost, what is beside the road stays there."""
    company: bool | Literal["follower"] = True
    """Whether ordinary traffic may drive beside the ego, behind it or come towards it; with
    `follower` somebody always drives close behind."""
    width: float = Field(default=0.0, ge=0.0)
    """m across of what is in the way. Where it is given, and nothing moves, some decisions come so
    late that braking does not suffice and a change of lane does."""
    variants: tuple[Variant, ...] = ()
    weather: dict[str, Range | str] = {}
    """Fields of `oodscen.data._scene.Weather`, where the weather is the hazard."""
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
    ordinary: Names = Field(min_length=1)
    """The ordinary counterpart as a clause; of several the first is told that suits where it is."""
    needs: Needs = Needs()
    first: bool = False
    """Whether it is imagined before others, as long as a question does not name it as covered."""
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


class Clash(Data):
    """Words that do not go with some places, weather or traffic."""

    words: Names = Field(min_length=1)
    """Whole words; a star stands for any ending."""
    places: tuple[str, ...] = ()
    conditions: tuple[str, ...] = ()
    traffic: tuple[str, ...] = ()
    why: str = ""

    @cached_property
    def pattern(self) -> re.Pattern[str]:
        """What finds the words in a text."""
        words = "|".join(re.escape(word).replace(r"\*", r"\w*") for word in self.words)
        return re.compile(rf"(?<![\w-])(?:{words})(?![\w-])", re.IGNORECASE)


class Driving(Data):
    """What else is ordinary while the ego of an ordinary twin drives on."""

    phrases: tuple[str, ...] = Field(min_length=1)
    """Clauses that call the ego `the ego vehicle`."""
    places: tuple[str, ...] = ()
    """Where it can be said; empty for any road."""
    conditions: tuple[str, ...] = ()
    """When; empty for any."""
    others: Literal["none", "ahead", "around"] = "none"
    """Where it puts other road users: in front of the ego, or elsewhere around it."""


class Company(Data):
    """Ordinary traffic that no text mentions, there when the ego must decide."""

    side: Literal["left", "right", "oncoming", "behind"]
    share: float = Field(ge=0.0, le=1.0)
    """Of the scenes in which the road has room for it."""
    asset: Names
    gap: Range
    """m ahead of the ego at the decision; for who follows it, s between the two at the start."""
    speed: Range | Literal["ego"] = "ego"
    """m/s; `ego` stands for the ego's."""
    parameters: dict[str, Range] = {}
    """Further ones of the behaviour, such as how close it follows."""


class Things(Data):
    """Names of things that hazards need, by the category that a catalogue would put them in."""

    category: Category
    names: tuple[str, ...] = Field(min_length=1)
    kinds: tuple[str, ...] = ()
    """Words for the category as a whole: `animal`, `wildlife`."""
    others: tuple[str, ...] = ()
    """Members of it that no hazard needs, in plain words."""


class Substitute(Data):
    """What may be shown where a thing is not to be had, and is still recognised for what is meant."""

    wanted: str
    by: tuple[str, ...] = Field(min_length=1)
    """The nearest first."""
    why: str = ""


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
    clash: tuple[Clash, ...] = ()
    driving: tuple[Driving, ...] = ()
    company: tuple[Company, ...] = ()
    things: tuple[Things, ...] = ()
    substitute: tuple[Substitute, ...] = ()
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

    @cached_property
    def categories(self) -> dict[str, Category]:
        """Category of every named thing."""
        return {
            "_".join(re.split(r"[\s-]+", name)): group.category
            for group in self.things
            for name in (*group.others, *group.names)
        }

    def category(self, name: str) -> Category | None:
        """Return the category of a thing; `None` where nobody said it."""
        return self.categories.get(name)

    @cached_property
    def substitutes(self) -> dict[str, tuple[str, ...]]:
        """What may stand in for a thing, by its name."""
        return {one.wanted: one.by for one in self.substitute}

    def of_class(self, class_name: str) -> tuple[Hazard, ...]:
        """Return the hazards of one class."""
        return tuple(h for h in self.hazards if h.class_name == class_name)

    def kin(self, hazard: Hazard) -> tuple[Hazard, ...]:
        """Return the hazards that the wider label of a hazard covers besides it."""
        return tuple(self.by_id[name] for name in hazard.kin if name in self.by_id)
