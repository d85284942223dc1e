"""Checks that actors act on their triggers and brake for others, as in the reference world."""

from collections.abc import Callable, Sequence

from oodscen.data._scene import Scene, Trigger
from oodscen.driving._motion.boxes import Footprint, gap
from oodscen.errors import OodscenError
from oodscen.protocols import Control
from oodscen.testing._kit.findings import NotApplicable
from oodscen.testing._kit.probe import Probe
from oodscen.testing._kit.samples import constantly
from oodscen.testing._kit.tracks import ONSET_S, Tracks, run_both

_WAITING = "cross_road pull_out dart bolt walk_along roll_away reverse hard_brake stall halt cut_in".split()
"""Behaviours that show when their trigger fires, best first."""


def check_triggers(probe: Probe) -> None:
    """Compare when actors act on triggers by time, distance and time to collision, also to another actor.

    Raises:
        NotApplicable: If no behaviour waits for its trigger.
    """
    kinds = {kind.id: kind for kind in probe.catalogue.behaviours}
    name = next((name for name in _WAITING if name in kinds), None)
    if name is None:
        raise NotApplicable("no behaviour waits for its trigger")
    parameters = {"lanes": 0.0} if "lanes" in kinds[name].parameters else {}
    mark = min(probe.catalogue.assets, key=lambda asset: asset.width)
    for trigger in (
        Trigger(kind="time", value=1.5),
        Trigger(kind="distance", value=30.0),
        Trigger(kind="ttc", value=4.0),
        Trigger(kind="distance", value=14.0, actor="mark"),
    ):
        actor = probe.doing(name, ahead=50.0, trigger=trigger, parameters=parameters)
        marks = [probe.still(mark, id="mark", ahead=30.0, offset=3.4)] if trigger.actor else []
        scene = probe.scene(actor, *marks, road=probe.widest, speed=10.0)
        subject = f"trigger by {trigger.kind}" + (" to another actor" if marks else "")
        if marks and not probe.can_stage(scene, subject):
            continue
        tracks, reference = run_both(probe, scene, constantly(Control()))
        onset_s, expected_s = tracks.onset(1), reference.onset(1)
        if expected_s is None:
            continue
        if onset_s is None:
            probe.findings.add(subject, f"never shows in {name!r}")
        elif not abs(onset_s - expected_s) <= ONSET_S:
            probe.findings.add(
                subject,
                f"shows in {name!r} after {onset_s:.2f} s, in the reference world {expected_s:.2f} s",
            )


def check_reactions(probe: Probe) -> None:
    """Check that a driver brakes for a standing body ahead, and for the ego."""
    follower = probe.doing("follow_lane", id="follower", ahead=20.0)
    block = probe.still(probe.box_like, id="block", ahead=75.0)
    ahead = probe.scene(follower, block, speed=3.0)
    _check_stop(probe, ahead, 2, "brakes for a body ahead", constantly(Control()))
    behind = probe.scene(
        probe.doing("follow_lane", id="follower", ahead=-30.0, parameters={"speed": 12.0}),
        speed=12.0,
    )
    _check_stop(
        probe, behind, 0, "brakes for the ego", lambda time: Control(-3.0 if time > 0.5 else 0.0)
    )


def _check_stop(
    probe: Probe, scene: Scene, row: int, reaction: str, control: Callable[[float], Control]
) -> None:
    """Check that the driver in row 1 does not drive into the body in another row."""
    try:
        tracks, reference = run_both(probe, scene, control, seconds=9.0)
    except OodscenError as error:
        probe.findings.add("reaction", str(error))
        return
    sizes = [(asset.length, asset.width) for _, asset, _ in probe.catalogue.bodies(scene)]
    if not _least_gap(reference, row, sizes) > 0.3:
        return
    if not _least_gap(tracks, row, sizes) > 0.0:
        probe.findings.add("reaction", f"no driver of follow_lane {reaction}: it drives into it")
        return
    start, expected = float(reference.speeds[0, 1]), float(reference.speeds[-1, 1])
    speed = float(tracks.speeds[-1, 1])
    if speed > expected + 0.5 * max(0.0, start - expected) + 1.0:
        probe.findings.add(
            "reaction",
            f"hardly {reaction}: still {speed:.1f} m/s, in the reference world {expected:.1f}",
        )


def _least_gap(tracks: Tracks, row: int, sizes: Sequence[tuple[float, float]]) -> float:
    """Return the least gap between the boxes of the driver in row 1 and of another body, m."""

    def footprint(step: int, index: int) -> Footprint:
        x, y, _, yaw = map(float, tracks.poses[step, index])
        return Footprint(x, y, yaw, *sizes[index])

    return min(
        gap(footprint(step, 1), footprint(step, row)) for step in range(0, len(tracks.poses), 4)
    )
