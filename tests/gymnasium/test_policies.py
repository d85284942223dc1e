"""A policy drives as it does in its environment, and what it returns is checked."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.errors import UsageError
from oodscen.protocols import Camera, Control
from oodscen.stages._drive import drive
from oodscen.testing import example_scene
from oodscen.testing._flat import FlatSimulator

gymnasium = pytest.importorskip("gymnasium")

from oodscen.gymnasium import PolicyDriver, SceneEnv  # noqa: E402
from tests.gymnasium.test_env import TINY, rolled  # noqa: E402


class Careful:
    """A policy of stable-baselines3's form: brakes near a body; counts its calls in its state."""

    def __init__(self):
        self.states = []

    def predict(self, observation, state=None, episode_start=None, deterministic=False):
        assert deterministic
        self.states.append((state, bool(episode_start[0])))
        seen = observation["neighbours"][0]
        brakes = seen[0] > 0.0 and seen[1] * 100.0 < 25.0
        return np.array([-0.6 if brakes else 0.0, -observation["ego"][1]], np.float32), len(
            self.states
        )


@pytest.fixture(scope="module")
def simulator():
    with FlatSimulator() as made:
        yield made


def test_a_policy_drives_as_in_its_environment(simulator):
    env = SceneEnv(scenes=[example_scene()], twins=True)
    policies = []

    def driver():
        policies.append(Careful())
        return PolicyDriver(policies[-1])

    for result in drive([example_scene()], driver, simulator, name="careful"):
        assert result.status == "ok", result.error
        policy = Careful()
        episode = rolled(
            env,
            lambda seen, policy=policy: policy.predict(
                seen, episode_start=np.array([False]), deterministic=True
            )[0],
            options={"scene": result.scene_id},
        )
        info = episode[-1][2]
        assert info["progress_m"] == pytest.approx(result.progress_m, abs=1e-3)
        assert (info["time"], info["collisions"]) == (result.seconds, result.collisions)
    assert policies[0].states[:3] == [(None, True), (1, False), (2, False)]
    env.close()


class Wrapped:
    def __init__(self, model):
        self.model = model

    def predict(self, observation, *args, **kwargs):
        return self.model.predict(observation, *args, **kwargs)


@pytest.mark.parametrize(
    "given",
    [
        Wrapped,
        lambda policy: Wrapped(policy).predict,
        lambda policy: policy.predict,
        lambda policy: (
            lambda seen, state, deterministic: policy.predict(
                seen, state, [state is None], deterministic
            )
        ),
    ],
)
def test_a_recurrent_policy_keeps_its_state_however_it_is_passed_on(simulator, given):
    policy = Careful()
    drive([example_scene()], lambda: PolicyDriver(given(policy)), simulator, name="p", twins=False)
    assert policy.states[:3] == [(None, True), (1, False), (2, False)]


@given(st.integers(1, 60), st.sampled_from([0.0, 0.01, 0.02, 0.025, 0.04]))
@settings(max_examples=20, deadline=None)
def test_an_action_holds_as_long_as_in_the_environment_or_is_refused(simulator, steps, more):
    step_s = steps * simulator.dt + more
    times = []

    def policy(seen):
        times.append(simulator.state().time)
        return 0

    (result,) = drive(
        [example_scene()],
        lambda: PolicyDriver(policy, actions="discrete", step_s=step_s),
        simulator,
        twins=False,
    )
    if more:
        assert "not a multiple of the simulator's step" in result.error
    else:
        assert result.status == "ok", result.error
        assert np.diff(times) == pytest.approx(step_s)


@pytest.mark.parametrize(("dt", "step_s"), [(0.04, 0.08), (0.05, 0.1), (0.03, 0.09), (0.1, 0.1)])
def test_by_default_an_action_holds_as_long_as_in_the_environment(dt, step_s):
    class Stepping(FlatSimulator):
        pass

    Stepping.dt = dt
    times = []

    def policy(seen):
        times.append(simulator.state().time)
        return 0

    with Stepping() as simulator:
        (result,) = drive(
            [example_scene()],
            lambda: PolicyDriver(policy, actions="discrete"),
            simulator,
            twins=False,
        )
    assert result.status == "ok", result.error
    assert np.diff(times) == pytest.approx(step_s)
    env = SceneEnv(scenes=[example_scene()], simulator=Stepping())
    assert env.interface.step_s == pytest.approx(step_s)
    env.close()


def test_a_policy_of_pictures_gets_those_of_its_camera(simulator):
    shapes = set()

    def policy(seen):
        shapes.add(seen.shape)
        return 2

    settings = {"observation": "frame", "actions": "discrete", "camera": TINY, "step_s": 0.5}
    results = drive([example_scene()], lambda: PolicyDriver(policy, **settings), simulator)
    assert [result.status for result in results] == ["ok", "ok"]
    assert shapes == {(12, 16, 3)}
    wrong = {"twins": False, "camera": Camera(width=20, height=10)}
    (lost,) = drive([example_scene()], lambda: PolicyDriver(policy, **settings), simulator, **wrong)
    assert lost.error_type == "SimulatorError"
    assert "Observation.frame" in lost.error


@pytest.mark.parametrize(
    ("actions", "answer"),
    [
        *(("continuous", bad) for bad in (None, (), np.full(2, math.nan), np.zeros(3), "left")),
        *(("discrete", bad) for bad in (None, 7, -1, 0.5, "stop", (9, None))),
    ],
)
def test_an_answer_that_is_no_action_is_a_result_that_names_the_method(simulator, actions, answer):
    class Wild:
        def predict(self, observation):
            return answer

    (found,) = drive(
        [example_scene()], lambda: PolicyDriver(Wild(), actions=actions), simulator, twins=False
    )
    assert (found.status, found.error_type) == ("failed", "UsageError")
    assert "Wild.predict()" in found.error


def test_a_policy_that_fails_is_a_result_too(simulator):
    def broken(observation):
        raise KeyError("no key")

    (found,) = drive([example_scene()], lambda: PolicyDriver(broken), simulator, twins=False)
    assert found.error_type == "UsageError"
    assert "broken()" in found.error


@pytest.mark.parametrize("policy", [None, 3, Careful, object()])
def test_what_is_no_policy_is_refused(policy):
    with pytest.raises(UsageError, match="policy"):
        PolicyDriver(policy)


def test_a_driver_needs_an_environment_of_its_kind():
    with pytest.raises(UsageError, match="continuous"):
        SceneEnv(actions="discrete").policy(Careful)
    with pytest.raises(UsageError, match="rule-based"):
        SceneEnv().policy("rule_based")


def test_a_driver_in_an_environment_is_checked_and_may_see_pictures():
    shapes = []

    class Sees:
        wants_frames = True
        camera = TINY

        def act(self, observation):
            shapes.append(observation.frame.rgb.shape)
            return Control(math.nan if len(shapes) > 1 else 0.0)

    env = SceneEnv(scenes=[example_scene()])
    policy = env.policy(Sees)
    with pytest.raises(UsageError, match="reset"):
        policy(None)
    seen, _ = env.reset(seed=0)
    action, state = policy.predict(seen, deterministic=True)
    assert (action.tolist(), state, shapes) == ([0.0, 0.0], None, [(12, 16, 3)])
    with pytest.raises(UsageError, match=r"Sees\.act\(\)"):
        policy(seen)
    env.close()


@pytest.mark.parametrize("make", [lambda: {}["key"], lambda: None])
def test_a_driver_that_cannot_be_made_is_told_of(make):
    env = SceneEnv(scenes=[example_scene()])
    seen, _ = env.reset(seed=0)
    with pytest.raises(UsageError, match="driver"):
        env.policy(make)(seen)
    env.close()
