"""Checks, on rendered frames, that a simulator shows a scene as specified."""

import math
from collections.abc import Callable, Mapping
from itertools import pairwise

import numpy as np

from oodscen._arguments import checked
from oodscen.data._episode import ACTIONS, MOMENTS
from oodscen.data._scene import CLEAR_AIR_M, Scene, Weather
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

_SLICES = (3.0 * 1.25 ** np.arange(24)).tolist()
"""Bounds of the distance bins, m."""
_LEAST_STEP = 3.0
"""Minimum grey-level step between neighbouring clear pixels for a meaningful ratio."""
_LEAST_STEPS = 60
"""Minimum number of such steps per bin."""
_LEAST_RATIO = 0.05
_DAYLIGHT_DEG = 10.0
_LEAST_PX = 40
_MARGIN_PX = 4.0
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
    issues = _misplaced(scene, corridor, moments["first"])
    issues += floating_issues(scene, corridor, moments) + overlap_issues(scene, corridor, moments)
    issues += _unlike(simulated.frames, moments, camera)
    if simulated.episode.hazard_visible is False:
        issues.append(_unseen(scene, simulated))
    issues += _outcomes(scene, simulated)
    if scene.weather.fog_visual_range_m <= FOGGY_M:
        issues += _fog(scene, simulator, seed, camera)
    return issues


def measured_visual_range(frame: Frame, clear: Frame, camera: Camera) -> float | None:
    """Return the distance at which contrast falls to 5 %, measured from two frames, m.

    In fog, the contrast at distance d is the clear contrast times exp(-3 d / range) (Koschmieder,
    1924). It is measured between neighbouring pixels of one surface, where lamps and haze vary slowly:
    per distance bin, the median ratio of the foggy step to the clear step. One range is then fitted to
    all bins. Shadows and headlamp beams distort the result: compare frames of an overcast day.

    Args:
        frame: The frame in fog.
        clear: The frame of the same state without fog.
        camera: The camera of both frames.

    Returns:
        `None` if the frames have too little contrast.
    """
    u, v = tangents(camera)
    away = np.where(np.isfinite(frame.depth), frame.depth, 0.0)
    distance = away * np.sqrt(1.0 + u[None, :] ** 2 + v[:, None] ** 2)
    grey, clear_grey = (one.rgb.astype(np.float64).mean(axis=2) for one in (frame, clear))
    far, fades, weights = [], [], []
    for axis in (0, 1):
        first, second = (
            tuple(part if axis == one else slice(None) for one in (0, 1))
            for part in (slice(None, -1), slice(1, None))
        )
        near, step = distance[first], np.abs(distance[second] - distance[first])
        before, after = clear_grey[second] - clear_grey[first], grey[second] - grey[first]
        usable = (near > 0.0) & (step < 0.1 * near) & (np.abs(before) >= _LEAST_STEP)
        usable &= (frame.ids[first] != 1) & (frame.ids[second] != 1)
        for low, high in pairwise(_SLICES):
            inside = usable & (near >= low) & (near < high)
            count = int(inside.sum())
            if count < _LEAST_STEPS:
                continue
            ratio = float(np.median(after[inside] / before[inside]))
            if ratio >= _LEAST_RATIO:
                far.append(float(near[inside].mean()))
                fades.append(math.log(ratio))
                weights.append(count * ratio * ratio)
    if len(far) < 3:
        return None
    x, y, w = np.array(far), np.array(fades), np.array(weights)
    x_mean, y_mean = np.average(x, weights=w), np.average(y, weights=w)
    slope = float(np.average((x - x_mean) * (y - y_mean), weights=w)) / float(
        np.average((x - x_mean) ** 2, weights=w)
    )
    return -math.log(20.0) / slope if slope < 0.0 else math.inf


def fog_fault(wanted: float, camera: Camera, seen: Callable[[float], Frame]) -> str:
    """Return how a fog differs from its visual range in m, or an empty string.

    Args:
        wanted: The visual range of the scene, m.
        camera: The camera of the frames.
        seen: Returns the frame of the same state with a visual range.
    """
    found = measured_visual_range(seen(wanted), seen(CLEAR_AIR_M), camera)
    if found is None or abs(found - wanted) <= RANGE_TOLERANCE * wanted:
        return ""
    return f"the visual range is {found:.0f} m in the frame, {wanted:.0f} m in the scene"


def _misplaced(scene: Scene, corridor: Corridor, cast: tuple[PlacedBody, ...]) -> list[Issue]:
    """Return issues for actors that do not start where the scene says."""
    lane = ego_strip(corridor, scene.ego.lane)
    issues = []
    for index, actor in enumerate(scene.actors):
        if actor.behaviour.other is not None:
            continue
        place, body = actor.placement, cast[index + 1]
        s = corridor.start + place.ahead_m
        t = corridor.centre(neighbour_strip(corridor, lane, place.lane), s) + place.offset_m
        x, y, _, _ = corridor.point(s, t)
        apart = math.dist((x, y), (body.solid.x, body.solid.y))
        if apart > PLACE_M:
            message = f"{body} starts {apart:.1f} m from where it is placed"
            issues.append(Issue(f"actors[{index}].placement", message))
    return issues


def _unlike(
    frames: Mapping[str, Frame], moments: Mapping[str, tuple[PlacedBody, ...]], camera: Camera
) -> list[Issue]:
    """Return issues for actors whose pixels are not where their boxes are."""
    issues: dict[str, Issue] = {}
    for moment, frame in frames.items():
        cast = moments[moment]
        eye = Eye(camera, cast[0].solid)
        for row, body in enumerate(cast):
            mask = frame.ids == row + 1
            if row == 0 or body.id in issues or mask.sum() < _LEAST_PX:
                continue
            outline = eye.silhouette(body.solid)
            path, where = f"actors[{row - 1}]", _WHEN[moment]
            if not outline:
                issues[body.id] = Issue(path, f"{body} is behind the camera, yet shown {where}")
                continue
            if share_inside(mask, outline, _MARGIN_PX) < 0.9:
                issues[body.id] = Issue(path, f"{body} is shown beside its place {where}")
                continue
            low, high = depths(eye, body.solid)
            depth = float(np.median(frame.depth[mask]))
            if not low - 0.5 <= depth <= high + 0.5:
                what = f"{body} has a depth of {depth:.1f} m {where}, not {low:.1f} m"
                issues[body.id] = Issue(path, what)
    return list(issues.values())


def _unseen(scene: Scene, simulated: Simulated) -> Issue:
    shown = simulated.episode.visible
    counts = [
        f"{name}: "
        + ", ".join(f"{shown[moment].get(name, 0)} px {_WHEN[moment]}" for moment in shown)
        for name in scene.hazard.actors
    ]
    return Issue("hazard", f"cannot be seen in any frame ({'; '.join(counts) or 'weather'})")


def _outcomes(scene: Scene, simulated: Simulated) -> list[Issue]:
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
        hit = frame.ids > 0
        if not np.isfinite(frame.depth[hit]).all():
            issues.append(Issue("", f"a body in the frame {_WHEN[moment]} has no depth"))
    return issues


def _fog(scene: Scene, simulator: Simulator, seed: int, camera: Camera) -> list[Issue]:
    """Measure the visual range of the scene's fog alone, at its start on an overcast day."""
    wanted = scene.weather.fog_visual_range_m
    sun = max(scene.weather.sun_elevation_deg, _DAYLIGHT_DEG)

    def seen(visual_range: float) -> Frame:
        weather = Weather(
            fog_visual_range_m=visual_range, cloud_cover=OVERCAST, sun_elevation_deg=sun
        )
        state = simulator.reset(scene.model_copy(update={"weather": weather}), seed)
        return render_checked(simulator, camera, len(state.ids))

    fault = fog_fault(wanted, camera, seen)
    return [Issue("weather.fog_visual_range_m", fault)] if fault else []
