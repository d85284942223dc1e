"""Part about motion: ego and actors move as the reference world moves them, within stated tolerances.

The reference is `oodscen.driving.KinematicWorld`, under the same controls. Simulators with dynamics of their own
differ from it, and may; they must not differ by what changes the meaning of a scene.
"""

import math
from typing import NamedTuple

import numpy as np

from oodscen.data._catalogue import RoadMap
from oodscen.data._scene import Trigger
from oodscen.driving._motion.behaviours.table import BUILT_IN, DRIVES_IN_LANE
from oodscen.driving._roads.building import load_corridor
from oodscen.protocols import Control
from oodscen.testing._kit.behaviours import check_behaviour
from oodscen.testing._kit.comparing import ACROSS_M, compare
from oodscen.testing._kit.ego_motion import check_contact, check_ego, check_grip
from oodscen.testing._kit.findings import NotApplicable
from oodscen.testing._kit.lane_changes import check_lane_changes
from oodscen.testing._kit.probe import Probe
from oodscen.testing._kit.reactions import check_reactions, check_triggers
from oodscen.testing._kit.samples import constantly
from oodscen.testing._kit.tracks import SECONDS, START_M, run_both, start_fault

_CALM = 2.0
"""Acceleration towards the inside of a bend that no driver minds, m/s^2."""
_FASTEST = 14.0
"""Greatest speed in a bend, m/s."""
_LEAST_BEND = 1e-9
"""Least curvature by which an acceleration is divided, 1/m."""


def check_motion(probe: Probe) -> None:
    """Check starts, controls, behaviours, triggers, lane changes, reactions and contacts against the reference world."""
    findings = probe.findings
    for name, part in (
        ("starts", _check_starts),
        ("ego", check_ego),
        ("grip", check_grip),
        ("triggers", check_triggers),
        ("bends", _check_bends),
        ("lane changes", check_lane_changes),
        ("reactions", check_reactions),
        ("contact", check_contact),
    ):
        with findings.trying(name):
            try:
                part(probe)
            except NotApplicable as reason:
                findings.notes.append(f"{name} not tried, {reason}")
    own = [kind.id for kind in probe.catalogue.behaviours if kind.id not in BUILT_IN]
    if own:
        findings.notes.append(
            f"of the simulator's own behaviours only starts are compared: {', '.join(own)}"
        )
    for kind in probe.catalogue.behaviours:
        with findings.trying(f"behaviour {kind.id}"):
            check_behaviour(probe, kind)


def _check_starts(probe: Probe) -> None:
    """Check that standing bodies are where the scene places them, on both sides and at any angle."""
    firsts = {asset.category: asset for asset in reversed(probe.catalogue.assets)}
    actors = [
        probe.still(
            asset, id=f"s{index}", ahead=15.0 + 14.0 * index, offset=offset, heading=heading
        )
        for index, (asset, offset, heading) in enumerate(
            zip(firsts.values(), (1.6, -1.2, 0.8, -0.4), (25.0, -60.0, 160.0, -10.0), strict=False)
        )
    ]
    scene = probe.scene(*actors, road=probe.widest, lane=probe.widest.lanes - 1)
    tracks, reference = run_both(probe, scene, constantly(Control()), seconds=1.0)
    for row, actor in enumerate(actors, start=1):
        fault = start_fault(tracks, reference, row)
        probe.findings.expect(
            not fault, f"actor {actor.asset} at {actor.placement.offset_m:g} m", fault
        )
        moved_m = float(np.linalg.norm(tracks.poses[-1, row, :2] - tracks.poses[0, row, :2]))
        probe.findings.expect(
            moved_m < START_M, f"actor {actor.asset}", "moves though it should stand"
        )


def _check_bends(probe: Probe) -> None:
    """Compare drivers in a bend with the reference world's, in the ego's lane and in an oncoming one.

    Raises:
        NotApplicable: If no map bends, or no behaviour drives along its lane.
    """
    bend = _sharpest_bend(probe)
    road = bend.road
    calm_speed = math.sqrt(_CALM / max(bend.curvature, _LEAST_BEND))
    speed = min(0.8 * road.speed_limit, calm_speed, _FASTEST)
    if 0.5 * bend.curvature * (speed * SECONDS) ** 2 < 2.0 * ACROSS_M:
        raise NotApplicable("no map has a bend within 150 m of the ego's start")
    names = [kind.id for kind in probe.catalogue.behaviours if kind.id in DRIVES_IN_LANE]
    if not names:
        raise NotApplicable("no behaviour drives along its lane")
    sides = [("", 0, -1.0)]
    if road.oncoming_lanes:
        sides.append((" in an oncoming lane", road.lanes, 1.0))
    for name in names:
        for words, lane, side in sides:
            kind = probe.catalogue.behaviour(name)
            actor = probe.doing(
                name,
                ahead=bend.ahead_m + side * 15.0,
                lane=lane,
                trigger=Trigger(value=2.0 * SECONDS),
                parameters={
                    parameter: value
                    for parameter, value in (("speed", speed), ("lanes", 0.0))
                    if parameter in kind.parameters
                },
            )
            scene = probe.scene(actor, road=road, speed=2.0)
            subject = f"behaviour {name} in a bend{words}"
            if probe.can_stage(scene, subject):
                compare(probe, scene, kind, subject, SECONDS)


class _Bend(NamedTuple):
    """The sharpest point of a map near the ego's start."""

    curvature: float
    """1/m"""
    ahead_m: float
    road: RoadMap


def _sharpest_bend(probe: Probe) -> _Bend:
    """Return the sharpest bend of all maps, at least 30 m ahead of the ego.

    A map with a turn near the start that is tighter than 30 m, as on a roundabout, is left out.

    Raises:
        NotApplicable: If there is no other map.
    """
    bends = []
    for road in probe.catalogue.maps:
        corridor = load_corridor(road, probe.catalogue)
        is_near = (corridor.s > corridor.start + 20.0) & (corridor.s < corridor.start + 150.0)
        curvatures = np.where(is_near, abs(corridor.curvature), 0.0)
        index = int(curvatures.argmax())
        if curvatures[index] < 1.0 / 30.0:
            ahead_m = max(float(corridor.s[index] - corridor.start), 30.0)
            bends.append(_Bend(float(curvatures[index]), ahead_m, road))
    if not bends:
        raise NotApplicable("every map has a tight turn near the ego's start")
    return max(bends, key=lambda bend: bend.curvature)
