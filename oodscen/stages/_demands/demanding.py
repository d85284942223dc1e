"""The ordinary demand of a scene: drawn, checked like a scene, and run."""

import math
from collections.abc import Iterable, Iterator, Mapping
from itertools import islice
from typing import NamedTuple

from oodscen._io.jpeg import to_jpeg
from oodscen.claims._checking import check_claims, mismatches
from oodscen.data._episode import Episode
from oodscen.data._pairing import demand_id
from oodscen.data._scene import Actor, Demand, Hazard, Scene, Trigger
from oodscen.data._weather import DARK_DEG, FOG_M, Precipitation, Weather
from oodscen.driving._base_simulator import render_checked
from oodscen.driving._sight.placement import check_scene
from oodscen.errors import DataError, Issue, SceneError
from oodscen.protocols import camera_for
from oodscen.stages._demands.kinds import Candidate, ranked_candidates
from oodscen.stages._demands.setting import Draft, Setting
from oodscen.stages._restaging.rerun import Rerunner
from oodscen.stages._simulate import VISIBLE_PX, Simulated, approach

_SEEN = 4.0
"""Multiple of the least visible pixels that a demand must show at the decision."""
_COMPARED = 4
"""Candidates at a time whose pictures are compared with that of the rare scene."""
_FULLER = 3.0
"""Weight of a difference in a picture that is fuller than the rare scene's: most are, so the others are preferred."""


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


class DemandRun(NamedTuple):
    """A demand and its run."""

    scene: Scene
    simulated: Simulated


def draw_demand(scene: Scene, simulated: Simulated, rerunner: Rerunner) -> DemandRun:
    """Return the ordinary demand of a scene, and its run.

    It has the scene's map, ego and ordinary weather, and is decided at the same time. Kinds are tried in an
    order drawn by their likeness to the hazard, of every few the one first whose picture holds about as much as the
    scene's, until one is accepted by the checks of a scene, is seen, leaves an action safe, and is unsafe for a
    driver who keeps the speed. One in which some or all drivers may keep the speed is the last resort.

    Raises:
        SceneError: When no kind fits.
    """
    catalogue = rerunner.simulator.catalogue()
    setting = Setting.of(scene, catalogue, simulated.trace, simulated.episode.sketch)
    last_resort: Scene | None = None
    calm_kinds: set[str] = set()
    ranked = ranked_candidates(scene, setting, rerunner.seed, _company(scene))
    for candidate, demand in _alike_first(_admitted(scene, setting, ranked), simulated, rerunner):
        if candidate.kind.id in calm_kinds:
            continue
        try:
            episode = rerunner.keep_speed(demand)
        except SceneError:
            continue
        if not _is_shown(episode, candidate.draft):
            continue
        # Most candidates are calm; what else an ego may do there need not be known.
        if episode.label("keep_speed") != "safe":
            run = rerunner.run(demand, simulated)
            if not (_is_shown(run.episode, candidate.draft) and run.episode.safe_set):
                continue
            if run.episode.label("keep_speed") == "unsafe":
                return DemandRun(demand, run)
        last_resort = last_resort or demand
        calm_kinds.add(candidate.kind.id)
    if last_resort is None:
        fault = Issue("demand", "no kind of ordinary demand fits the scene")
        raise SceneError(demand_id(scene.id), [fault])
    return DemandRun(last_resort, rerunner.run(last_resort, simulated))


class _Staged(NamedTuple):
    """A candidate and its scene."""

    candidate: Candidate
    scene: Scene


def _admitted(scene: Scene, setting: Setting, ranked: Iterable[Candidate]) -> Iterator[_Staged]:
    """Yield the candidates that the checks of a scene accept, in their order."""
    for candidate in ranked:
        demand = _stage(scene, setting, candidate)
        if demand is None or check_scene(demand, setting.catalogue):
            continue
        if not mismatches(check_claims(candidate.draft.claims, demand, setting.catalogue)):
            yield _Staged(candidate, demand)


def _alike_first(
    staged: Iterable[_Staged], simulated: Simulated, rerunner: Rerunner
) -> Iterator[_Staged]:
    """Yield candidates, of every few those first whose picture holds about as much as the rare scene's.

    How much a picture holds is the size of its file. Stripes, lights and parked cars make pictures fuller than
    what lies in the road does: without this, the fuller picture of two would be the ordinary one.
    """
    frame = simulated.frames.get("last")
    if frame is None:
        yield from staged
        return
    rare_bytes = len(to_jpeg(frame.rgb))
    rest = iter(staged)
    while few := list(islice(rest, _COMPARED)):
        few.sort(key=lambda one: _difference(rare_bytes, _picture_bytes(one.scene, rerunner)))
        yield from few


def _difference(rare_bytes: float, other_bytes: float) -> float:
    """Return how much a picture differs in file size from the rare scene's, as a logarithm."""
    difference = math.log(other_bytes / rare_bytes)
    return difference * _FULLER if difference > 0.0 else -difference


def _picture_bytes(scene: Scene, rerunner: Rerunner) -> float:
    """Return the size of the picture file at a scene's decision, bytes; infinite where there is none."""
    simulator = rerunner.simulator
    try:
        state = approach(scene, simulator, rerunner.seed)[0][-1]
        camera = camera_for(simulator.catalogue(), rerunner.camera)
        return float(len(to_jpeg(render_checked(simulator, camera, len(state.ids)).rgb)))
    except SceneError:
        return math.inf


def _stage(scene: Scene, setting: Setting, candidate: Candidate) -> Scene | None:
    """Return the scene of a candidate; `None` if its values are out of range."""
    kind, draft = candidate.kind, candidate.draft
    weather = scene.hazard.weather or scene.weather
    text = f"{_opening(setting, weather)} {draft.event[0].upper()}{draft.event[1:]}."
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
            decision=Trigger(kind="time", value=round(setting.decision_s, 6)),
            horizon_s=scene.horizon_s,
            demand=demand,
        )
    except DataError:
        return None


def _company(scene: Scene) -> tuple[Actor, ...]:
    """Return the traffic that drives along in a scene and has nothing to do with its hazard."""
    return tuple(
        actor
        for actor in scene.actors
        if actor.id not in scene.hazard.actors
        and actor.behaviour.name == "follow_lane"
        and actor.behaviour.other is None
    )


def _is_shown(episode: Episode, draft: Draft) -> bool:
    """Return whether a run is decided, and the demand can be seen."""
    by_actor = episode.visible.get("last", {})
    pixels = sum(by_actor.get(actor.id, 0) for actor in draft.actors)
    is_seen = not episode.visible or pixels >= _SEEN * VISIBLE_PX
    return is_seen and episode.decision_fired and episode.is_deterministic


def _opening(setting: Setting, weather: Weather) -> str:
    """Return a sentence with place, time and weather."""
    place = next((name for trait, name in _PLACES if setting.has(trait)), "a road")
    when = " at night" if weather.sun_elevation_deg < DARK_DEG else ""
    if weather.precipitation != "none":
        when += _FALLING[weather.precipitation]
    elif weather.fog_visual_range_m < FOG_M:
        when += " in fog"
    return f"The ego vehicle drives along {place}{when}."
