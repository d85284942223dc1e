"""Staging: drafts a scene by recipe from a text and a catalogue's digest."""

import re
from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence

import numpy as np

from oodscen._seeding import stream
from oodscen.author._knowledge.base import (
    BackgroundTraffic,
    HazardKind,
    Knowledge,
    Recipe,
    RecipeActor,
    RoadKind,
)
from oodscen.author._reading.recognition import Recogniser
from oodscen.author._settings import places_of, roads_for
from oodscen.author._staging import decision_timing as timing
from oodscen.author._staging.actors import SceneDraftState, cast, named_traffic
from oodscen.author._staging.anchors import anchors
from oodscen.author._staging.aside import moved_aside
from oodscen.author._staging.background_traffic import (
    company,
    expected_decision_s,
    follower,
    is_followed,
    on_offer,
)
from oodscen.author._staging.counterparts import drawn_near, replaced
from oodscen.author._staging.lanes import settled, varied
from oodscen.author._staging.weather import draw_weather
from oodscen.author._writing.stand_in import stand_in
from oodscen.claims._roads import is_so, of_roads
from oodscen.claims._things import Thing, may_be, mentions
from oodscen.data._catalogue import LANDMARKS
from oodscen.data._claim import Claim
from oodscen.data._scene import Actor, Ego, Hazard, Trigger
from oodscen.driving._motion.behaviours import STAYS
from oodscen.driving._motion.off_centre import off_centre
from oodscen.errors import LLMError
from oodscen.prompts._digest import CatalogueDigest, MapLine
from oodscen.prompts._scenario.describe_path import plain
from oodscen.prompts._scenario.stage_scene import SceneDraft, StageScene
from oodscen.prompts._weather_line import WeatherLimits

_DISTANCE = re.compile(r"\b(\d{1,3})\s?(?:m|metres?|meters?)\b")
_LEAST_SPEED = 3.0
"""Least speed of the ego, m/s."""
_LEAST_FOLLOWED = 8.0
"""Speed down to which an ego that is followed slows down so that its hazard is recognised in time, m/s."""
_LATE = 0.75
"""Share of late decisions, if at some distance only a lane change helps."""
_URGENT = 0.7
"""Share of the other decisions at which emergency braking suffices but comfortable braking hardly does."""
_HURRIED = 0.7
"""The same share for scenes in which someone crosses, or a group blocks the road."""
_EVADING_S = 2.2
"""Time before a head-on collision at which evasion is still possible, s."""
_CLEAR_PX = 400.0
"""Area in the dash camera's image below which an actor is not recognised at a glance, square pixels."""
_WINDOW_M = 0.8
"""Least range of distances at which only hard braking suffices, m."""
_SEEN_PX = 120.0
"""Area in the dash camera's image below which an actor is hardly seen, square pixels."""
_ASIDE = 0.4
"""Offset of an obstacle that requires a lane change, towards the far side of its lane, m."""
_INSIDE = 1.2
"""Offset from the lane's centre within which an obstacle is in the way, m."""


class Stager:
    """Answers `StageScene`."""

    def __init__(self, knowledge: Knowledge, recogniser: Recogniser) -> None:
        self.knowledge = knowledge
        self.recogniser = recogniser

    def stage(self, prompt: StageScene, seed: int, attempt: int) -> SceneDraft:
        """Stage a scene for a text; each attempt, from 0, draws other values.

        Raises:
            LLMError: If the text shows nothing that the author can stage.
        """
        hazard = self._hazard(prompt)
        # Its many patterns are compiled at the import.
        from oodscen.author._reading.claim_extraction import read_claims

        assert hazard.stage is not None
        offered = {asset.id: asset for asset in prompt.catalogue.assets}
        recipe = moved_aside(varied(hazard.stage, prompt.text), prompt.text, offered)
        said = read_claims(prompt.text)
        rng = stream(seed, "stage", prompt.text, attempt)
        place = self._place(prompt.text, hazard, rng)
        road = _map_for(place, hazard, prompt.catalogue, said)
        conditions = self.recogniser.conditions(prompt.text, hazard)
        limits = WeatherLimits.of(prompt.catalogue.weather)
        weather, ordinary = draw_weather(recipe, conditions, self.knowledge, limits, rng, said)
        distance = _distance(prompt.text)
        recipe, lane = settled(recipe, road, prompt.text, rng)
        scene = _set(prompt.catalogue, road, recipe, place, lane, rng)
        traffic = self.recogniser.traffic(prompt.text)
        scene.named, others = _named(prompt.text, said, traffic)
        is_dense = any(_is_busy(claim) for claim in said)
        kinds = on_offer(self.knowledge.company, prompt.catalogue)
        tailgater = is_followed(kinds, recipe, traffic, rng, is_dense=is_dense)
        scene.is_followed = tailgater is not None
        shift, decision = _timing(scene, weather.friction, distance)
        recipe = scene.recipe
        actors, unusual = _cast_all(scene, shift)
        if traffic is not None and traffic.actor is not None:
            actors += named_traffic(traffic.actor, scene, others)
        is_asked = is_dense or (traffic is not None and traffic.key == "follower")
        if tailgater is not None and (scene.is_followed or is_asked):
            actors += follower(tailgater, scene, actors)
        decisive = decision.actor or next(iter(unusual), None)
        one = stand_in(hazard, prompt.text, self.recogniser.place(prompt.text, hazard.places))
        is_quiet = traffic is not None and traffic.key == "quiet"
        found = next((actor for actor in actors if actor.id == decisive), None)
        if found is not None and attempt < 2:
            until = expected_decision_s((decision, decisive), actors, scene.speed)
            if one is not None and not is_quiet and found.id in unusual:
                unusual |= replaced(one, scene, found, until)
            elif ordinary is None:
                unusual = drawn_near(unusual, scene, actors, found, until)
        if traffic is None and recipe.company and attempt < 2:
            actors += company(
                kinds,
                road,
                (scene.ego_lane, scene.speed),
                [*actors, *(twin for twin in unusual.values() if twin is not None)],
                (decision, decisive),
                rng,
                free=scene.escape,
                is_dense=is_dense,
            )
        actors, unusual = _off_centre(actors, unusual, seed, prompt.text)
        if ordinary is None and not unusual:
            raise LLMError(f"the recipe for {hazard.label!r} has no hazard", model="builtin")
        return SceneDraft(
            reasoning=(
                f"The text is about: {hazard.label}. It fits {road.description}; the ego drives "
                f"at {scene.speed:g} m/s."
            ),
            map=road.id,
            ego=Ego(speed=scene.speed, lane=scene.ego_lane),
            weather=weather,
            actors=actors,
            stands_for=_shown(prompt.things, actors, unusual, prompt.catalogue),
            hazard=Hazard(actors=unusual, weather=ordinary),
            decision=decision
            if decision.kind == "time"
            else decision.model_copy(update={"actor": decisive}),
            horizon_s=recipe.horizon,
        )

    def _hazard(self, prompt: StageScene) -> HazardKind:
        """Return the hazard that the text describes, or else the one that its leaf names."""
        hazard = self.recogniser.recognise(prompt.text).hazard
        if hazard is None and prompt.path:
            hazard, _ = self.recogniser.label(prompt.path[-1])
        if hazard is None:
            raise LLMError("the built-in author does not recognise the text", model="builtin")
        if hazard.stage is None:
            raise LLMError(
                f"the built-in author has no recipe to stage {hazard.label!r}", model="builtin"
            )
        return hazard

    def _place(self, text: str, hazard: HazardKind, rng: np.random.Generator) -> RoadKind:
        named = self.recogniser.place(text, hazard.places)
        if named is not None and named.key in hazard.places:
            return named
        fitting = places_of(hazard, self.knowledge)
        if named is not None:
            alike = max(len(set(named.traits) & set(p.traits)) for p in fitting)
            fitting = [p for p in fitting if len(set(named.traits) & set(p.traits)) == alike]
        return fitting[int(rng.integers(len(fitting)))]


def _cast_all(scene: SceneDraftState, shift: float) -> tuple[list[Actor], dict[str, Actor | None]]:
    """Place the recipe's actors; return all, and the counterparts of the unusual ones by id."""
    actors: list[Actor] = []
    unusual: dict[str, Actor | None] = {}
    for part in scene.recipe.actors:
        for actor, counterpart in cast(part, scene, shift):
            actors.append(actor)
            if part.hazard:
                unusual[actor.id] = counterpart
    return actors, unusual


def _off_centre(
    actors: Sequence[Actor], unusual: Mapping[str, Actor | None], seed: int, text: str
) -> tuple[list[Actor], dict[str, Actor | None]]:
    """Move road users a little beside the middle of their lanes, a hazard and its counterpart alike.

    Those that tow or carry another stay where they are.
    """
    tied = {one.behaviour.other for one in (*actors, *unusual.values()) if one}

    def moved(one: Actor) -> Actor:
        return one if one.id in tied else off_centre(one, stream(seed, "off centre", text, one.id))

    return [moved(one) for one in actors], {
        name: one and moved(one) for name, one in unusual.items()
    }


def _shown(
    things: Sequence[str],
    actors: Sequence[Actor],
    unusual: Collection[str],
    digest: CatalogueDigest,
) -> dict[str, list[str]]:
    """Return for each thing of the claims the actors that its noun fits: unusual ones, or else others."""
    lines = {asset.id: asset for asset in digest.assets}
    found = {}
    for thing in things:
        fits = [one.id for one in actors if one.asset in lines and may_be(thing, lines[one.asset])]
        shown = [name for name in fits if name in unusual] or fits
        if shown:
            found[thing] = shown
    return found


def _distance(text: str) -> float | None:
    found = _DISTANCE.search(text)
    return float(found.group(1)) if found else None


def _named(
    text: str, said: Sequence[Claim], traffic: BackgroundTraffic | None
) -> tuple[tuple[Thing, ...], tuple[Thing, ...]]:
    """Return the things that a text names, and separately those of its ordinary traffic."""
    words = plain(text)
    phrase = next((p for p in traffic.phrases if plain(p) in words), "") if traffic else ""
    of_traffic = {mention.thing for mention in mentions(phrase)}
    quotes = [claim.quote for claim in said if claim.kind == "thing"]
    counts = Counter(m.thing for quote in quotes for m in mentions(quote))
    named = [thing for thing in counts if thing not in of_traffic or counts[thing] > 1]
    return tuple(named), tuple(of_traffic)


def _is_busy(claim: Claim) -> bool:
    """Return whether a claim asks for more road users than a recipe has."""
    if claim.kind == "count":
        return claim.subject in ("vehicle", "car")
    return claim.kind == "traffic" and claim.value == "dense"


def _map_for(
    place: RoadKind, hazard: HazardKind, digest: CatalogueDigest, said: Sequence[Claim] = ()
) -> MapLine:
    """Return the map for which most claims of the text hold; among equals, the one most like the place."""
    fitting = roads_for(hazard, digest)
    if not fitting:
        raise LLMError("no map of the simulator fits the text", model="builtin")
    about_roads = of_roads(said)
    return max(
        fitting,
        key=lambda road: (
            sum(is_so(claim, road) for claim in about_roads),
            len(set(place.traits) & set(road.traits)),
        ),
    )


def _set(
    digest: CatalogueDigest,
    road: MapLine,
    recipe: Recipe,
    place: RoadKind,
    lane: int,
    rng: np.random.Generator,
) -> SceneDraftState:
    """Choose the ego's speed and set up the scene."""
    limits = place.speed if timing.scales(recipe) else recipe.speed
    wanted = round(float(rng.uniform(*limits)), 2)
    speed = round(min(wanted, road.speed_limit), 2)
    return SceneDraftState(
        digest=digest,
        road=road,
        recipe=recipe,
        rng=rng,
        speed=speed,
        slowed=speed / wanted,
        ego_lane=lane,
    )


def _timing(
    scene: SceneDraftState, friction: float, distance: float | None
) -> tuple[float, Trigger]:
    """Return the displacement of all actors along the road, m, and the decision's trigger.

    A distance in the text applies at the start of the scene; the decision comes later.
    """
    recipe, decision = scene.recipe, scene.recipe.decision
    value = scene.draw(decision.value)
    actor = timing.decisive(recipe)
    shift = 0.0
    if actor is not None and anchors(recipe, actor)[-1].at in LANDMARKS:
        if timing.scales(recipe):
            value = _room(scene, actor, friction)(scene.speed)
    elif actor is not None and timing.scales(recipe):
        away = _room(scene, actor, friction)
        middle = 0.5 * sum(actor.ahead)
        value = away(scene.speed)
        if distance is not None:
            while scene.speed > _LEAST_SPEED and value + 0.7 * scene.speed > distance:
                scene.speed = round(0.95 * scene.speed, 2)
                value = away(scene.speed)
            value = min(value, max(distance - 2.0, 1.0))
            shift = distance - middle
        else:
            shift = value + scene.speed * float(scene.rng.uniform(1.6, 3.0)) - middle
    elif actor is not None and distance is not None:
        low, high = actor.ahead
        shift = min(max(distance, low), high) - 0.5 * (low + high)
    if actor is not None and decision.kind == "ttc":
        value = _hurried(scene, actor, friction, value)
    return round(shift, 2), Trigger(kind=decision.kind, value=round(value, 2), actor=decision.actor)


def _hurried(scene: SceneDraftState, actor: RecipeActor, friction: float, seconds: float) -> float:
    """Return the TTC of the decision, reduced until the actor is large enough to recognise, s.

    In some scenes it is so short that only hard braking suffices.
    """
    draw, share = (float(draw) for draw in scene.rng.random(2))
    along = scene.along(actor)
    closing = scene.speed - along
    if closing < _LEAST_SPEED:
        return seconds
    reach = scene.reach(actor)
    hard = timing.braking(closing, friction) + reach + 1.0
    calm = max(timing.calm_braking(closing, friction) + reach, hard)
    least = _EVADING_S * closing if along < -1.0 else hard
    away = seconds * closing
    while away > least and scene.pixels(actor, away) < _CLEAR_PX:
        away *= 0.95
    if away < calm:
        scene.is_followed = False
    if actor.behaviour in STAYS and not scene.is_followed and draw < _HURRIED:
        late = timing.too_late_to_stop(closing, friction) + reach
        if late > hard:
            away = min(away, hard + 0.8 * share * (late - hard))
    return min(seconds, away / closing)


def _room(scene: SceneDraftState, actor: RecipeActor, friction: float) -> Callable[[float], float]:
    """Choose the distance that the decision leaves, as a function of the speed, m.

    It allows a comfortable stop or a lane change; or only hard braking; or, at speeds at which
    braking takes longer than that, only a lane change.
    """
    recipe, spare = scene.recipe, timing.spare(scene.recipe)
    late, urgent, share = (float(draw) for draw in scene.rng.random(3))
    is_inside = max(map(abs, actor.offset)) < _INSIDE
    if scene.is_followed:
        urgent = 1.0
    if recipe.width and is_inside and late < _LATE and scene.road.lanes > 1:
        low = timing.swerving(scene.speed, recipe.width, _ASIDE)
        high = timing.braking(scene.speed, friction)
        if low + 0.5 <= high - 1.5:
            scene.escape = 1 if scene.ego_lane + 1 < scene.road.lanes else -1
            aside = -scene.escape * _ASIDE
            moved = actor.model_copy(update={"offset": (aside - 0.05, aside + 0.05)})
            actors = tuple(moved if a is actor else a for a in recipe.actors)
            scene.recipe = recipe.model_copy(update={"actors": actors})
            value = low + share * (high - 1.5 - low)
            return lambda speed: value

    def is_unseen() -> bool:
        away = timing.late_room(scene.speed, friction) + spare
        return scene.pixels(actor, away) < _CLEAR_PX

    # Room for a calm stop is left behind a slower ego.
    while scene.is_followed and is_unseen() and scene.speed > _LEAST_FOLLOWED:
        scene.speed = round(0.95 * scene.speed, 2)
    if is_unseen():
        scene.is_followed = False

    def least(speed: float) -> float:
        return timing.braking(speed, friction) + 0.75 * spare

    def is_seen(speed: float) -> bool:
        return scene.pixels(actor, least(speed)) >= _SEEN_PX

    while not is_seen(scene.speed) and scene.speed > _LEAST_SPEED:
        scene.speed = round(0.95 * scene.speed, 2)
    if urgent < _URGENT or is_unseen():
        fast = _urgent_speed(scene, friction)
        fast = fast if fast and is_seen(fast) else None
        scene.speed = fast or scene.speed
        room = max(
            timing.too_late_to_stop(scene.speed, friction) - timing.braking(scene.speed, friction),
            0.0,
        )
        if fast or is_unseen():
            return lambda speed: (
                timing.braking(speed, friction) + 0.55 * spare + share * min(room, 4.0)
            )
    return lambda speed: timing.late_room(speed, friction) + (0.9 + 0.4 * share) * spare


def _urgent_speed(scene: SceneDraftState, friction: float) -> float | None:
    """Return the lowest speed, not below the ego's, at which the slowest driver can brake and the quickest cannot stop."""
    speed = scene.speed
    while speed <= scene.road.speed_limit:
        late = timing.too_late_to_stop(speed, friction)
        if late - timing.braking(speed, friction) >= _WINDOW_M:
            return round(speed, 2)
        speed *= 1.04
    return None
