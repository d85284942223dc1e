"""An adapter with dynamics of its own gets state, observation and triggers from the library."""

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen import simulate
from oodscen._abilities import ChecksScenes, Snapshots
from oodscen.data._designs.motion import Motion
from oodscen.data._scene import Ego, Trigger
from oodscen.driving import DynamicSimulator, KinematicWorld, RestorableSimulator, StagedScene
from oodscen.driving._sight.placement import staging_issues
from oodscen.driving._sight.staging_advice import AdvisingCheck
from oodscen.errors import Issue, SceneError, SimulatorError, UsageError
from oodscen.protocols import Camera, Control, Simulator
from oodscen.testing import example_scene
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._new.adapter import MySimulator
from tests.driving.staging import CATALOGUE, actor, scene, world
from tests.motions import STREAM

CAR = scene(
    actor("box", "cardboard_box", ahead=80.0),
    actor("car", "car", "pull_out", ahead=35.0, trigger=Trigger(kind="distance", value=30.0)),
    speed=12.0,
)


class Engine(DynamicSimulator):
    """Moves bodies by a world of its own, as if that were another engine."""

    name = "engine"

    def __init__(self, columns: int = 4) -> None:
        super().__init__()
        self.columns = columns
        self.fired: list[tuple[str, float]] = []

    def catalogue(self):
        return CATALOGUE

    def begin(self, staged, seed) -> None:
        self.engine = KinematicWorld(
            staged.corridor, staged.scene, staged.catalogue, seed, dt=self.dt
        )
        self.fired = []

    def move(self, control) -> None:
        self.engine.step(control)

    def bodies(self):
        poses = self.engine.poses()
        return (poses if self.columns == 4 else poses[:, [0, 1, 3]]), self.engine.speeds()

    def triggered(self, body) -> None:
        self.fired.append((body.id, self.engine.time))

    def draw(self, camera):
        return self.staged.draw(camera, self.state().poses)


class GoesBack(RestorableSimulator, Engine):
    def save(self):
        return self.engine.snapshot()

    def resume(self, saved) -> None:
        self.engine.restore(saved)


@pytest.mark.parametrize("make", [Engine, GoesBack])
def test_the_same_motion_gives_the_same_episode_as_the_kinematic_world(make) -> None:
    engine, flat = (simulate(CAR, one).episode for one in (make(), FlatSimulator()))
    assert engine.trace_sha256 == flat.trace_sha256
    assert engine.frame_sha256 == flat.frame_sha256
    assert engine.is_deterministic
    if make is GoesBack:
        names = ("safe", "marginal", "margin_m", "off_road", "contacts", "final_speed")
        for name, outcome in engine.actions.items():
            if not outcome.marginal and not flat.actions[name].marginal:
                assert all(
                    getattr(outcome, one) == getattr(flat.actions[name], one) for one in names
                )


def test_everything_that_is_derived_equals_the_kinematic_worlds() -> None:
    one, other = Engine(columns=3), FlatSimulator()
    states = one.reset(CAR, 0), other.reset(CAR, 0)
    for step in range(120):
        for name in ("poses", "speeds", "gaps", "accelerations", "places"):
            np.testing.assert_allclose(
                getattr(states[0], name), getattr(states[1], name), atol=1e-4, err_msg=name
            )
        assert states[0].off_road == states[1].off_road
        assert vars(one.observe()) == pytest.approx(vars(other.observe()), abs=1e-4)
        if step % 40 == 0:
            derived = StagedScene(CAR, CATALOGUE).observation(states[0])
            assert vars(derived) == pytest.approx(vars(one.observe()), abs=1e-9)
        states = tuple(simulator.step(Control(-0.5, 0.02)) for simulator in (one, other))
    assert one.fired == [("box", 0.0), ("car", other.world.motion("car").triggered)]
    assert one.since("car") == pytest.approx(one.state().time - one.fired[1][1])


def test_bodies_start_where_the_scene_says_with_all_parameters() -> None:
    engine = Engine()
    engine.reset(CAR, 0)
    staged = engine.staged
    assert [body.id for body in staged.bodies] == list(staged.ids) == ["ego", "box", "car"]
    ego, _, car = staged.bodies
    assert (ego.speed, ego.actor, ego.direction) == (12.0, None, 1)
    assert car.actor is CAR.actors[1]
    assert set(car.parameters or ()) == set(CATALOGUE.behaviour("pull_out").parameters)
    for body in staged.bodies:
        s, t = staged.corridor.locate(*body.pose[:2])
        assert staged.places(engine.engine.poses())[staged.ids.index(body.id)] == pytest.approx(
            (s, t), abs=1e-6
        )


def test_centrelines_lie_in_the_middle_of_their_lanes_in_the_direction_of_travel() -> None:
    engine = Engine()
    engine.reset(CAR, 0)
    road = engine.corridor
    assert [line.strip for line in engine.staged.lanes] == list(road.driving)
    for line in engine.staged.lanes:
        for point, ahead in zip(line.points[100:103], line.points[101:104], strict=True):
            s, t = road.locate(*map(float, point))
            assert t == pytest.approx(road.centre(line.strip, s), abs=0.02)
            yaw = float(np.arctan2(*(ahead - point)[::-1]))
            assert road.alignment(s, yaw) * line.direction > 0.99


@pytest.mark.parametrize(
    "wrong",
    [
        lambda poses, speeds: (poses[:2], speeds),
        lambda poses, speeds: (poses * np.nan, speeds),
        lambda poses, speeds: (poses.astype(str), speeds),
        lambda poses, speeds: (poses + 1j, speeds),
        lambda poses, speeds: (poses, speeds[:1]),
        lambda poses, speeds: (poses + 1e300, speeds),
        lambda poses, speeds: (poses, speeds + np.inf),
        lambda poses, speeds: (poses, speeds - 1e300),
        lambda poses, speeds: (None, speeds),
        lambda poses, speeds: 3,
        lambda poses, speeds: None,
        lambda poses, speeds: (poses, speeds, speeds),
        lambda poses, speeds: (poses, ["fast"] * len(speeds)),
        lambda poses, speeds: ([*poses.tolist()[:-1], [0.0]], speeds),
    ],
)
def test_wrong_bodies_are_refused_by_name(wrong, monkeypatch) -> None:
    engine = Engine()
    right = engine.bodies
    monkeypatch.setattr(engine, "bodies", lambda: wrong(*right()))
    words = r"engine: bodies\(\) returned (no poses and speeds: |speeds that are not)"
    with pytest.raises(SimulatorError, match=words):
        engine.reset(CAR, 0)


def test_a_failure_of_bodies_is_not_told_as_what_it_returned(monkeypatch) -> None:
    engine = Engine()
    monkeypatch.setattr(engine, "bodies", lambda: float("no number"))
    with pytest.raises(SimulatorError, match="crashed: ValueError: could not convert"):
        simulate(CAR, engine, actions=(), render=False)


def test_misuse_is_typed() -> None:
    engine = Engine()
    for call in (
        engine.state,
        engine.observe,
        lambda: engine.staged,
        lambda: engine.step(Control()),
    ):
        with pytest.raises(SimulatorError, match="reset"):
            call()
    with pytest.raises(SceneError):
        engine.reset(CAR.model_copy(update={"map": "nowhere"}), 0)
    engine.reset(CAR, 0)
    with pytest.raises(UsageError):
        engine.step(Control(float("nan")))
    engine.close()
    engine.close()
    with pytest.raises(SimulatorError):
        engine.render(Camera())


def test_abilities_are_declared() -> None:
    assert isinstance(Engine(), Simulator)
    assert not isinstance(Engine(), Snapshots)
    assert isinstance(GoesBack(), Snapshots)


@settings(max_examples=60, deadline=None)
@given(st.floats(-20.0, 20.0), st.floats(-1.0, 1.0), st.floats(0.0, 40.0), st.floats(0.1, 1.0))
def test_a_control_within_grip_moves_the_ego_as_the_whole_control_does(
    acceleration, steering, speed, friction
) -> None:
    ends = []
    staged = scene(speed=speed, friction=friction)
    whole = Control(acceleration, steering)
    for control in (whole, StagedScene(staged, CATALOGUE).within_grip(whole, speed)):
        moved = world(staged)
        moved.step(control)
        ends.append(moved.ego)
    assert ends[1] == pytest.approx(ends[0], abs=1e-5)


def test_a_behaviour_of_its_own_runs_by_the_one_that_it_is_like() -> None:
    own = CATALOGUE.behaviour("follow_lane").model_copy(
        update={"id": "mobil", "like": "follow_lane"}
    )
    catalogue = CATALOGUE.model_copy(update={"behaviours": (own,)})
    staged = scene(actor("car", "car", "mobil", ahead=40.0))
    assert not staging_issues(staged, catalogue)
    lost = catalogue.model_copy(update={"behaviours": (own.model_copy(update={"like": ""}),)})
    assert [issue.path for issue in staging_issues(staged, lost)] == ["actors[0].behaviour.name"]
    engine = Engine()
    engine.catalogue = lambda: catalogue  # type: ignore[method-assign]
    engine.reset(staged, 0)
    assert engine.staged.bodies[1].behaviour == "mobil"
    assert engine.staged.bodies[1].speed > 0.0


def test_motions_that_cannot_be_played_are_refused_beside_all_other_faults() -> None:
    walker = actor("walker", "adult", "stream", ahead=40.0)
    staged = scene(walker, actor("box", "no_box", ahead=80.0))
    staged = staged.model_copy(update={"motions": (Motion.model_validate(STREAM),)})
    with pytest.raises(SceneError) as caught:
        Engine().reset(staged, 0)
    *faults, advice = caught.value.issues
    assert [issue.path for issue in faults] == ["actors[1].asset", "motions"]
    assert "use the simulator that it was written for" in advice.message


def test_a_simulator_refuses_scenes_by_its_own_check() -> None:
    class Choosy(Engine):
        def check(self, scene):
            slow = scene.ego.speed < 5.0
            return [Issue("ego.speed", "is too slow for this engine")] if slow else []

    assert isinstance(Choosy(), ChecksScenes)
    assert not isinstance(Engine(), ChecksScenes)
    Choosy().reset(CAR, 0)
    slow = scene(speed=3.0)
    with pytest.raises(SceneError, match="too slow for this engine"):
        Choosy().reset(slow, 0)
    staged = example_scene().model_copy(update={"ego": Ego(speed=4.0)})
    check = AdvisingCheck(Choosy())
    assert [issue.path for issue in check(staged, CATALOGUE)] == ["ego.speed"]
    assert not AdvisingCheck(Engine())(staged, CATALOGUE)


@pytest.mark.parametrize("kind", [FlatSimulator, MySimulator])
@given(seeds=st.lists(st.integers(0, 99), min_size=2, max_size=2), moved=st.booleans())
@settings(max_examples=10, deadline=None)
def test_a_snapshot_is_of_one_scene_and_seed(kind, seeds, moved):
    one = example_scene()
    speed = one.ego.speed + moved
    other = one.model_copy(update={"ego": one.ego.model_copy(update={"speed": speed})})
    with kind() as simulator:
        simulator.reset(one, seeds[0])
        snapshot = pickle.loads(pickle.dumps(simulator.snapshot()))
        begun = simulator.reset(other, seeds[1]).fingerprint()
        if other == one and seeds[0] == seeds[1]:
            assert simulator.restore(snapshot).fingerprint() == begun
        else:
            with pytest.raises(UsageError, match="another scene or seed"):
                simulator.restore(snapshot)
        for value in (None, 5, "x", (1, b"")):
            with pytest.raises(UsageError):
                simulator.restore(value)
        assert simulator.state().fingerprint() == begun
