"""Check of part `pictures`: pictures of many bodies follow the state, step for step and back."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from oodscen._abilities import Snapshots
from oodscen.data._scene import Scene, Trigger
from oodscen.driving._flat_frame import tangents
from oodscen.driving._motion.behaviours.table import DRIVES_IN_LANE
from oodscen.driving._motion.triggers import ROUNDING_S
from oodscen.driving._sight.outlines import area
from oodscen.driving._sight.scene_checks import PlacedBody, bodies
from oodscen.driving._sight.visibility import Eye
from oodscen.driving._staged_scene import StagedScene
from oodscen.protocols import Camera, Control, Frame, State
from oodscen.testing._kit.probe import Probe
from oodscen.testing._kit.samples import frame_bytes
from oodscen.testing._kit.shapes import place_faults

STILL = (
    (17.0, 3.2, 20.0),
    (27.0, -2.8, 0.0),
    (32.0, 5.0, 0.0),
    (40.0, -2.8, 0.0),
    (47.0, 3.2, 0.0),
)
"""Places of standing bodies beside the road: metres ahead and to the left, and degrees."""
LEAST_M = 0.4
"""Way, m, after which two pictures are compared: one step at the usual `dt`."""
_SPEED = 10.0
_WALKS = ("walk_along", "cross_road", "dart", "bolt")
_TURNS = ("u_turn", "swerve", "pull_out", "cut_in")
_AT_S = (0.6, 1.2, 2.0)
"""Times of the pictures in which all bodies are looked for, s."""
_LEAST_PX = 50
"""Fewest pixels of a body whose motion is measured in pictures."""


def check_following(probe: Probe) -> None:
    """Check that pictures show many bodies where they are: a step later, seconds later, after `restore`."""
    simulator, scene = probe.simulator, _scene(probe)
    watched = _Watched(probe, scene, probe.staged(scene), probe.camera(240, 180))
    first = _look(watched, simulator.reset(scene, 0), "at the start")
    state = first.state
    while _way(first.state, state, 0) < LEAST_M and state.time < 0.5:
        state = simulator.step(Control())
    if state.step:
        later = _look(watched, state, f"after {state.time:.2f} s")
        _check_lag(watched, first, later)
    look, snapshot = first, None
    for seconds in _AT_S:
        while state.time < seconds - ROUNDING_S:
            state = simulator.step(Control(0.0, 0.005))
        seen = _look(watched, state, f"after {seconds:g} s")
        if snapshot is None and isinstance(simulator, Snapshots):
            look, snapshot = seen, simulator.snapshot()
    if isinstance(simulator, Snapshots):
        state = simulator.restore(snapshot)
        seen = _look(watched, state, "right after restore()")
        is_same = probe.states_only or frame_bytes(seen.frame) == frame_bytes(look.frame)
        what = "is another picture than when the snapshot was taken"
        probe.findings.expect(is_same, "right after restore()", what)


class _Watched(NamedTuple):
    """A scene, as it is looked at."""

    probe: Probe
    scene: Scene
    staged: StagedScene
    camera: Camera


class _Look(NamedTuple):
    """A picture of a state, and what the library draws of it."""

    state: State
    cast: tuple[PlacedBody, ...]
    frame: Frame
    drawn: Frame


def _scene(probe: Probe) -> Scene:
    """Return a scene of standing bodies on both sides, one that drives, one that walks and one that turns, if there are any."""
    box = probe.box_like
    actors = [
        probe.still(box, id=f"s{number}", ahead=ahead, offset=offset, heading=heading)
        for number, (ahead, offset, heading) in enumerate(STILL)
    ]
    known = {kind.id: kind for kind in probe.catalogue.behaviours}
    drives = [one for one in sorted(DRIVES_IN_LANE, key="follow_lane".__ne__) if one in known]
    places = ((drives, (22.0, 0.0)), (_WALKS, (33.0, -2.6)), (_TURNS, (45.0, 0.0)))
    for names, place in places:
        name = next((one for one in names if one in known), None)
        if name is None:
            continue
        parameters = {"speed": _SPEED, "lanes": 0.0} if names is drives else {}
        actor = probe.doing(
            name,
            id=name.replace("_", "-"),
            trigger=Trigger(value=0.1),
            parameters={
                parameter: parameters[parameter]
                for parameter in parameters
                if parameter in known[name].parameters
            },
        )
        ahead, offset = place
        placement = actor.placement.model_copy(update={"ahead_m": ahead, "offset_m": offset})
        actors.insert(2, actor.model_copy(update={"placement": placement}))
    return probe.scene(*actors, speed=_SPEED)


def _look(watched: _Watched, state: State, when: str) -> _Look:
    """Render a state, and compare the picture with it."""
    probe, scene, staged, camera = watched
    frame = probe.simulator.render(camera)
    drawn = staged.draw(camera, state.poses)
    cast = bodies(scene, probe.catalogue, state.poses)
    for fault in place_faults(frame, camera, cast, drawn):
        probe.findings.add(f"many bodies {when}", fault)
    return _Look(state, cast, frame, drawn)


def _check_lag(watched: _Watched, first: _Look, later: _Look) -> None:
    """Check that bodies moved in the pictures as in the states: half a step's way is too much."""
    probe, camera = watched.probe, watched.camera
    ego = _way(first.state, later.state, 0)
    for row, (before, after) in enumerate(zip(first.cast, later.cast, strict=True)):
        points = [_middle(look, camera, row) for look in (first, later)]
        if row == 0 or points[0] is None or points[1] is None:
            continue
        ways = [way for way in (ego, _way(first.state, later.state, row)) if way >= 0.5 * LEAST_M]
        eyes = [Eye(camera, look.cast[0].solid) for look in (first, later)]
        places = [
            np.array(eye.to_camera((body.solid.x, body.solid.y, body.solid.z)))
            for eye, body in zip(eyes, (before, after), strict=True)
        ]
        off = float(np.linalg.norm((points[1] - points[0]) - (places[1] - places[0])))
        if ways and off > 0.5 * min(ways):
            what = f"{after.id!r} moved in the picture by {off:.2f} m otherwise than in the state"
            probe.findings.add(f"after {later.state.time:.2f} s", what)


def _way(one: State, other: State, row: int) -> float:
    """Return how far a body moved between two states, m."""
    return float(np.linalg.norm(other.poses[row, :2] - one.poses[row, :2]))


def _middle(look: _Look, camera: Camera, row: int) -> NDArray[np.float64] | None:
    """Return the mean of what a picture shows of a body, in camera coordinates; `None` if it is not seen whole."""
    eye = Eye(camera, look.cast[0].solid)
    whole = area(eye.silhouette(look.cast[row].solid))
    mask = look.frame.ids == row + 1
    if (look.drawn.ids == row + 1).sum() < max(_LEAST_PX, 0.9 * whole) or mask.sum() < _LEAST_PX:
        return None
    u, v = tangents(camera)
    rows, columns = np.nonzero(mask)
    depth = look.frame.depth[mask].astype(np.float64)
    return np.array([(u[columns] * depth).mean(), (v[rows] * depth).mean(), depth.mean()])
