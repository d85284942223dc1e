"""Staging: drafts a scene by recipe from a text and a catalogue's digest."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from oodscen._seeding import stream
from oodscen.author._knowledge.base import Knowledge, RoadKind
from oodscen.author._reading.claim_extraction import read_claims
from oodscen.author._reading.recognition import Recogniser
from oodscen.author._settings import places_of, roads_for
from oodscen.author._staging.actors import cast_all, named_traffic
from oodscen.author._staging.aside import recipe_aside
from oodscen.author._staging.background_traffic import (
    available,
    expected_decision_s,
    follower,
    surrounding_traffic,
    tailgater,
)
from oodscen.author._staging.counterpart_placing import moved_near, placed_counterpart
from oodscen.author._staging.decision import with_decision
from oodscen.author._staging.decision_distances import suits_any_speed
from oodscen.author._staging.lanes import with_ego_lane, with_variant
from oodscen.author._staging.layout import Cast, Layout
from oodscen.author._staging.told import Told
from oodscen.author._staging.weather import draw_weather
from oodscen.author._writing.ordinary_road_user import ordinary_road_user
from oodscen.claims._roads import holds_by_traits, road_claims
from oodscen.claims._things import may_be
from oodscen.data._scene import Actor, Ego, Hazard
from oodscen.driving._motion.behaviours.off_centre import off_centre
from oodscen.errors import LLMError
from oodscen.prompts._digest import CatalogueDigest, MapLine
from oodscen.prompts._scenario.stage_scene import SceneDraft, StageScene

_PLAIN_FROM = 2
"""Attempt, from 0, from which a scene has nothing beside the recipe that could be refused."""


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
        told = self._told(prompt)
        rng = stream(seed, "stage", prompt.text, attempt)
        layout = self._layout(told, prompt.catalogue, rng)
        kinds = available(self.knowledge.company, prompt.catalogue)
        behind = tailgater(kinds, layout, told)
        layout = with_decision(replace(layout, is_followed=behind is not None), told.distance_m)
        cast = cast_all(layout)
        if told.traffic is not None and told.traffic.actor is not None:
            cast = cast.joined_by(named_traffic(told.traffic.actor, layout, told.of_traffic))
        if behind is not None and (layout.is_followed or told.is_dense or told.is_followed):
            cast = cast.joined_by(follower(behind, layout, cast.actors))
        decisive = layout.decision.actor or next(iter(cast.unusual), None)
        decision = layout.decision
        if decision.kind != "time":
            decision = decision.model_copy(update={"actor": decisive})
        if attempt < _PLAIN_FROM:
            decision_s = expected_decision_s(decision, cast.actors, layout.speed)
            cast = _with_counterparts(cast, told, layout, decisive, decision_s)
            if told.traffic is None and layout.recipe.company:
                others = surrounding_traffic(
                    kinds, layout, cast.everyone, decision_s, is_dense=told.is_dense
                )
                cast = cast.joined_by(others)
        cast = _off_centre(cast, seed, told.text)
        if layout.ordinary_weather is None and not cast.unusual:
            raise LLMError(f"the recipe for {told.hazard.label!r} has no hazard", model="builtin")
        return SceneDraft(
            reasoning=(
                f"The text is about: {told.hazard.label}. It fits {layout.road.description}; the ego "
                f"drives at {layout.speed:g} m/s."
            ),
            map=layout.road.id,
            ego=Ego(speed=layout.speed, lane=layout.ego_lane),
            weather=layout.weather,
            actors=list(cast.actors),
            stands_for=_actors_of(prompt.things, cast, layout),
            hazard=Hazard(actors=dict(cast.unusual), weather=layout.ordinary_weather),
            decision=decision,
            horizon_s=layout.recipe.horizon,
        )

    def _told(self, prompt: StageScene) -> Told:
        """Read the text; its hazard is the one that it describes, or else the one that its leaf names."""
        text, hazard = prompt.text, self.recogniser.recognise(prompt.text).hazard
        if hazard is None and prompt.path:
            hazard, _ = self.recogniser.label(prompt.path[-1])
        if hazard is None:
            raise LLMError("the built-in author does not recognise the text", model="builtin")
        if hazard.stage is None:
            raise LLMError(
                f"the built-in author has no recipe to stage {hazard.label!r}", model="builtin"
            )
        return Told(
            text,
            hazard,
            hazard.stage,
            place=self.recogniser.place(text, hazard.places),
            conditions=self.recogniser.conditions(text, hazard),
            traffic=self.recogniser.traffic(text),
            claims=tuple(read_claims(text)),
        )

    def _layout(self, told: Told, digest: CatalogueDigest, rng: np.random.Generator) -> Layout:
        """Choose road, weather, and the ego's lane and speed."""
        place = self._place(told, rng)
        road = _map_for(place, told, digest)
        recipe = recipe_aside(with_variant(told.recipe, told.text), told.text, digest.by_name)
        weather, ordinary = draw_weather(recipe, told, self.knowledge, digest.limits, rng)
        recipe, lane = with_ego_lane(recipe, road, told.text, rng)
        speeds = place.speed if suits_any_speed(recipe) else recipe.speed
        usual_speed = round(float(rng.uniform(*speeds)), 2)
        speed = round(min(usual_speed, road.speed_limit), 2)
        return Layout(
            digest=digest,
            road=road,
            recipe=recipe,
            rng=rng,
            speed=speed,
            slowed=speed / usual_speed,
            ego_lane=lane,
            weather=weather,
            ordinary_weather=ordinary,
            named=told.named,
        )

    def _place(self, told: Told, rng: np.random.Generator) -> RoadKind:
        """Return the told kind of road if the hazard occurs there, or else one that it occurs on and that is most like it."""
        named, hazard = told.place, told.hazard
        if named is not None and named.key in hazard.places:
            return named
        fitting = places_of(hazard, self.knowledge)
        if named is not None:
            shared = [len(set(named.traits) & set(place.traits)) for place in fitting]
            most = max(shared)
            fitting = [place for place, count in zip(fitting, shared, strict=True) if count == most]
        return fitting[int(rng.integers(len(fitting)))]


def _map_for(place: RoadKind, told: Told, digest: CatalogueDigest) -> MapLine:
    """Return the map for which most claims of the text hold; among equals, the one most like the place."""
    fitting = roads_for(told.hazard, digest)
    if not fitting:
        raise LLMError("no map of the simulator fits the text", model="builtin")
    about_roads = road_claims(told.claims)
    return max(
        fitting,
        key=lambda road: (
            sum(holds_by_traits(claim, road) for claim in about_roads),
            len(set(place.traits) & set(road.traits)),
        ),
    )


def _with_counterparts(
    cast: Cast, told: Told, layout: Layout, decisive: str | None, decision_s: float
) -> Cast:
    """Give the twin an ordinary road user where the hazard is, a new one or one of its own that would drive away."""
    hazard = next((actor for actor in cast.actors if actor.id == decisive), None)
    if hazard is None:
        return cast
    road_user = ordinary_road_user(told.hazard, told.text, told.place)
    if road_user is not None and not told.is_quiet and hazard.id in cast.unusual:
        twin = placed_counterpart(road_user, layout, hazard, decision_s)
        return cast._replace(unusual={**cast.unusual, **twin})
    if layout.ordinary_weather is None:
        return cast._replace(unusual=moved_near(cast, layout, hazard, decision_s))
    return cast


def _off_centre(cast: Cast, seed: int, text: str) -> Cast:
    """Move road users a little beside the middle of their lanes, a hazard and its counterpart alike.

    Those that tow or carry another stay where they are.
    """
    tied = cast.tied

    def moved(actor: Actor) -> Actor:
        if actor.id in tied:
            return actor
        return off_centre(actor, stream(seed, "off centre", text, actor.id))

    unusual = {
        actor_id: None if counterpart is None else moved(counterpart)
        for actor_id, counterpart in cast.unusual.items()
    }
    return Cast([moved(actor) for actor in cast.actors], unusual)


def _actors_of(things: Sequence[str], cast: Cast, layout: Layout) -> dict[str, list[str]]:
    """Return for each thing of the claims the actors that its noun fits: unusual ones, or else others."""
    actors_of = {}
    for thing in things:
        fitting = [
            actor.id
            for actor in cast.actors
            if actor.asset in layout.assets and may_be(thing, layout.assets[actor.asset])
        ]
        unusual = [actor_id for actor_id in fitting if actor_id in cast.unusual]
        if fitting:
            actors_of[thing] = unusual or fitting
    return actors_of
