"""Scenes that contradict their texts, made independently of the claims read from the texts.

Each change follows from the scene itself (its hazard and how it moves), from the knowledge base's phrases
for weather, time and road that the text contains, and from a few plain words. Anything a text leaves open is
left out, with the reason.
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from oodscen import Scene
from oodscen.author._knowledge.base import Conditions, Knowledge, RoadKind
from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import Actor
from oodscen.driving._sight.placement import staging_issues
from oodscen.errors import DataError

Fields = dict[str, Any]

DRY = {"precipitation": "none", "precipitation_mm_h": 0.0, "friction": 1.0}
WET = {"precipitation": "rain", "precipitation_mm_h": 12.0, "friction": 0.6, "cloud_cover": 1.0}
CLEAR = {"fog_visual_range_m": 10_000.0}
NOON, NIGHT = {"sun_elevation_deg": 45.0}, {"sun_elevation_deg": -25.0}

_DAY = re.compile(r"\b(?:day|daylight|sun\w*|sunny|morning|afternoon)\b", re.IGNORECASE)
_FINE = re.compile(r"\b(?:clear|fine|sunny|dry|sun shines|bright(?! daylight))\b", re.IGNORECASE)
_EGO = r"(?:the ego|ego|the ego vehicle|the ego car|its|my|your)"
_LANE = re.compile(
    rf"\b(?:{_EGO}(?:['’]s)?(?: own)? (?:lane|path)\b|(?:lane|path) of {_EGO}\b|in the path\b)",
    re.IGNORECASE,
)
_ASIDE = re.compile(
    r"\b(?:beside|edge|half|partly|part of|room|past|open|passable|free|into|juts?|sticks?|leans?|hangs?"
    r"|reach\w*|narrow\w*|along|clear of|next to|shoulder|verge|kerb|towards|left|right|from|all lanes|whole road"
    r"|entire road|across|overhead|out of)\b",
    re.IGNORECASE,
)
_SIDE = re.compile(
    r"\bfrom (?:the |its |the ego's |my )?(left|right)\b(?! lane)|\b(?:on|at) the (left|right)\b",
    re.IGNORECASE,
)
_AHEAD = re.compile(r"\b(?:ahead|in front of)\b", re.IGNORECASE)
_STAYS = re.compile(
    r"\b(?:stand|lie|lying|lay|sit|kneel|kneeling|wait|sleep|asleep|collaps|crouch|remain|stay|motionless|still|"
    r"stationary|immobile|unconscious|stop|halt|freez|frozen|on the ground|glued)\w*",
    re.IGNORECASE,
)
_KINDS = frozenset({"residential", "urban", "highway", "rural", "tunnel", "bridge", "railway"})
_STANDS = frozenset({"stand"})
_ROLLS = {"vehicle": "follow_lane", "cyclist": "follow_lane", "work_zone": "roll_away"}

OPEN_STANDING: tuple[tuple[str, str], ...] = (
    (r"\bhalts in\b", "it comes to a halt: at first it may move"),
    (r"\bcheckpoint appears\b", "a checkpoint appears: nothing is said of who stands in it"),
    (r"\bround in small steps\b", "it is said to move"),
    (r"\bhas turned a car round\b", "whether the car still slides is not told"),
)
"""Patterns of texts in which a standing actor need not stand, and the reasons."""
OPEN_MOTION: tuple[tuple[str, str], ...] = (
    (r"\b(?:vehicle|car) ahead in (?:the same|(?:the )?ego)\b", "a vehicle ahead may stand"),
    (r"\bgather in\b", "people who gather may stand"),
    (r"\boccupy the carriageway\b", "people who occupy a road may stand"),
    (r"\bstays on the kerb\b", "somebody feigns a jump and stays"),
    (r"\bappears beside\b", "somebody appears: how is not told"),
    (r"\btaken .* into fast traffic\b", "the machine may stand by now"),
)
"""Patterns of texts in which a moving actor need not move, and the reasons."""


@dataclass(frozen=True)
class Case:
    """A text and a scene that satisfies it."""

    text: str
    scene: Scene
    catalogue: Catalogue
    knowledge: Knowledge

    @cached_property
    def hazards(self) -> list[tuple[int, Actor]]:
        """The unusual actors with their indices."""
        return [
            (index, actor)
            for index, actor in enumerate(self.scene.actors)
            if actor.id in self.scene.hazard.actors
        ]

    @cached_property
    def conditions(self) -> list[tuple[Conditions, str]]:
        """Conditions mentioned in the text, each with the longest of its phrases there."""
        plain = self.text.casefold()
        found = []
        for condition in self.knowledge.conditions:
            told = [
                phrase
                for phrase in (*condition.phrases, *condition.statements)
                if re.search(rf"\b{re.escape(phrase.casefold())}\b", plain)
            ]
            if told:
                found.append((condition, max(told, key=len)))
        return found

    @cached_property
    def places(self) -> list[RoadKind]:
        """Kinds of road mentioned in the text."""
        plain = self.text.casefold()
        return [
            place
            for place in self.knowledge.places
            if any(phrase.casefold() in plain for phrase in place.phrases)
        ]

    def category(self, actor: Actor) -> str:
        """Return the category of an actor's asset."""
        return self.catalogue.asset(actor.asset).category

    def weather(self, change: Fields) -> Fields:
        """Return the scene's fields with a changed weather."""
        fields = self.scene.model_dump()
        fields["weather"] |= change
        return fields


class LeftOutError(Exception):
    """Raised when a text does not state what a mutation would contradict."""


def _missing(case: Case) -> Fields:
    fields = case.scene.model_dump()
    gone = {actor.id for _, actor in case.hazards}
    kinds = {case.category(actor) for _, actor in case.hazards}
    while True:
        more = {
            actor.id
            for actor in case.scene.actors
            if {actor.behaviour.other, actor.behaviour.trigger.actor} & gone
            or (actor.id not in gone and case.category(actor) in kinds)
        }
        if more <= gone:
            break
        gone |= more
    if not gone:
        raise LeftOutError("no actor is the hazard")
    fields["actors"] = [actor for actor in fields["actors"] if actor["id"] not in gone]
    fields["hazard"] = {"actors": {}, "weather": fields["weather"]}
    fields["decision"] = {"kind": "time", "value": 4.0}
    return fields


def _moving(case: Case) -> Fields:
    if not case.hazards or any(a.behaviour.name not in _STANDS for _, a in case.hazards):
        raise LeftOutError("part of the hazard moves")
    _refuse(case, OPEN_STANDING)
    alive = {case.category(actor) for _, actor in case.hazards} <= {"pedestrian", "animal"}
    if alive and not _STAYS.search(case.text):
        raise LeftOutError("people and animals that are not said to stand may walk")
    fields = case.scene.model_dump()
    for index, actor in case.hazards:
        category = case.category(actor)
        if category == "signal":
            raise LeftOutError("a signal is fixed to its post")
        fields["actors"][index]["behaviour"] = {
            "name": _ROLLS.get(category, "walk_along"),
            "trigger": {"kind": "time", "value": 0.0},
            "parameters": {"speed": 4.0},
        }
    return fields


def _standing(case: Case) -> Fields:
    moving = [index for index, actor in case.hazards if actor.behaviour.name not in _STANDS]
    if not moving:
        raise LeftOutError("nothing of the hazard moves")
    _refuse(case, OPEN_MOTION)
    fields = case.scene.model_dump()
    for index in moving:
        fields["actors"][index]["behaviour"] = {}
    fields["decision"] = {"kind": "time", "value": 4.0}
    return fields


def _refuse(case: Case, reasons: tuple[tuple[str, str], ...]) -> None:
    for words, why in reasons:
        if re.search(words, case.text, re.IGNORECASE):
            raise LeftOutError(why)


def _sky(case: Case) -> Fields:
    keys = {condition.key: phrase for condition, phrase in case.conditions}
    if not keys:
        raise LeftOutError("no weather is named")
    if keys.keys() & {"rain", "rainy_night", "snow"}:
        return case.weather(DRY)
    if "fog" in keys:
        return case.weather(CLEAR)
    if "overcast" in keys:
        return case.weather({"cloud_cover": 0.0})
    if any(_FINE.search(phrase) for phrase in keys.values()):
        return case.weather(WET)
    raise LeftOutError("the phrase leaves rain and cloud open")


def _light(case: Case) -> Fields:
    keys = {condition.key: phrase for condition, phrase in case.conditions}
    if keys.keys() & {"night", "rainy_night", "dusk", "dawn", "low_sun"}:
        return case.weather(NOON)
    if any(_DAY.search(phrase) for phrase in keys.values()):
        return case.weather(NIGHT)
    raise LeftOutError("no time of day is named")


def _lane(case: Case) -> Fields:
    if len(case.hazards) != 1 or case.hazards[0][1].behaviour.name not in _STANDS:
        raise LeftOutError("several actors, or a moving one, are the hazard")
    ((index, actor),) = case.hazards
    place = actor.placement
    if place.lane or abs(place.offset_m) > 1.0:
        raise LeftOutError("the hazard is not in the middle of the ego's lane")
    lane = _LANE.search(case.text)
    if lane is None:
        raise LeftOutError("the ego's lane is not named")
    if _ASIDE.search(case.text):
        raise LeftOutError("the text names something beside the lane too")
    fields = case.scene.model_dump()
    asset = case.catalogue.asset(actor.asset)
    reach = 0.5 * max(asset.length, asset.width)
    fields["actors"][index]["placement"]["offset_m"] = -(1.75 + reach + 0.8)
    return fields


def _side(case: Case) -> Fields:
    sides = {found.casefold() for pair in _SIDE.findall(case.text) for found in pair if found}
    if len(sides) != 1:
        raise LeftOutError("no side, or both, are named")
    sign = 1.0 if sides == {"left"} else -1.0
    fields, mirrored = case.scene.model_dump(), False
    for index, actor in case.hazards:
        place = actor.placement
        aside = place.lane * 3.5 + place.offset_m
        if sign * aside < 1.0:
            continue
        mirrored = True
        for name in ("lane", "offset_m", "heading_deg"):
            fields["actors"][index]["placement"][name] *= -1
    if not mirrored:
        raise LeftOutError("the side is not the hazard's at the start")
    return fields


def _road(case: Case) -> Fields:
    if len(case.places) != 1:
        raise LeftOutError("no road, or several, are named")
    kinds = _KINDS & set(case.places[0].traits)
    for road in case.catalogue.maps:
        if road.id == case.scene.map or kinds & set(road.traits) or not kinds:
            continue
        fields = {**case.scene.model_dump(), "map": road.id}
        scene = Scene.parse(fields)
        if not staging_issues(scene, case.catalogue):
            return fields
    raise LeftOutError("no other map has room for the scene")


def _behind(case: Case) -> Fields:
    if not _AHEAD.search(case.text) or not case.hazards:
        raise LeftOutError("nothing is said to be ahead")
    if any(actor.behaviour.name not in _STANDS for _, actor in case.hazards):
        raise LeftOutError("part of the hazard moves")
    fields = case.scene.model_dump()
    first = min(actor.placement.ahead_m for _, actor in case.hazards)
    for index, actor in case.hazards:
        fields["actors"][index]["placement"]["ahead_m"] = -12.0 - (actor.placement.ahead_m - first)
    fields["decision"] = {"kind": "time", "value": 4.0}
    return fields


MUTATIONS: dict[str, Callable[[Case], Fields]] = {
    "missing actor": _missing,
    "moving instead of static": _moving,
    "static instead of moving": _standing,
    "wrong weather": _sky,
    "wrong time of day": _light,
    "wrong lane": _lane,
    "wrong side": _side,
    "wrong road": _road,
    "behind instead of ahead": _behind,
}


def mutants(case: Case) -> Iterator[tuple[str, Scene | str]]:
    """Yield every mutant of a scene.

    Yields:
        The mutation's name with the mutant, or with the reason why there is none.
    """
    for name, mutate in MUTATIONS.items():
        try:
            fields = mutate(case)
            scene = Scene.parse({**fields, "id": f"{case.scene.id}.{name.replace(' ', '-')}"})
        except LeftOutError as error:
            yield name, str(error)
            continue
        except DataError:
            yield name, "no valid scene"
            continue
        if staging_issues(scene, case.catalogue):
            yield name, "it cannot be staged"
        elif scene.model_dump(exclude={"id"}) == case.scene.model_dump(exclude={"id"}):
            yield name, "nothing is changed"
        else:
            yield name, scene
