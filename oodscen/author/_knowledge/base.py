"""The entries of the knowledge base, from which the built-in author works. `loading` reads them from files."""

import re
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, Strict, model_validator

from oodscen.data._base import Data, no_truth_value
from oodscen.data._catalogue import LANDMARKS
from oodscen.data._category import Category
from oodscen.data._details import Details
from oodscen.data._issues import IssuesError
from oodscen.data._scene import LONGEST_HORIZON_S, SHORTEST_HORIZON_S
from oodscen.errors import Issue
from oodscen.tree._labels import MAX_LABEL


def _as_range(value: Any) -> Any:
    no_truth_value(value)
    if isinstance(value, list | tuple) and len(value) != 2:
        raise ValueError("must be a number, or two for a range")
    return (value, value) if isinstance(value, (int, float)) else value


def _as_choice(value: Any) -> Any:
    no_truth_value(value)
    return (value,) if isinstance(value, (int, str)) else value


def _not_backward(value: Any) -> Any:
    if isinstance(value, tuple) and value[0] > value[1]:
        raise ValueError(f"{value[0]:g} is more than {value[1]:g}")
    return value


Number = Annotated[float, Strict(), BeforeValidator(no_truth_value)]
Whole = Annotated[int, Strict(), BeforeValidator(no_truth_value)]
Truth = Annotated[bool, Strict()]
_Limits = Annotated[tuple[Number, Number], BeforeValidator(_as_range)]
_NOT_BACKWARD = AfterValidator(_not_backward)
"""Checks a range or what may stand in its place; outside a union, so that its fault has the field's path."""
Range = Annotated[_Limits, _NOT_BACKWARD]
"""Lower and upper limit; a single number stands for both."""
Drawn = Annotated[_Limits | Literal["ego"], _NOT_BACKWARD]
"""A range to draw from; `ego` stands for the ego's speed."""
RangeOrWord = Annotated[_Limits | str, _NOT_BACKWARD]
"""A range to draw from, or a word."""
Names = Annotated[tuple[str, ...], Field(min_length=1), BeforeValidator(_as_choice)]
"""One or several names to choose from."""
Lanes = Annotated[tuple[Whole, ...], Field(min_length=1), BeforeValidator(_as_choice)]
"""One or several lanes to choose from, counted to the left of the ego's."""

ClassName = Literal["environmental", "interactional"]


class Needs(Data):
    """The capabilities that a hazard needs from a simulator."""

    assets: tuple[str, ...] = ()
    """Asset ids, or plain names if no known catalogue has the asset."""
    behaviours: tuple[str, ...] = ()
    """Behaviour ids."""
    weather: tuple[str, ...] = ()
    """`night`, `fog`, `rain`, `snow`, `ice`; other words name weather that no range can express."""
    traits: tuple[str, ...] = ()
    """Traits that a single map must have."""


class RecipeTrigger(Data):
    """A trigger with a range of values."""

    kind: Literal["time", "distance", "ttc"] = "time"
    """Time since the start, distance to an actor, or time to collision with it."""
    value: Range = (0.0, 0.0)
    """Value in s or m."""
    actor: str | None = None
    """The actor that the ego approaches: by default the one that the trigger starts; for a decision, the first of the hazard."""


class Counterpart(Data):
    """Fields of an actor that differ in the ordinary twin or in a variant; `None` leaves a field as it is."""

    asset: Names | None = None
    ahead: Range | None = None
    """Distance ahead of the ego's start in the twin, m; of the recipe's anchor in a variant."""
    lane: Whole | None = None
    """Lane, counted to the left of the ego's."""
    offset: Range | None = None
    """Offset to the left of the lane's centre, m."""
    heading_deg: Range | None = None
    """Heading relative to the lane, degrees to the left."""
    behaviour: str | None = None
    parameters: dict[str, Drawn] | None = None
    """Parameters of the behaviour; those that are not named keep their values."""
    trigger: RecipeTrigger | None = None
    state: str | None = None
    """State of the asset, such as `indicate_left`."""


class RecipeActor(Data):
    """One actor, or a row of identical actors, with ranges to draw from."""

    id: str
    """Id in the scene."""
    asset: Names
    """Ids of the assets that the actor may be."""
    ahead: Range
    """Distance ahead of the ego's start, or of the anchor that `at` names, m."""
    at: str = "start"
    """The anchor. Either a landmark: the middle of a junction or roundabout, the near end of a
    tunnel or bridge, the highest point of a crest, or `traffic_light`, which makes an actor of
    every light that faces the ego. Or the id of an actor listed before, from which `offset` is
    also measured."""
    lane: Lanes = (0,)
    """Lane, counted to the left of the ego's."""
    offset: Range = (0.0, 0.0)
    """Offset to the left of the lane's centre, m."""
    meets: Range | None = None
    """For crossing traffic: time by which the actor reaches the middle of the ego's lane after an
    ego that continues unchanged, s. It replaces `offset`; the side follows from `heading_deg`."""
    heading_deg: Range = (0.0, 0.0)
    """Heading relative to the lane, degrees to the left."""
    behaviour: str = "stand"
    """Id of the behaviour."""
    parameters: dict[str, Drawn] = {}
    """Parameters of the behaviour by name."""
    trigger: RecipeTrigger = RecipeTrigger()
    """Start of the behaviour."""
    other: str | None = None
    """The actor to which this one belongs: the one that tows or carries it, or its car."""
    state: str = ""
    """State of the asset, such as `indicate_left`; ignored if the asset does not have it."""
    details: Details | None = None
    """Pose of a person or states of a vehicle's parts, where the simulator has them."""
    hazard: Truth = True
    """True if the actor is part of the unusual event."""
    ordinary: Literal["remove"] | Counterpart = "remove"
    """Differences of the actor in the ordinary twin; by default the twin does not have it."""
    count: Whole = Field(default=1, ge=1, le=40)
    """Number of actors; if there are several, they are called `<id>-1`, `<id>-2` ..."""
    spread_ahead: Number = 0.0
    """Spacing along the road, m."""
    spread_offset: Number = 0.0
    """Spacing to the left, m."""

    @property
    def names(self) -> tuple[str, ...]:
        """Ids of the resulting actors."""
        if self.count == 1:
            return (self.id,)
        return tuple(f"{self.id}-{number}" for number in range(1, self.count + 1))


class Variant(Data):
    """A variant of a recipe for texts with certain words."""

    words: Names
    """Phrases, any of which selects the variant."""
    actors: dict[str, Counterpart]
    """Changed fields, by actor id in the recipe."""


class Recipe(Data):
    """A recipe for staging a hazard."""

    speed: Range
    """Speed of the ego, m/s."""
    decision: RecipeTrigger
    """The moment at which the ego must choose an action."""
    horizon: Number = Field(default=8.0, ge=SHORTEST_HORIZON_S, le=LONGEST_HORIZON_S)
    """Duration from the decision to the end, s."""
    ego_lane: Literal["right", "any", "left", "mirror"] = "right"
    """Permitted starting lanes of the ego: the rightmost, any, the leftmost, so that the lane to its
    left is an oncoming one, or the leftmost with everything mirrored. If the ego starts in another
    lane than the rightmost, roadside objects stay at the roadside."""
    company: Truth | Literal["follower"] = True
    """True if ordinary traffic may drive beside the ego, behind it or towards it; with `follower`,
    a vehicle always drives close behind."""
    width: Number = Field(default=0.0, ge=0.0)
    """Width of the obstacle, m. If it is given and nothing moves, some decisions come so late that
    only a lane change helps, not braking."""
    variants: tuple[Variant, ...] = ()
    """Variants for certain texts, of which the first that fits applies."""
    weather: dict[str, RangeOrWord] = {}
    """Fields of `oodscen.data._scene.Weather`, if the weather is the hazard."""
    ordinary_weather: dict[str, Number | str] = {}
    """Values of these fields in the ordinary twin."""
    actors: tuple[RecipeActor, ...] = ()
    """The actors, in an order in which each follows its anchor."""

    @model_validator(mode="after")
    def _anchored(self) -> Self:
        anchors = {"start", *LANDMARKS}
        issues = []
        for index, actor in enumerate(self.actors):
            if actor.at not in anchors:
                fault = f"{actor.at!r} is neither a landmark nor an actor listed before"
                issues.append(Issue(f"actors[{index}].at", fault))
            anchors.add(actor.id)
        if issues:
            raise IssuesError(issues)
        return self

    @property
    def hazards(self) -> tuple[RecipeActor, ...]:
        """The actors that are part of the unusual event."""
        return tuple(actor for actor in self.actors if actor.hazard)

    @property
    def removes_hazards(self) -> bool:
        """True if it has such actors, and the ordinary twin has nothing in their place."""
        return bool(self.hazards) and all(hazard.ordinary == "remove" for hazard in self.hazards)

    @property
    def is_static(self) -> bool:
        """True if only the ego moves."""
        return all(actor.behaviour == "stand" for actor in self.actors)

    @property
    def behaviours(self) -> tuple[str, ...]:
        """All behaviours of the recipe, including the twin's."""
        twins = [a.ordinary for a in self.actors if isinstance(a.ordinary, Counterpart)]
        named = [actor.behaviour for actor in self.actors]
        named += [twin.behaviour for twin in twins if twin.behaviour]
        return tuple(dict.fromkeys(named))


class HazardKind(Data):
    """One kind of out-of-distribution scenario."""

    model_config = ConfigDict(populate_by_name=True)
    noun: ClassVar[str] = "hazard"

    id: str = Field(pattern=r"^[a-z0-9][a-z0-9-]*$")
    """Internal id; it occurs in no prompt and no answer."""
    class_name: ClassName = Field(alias="class")
    """Class of the paper's taxonomy."""
    family: str = Field(min_length=3, max_length=MAX_LABEL)
    """Label of the family's node in a scenario tree."""
    label: str = Field(min_length=3, max_length=MAX_LABEL)
    """Label of the leaf."""
    wider: str = Field(default="", max_length=MAX_LABEL)
    """The label of the leaf after it is broadened to cover the hazard's kin."""
    kin: tuple[str, ...] = ()
    """Ids of the hazards that the wider label also covers."""
    words: tuple[str, ...] = ()
    """Distinctive words, by which texts are recognised."""
    places: tuple[str, ...] = Field(min_length=1)
    """Keys of the places where it can be met."""
    conditions: tuple[str, ...] = ()
    """Keys of the conditions compatible with it; empty if its events describe the weather themselves."""
    events: tuple[str, ...] = Field(min_length=1)
    """Full clauses that start with a capital letter and end without a full stop; `{where}` is filled in."""
    details: tuple[str, ...] = ()
    """Sentences about the consequence, added to some texts."""
    traffic: Truth = False
    """True if a text may also mention ordinary traffic."""
    ordinary: Names
    """Ordinary counterparts as clauses; the first one that suits the setting is used."""
    needs: Needs = Needs()
    """Assets and places that a simulator must have to show it."""
    first: Truth = False
    """True if the hazard is imagined before others, until a question names it as covered."""
    source: str = ""
    """Kind of source that it was taken from."""
    stage: Recipe | None = None
    """The recipe for staging it; `None` if it cannot be staged yet."""


class RoadKind(Data):
    """A kind of road."""

    key: str
    """Key by which hazards name it; several kinds of road may share one."""
    traits: tuple[str, ...]
    """Traits of a map that shows this kind of road."""
    told: dict[str, Names] = {}
    """Traits that only some phrases mention, each with the beginnings of the words that do so; all phrases mention the others."""
    speed: Range = (8.0, 12.0)
    """Usual speed of the ego, m/s."""
    words: tuple[str, ...] = ()
    """Words by which texts name this kind of road."""
    phrases: tuple[str, ...] = Field(min_length=1)
    """Adverbials, such as `on a two-lane residential street`."""


class Conditions(Data):
    """Weather and time of day."""

    key: str
    """Key by which hazards name it."""
    phrases: tuple[str, ...] = Field(min_length=1)
    """Adverbials, such as `in light rain`."""
    statements: tuple[str, ...] = ()
    """Clauses, such as `It is raining`."""
    words: tuple[str, ...] = ()
    """Words by which texts name it."""
    weather: dict[str, RangeOrWord] = {}
    """Fields of `oodscen.data._scene.Weather`, with ranges to draw from."""


class TrafficActor(Data):
    """The ordinary road user of a traffic phrase."""

    id: str
    """Id in the scene."""
    asset: Names
    """Ids of the assets that it may be."""
    side: Literal["oncoming", "left"]
    """Its lane: the first one for oncoming traffic, or the one to the left of the ego's."""
    ahead: Range
    """Distance ahead of the ego's start, m."""
    behaviour: str = "follow_lane"
    """Id of its behaviour."""
    parameters: dict[str, Drawn] = {}
    """Parameters of the behaviour by name."""


class BackgroundTraffic(Data):
    """Other traffic on the road."""

    key: str
    """Key by which clashes name it: `quiet` for none, `follower` for a vehicle behind the ego."""
    traits: tuple[str, ...] = ()
    """Traits of the maps on which this traffic can occur."""
    phrases: tuple[str, ...] = Field(min_length=1)
    """Adverbials, such as `with no other traffic nearby`."""
    actor: TrafficActor | None = None
    """The road user that the phrases mention, if staging adds one."""


class Clash(Data):
    """Words that are incompatible with some places, weather or traffic."""

    words: Names
    """Whole words; an asterisk stands for any ending."""
    places: tuple[str, ...] = ()
    """Keys of places."""
    conditions: tuple[str, ...] = ()
    """Keys of conditions."""
    traffic: tuple[str, ...] = ()
    """Keys of traffic."""
    why: str = ""
    """The reason, for readers of the file and of faults."""

    @cached_property
    def pattern(self) -> re.Pattern[str]:
        """Pattern that matches the words in a text."""
        words = "|".join(re.escape(word).replace(r"\*", r"\w*") for word in self.words)
        return re.compile(rf"(?<![\w-])(?:{words})(?![\w-])", re.IGNORECASE)


class Driving(Data):
    """Ordinary events of an ordinary twin, besides the ego driving on."""

    phrases: tuple[str, ...] = Field(min_length=1)
    """Clauses that call the ego `the ego vehicle`."""
    places: tuple[str, ...] = ()
    """Places for which the clauses are suitable; empty for any road."""
    conditions: tuple[str, ...] = ()
    """Conditions for which the clauses are suitable; empty for any."""
    others: Literal["none", "ahead", "around"] = "none"
    """Position of the other road users that the clauses mention: in front of the ego, or elsewhere around it."""


class AmbientTraffic(Data):
    """Ordinary traffic that no text mentions, present when the ego must decide."""

    side: Literal["left", "right", "oncoming", "behind"]
    """Its position relative to the ego."""
    share: Number = Field(ge=0.0, le=1.0)
    """Share of the scenes with room for this traffic in which it appears."""
    asset: Names
    """Ids of the assets that it may be."""
    gap: Range
    """Distance ahead of the ego at the decision, m; for a follower, the time gap at the start, s."""
    speed: Drawn = "ego"
    """Speed, m/s; `ego` stands for the ego's."""
    parameters: dict[str, Range] = {}
    """Further parameters of the behaviour, such as the following distance."""


class Things(Data):
    """Names of things that hazards need, grouped by their category in a catalogue."""

    category: Category
    names: tuple[str, ...] = Field(min_length=1)
    """The names of the things."""
    kinds: tuple[str, ...] = ()
    """Words for the category as a whole: `animal`, `wildlife`."""
    others: tuple[str, ...] = ()
    """Members of the category that no hazard needs, in plain words."""


class Replacement(Data):
    """Acceptable replacements for an unavailable thing, which viewers still recognise as intended."""

    wanted: str
    """Name of the thing that a hazard needs."""
    by: tuple[str, ...] = Field(min_length=1)
    """Replacements, the closest first."""
    why: str = ""
    """The reason, for readers of the file."""


class Wording(Data):
    """Phrases for how a text opens and how far away something is."""

    openings: tuple[str, ...] = Field(min_length=1)
    """Beginnings of a text, up to the place."""
    near: tuple[str, ...] = Field(min_length=1)
    """Adverbials for a place ahead, at no certain distance."""
    metres: tuple[str, ...] = Field(min_length=1)
    """The same with `{distance}` filled in, m."""
    near_ego: tuple[str, ...] = Field(min_length=1)
    """Adverbials for a place ahead of the ego, for texts that do not mention it elsewhere."""
    metres_ego: tuple[str, ...] = Field(min_length=1)
    """The same with `{distance}` filled in, m."""


class Paper(Data):
    """The scenarios of the paper, described in a few words each."""

    simulated: tuple[str, ...] = ()
    """The simulated ones."""
    mentioned: tuple[str, ...] = ()
    """The ones that it only mentions."""


class Knowledge(Data):
    """The complete knowledge base."""

    noun: ClassVar[str] = "knowledge base"

    hazards: tuple[HazardKind, ...]
    places: tuple[RoadKind, ...]
    conditions: tuple[Conditions, ...]
    traffic: tuple[BackgroundTraffic, ...] = ()
    clash: tuple[Clash, ...] = ()
    driving: tuple[Driving, ...] = ()
    company: tuple[AmbientTraffic, ...] = ()
    things: tuple[Things, ...] = ()
    substitute: tuple[Replacement, ...] = ()
    wording: Wording
    paper: Paper = Paper()

    @cached_property
    def by_id(self) -> dict[str, HazardKind]:
        """Hazards by id."""
        return {hazard.id: hazard for hazard in self.hazards}

    @cached_property
    def place_keys(self) -> dict[str, tuple[RoadKind, ...]]:
        """Places by key; one key may stand for several kinds of road."""
        keys = dict.fromkeys(place.key for place in self.places)
        return {key: tuple(p for p in self.places if p.key == key) for key in keys}

    @cached_property
    def condition_keys(self) -> dict[str, Conditions]:
        """Conditions by key."""
        return {condition.key: condition for condition in self.conditions}

    @cached_property
    def families(self) -> dict[str, tuple[HazardKind, ...]]:
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
        """Return the category of a thing, or `None` if none is recorded."""
        return self.categories.get(name)

    @cached_property
    def substitutes(self) -> dict[str, tuple[str, ...]]:
        """Acceptable replacements for a thing, by its name."""
        return {replacement.wanted: replacement.by for replacement in self.substitute}

    def of_class(self, class_name: str) -> tuple[HazardKind, ...]:
        """Return the hazards of one class."""
        return tuple(h for h in self.hazards if h.class_name == class_name)

    def kin(self, hazard: HazardKind) -> tuple[HazardKind, ...]:
        """Return the other hazards that the wider label of a hazard covers."""
        return tuple(self.by_id[name] for name in hazard.kin if name in self.by_id)
