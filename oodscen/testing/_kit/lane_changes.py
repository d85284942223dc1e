"""Part about lane changes: in every step a driver covers what its speed says, without a jump."""

import math
from itertools import pairwise

import numpy as np

from oodscen.data._catalogue import RoadMap
from oodscen.data._scene import Trigger
from oodscen.driving._motion.behaviours.table import having
from oodscen.protocols import Control
from oodscen.testing._kit.findings import NotApplicable
from oodscen.testing._kit.probe import Probe
from oodscen.testing._kit.samples import constantly
from oodscen.testing._kit.tracks import Tracks, turned_by

JUMP_M = 0.05
"""Tolerance of the way in one step against the speed, m; and a tenth of the way."""
SLIDE_DEG = 20.0
"""Angle between heading and motion that is no jump to the side, degrees."""
_TURN_DEG = 5.0
"""Turn of the heading in one step that no driver makes, degrees."""
_SECONDS = 4.5
"""Length of a run, s: the change begins after half a second and takes three or less."""
_CHANGES_LANE = having(lambda row: row.plain_action == "lane_change")


def check_lane_changes(probe: Probe) -> None:
    """Check one lane change on every map that has two lanes in one direction.

    Raises:
        NotApplicable: If there is no such map, or no behaviour changes lanes.
    """
    names = [kind.id for kind in probe.catalogue.behaviours if kind.id in _CHANGES_LANE]
    if not names:
        raise NotApplicable("no behaviour changes lanes")
    roads = [road for road in probe.catalogue.maps if road.lanes > 1]
    if not roads:
        raise NotApplicable("no map has two lanes in one direction")
    for road in roads:
        subject = f"map {road.id}"
        with probe.findings.trying(subject):
            fault = _fault(probe, names[0], road)
            probe.findings.expect(not fault, subject, fault)


def _fault(probe: Probe, name: str, road: RoadMap) -> str:
    """Return how a driver's motion in a lane change from the left contradicts its speed; empty if it does not."""
    kind = probe.catalogue.behaviour(name)
    wanted = {"speed": 10.0, "lanes": -1.0, "duration": 3.0}
    actor = probe.doing(
        name,
        ahead=25.0,
        lane=1,
        trigger=Trigger(value=0.5),
        parameters={key: value for key, value in wanted.items() if key in kind.parameters},
    )
    scene = probe.scene(actor, road=road, speed=8.0)
    if not probe.can_stage(scene, f"a lane change on {road.id}"):
        return ""
    dt = probe.simulator.dt
    states = probe.run(scene, constantly(Control()), steps=round(_SECONDS / dt))
    return step_fault(Tracks.of(states, dt), 1)


def step_fault(tracks: Tracks, row: int) -> str:
    """Return the first step in which a body jumps: its way differs from its speed, or it turns at once."""
    poses, speeds = tracks.poses[:, row], tracks.speeds[:, row]
    for step, (start, end) in enumerate(pairwise(poses), start=1):
        when = f"in a lane change, after {step * tracks.dt:.2f} s"
        turn_deg = turned_by(float(end[3]), float(start[3]))
        yaw = start[3] + 0.5 * math.radians(turn_deg)
        way = end[:2] - start[:2]
        along = float(way @ (math.cos(yaw), math.sin(yaw)))
        across = float(way @ (-math.sin(yaw), math.cos(yaw)))
        expected = float(np.mean(speeds[step - 1 : step + 1])) * tracks.dt
        if not abs(along - expected) <= JUMP_M + 0.1 * abs(expected):
            return f"covers {along:.2f} m in a step, by its speed {expected:.2f} m, {when}"
        if not abs(across) <= JUMP_M + math.tan(math.radians(SLIDE_DEG)) * abs(expected):
            return f"jumps {abs(across):.2f} m to the side in a step, {when}"
        if not abs(turn_deg) <= _TURN_DEG:
            return f"turns by {turn_deg:.0f} degrees in a step, {when}"
    return ""
