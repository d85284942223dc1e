"""Scenes of a language model that contradict their texts, each in one respect.

A change is made to the scene alone: another kind of thing, the other side, another distance, weather, hour,
number, motion or lane. Which claims it contradicts follows from what was changed.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from oodscen import Scene
from oodscen._seeding import stream
from oodscen.claims._things import may_be
from oodscen.data._catalogue import Catalogue
from oodscen.data._claim import Claim
from oodscen.driving._sight.placement import staging_issues
from oodscen.errors import DataError

Fields = dict[str, Any]


@dataclass(frozen=True)
class Told:
    """A text's claims and a scene that satisfies them."""

    claims: tuple[Claim, ...]
    scene: Scene


class Falsified(NamedTuple):
    """A scene that contradicts its text."""

    change: str
    told: Told
    scene: Scene
    kinds: frozenset[str]
    """Kinds of claims, one of which must be named."""


def falsified(
    told: Sequence[Told], catalogue: Catalogue, count: int, seed: int = 0
) -> Iterator[Falsified]:
    """Yield `count` falsified scenes, with the changes in turn and the scenes in random order."""
    queues = {
        name: [told[index] for index in stream(seed, "falsify", name).permutation(len(told))]
        for name in CHANGES
    }
    taken = 0
    while taken < count and any(queues.values()):
        for name, queue in queues.items():
            while queue and taken < count:
                one = queue.pop()
                rng = stream(seed, name, one.scene.id)
                found = _changed(name, one, catalogue, int(rng.integers(1 << 30)))
                if found is not None:
                    taken += 1
                    yield found
                    break


def _changed(name: str, told: Told, catalogue: Catalogue, draw: int) -> Falsified | None:
    change, kinds = CHANGES[name]
    fields = change(told, told.scene.model_dump(mode="json"), catalogue, draw)
    if fields is None:
        return None
    try:
        scene = Scene.parse(fields)
    except DataError:
        return None
    if scene == told.scene or staging_issues(scene, catalogue):
        return None
    return Falsified(name, told, scene, kinds)


def _of(told: Told, kind: str, *values: str) -> list[Claim]:
    return [
        claim
        for claim in told.claims
        if claim.kind == kind and (not values or claim.value in values)
    ]


def _shown(told: Told, subject: str, catalogue: Catalogue) -> list[int]:
    """Return the indices of the actors that show a thing."""
    named = told.scene.stands_for.get(subject)
    return [
        index
        for index, actor in enumerate(told.scene.actors)
        if (actor.id in named if named else may_be(subject, catalogue.asset(actor.asset)))
    ]


def _kind(told: Told, fields: Fields, catalogue: Catalogue, draw: int) -> Fields | None:
    """Put another kind of thing in place of what the text names, and say that it stands for it."""
    subjects = [one.subject for one in _of(told, "thing")]
    subjects = [one for one in subjects if _shown(told, one, catalogue)]
    if not subjects:
        return None
    subject = subjects[draw % len(subjects)]
    rows = _shown(told, subject, catalogue)
    own = catalogue.asset(told.scene.actors[rows[0]].asset)
    others = [
        asset
        for asset in catalogue.assets
        if asset.category == own.category
        and not may_be(subject, asset)
        and asset.id != own.id
        and not {*asset.tags, asset.id} & {*own.tags, own.id}
    ]
    if not others:
        return None
    other = others[draw // 7 % len(others)]
    for row in rows:
        fields["actors"][row] |= {"asset": other.id, "state": ""}
    fields["hazard"]["actors"] = {
        key: None if key in {told.scene.actors[row].id for row in rows} else one
        for key, one in fields["hazard"]["actors"].items()
    }
    ids = [told.scene.actors[row].id for row in rows]
    fields["stands_for"] = {**fields.get("stands_for", {}), subject: ids}
    return fields


def _gone(told: Told, fields: Fields, catalogue: Catalogue, draw: int) -> Fields | None:
    """Take away what the text names."""
    subjects = [one.subject for one in _of(told, "thing")]
    for subject in subjects[draw % max(1, len(subjects)) :]:
        rows = _shown(told, subject, catalogue)
        gone = {told.scene.actors[row].id for row in rows}
        if any(catalogue.asset(told.scene.actors[row].asset).category == "signal" for row in rows):
            continue  # the road has its own
        left = [actor for actor in fields["actors"] if actor["id"] not in gone]
        if gone and left and fields["decision"]["actor"] not in gone:
            return _without(fields, gone)
    return None


def _count(told: Told, fields: Fields, catalogue: Catalogue, draw: int) -> Fields | None:
    """Leave one of several."""
    for claim in _of(told, "count"):
        rows = _shown(told, claim.subject, catalogue)
        if len(rows) > 1 and int(claim.value) > 1:
            kept = fields["decision"]["actor"]
            ids = [told.scene.actors[row].id for row in rows]
            last = kept if kept in ids else ids[0]
            return _without(fields, set(ids) - {last})
    return None


def _without(fields: Fields, gone: set[str]) -> Fields:
    fields["actors"] = [actor for actor in fields["actors"] if actor["id"] not in gone]
    hazard = {key: one for key, one in fields["hazard"]["actors"].items() if key not in gone}
    fields["hazard"]["actors"] = hazard or {fields["actors"][0]["id"]: None}
    fields["stands_for"] = {
        thing: rest
        for thing, ids in fields.get("stands_for", {}).items()
        if (rest := [one for one in ids if one not in gone])
    }
    return fields


def _side(told: Told, fields: Fields, catalogue: Catalogue, draw: int) -> Fields | None:
    """Mirror an actor at the middle of the ego's lane."""
    found = _of(told, "motion", "from_left", "from_right")
    for claim in (*found, *_of(told, "place", "left", "right", "left_lane", "right_lane")):
        rows = _shown(told, claim.subject, catalogue)
        sides = {
            one.value.removeprefix("from_").partition("_")[0]
            for one in told.claims
            if one.subject == claim.subject and one.kind in ("place", "motion")
        }
        if len(rows) != 1 or {"left", "right"} <= sides:
            continue
        place = fields["actors"][rows[0]]["placement"]
        if place["lane"] == 0 and abs(place["offset_m"]) > 1.0:
            place["offset_m"] *= -1.0
            place["heading_deg"] *= -1.0
            return fields
        if place["lane"]:
            place["lane"] *= -1
            return fields
    return None


def _distance(told: Told, fields: Fields, catalogue: Catalogue, draw: int) -> Fields | None:
    """Let the ego decide at once, twice as far away."""
    for claim in _of(told, "distance"):
        rows = _shown(told, claim.subject, catalogue)
        metres = float(claim.value)
        if not rows or len(rows) > 3:
            continue
        for row in rows:
            fields["actors"][row]["placement"]["ahead_m"] += 2.0 * metres + 30.0
        fields["decision"] = {"kind": "time", "value": 0.5, "actor": None}
        return fields
    return None


_SKIES: Mapping[str, Fields] = {
    "clear": {"precipitation": "rain", "precipitation_mm_h": 12.0, "friction": 0.6},
    "dry": {"precipitation": "snow", "precipitation_mm_h": 5.0, "friction": 0.35},
    "rain": {"precipitation": "none", "precipitation_mm_h": 0.0},
    "light_rain": {"precipitation": "rain", "precipitation_mm_h": 30.0},
    "heavy_rain": {"precipitation": "rain", "precipitation_mm_h": 1.0},
    "fog": {"fog_visual_range_m": 10_000.0},
    "mist": {"fog_visual_range_m": 10_000.0},
    "snow": {"precipitation": "rain", "precipitation_mm_h": 5.0},
}


def _weather(told: Told, fields: Fields, catalogue: Catalogue, draw: int) -> Fields | None:
    for claim in _of(told, "weather"):
        if claim.value in _SKIES:
            fields["weather"] |= _SKIES[claim.value]
            return fields
    return None


def _hour(told: Told, fields: Fields, catalogue: Catalogue, draw: int) -> Fields | None:
    for claim in _of(told, "time"):
        fields["weather"]["sun_elevation_deg"] = -30.0 if claim.value == "day" else 50.0
        return fields
    return None


def _speed(told: Told, fields: Fields, catalogue: Catalogue, draw: int) -> Fields | None:
    """Let what moves stand, and what stands move."""
    for claim in _of(told, "motion", "moving", "stationary", "oncoming", "reversing", "crossing"):
        rows = _shown(told, claim.subject, catalogue)
        is_still = claim.value == "stationary"
        if not rows or (is_still and _of_subject(told, claim.subject, "motion") > 1):
            continue
        for row in rows:
            category = catalogue.asset(told.scene.actors[row].asset).category
            name = "follow_lane" if category in ("vehicle", "cyclist") else "walk_along"
            if is_still and category in ("signal", "work_zone"):
                return None
            fields["actors"][row]["behaviour"] = {
                "name": name if is_still else "stand",
                "parameters": {"speed": 4.0} if is_still else {},
            }
        if not is_still:
            fields["decision"] = {"kind": "time", "value": 1.0, "actor": None}
        return fields
    return None


def _of_subject(told: Told, subject: str, kind: str) -> int:
    return sum(claim.subject == subject and claim.kind == kind for claim in told.claims)


def _ego(told: Told, fields: Fields, catalogue: Catalogue, draw: int) -> Fields | None:
    """Put the ego, with everything around it, into another lane."""
    lanes = catalogue.map(told.scene.map).lanes
    if not _of(told, "ego", "left_lane", "right_lane", "middle_lane") or lanes < 2:
        return None
    other = (fields["ego"]["lane"] + 1) % lanes
    shift = fields["ego"]["lane"] - other
    fields["ego"]["lane"] = other
    for actor in (*fields["actors"], *filter(None, fields["hazard"]["actors"].values())):
        actor["placement"]["lane"] += shift
    return fields


def _lane(told: Told, fields: Fields, catalogue: Catalogue, draw: int) -> Fields | None:
    """Move what stands in the ego's lane off the road."""
    for claim in _of(told, "place", "in_lane"):
        rows = _shown(told, claim.subject, catalogue)
        if not rows or any(told.scene.actors[row].behaviour.name != "stand" for row in rows):
            continue
        for row in rows:
            asset = catalogue.asset(told.scene.actors[row].asset)
            reach = 0.5 * max(asset.length, asset.width)
            fields["actors"][row]["placement"] |= {"lane": 0, "offset_m": -2.6 - reach}
        return fields
    return None


def _road(told: Told, fields: Fields, catalogue: Catalogue, draw: int) -> Fields | None:
    """Take another road, of which something that the text says is not true."""
    kinds = {one.value for one in _of(told, "road")} - {"two_way", "junction"}
    if not kinds:
        return None
    others = [road for road in catalogue.maps if not kinds & {*road.traits}]
    others = [one for one in others if not (kinds <= {"urban"} and "residential" in one.traits)]
    if not others:
        return None
    return {**fields, "map": others[draw % len(others)].id}


def _state(told: Told, fields: Fields, catalogue: Catalogue, draw: int) -> Fields | None:
    for claim in _of(told, "state"):
        rows = _shown(told, claim.subject, catalogue)
        for row in rows:
            states = catalogue.asset(told.scene.actors[row].asset).states
            shown = told.scene.actors[row].state or states[0]
            if claim.value in ("red", "green", "beacon", "all_on", "off") and "off" in states:
                fields["actors"][row]["state"] = "brake" if shown == "off" else "off"
                if fields["actors"][row]["state"] not in states:
                    return None
        if rows:
            return fields
    return None


_THING = frozenset({"thing", "place", "distance", "motion", "count", "state", "traffic"})
CHANGES: Mapping[
    str, tuple[Callable[[Told, Fields, Catalogue, int], Fields | None], frozenset[str]]
]
CHANGES = {
    "another kind of thing": (_kind, frozenset({"thing"})),
    "missing": (_gone, _THING),
    "fewer": (_count, frozenset({"count"})),
    "other side": (_side, frozenset({"place", "motion"})),
    "other distance": (_distance, frozenset({"distance"})),
    "other weather": (_weather, frozenset({"weather"})),
    "other time of day": (_hour, frozenset({"time"})),
    "other motion": (_speed, frozenset({"motion"})),
    "other lane of the ego": (_ego, frozenset({"ego"})),
    "out of the lane": (_lane, frozenset({"place"})),
    "other road": (_road, frozenset({"road", "lanes", "own_lanes"})),
    "other state": (_state, frozenset({"state"})),
}
"""Changes by name, each with the kinds of claims that it contradicts."""
