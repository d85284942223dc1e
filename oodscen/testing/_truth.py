"""Checks, on rendered frames, that a simulator shows a scene as specified."""

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from oodscen._arguments import checked
from oodscen.data._episode import ACTIONS, MOMENTS
from oodscen.data._scene import Scene
from oodscen.data._weather import CLEAR_AIR_M, Weather
from oodscen.driving._base_simulator import render_checked
from oodscen.driving._flat_frame import tangents
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor, ego_strip, neighbour_strip
from oodscen.driving._sight.scene_checks import PlacedBody, bodies, floating_issues, overlap_issues
from oodscen.driving._sight.visibility import Eye
from oodscen.errors import Issue, SceneError
from oodscen.protocols import Camera, Frame, Simulator, camera_for
from oodscen.stages._simulate import Simulated, simulate
from oodscen.testing._kit.shapes import depths, share_inside

FOGGY_M = 400.0
"""Visual range below which it is measured, m."""
RANGE_TOLERANCE = 0.2
"""Relative tolerance between the measured and the configured visual range."""
OVERCAST = 0.9
"""Cloud cover under which contrast is measured."""
PLACE_M = 0.75
"""Maximum distance between an actor's start and its placement, m."""

_BIN_EDGES_M = (3.0 * 1.25 ** np.arange(24)).tolist()
_LEAST_STEP = 3.0
"""Least grey-level step between neighbouring clear pixels for a meaningful ratio."""
_LEAST_STEPS = 60
"""Least number of such steps per bin."""
_LEAST_BINS = 3
"""Least number of bins that a visual range is fitted to."""
_LEAST_CONTRAST = 0.05
"""Least contrast of a bin that a visual range is fitted to, relative to the clear one."""
_DAYLIGHT_DEG = 10.0
"""Least sun elevation under which contrast is measured, degrees."""
_LEAST_PX = 40
"""Fewest pixels of a body whose place is checked."""
_MARGIN_PX = 4.0
"""Width of the margin around a body's silhouette in which its pixels may be."""
_WHEN = {"first": "at the start", "middle": "half-way", "last": "at the decision"}


@checked
def check_truth(
    scene: Scene, simulator: Simulator, *, seed: int = 0, camera: Camera | None = None
) -> list[Issue]:
    """Run a scene and return an issue for every difference between its states and frames and its specification.

    The checks: the hazard is visible in a key frame; the visual range, measured from contrast against
    depth, matches the configured one; actors start where the scene places them and appear where the states
    say; no body floats, sinks or overlaps another; the decision fires, the run repeats, and every action
    has an outcome.

    Args:
        scene: A scene without faults by `Scene.check`.
        simulator: The simulator to run it on.
        seed: Seed of the simulator's random streams.
        camera: The camera; the ego's dash camera by default.

    Returns:
        One issue per fault, with its path in the scene; empty if everything is true.
    """
    camera = camera_for(simulator.catalogue(), camera)
    try:
        simulated = simulate(scene, simulator, seed=seed, camera=camera)
    except SceneError as error:
        return list(error.issues)
    catalogue = simulator.catalogue()
    corridor = load_corridor(scene.map, catalogue)
    moments = {
        moment: bodies(scene, catalogue, simulated.state_of(moment).poses) for moment in MOMENTS
    }
    issues = _placement_issues(scene, corridor, moments["first"])
    issues += floating_issues(scene, corridor, moments) + overlap_issues(scene, corridor, moments)
    issues += _picture_issues(simulated.frames, moments, camera)
    if simulated.episode.hazard_visible is False:
        issues.append(_hidden_hazard(scene, simulated))
    issues += _record_issues(scene, simulated)
    if scene.weather.fog_visual_range_m <= FOGGY_M:
        issues += _fog_issues(scene, simulator, seed, camera)
    return issues


class _Contrast(NamedTuple):
    """The contrast in fog of all surfaces within a distance bin."""

    distance_m: float
    ratio: float
    """Foggy contrast over clear contrast."""
    steps: int
    """Number of grey-level steps that were compared."""


def _contrasts(frame: Frame, clear: Frame, camera: Camera) -> list[_Contrast]:
    """Return the contrasts of a foggy frame, by distance.

    Contrast is measured between neighbouring pixels of one surface, where lamps and haze vary slowly: per
    distance bin, the median ratio of the foggy step to the clear step, along rows and columns together.
    Shadows and headlamp beams distort it: compare frames of an overcast day.
    """
    u, v = tangents(camera)
    depth = np.where(np.isfinite(frame.depth), frame.depth, 0.0)
    distance = depth * np.sqrt(1.0 + u[None, :] ** 2 + v[:, None] ** 2)
    grey = frame.rgb.astype(np.float64).mean(axis=2)
    clear_grey = clear.rgb.astype(np.float64).mean(axis=2)
    is_ego = frame.ids == 1
    steps = []
    for one, other in (
        (np.s_[:-1, :], np.s_[1:, :]),
        (np.s_[:, :-1], np.s_[:, 1:]),
    ):
        near, gap = distance[one], np.abs(distance[other] - distance[one])
        step, clear_step = grey[other] - grey[one], clear_grey[other] - clear_grey[one]
        usable = (near > 0.0) & (gap < 0.1 * near) & (np.abs(clear_step) >= _LEAST_STEP)
        usable &= ~is_ego[one] & ~is_ego[other]
        steps.append((near[usable], step[usable] / clear_step[usable]))
    near, ratio = (np.concatenate(parts) for parts in zip(*steps, strict=True))
    contrasts = []
    for low, high in pairwise(_BIN_EDGES_M):
        inside = (near >= low) & (near < high)
        count = int(inside.sum())
        if count >= _LEAST_STEPS:
            median = float(np.median(ratio[inside]))
            contrasts.append(_Contrast(float(near[inside].mean()), median, count))
    return contrasts


def _fitted_visual_range(contrasts: Sequence[_Contrast]) -> float | None:
    """Return the distance at which contrast falls to 5 %, m; `None` if too few contrasts tell of it.

    In fog, the contrast at distance d is the clear contrast times exp(-3 d / range) (Koschmieder, 1924); one
    range is fitted to all bins.
    """
    visible = [contrast for contrast in contrasts if contrast.ratio >= _LEAST_CONTRAST]
    if len(visible) < _LEAST_BINS:
        return None
    x = np.array([contrast.distance_m for contrast in visible])
    y = np.log([contrast.ratio for contrast in visible])
    weights = np.array([contrast.steps * contrast.ratio**2 for contrast in visible])
    x_mean, y_mean = np.average(x, weights=weights), np.average(y, weights=weights)
    covariance = float(np.average((x - x_mean) * (y - y_mean), weights=weights))
    slope = covariance / float(np.average((x - x_mean) ** 2, weights=weights))
    return -math.log(20.0) / slope if slope < 0.0 else math.inf


def fog_fault(visual_range_m: float, camera: Camera, render: Callable[[float], Frame]) -> str:
    """Return how a fog differs from its visual range, or an empty string.

    Args:
        visual_range_m: The visual range of the scene.
        camera: The camera of the frames.
        render: Returns the frame of the same state with a visual range, m.
    """
    contrasts = _contrasts(render(visual_range_m), render(CLEAR_AIR_M), camera)
    measured_m = _fitted_visual_range(contrasts)
    if measured_m is None:
        is_opaque = len(contrasts) >= _LEAST_BINS and all(
            contrast.ratio < _LEAST_CONTRAST for contrast in contrasts
        )
        nearest_m = min((contrast.distance_m for contrast in contrasts), default=math.inf)
        if is_opaque and nearest_m < 0.5 * visual_range_m:
            return f"nothing shows through the fog at {nearest_m:.0f} m, with a visual range of {visual_range_m:.0f} m"
        return ""
    if abs(measured_m - visual_range_m) <= RANGE_TOLERANCE * visual_range_m:
        return ""
    if measured_m >= CLEAR_AIR_M:
        return (
            f"contrast does not fall with distance, with a visual range of {visual_range_m:.0f} m"
        )
    return (
        f"the visual range is {measured_m:.0f} m in the frame, {visual_range_m:.0f} m in the scene"
    )


def _placement_issues(
    scene: Scene, corridor: Corridor, cast: tuple[PlacedBody, ...]
) -> list[Issue]:
    """Return issues for actors that do not start where the scene says."""
    lane = ego_strip(corridor, scene.ego.lane)
    issues = []
    for index, actor in enumerate(scene.actors):
        if actor.behaviour.other is not None:
            continue
        placement, body = actor.placement, cast[index + 1]
        s = corridor.start + placement.ahead_m
        strip = neighbour_strip(corridor, lane, placement.lane)
        x, y, _, _ = corridor.point(s, corridor.centre(strip, s) + placement.offset_m)
        distance_m = math.dist((x, y), (body.solid.x, body.solid.y))
        if distance_m > PLACE_M:
            message = f"{body} starts {distance_m:.1f} m from where it is placed"
            issues.append(Issue(f"actors[{index}].placement", message))
    return issues


def _picture_issues(
    frames: Mapping[str, Frame], moments: Mapping[str, tuple[PlacedBody, ...]], camera: Camera
) -> list[Issue]:
    """Return issues for actors whose pixels are not where their boxes are."""
    issues: dict[str, Issue] = {}
    for moment, frame in frames.items():
        cast = moments[moment]
        eye = Eye(camera, cast[0].solid)
        for index, body in enumerate(cast[1:]):
            mask = frame.ids == index + 2
            if body.id in issues or mask.sum() < _LEAST_PX:
                continue
            outline = eye.silhouette(body.solid)
            path, where = f"actors[{index}]", _WHEN[moment]
            if not outline:
                issues[body.id] = Issue(path, f"{body} is behind the camera, yet shown {where}")
                continue
            if share_inside(mask, outline, _MARGIN_PX) < 0.9:
                issues[body.id] = Issue(path, f"{body} is shown beside its place {where}")
                continue
            low, high = depths(eye, body.solid)
            depth = float(np.median(frame.depth[mask]))
            if not low - 0.5 <= depth <= high + 0.5:
                message = (
                    f"{body} has a depth of {depth:.1f} m {where}, not {low:.1f} to {high:.1f} m"
                )
                issues[body.id] = Issue(path, message)
    return list(issues.values())


def _hidden_hazard(scene: Scene, simulated: Simulated) -> Issue:
    """Return an issue with the hazard's pixels in every frame."""
    counts = []
    for name in scene.hazard.actors:
        pixels = [
            f"{visible.get(name, 0)} px {_WHEN[moment]}"
            for moment, visible in simulated.episode.visible.items()
        ]
        counts.append(f"{name}: {', '.join(pixels)}")
    return Issue("hazard", f"cannot be seen in any frame ({'; '.join(counts) or 'weather'})")


def _record_issues(scene: Scene, simulated: Simulated) -> list[Issue]:
    """Return an issue for everything that the episode's record lacks."""
    episode, issues = simulated.episode, []
    if not episode.decision_fired:
        issues.append(Issue("decision", "the trigger never fires"))
    if not episode.is_deterministic:
        issues.append(Issue("", "the same scene and seed gave another trace"))
    if set(episode.actions) != set(ACTIONS):
        issues.append(Issue("", "the safe set is not recorded"))
    for moment, frame in simulated.frames.items():
        if frame.rgb.std() < 2.0 and scene.weather.fog_visual_range_m > FOGGY_M:
            issues.append(Issue("", f"the frame {_WHEN[moment]} is blank"))
        if not np.isfinite(frame.depth[frame.ids > 0]).all():
            issues.append(Issue("", f"a body in the frame {_WHEN[moment]} has no depth"))
    return issues


def _fog_issues(scene: Scene, simulator: Simulator, seed: int, camera: Camera) -> list[Issue]:
    """Measure the visual range of the scene's fog alone, at its start on an overcast day."""
    sun_elevation_deg = max(scene.weather.sun_elevation_deg, _DAYLIGHT_DEG)

    def render(visual_range_m: float) -> Frame:
        weather = Weather(
            fog_visual_range_m=visual_range_m,
            cloud_cover=OVERCAST,
            sun_elevation_deg=sun_elevation_deg,
        )
        state = simulator.reset(scene.model_copy(update={"weather": weather}), seed)
        return render_checked(simulator, camera, len(state.ids))

    fault = fog_fault(scene.weather.fog_visual_range_m, camera, render)
    return [Issue("weather.fog_visual_range_m", fault)] if fault else []
