"""The ordinary demand of a scene: drawn, checked like a scene, and run."""

from collections.abc import Mapping
from typing import NamedTuple

from pydantic import ValidationError

from oodscen.claims._checking import check_claims, mismatches
from oodscen.data._episode import Episode
from oodscen.data._pairing import demand_id
from oodscen.data._scene import (
    DARK_DEG,
    FOG_M,
    Actor,
    Demand,
    Hazard,
    Precipitation,
    Scene,
    Trigger,
    Weather,
)
from oodscen.driving import check_scene
from oodscen.errors import Issue, SceneError
from oodscen.stages._demands.kinds import Candidate, ranked_candidates
from oodscen.stages._demands.setting import Draft, Setting
from oodscen.stages._rerun import Rerunner
from oodscen.stages._simulate import VISIBLE_PX, Simulated

_SEEN = 4.0
"""Multiple of the least visible pixels that a demand must show at the decision."""


class Demanding(NamedTuple):
    """A demand that was run."""

    scene: Scene
    simulated: Simulated


def draw_demand(scene: Scene, simulated: Simulated, rerunner: Rerunner) -> Demanding:
    """Return the ordinary demand of a scene, and its run.

    It has the scene's map, ego and ordinary weather, and is decided at the same time. Kinds are tried in an
    order drawn by their likeness to the hazard, until one is accepted by the checks of a scene, is seen, leaves
    an action safe, and is unsafe for a driver who keeps the speed. One in which some or all drivers may keep the
    speed is the last resort.

    Args:
        scene: A scene that was run.
        simulated: Its run.
        rerunner: Runs the trials.

    Raises:
        SceneError: When no kind fits.
    """
    catalogue = rerunner.simulator.catalogue()
    at = Setting.of(scene, catalogue, simulated.trace, simulated.episode.sketch)
    resort: Demanding | None = None
    calm: set[str] = set()
    for candidate in ranked_candidates(scene, at, rerunner.seed, _company(scene)):
        if candidate.kind.id in calm:
            continue
        one = _stage(scene, at, candidate)
        if one is None or check_scene(one, catalogue):
            continue
        assert one.demand is not None
        if mismatches(check_claims(one.demand.claims, one, catalogue)):
            continue
        try:
            run = rerunner.run(one, simulated)
        except SceneError:
            continue
        if not _is_fair(run.episode, candidate.draft):
            continue
        if run.episode.label("keep_speed") == "unsafe":
            return Demanding(one, run)
        resort = resort or Demanding(one, run)
        calm.add(candidate.kind.id)
    if resort is None:
        fault = Issue("demand", "no kind of ordinary demand fits the scene")
        raise SceneError(demand_id(scene.id), [fault])
    return resort


def _stage(scene: Scene, at: Setting, candidate: Candidate) -> Scene | None:
    """Return the scene of a candidate; `None` if its values are out of range."""
    kind, draft = candidate.kind, candidate.draft
    weather = scene.hazard.weather or scene.weather
    text = f"{_opening(at, weather)} {draft.event[0].upper()}{draft.event[1:]}."
    try:
        demand = Demand(kind=kind.id, text=text, claims=tuple(draft.claims))
        return Scene(
            id=demand_id(scene.id),
            scenario_id=scene.scenario_id,
            map=scene.map,
            ego=scene.ego,
            weather=weather,
            actors=candidate.actors,
            hazard=Hazard(),
            decision=Trigger(kind="time", value=round(at.decision_s, 6)),
            horizon_s=scene.horizon_s,
            demand=demand,
        )
    except ValidationError:
        return None


def _company(scene: Scene) -> tuple[Actor, ...]:
    """Return the traffic that drives along in a scene and has nothing to do with its hazard."""
    return tuple(
        one
        for one in scene.actors
        if one.id not in scene.hazard.actors
        and one.behaviour.name == "follow_lane"
        and one.behaviour.other is None
    )


def _is_fair(episode: Episode, draft: Draft) -> bool:
    """Return whether a run is decided, an action is safe, and the demand can be seen."""
    pixels = episode.visible.get("last", {})
    pixels_of_draft = sum(pixels.get(one.id, 0) for one in draft.actors)
    is_seen = not episode.visible or pixels_of_draft >= _SEEN * VISIBLE_PX
    is_decided = episode.decision_fired and episode.is_deterministic
    return is_seen and is_decided and bool(episode.safe_set)


_PLACES = (
    ("tunnel", "a road that runs through a tunnel"),
    ("bridge", "a road that crosses a bridge"),
    ("roundabout", "a road that leads to a roundabout"),
    ("signalised", "an avenue that leads to a junction with traffic lights"),
    ("t_junction", "a residential street that a side street joins"),
    ("highway", "a highway"),
    ("residential", "a residential street"),
    ("urban", "a city street"),
    ("rural", "a country road"),
)
"""Names of roads by the first trait that a map has."""
_FALLING: Mapping[Precipitation, str] = {"rain": " in the rain", "snow": " while it snows"}


def _opening(at: Setting, weather: Weather) -> str:
    """Return a sentence with place, time and weather."""
    place = next((name for trait, name in _PLACES if at.has(trait)), "a road")
    when = " at night" if weather.sun_elevation_deg < DARK_DEG else ""
    if weather.precipitation != "none":
        when += _FALLING[weather.precipitation]
    elif weather.fog_visual_range_m < FOG_M:
        when += " in fog"
    return f"The ego vehicle drives along {place}{when}."
