"""Parts about whole runs: they repeat, obey the controls, go back, and refuse what cannot be staged."""

import numpy as np

from oodscen._abilities import ChecksScenes, Rehearses, Snapshots, own_issues
from oodscen.data._scene import Behaviour, Scene
from oodscen.errors import SceneError, SpawnError, UnknownComponent
from oodscen.protocols import Control
from oodscen.testing._kit.findings import NotApplicable
from oodscen.testing._kit.probe import Probe
from oodscen.testing._kit.samples import constantly, run_bytes

_STEPS = 60
"""Steps of the runs that are restored."""
_SAVED = (5, 30)
"""Steps at which snapshots are taken."""
_RESTORED = (5, 30, 5)
"""Steps whose snapshots are restored, in this order."""
_TOLERANCE = 1e-6
"""Largest difference between an observation and the state that it shows."""
_TRIALS = (
    ("keep_speed", {"reaction_s": 0.0}, False),
    ("keep_speed", {"reaction_s": 0.0, "speed": 0.5}, True),
    ("emergency_brake", {"reaction_s": 0.0}, True),
    ("emergency_brake", {"reaction_s": 5.0}, False),
    ("emergency_brake", {"reaction_s": 0.0, "friction": 0.05}, False),
)
"""Actions at 10 m/s, 40 m behind a body that stands, the driver and the road, and whether they pass for 5 s."""


def check_determinism(probe: Probe) -> None:
    """Check that a run repeats to the byte: again, after another scene, and in a new simulator."""
    camera = None if probe.states_only else probe.camera()
    first = [run_bytes(probe.simulator, scene, camera, seed=3) for scene in probe.scenes]
    with probe.factory() as other:
        for scene, expected in reversed(list(zip(probe.scenes, first, strict=True))):
            again = run_bytes(probe.simulator, scene, camera, seed=3)
            fresh = run_bytes(other, scene, camera, seed=3)
            subject = f"scene {scene.id}"
            probe.findings.expect(
                again == expected, subject, "another result after other scenes had run"
            )
            probe.findings.expect(
                fresh == expected, subject, "another result from a fresh simulator"
            )


def check_controls(probe: Probe) -> None:
    """Check that the ego obeys its control, left is positive, and the observation agrees."""
    scene, ends = probe.scene(speed=8.0), {}
    for name, control in (
        ("coasting", Control()),
        ("accelerating", Control(acceleration=1.0)),
        ("braking", Control(acceleration=-6.0)),
        ("steering left", Control(steering=0.03)),
        ("steering right", Control(steering=-0.03)),
    ):
        state = probe.run(scene, constantly(control))[-1]
        ends[name] = probe.simulator.observe()
        speed = float(state.speeds[0])
        agrees = (
            abs(ends[name].speed - speed) < _TOLERANCE
            and abs(ends[name].time - state.time) < _TOLERANCE
        )
        probe.findings.expect(agrees, "", f"after {name} observation and state disagree")
    faster = ends["accelerating"].speed > ends["coasting"].speed > ends["braking"].speed
    probe.findings.expect(
        faster, "", "accelerating and braking do not change the speed as they should"
    )
    probe.findings.expect(ends["braking"].speed >= 0.0, "", "braking makes the ego reverse")
    left, right = ends["steering left"].offset_m, ends["steering right"].offset_m
    is_left = left > ends["coasting"].offset_m > right
    probe.findings.expect(is_left, "", "left must be positive")


def check_snapshot(probe: Probe) -> None:
    """Check that a run from a restored snapshot repeats the original run.

    Snapshots are taken before and after a trigger fires, and restored in another order and twice.
    """
    simulator = probe.simulator
    if not isinstance(simulator, Snapshots):
        raise NotApplicable("has no snapshot() and restore()")
    scenes = [*probe.scenes[:1], *_triggered_scenes(probe)]
    for scene in scenes:
        simulator.reset(scene, 1)
        snapshots, states = {}, []
        for step in range(_STEPS):
            if step in _SAVED:
                snapshots[step] = simulator.snapshot()
            states.append(simulator.step(_weaving(step)).fingerprint())
        for step in _RESTORED:
            simulator.restore(snapshots[step])
            repeated = [
                simulator.step(_weaving(later)).fingerprint() for later in range(step, _STEPS)
            ]
            if repeated != states[step:]:
                probe.findings.add(f"scene {scene.id}", "what follows a restored snapshot differs")
                break
        simulator.reset(scene, 1)
        start = simulator.snapshot()
        for step in range(10):
            simulator.step(_weaving(step))
        state = simulator.restore(start)
        at_start = getattr(state, "step", None) == 0
        probe.findings.expect(at_start, "", "restore() does not return the restored state")


def check_rehearsal(probe: Probe) -> None:
    """Check that rehearsals tell which actions pass, for other drivers and on other roads, and move nothing."""
    simulator = probe.simulator
    if not isinstance(simulator, Rehearses):
        raise NotApplicable("has no rehearse()")
    scene = probe.scene(probe.still(probe.box_like, ahead=40.0), speed=10.0)
    expected = [state.fingerprint() for state in probe.run(scene)]
    states = [simulator.reset(scene, 0).fingerprint()]
    for action, variation, passes in _TRIALS:
        found = simulator.rehearse(action, 5.0, **variation)
        told = ", ".join(f"{name}={value:g}" for name, value in variation.items())
        probe.findings.expect(
            isinstance(found, bool | np.bool_) and found == passes,
            "",
            f"rehearse({action!r}, 5, {told}) is {found!r:.40}, not {passes}, 40 m behind a body, at 10 m/s",
        )
    states += [simulator.step(Control()).fingerprint() for _ in expected[1:]]
    probe.findings.expect(states == expected, "", "rehearse() changes what follows")


def _triggered_scenes(probe: Probe) -> list[Scene]:
    """Return a scene in which an actor acts between the two snapshots, if the catalogue has one."""
    for name in ("pull_out", "cut_in", "cross_road", "dart", "hard_brake", "stall", "reverse"):
        try:
            scene = probe.scene(probe.doing(name), road=probe.widest)
        except NotApplicable:
            continue
        return [scene.model_copy(update={"id": f"check-{name}"})]
    return []


def _weaving(step: int) -> Control:
    return Control(-0.5, 0.01 if step % 8 < 4 else -0.02)


def check_refusals(probe: Probe) -> None:
    """Check that impossible scenes raise typed errors and that the next scene still runs."""
    assets = probe.catalogue.assets
    solid = [asset for asset in assets if not asset.is_passable()]
    body = probe.still((solid or assets)[0], ahead=30.0)
    good = probe.scene(body)
    narrowest = min(probe.catalogue.maps, key=lambda road: road.lanes)
    unknown = body.model_copy(update={"asset": "no-such-asset"})
    strange = body.model_copy(update={"behaviour": Behaviour(name="no-such-behaviour")})
    impossible = {
        "an unknown asset": probe.scene(unknown),
        "an unknown behaviour": probe.scene(strange),
        "an unknown map": good.model_copy(update={"map": "no-such-map"}),
        "a lane that is not there": probe.scene(road=narrowest, lane=6),
    }
    if solid:
        double = body.model_copy(update={"id": "b"})
        impossible["two bodies in one place"] = probe.scene(body, double)
    for what, scene in impossible.items():
        try:
            probe.simulator.reset(scene, 0)
        except (SceneError, SpawnError, UnknownComponent):
            pass
        except Exception as error:
            name = type(error).__name__
            probe.findings.add("", f"{what} is refused by a {name}, not a SceneError")
        else:
            probe.findings.add("", f"{what} is not refused")
        probe.simulator.reset(good, 0)
    if isinstance(probe.simulator, ChecksScenes):
        issues = own_issues(probe.simulator, good)
        probe.findings.expect(not issues, "", f"check() refuses a plain scene: {issues[:1]}")
