"""The environment keeps Gymnasium's contract, repeats, ends as drives do, and refuses nonsense."""

import copy
import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

from oodscen.driving._motion.actions import Cruise
from oodscen.errors import (
    OodscenError,
    SimulatorCrash,
    SimulatorError,
    StudyMissing,
    UnknownComponent,
    UsageError,
)
from oodscen.protocols import Camera
from oodscen.stages._drive import drive
from oodscen.testing import example_scene
from oodscen.testing._flat import FlatSimulator

gymnasium = pytest.importorskip("gymnasium")

from oodscen.gymnasium import SceneEnv  # noqa: E402
from oodscen.gymnasium._reward import Reward  # noqa: E402

TINY = Camera(width=16, height=12)
FINE = {"step_s": FlatSimulator.dt}
KINDS = [
    *({"observation": "state"}, {"observation": "frame", "actions": "discrete"}),
    {"observation": "both"},
]


@pytest.fixture
def made():
    """Return a maker of environments that are closed afterwards."""
    found = []

    def make(**settings):
        found.append(SceneEnv(**{"scenes": [example_scene()], **settings}))
        return found[-1]

    make.cache_clear = found.clear
    yield make
    for env in found:
        env.close()


def rolled(env, policy, **reset):
    """Return the observations, rewards and infos of one episode."""
    seen, info = env.reset(**reset)
    steps = [(seen, 0.0, info)]
    is_over = False
    while not is_over:
        seen, reward, terminated, truncated, info = env.step(policy(seen))
        steps.append((seen, reward, info))
        is_over = terminated or truncated
        assert not (terminated and truncated)
    return steps


@pytest.mark.parametrize("settings", KINDS, ids=lambda one: one["observation"])
def test_gymnasium_finds_no_fault(settings):
    from gymnasium.utils.env_checker import check_env

    env = gymnasium.make("oodscen/Scene-v0", camera=TINY, render_mode="rgb_array", **settings)
    check_env(env.unwrapped)
    env.reset()
    assert env.render().shape == (480, 640, 3)
    env.close()


def test_many_run_side_by_side():
    envs = gymnasium.make_vec("oodscen/Scene-v0", num_envs=3, twins=True, actions="discrete")
    seen, info = envs.reset(seed=0)
    assert seen["neighbours"].shape == (3, 6, 10)
    for _ in range(3):
        seen, rewards, *_, info = envs.step(np.array([0, 2, 3]))
    assert rewards.shape == (3,)
    assert info["ttc_s"].shape == (3,)
    assert len(set(info["scene"])) > 1
    envs.close()


def test_a_drive_by_a_driver_is_that_of_drive(made):
    """The same driver comes to the same end at the same place, in scene and twin."""
    env = made(twins=True, **FINE)
    with FlatSimulator() as simulator:
        for driver in ("rule-based", Cruise):
            results = drive([example_scene()], driver, simulator)
            for result in results:
                policy = env.policy(driver)
                *_, (_, _, info) = rolled(env, policy, options={"scene": result.scene_id})
                assert info["collisions"] == result.collisions
                assert info["off_road"] == result.off_road
                assert info["time"] == pytest.approx(result.seconds)
                assert info["progress_m"] == pytest.approx(result.progress_m, abs=1e-2)


def test_episodes_repeat_and_seeds_choose_the_scenes(made):
    env = made(scenes=None, twins=True)
    coast = [0.0, 0.0]
    assert len(env.scene_ids) == 6
    for name in env.scene_ids:
        one, two = (rolled(env, lambda seen: coast, options={"scene": name}) for _ in range(2))
        assert [(reward, info) for _, reward, info in one] == [(r, i) for _, r, i in two]
    drawn = [[env.reset(seed=0 if not n else None)[1]["scene"] for n in range(8)] for _ in range(2)]
    assert drawn[0] == drawn[1]
    assert len(set(drawn[0])) > 2


def test_what_happens_is_told_and_rewarded(made):
    steps = rolled(made(), lambda seen: [0.0, 0.0])
    *before, (seen, reward, info) = steps
    assert (info["collision"], info["collisions"], info["ttc_s"]) == (True, ("box",), 0.0)
    assert reward < -15.0
    assert reward == pytest.approx(math.fsum(info["reward_terms"].values()))
    times = [info["ttc_s"] for _, _, info in before[10:]]
    assert times == sorted(times, reverse=True)
    assert all(reward == pytest.approx(0.1, abs=1e-3) for _, reward, _ in before[1:-20])
    assert seen["neighbours"][0, 0] == 1.0
    assert not seen["neighbours"][1:].any()
    off = rolled(made(), lambda seen: [0.0, 1.0])[-1][2]
    assert (off["off_road"], off["collision"]) == (True, False)
    assert off["reward_terms"]["off_road"] == Reward().off_road


@pytest.mark.parametrize("action", [0, 2])
def test_the_reward_of_a_drive_does_not_depend_on_how_long_an_action_holds(made, action):
    sums = []
    for step_s in (FlatSimulator.dt, 0.5, 2.0, 3.0):
        steps = rolled(made(actions="discrete", step_s=step_s), lambda seen: action)
        terms = [info["reward_terms"] for _, _, info in steps[1:]]
        sums.append({name: sum(term[name] for term in terms) for name in terms[0]})
    assert sums[0]["critical"] < -0.5 if action == 0 else sums[0]["braking"] < 0.0
    for other in sums[1:]:
        assert other == pytest.approx(sums[0], abs=1e-9)


def test_discrete_actions_follow_one_another(made):
    """A change to the left stays there; after slowing down, keeping the speed drives on."""
    env = made(actions="discrete", step_s=0.5, twins=True)
    plan = iter([4] * 7 + [0] * 2 + [5] * 7 + [1] * 4 + [0] * 99)
    steps = rolled(env, lambda seen: next(plan), options={"scene": "example-001~twin"})
    offsets = [10.0 * seen["ego"][1] for seen, _, _ in steps]
    speeds = [40.0 * seen["ego"][0] for seen, _, _ in steps]
    assert not steps[-1][2]["collision"]
    assert offsets[7] == pytest.approx(3.25, abs=0.2)
    assert offsets[9] == pytest.approx(3.25, abs=0.1)
    assert offsets[16] == pytest.approx(0.0, abs=0.2)
    assert min(speeds) == pytest.approx(4.0, abs=0.6)
    assert speeds[-1] > min(speeds) + 1.0


@pytest.mark.parametrize(
    ("actions", "action"),
    [
        *(("continuous", bad) for bad in ([math.nan, 0.0], [0.0, math.inf], [0.0], 0.5, None)),
        *(("continuous", bad) for bad in ("ab", [[0.0, 0.0]], {"a": 1}, [1, "b"])),
        *(("continuous", bad) for bad in ([1j, 0.0], np.array([1j, 0.0]))),
        *(
            ("discrete", bad)
            for bad in (7, -1, 1.0, math.nan, "stop", None, [1], True, [[1], [2, 3]])
        ),
    ],
)
def test_nonsense_is_refused_by_name_and_the_episode_goes_on(made, actions, action):
    env = made(actions=actions)
    env.reset(seed=0)
    with pytest.raises(UsageError, match=r"SceneEnv\.step\(\)"):
        env.step(action)
    assert env.step(env.action_space.sample())[4]["time"] == pytest.approx(0.1)


@pytest.mark.parametrize(
    "settings",
    [
        *({"observation": "pixels"}, {"actions": "words"}, {"neighbours": 0}, {"camera": "dash"}),
        *({"step_s": math.nan}, {"reward": 1.0}, {"render_mode": "human"}, {"seed": -1}),
        *({"twins": "no"}, {"step_s": 0.07}, {"step_s": 0.01}, {"scenes": [example_scene()] * 2}),
        *({"scenes": []}, {"scenes": ["a"]}, {"study": "nowhere"}, {"simulator": "no such"}),
    ],
    ids=lambda one: next(iter(one)),
)
def test_settings_that_make_no_sense_are_refused(made, settings):
    with pytest.raises(UsageError):
        made(**settings)


class Coarse(FlatSimulator):
    """Has another step."""

    dt = 0.04


def test_the_default_step_fits_the_simulator_and_another_that_does_not_is_refused(made):
    env = made(simulator=Coarse())
    env.reset(seed=0)
    info = env.step(env.action_space.sample())[4]
    assert (info["time"], info["step_s"]) == (pytest.approx(0.08), pytest.approx(0.08))
    with pytest.raises(UsageError, match=r"step_s is 0\.1 s, .* try 0\.08"):
        made(simulator=Coarse(), step_s=0.1)


def test_a_step_may_be_a_number_of_single_precision(made):
    assert made(step_s=np.float32(0.1)).interface.step_s == pytest.approx(0.1)


def test_calls_out_of_order_and_unknown_scenes_are_refused(made, tmp_path):
    env = made()
    for call in (lambda: env.step([0.0, 0.0]), lambda: env.look(TINY)):
        with pytest.raises(UsageError, match="reset"):
            call()
    with pytest.raises(UnknownComponent, match="example-001"):
        env.reset(options={"scene": "example-002"})
    with pytest.raises(UnknownComponent):
        env.reset(options={"scenes": "example-001"})
    rolled(env, lambda seen: [0.0, 0.0])
    with pytest.raises(UsageError, match="over"):
        env.step([0.0, 0.0])
    with pytest.raises(StudyMissing):
        SceneEnv(tmp_path)
    with pytest.raises(UsageError, match="both"):
        SceneEnv(tmp_path, scenes=[example_scene()])
    clash = example_scene().model_copy(update={"id": "example-001~twin"})
    with pytest.raises(UsageError, match="twin"):
        SceneEnv(scenes=[example_scene(), clash], twins=True)
    with pytest.raises(UsageError, match="progress"):
        SceneEnv(reward={"progress": math.nan})


def test_an_open_environment_shares_its_simulator_with_no_other(made):
    simulator = FlatSimulator()
    env = made(simulator=simulator)
    with pytest.raises(UsageError, match="one object per environment"):
        SceneEnv(simulator=simulator)
    with pytest.raises(UsageError, match="one object per environment"):
        gymnasium.make_vec(
            "oodscen/Scene-v0", 2, vectorization_mode="sync", simulator=FlatSimulator()
        )
    env.close()
    other = made(simulator=simulator)
    other.reset(seed=0)
    with pytest.raises(UsageError, match="one object per environment"):
        env.reset()
    del other
    made.cache_clear()
    env.reset()
    fresh = made()
    again = pickle.loads(pickle.dumps(fresh))  # It has a simulator of its own.
    assert again.reset(seed=0)[1] == fresh.reset(seed=0)[1]


def test_a_copy_has_no_simulator_of_its_own(made):
    env = made()
    other = copy.copy(env)
    env.reset()
    with pytest.raises(UsageError, match="another open environment"):
        other.reset()
    env.step(env.action_space.sample())


@pytest.mark.parametrize("duplicate", [copy.copy, copy.deepcopy, pickle.dumps])
def test_an_environment_that_runs_a_scene_is_not_duplicated(made, duplicate):
    env = made()
    env.reset()
    with pytest.raises(UsageError, match="after reset"):
        duplicate(env)
    env.step(env.action_space.sample())


def test_one_environment_of_a_vector_takes_an_object():
    envs = gymnasium.make_vec(
        "oodscen/Scene-v0", 1, vectorization_mode="sync", simulator=FlatSimulator()
    )
    envs.reset(seed=0)
    envs.close()


class Faulty(FlatSimulator):
    """Tells nonsense from the second step on, or in every picture."""

    def __init__(self, fault):
        super().__init__()
        self.fault = fault

    def step(self, control):
        state = super().step(control)
        if self.fault == "none":
            return None
        if self.fault == "raises":
            raise RuntimeError("no idea")
        if self.fault == "nan":
            return replace(state, poses=state.poses * math.nan)
        if self.fault == "short":
            return replace(state, speeds=state.speeds[:1])
        if self.fault == "no places":
            return replace(state, places=state.places * math.inf)
        return replace(state, time=0.0) if self.fault == "no time" else state

    def observe(self):
        seen = super().observe()
        return replace(seen, offset_m=math.nan) if self.fault == "blind" else seen

    def render(self, camera):
        frame = super().render(camera)
        return None if self.fault == "no frame" else replace(frame, rgb=frame.rgb[:2])


@pytest.mark.parametrize(
    "fault",
    [
        *("none", "raises", "nan", "short", "no places", "no time", "blind"),
        *("no frame", "cut frame"),
    ],
)
def test_a_faulty_simulator_is_named_and_ends_the_episode(made, fault):
    kind = "frame" if "frame" in fault else "state"
    env = made(simulator=Faulty(fault), observation=kind, camera=TINY)
    methods = {"raises": "no idea", "blind": r"observe\(\)"}
    method = r"render\(\)" if kind == "frame" else methods.get(fault, r"step\(\)")
    with pytest.raises(SimulatorError, match=rf"(?s){method}.*flat|flat.*{method}") as caught:
        one_step(env)
    assert isinstance(caught.value, SimulatorCrash) == (fault == "raises")
    if kind == "state":
        with pytest.raises(OodscenError, match="reset"):
            env.step([0.0, 0.0])


def one_step(env):
    """Take a step, with the duration of the scene from a sound simulator."""
    sound = SceneEnv(scenes=[example_scene()])
    sound.reset(seed=0)
    env._prepared["example-001"] = sound._prepared["example-001"]
    env.reset(seed=0)
    env.step([0.0, 0.0])


class FromAbove(FlatSimulator):
    """Sees from above only, and records its cameras."""

    def __init__(self):
        super().__init__()
        self.cameras = []

    def catalogue(self):
        return super().catalogue().model_copy(update={"camera": "top"})

    def draw(self, camera):
        self.cameras.append(camera)
        return super().draw(camera)


def test_a_simulator_that_sees_from_above_is_asked_for_nothing_else(made):
    simulator = FromAbove()
    env = made(simulator=simulator, observation="frame", camera=TINY, render_mode="rgb_array")
    picture, _ = env.reset(seed=0)
    assert picture.shape == (TINY.height, TINY.width, 3)
    assert env.render().shape == (480, 640, 3)
    assert {camera.pitch_deg for camera in simulator.cameras} == {90.0}


def test_every_step_has_a_frame_rate_that_videos_can_have(made):
    rates = [made(step_s=step_s).metadata["render_fps"] for step_s in (0.05, 0.5, 10.0)]
    assert rates == [20, 2, 1]


def test_only_a_camera_looks(made):
    env = made()
    env.reset(seed=0)
    with pytest.raises(UsageError, match="camera"):
        env.look("dash")
