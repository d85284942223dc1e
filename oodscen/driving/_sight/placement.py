"""Checks that a scene can be staged and shows its hazard: vocabulary, placement, decision, visibility."""

import numpy as np
from numpy.typing import NDArray

from oodscen._arguments import checked
from oodscen.data._catalogue import Asset, BehaviourKind, Catalogue
from oodscen.data._episode import MOMENTS
from oodscen.data._scene import Actor, Scene
from oodscen.driving._motion.actions import Cruise
from oodscen.driving._motion.behaviours.table import BUILT_IN
from oodscen.driving._motion.world import KinematicWorld
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import DRIVABLE, Corridor, ego_strip, neighbour_strip
from oodscen.driving._sight.motion_places import motion_places
from oodscen.driving._sight.scene_checks import (
    PlacedBody,
    bodies,
    overlap_issues,
    touch,
    truth_issues,
)
from oodscen.errors import DataError, Issue, UnknownComponent, close_matches
from oodscen.protocols import camera_for

DT = 0.05
"""Seconds per step of the trial run."""
APPROACH_S = 15.0
"""Time from the start within which the decision must be reached, s."""

_RAIL_WORDS = frozenset({"rail", "train", "tram", "locomotive"})
"""Words of assets that drive on railway tracks."""
_VEHICLES = frozenset({"vehicle", "cyclist"})
"""Categories whose moving actors must start on drivable road."""
_NEAR_M = 0.01
"""Gap between the circles around two footprints up to which the bodies may touch, m."""
_INSIDE_M = 1e-6
"""Distance from the lane's left edge at which a place is still in the lane, m."""


@checked
def check_scene(scene: Scene, catalogue: Catalogue) -> list[Issue]:
    """Return the reasons why a scene, or its ordinary twin, cannot be staged; `Scene.check` describes the checks."""
    issues = staging_issues(scene, catalogue)
    if issues:
        return issues
    corridor = load_corridor(scene.map, catalogue)
    path, issues = _roll(scene, catalogue, corridor, within=APPROACH_S)
    if not issues:
        last = len(path) - 1
        shown = (bodies(scene, catalogue, path[step]) for step in (0, last // 2, last))
        moments = dict(zip(MOMENTS, shown, strict=True))
        issues = truth_issues(scene, corridor, moments, camera=camera_for(catalogue))
    if issues or scene.is_ordinary:
        return issues
    twin = scene.twin(round(last * DT, 6))
    return [
        Issue(_in_hazard(issue.path, scene, twin), f"in the ordinary twin: {issue.message}")
        for issue in staging_issues(twin, catalogue)
    ]


def staging_issues(scene: Scene, catalogue: Catalogue) -> list[Issue]:
    """Return issues of a scene's vocabulary and placement, without simulating it."""
    issues = catalogue.lacks(scene)
    catalogue = catalogue.for_scene(scene)
    kinds = {kind.id: kind for kind in catalogue.behaviours}
    playable = BUILT_IN.keys() | {motion.id for motion in scene.motions}
    issues += [
        Issue(
            f"{path}.behaviour.name",
            f"the catalogue does not say which built-in behaviour {actor.behaviour.name!r} is like",
        )
        for path, actor in _all_actors(scene)
        if (kind := kinds.get(actor.behaviour.name)) is not None
        and not playable & {kind.id, kind.built_in}
    ]
    try:
        corridor = load_corridor(scene.map, catalogue)
    except UnknownComponent as error:
        return issues or [Issue("map", str(error))]
    except DataError as error:
        return [*issues, *(Issue("map", f"{scene.map}: {issue}") for issue in error.issues)]
    if issues:
        return issues
    try:
        lane = ego_strip(corridor, scene.ego.lane)
    except ValueError as error:
        return [Issue("ego.lane", str(error))]
    issues += _map_state_issues(scene, corridor)
    for path, actor in _all_actors(scene):
        issues += _place_issues(path, actor, catalogue, corridor, lane)
    if not issues and scene.motions:
        issues += motion_places(scene, _all_actors(scene), corridor, lane)
    if issues:
        return issues
    world = KinematicWorld(corridor, scene, catalogue, 0)
    return overlap_issues(scene, corridor, {"first": bodies(scene, catalogue, world.poses())})


def vocabulary_advice(scene: Scene, catalogue: Catalogue) -> list[Issue]:
    """Return what to do about a scene with an asset that resembles none of the catalogue's, for who runs it."""
    known = [asset.id for asset in catalogue.for_scene(scene).assets]
    if all(
        actor.asset in known or close_matches(actor.asset, known) for _, actor in _all_actors(scene)
    ):
        return []
    advice = (
        f"the scene is not in the words of the catalogue {catalogue.simulator!r}: use the simulator that it was "
        "written for, or one that is made with the catalogue of that"
    )
    return [Issue("", advice)]


def _map_state_issues(scene: Scene, corridor: Corridor) -> list[Issue]:
    """Return an issue for every part that a scene changes but its map lacks."""
    if scene.map_state is None:
        return []
    kinds = {"signals": "traffic_light", "signs": "sign"}
    on_map = {signal.kind for signal in corridor.signals}
    return [
        Issue(f"map_state.{part}", f"{scene.map!r} has no {kinds[part].replace('_', ' ')}s")
        for part, _ in scene.map_state.faults()
        if part in kinds and kinds[part] not in on_map
    ]


def _all_actors(scene: Scene) -> list[tuple[str, Actor]]:
    """Return the actors and their ordinary counterparts with their paths in the scene."""
    named = [(f"actors[{index}]", actor) for index, actor in enumerate(scene.actors)]
    ordinary = [
        (f"hazard.actors.{key}", actor)
        for key, actor in scene.hazard.actors.items()
        if actor is not None
    ]
    return named + ordinary


def _place_issues(
    path: str, actor: Actor, catalogue: Catalogue, corridor: Corridor, ego_lane: int
) -> list[Issue]:
    """Return issues of an actor's lanes, and of its place along the map, across it and on it."""
    place = actor.placement
    try:
        lane = neighbour_strip(corridor, ego_lane, place.lane)
    except ValueError as error:
        hint = "; use offset_m for places beside the lanes"
        return [Issue(f"{path}.placement.lane", f"{error}{hint}")]
    kind = catalogue.behaviour(actor.behaviour.name)
    issues = _target_lane_issues(path, actor, kind, corridor, lane)
    s = corridor.start + place.ahead_m
    if not 0.0 <= s <= corridor.length:
        limits = f"{-corridor.start:.0f} to {corridor.length - corridor.start:.0f} m"
        message = f"{place.ahead_m:g} m is beyond the map, which reaches from {limits}"
        return [*issues, Issue(f"{path}.placement.ahead_m", message)]
    t = corridor.centre(lane, s) + place.offset_m
    right, left = corridor.extent(s)
    if not right <= t <= left and not corridor.is_on_map(s, t):
        low, high = right - corridor.centre(lane, s), left - corridor.centre(lane, s)
        message = (
            f"{place.offset_m:g} m is beside the map; here it reaches from {low:.1f} to {high:.1f}"
        )
        return [*issues, Issue(f"{path}.placement.offset_m", message)]
    return issues + _ground_issues(path, catalogue.asset(actor.asset), kind, corridor, (s, t))


def _target_lane_issues(
    path: str, actor: Actor, kind: BehaviourKind, corridor: Corridor, lane: int
) -> list[Issue]:
    """Return issues of the number of lanes by which an actor moves over."""
    if "lanes" not in kind.parameters:
        return []
    path = f"{path}.behaviour.parameters.lanes"
    lanes = actor.behaviour.parameters.get("lanes", kind.parameters["lanes"].default)
    issues = []
    try:
        neighbour_strip(corridor, lane, round(lanes))
    except ValueError as error:
        issues.append(Issue(path, str(error)))
    if lanes != round(lanes):
        issues.append(Issue(path, f"must be a whole number of lanes, not {lanes:g}"))
    return issues


def _ground_issues(
    path: str, asset: Asset, kind: BehaviourKind, corridor: Corridor, place: tuple[float, float]
) -> list[Issue]:
    """Return an issue for a vehicle that drives but starts beside the road, at a place (s, t)."""
    behaviour = BUILT_IN.get(kind.built_in)
    if asset.category not in _VEHICLES or behaviour is None:
        return []
    if not behaviour.moves_before_trigger and not behaviour.drives_from_rest:
        return []
    s, t = place
    _, left = corridor.extent(s)
    strip = corridor.strip_at(s, min(t, left - _INSIDE_M))
    ground = "none" if strip is None else corridor.strips[strip].kind
    if ground in DRIVABLE or corridor.is_drivable(s, t, t):
        return []
    is_on_rails = ground == "rail" or corridor.is_on_track(s, t)
    if is_on_rails and _RAIL_WORDS & {*asset.tags, *asset.id.split("_")}:
        return []
    position = "beside it" if ground == "none" else f"on a {ground!r} strip"
    message = (
        f"{asset.id!r} that drives must start on the road, not {position}; only one that stands or rolls away may, "
        "and a train on its track"
    )
    return [Issue(f"{path}.placement", message)]


def _roll(
    scene: Scene, catalogue: Catalogue, corridor: Corridor, *, within: float
) -> tuple[list[NDArray[np.float64]], list[Issue]]:
    """Drive blindly until the decision; return the poses of all bodies at every step, and the issues found."""
    world = KinematicWorld(corridor, scene, catalogue, 0, dt=DT)
    driver = Cruise()
    path: list[NDArray[np.float64]] = []
    while True:
        state, apart = world.publish()
        path.append(state.poses)
        near = np.flatnonzero(apart <= _NEAR_M)
        if state.off_road or len(near):
            cast = bodies(scene, catalogue, state.poses)
            if state.off_road:
                return path, [_early(world, f"{cast[0].at(scene, corridor)} leaves the road")]
            for row in near:
                if touch(cast[0], cast[row], ignores_flat=False):
                    event = f"{cast[0].at(scene, corridor)} touches {cast[row].at(scene, corridor)}"
                    return path, [_early(world, event)]
        if world.is_due(scene.decision):
            return path, []
        if world.time >= within:
            break
        world.step(driver.act(world.observe()))
    return path, [_late(scene, bodies(scene, catalogue, path[-1]), corridor, within)]


def _late(scene: Scene, cast: tuple[PlacedBody, ...], corridor: Corridor, within: float) -> Issue:
    """Return the issue of a decision that is not reached in time; `cast` are the bodies at the end of that time."""
    decision = scene.decision
    message = f"{decision.kind} {decision.value:g} is not reached within {within:g} s by an ego that keeps lane and speed"
    if decision.kind != "time":
        actor = next(body for body in cast if body.id == decision.actor)
        ego_s, _ = corridor.locate(cast[0].solid.x, cast[0].solid.y)
        actor_s, _ = corridor.locate(actor.solid.x, actor.solid.y)
        relation = "before" if actor_s > ego_s else "past"
        message += f"; by then the ego is {abs(actor_s - ego_s):.0f} m {relation} {actor}"
    return Issue("decision", message)


def _early(world: KinematicWorld, event: str) -> Issue:
    """Return the issue of a decision before which something ends the drive."""
    return Issue("decision", f"comes too late: after {world.time:.2f} s {event}")


def _in_hazard(path: str, scene: Scene, twin: Scene) -> str:
    """Translate a path in the twin to the original scene."""
    for index, actor in enumerate(twin.actors):
        prefix = f"actors[{index}]"
        if path.startswith(prefix):
            if actor.id in scene.hazard.actors:
                return f"hazard.actors.{actor.id}{path.removeprefix(prefix)}"
            row = [original.id for original in scene.actors].index(actor.id)
            return f"actors[{row}]{path.removeprefix(prefix)}"
    return path.replace("weather", "hazard.weather", 1) if path.startswith("weather") else path
