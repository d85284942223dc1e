"""Simulating one scene: frames at three moments, every action, the same bytes each time."""

import math

import numpy as np
import pytest

from oodscen import drive, simulate
from oodscen.data._catalogue import Asset
from oodscen.data._episode import ACTIONS, MOMENTS, Episode
from oodscen.data._scene import Actor, Behaviour, Demand, Hazard, Placement, Scene, Trigger
from oodscen.errors import SceneError, SimulatorError, UsageError
from oodscen.protocols import Camera, Frame
from oodscen.stages._simulate import _steps_shown
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._scenes import example_scene

SMALL = Camera(width=80, height=60)


@pytest.fixture(scope="module")
def flat():
    with FlatSimulator() as simulator:
        yield simulator


@pytest.fixture(scope="module")
def result(flat):
    return simulate(example_scene(), flat, camera=SMALL)


def test_keeping_speed_hits_the_box_and_braking_does_not(result):
    actions = result.episode.actions
    assert tuple(actions) == ACTIONS
    assert actions["keep_speed"].contacts == ("box",)
    assert not actions["keep_speed"].safe
    assert actions["keep_speed"].margin_m == 0
    assert actions["emergency_brake"].safe
    assert actions["stop"].safe
    assert actions["stop"].final_speed == 0
    assert actions["change_lane_right"].unavailable
    assert not actions["change_lane_right"].safe
    assert actions["emergency_brake"].margin_m > 0


def test_the_decision_falls_where_the_trigger_says(result):
    episode = result.episode
    assert episode.decision_fired
    last = result.states[-1]
    ahead = float(last.poses[1, 0] - last.poses[0, 0])
    assert 25.0 - 8.0 * episode.dt <= ahead <= 25.0
    assert episode.decision_s == pytest.approx(last.time)


def test_three_frames_show_the_approach(result):
    assert tuple(result.frames) == MOMENTS
    pixels = [result.episode.visible[moment].get("box", 0) for moment in MOMENTS]
    assert pixels[0] < pixels[2]
    assert all(frame.rgb.shape == (60, 80, 3) for frame in result.frames.values())


class Buffers:
    """Returns the same arrays from every call, as engines do that own their buffers."""

    kept: Frame | None = None

    def same(self, frame):
        if self.kept is None:
            self.kept = frame
        for name in ("rgb", "depth", "ids"):
            getattr(self.kept, name)[:] = getattr(frame, name)
        return self.kept


class DrawsIntoBuffers(Buffers, FlatSimulator):
    def draw(self, camera):
        return self.same(super().draw(camera))


class RendersIntoBuffers(Buffers, FlatSimulator):
    def render(self, camera):
        return self.same(super().render(camera))


@pytest.mark.parametrize("make", [DrawsIntoBuffers, RendersIntoBuffers])
def test_a_simulator_may_draw_into_the_same_arrays_every_time(make, result):
    scene = example_scene()
    assert simulate(scene, make(), camera=SMALL, actions=()).episode.frame_sha256 == (
        result.episode.frame_sha256
    )
    twin = scene.twin(2.0)  # Its frames are taken from snapshots.
    mine, plain = (
        simulate(twin, one, camera=SMALL, actions=()) for one in (make(), FlatSimulator())
    )
    assert mine.episode.frame_sha256 == plain.episode.frame_sha256
    assert mine.episode.visible == plain.episode.visible


def test_the_same_scene_and_seed_give_the_same_bytes_after_another_scene(flat, result):
    simulate(
        example_scene().model_copy(update={"id": "other", "map": "highway"}),
        flat,
        camera=SMALL,
        actions=("stop",),
    )
    again = simulate(example_scene(), flat, camera=SMALL)
    assert again.episode == result.episode
    for moment in MOMENTS:
        np.testing.assert_array_equal(again.frames[moment].rgb, result.frames[moment].rgb)


def test_without_snapshots_the_actions_are_replayed_to_the_same_end(result):
    class Replayed(FlatSimulator):
        snapshot = restore = None

    with Replayed() as simulator:
        again = simulate(example_scene(), simulator, camera=SMALL)
    assert again.episode == result.episode


def test_a_simulator_that_is_not_deterministic_claims_no_safe_action():
    class Drifting(FlatSimulator):
        resets = 0

        def reset(self, scene, seed):
            self.resets += 1
            ego = scene.ego.model_copy(update={"speed": scene.ego.speed + 0.01 * self.resets})
            return super().reset(scene.model_copy(update={"ego": ego}), seed)

    with Drifting() as simulator:
        episode = simulate(example_scene(), simulator, render=False).episode
    assert not episode.is_deterministic
    assert episode.safe_set == ()


def test_a_trigger_that_never_fires_is_said_and_the_approach_ends(flat):
    scene = example_scene()
    moved = scene.actors[0].model_copy(
        update={"placement": scene.actors[0].placement.model_copy(update={"ahead_m": 250.0})}
    )
    episode = simulate(
        scene.model_copy(
            update={"actors": (moved,), "decision": Trigger(kind="ttc", value=1, actor="box")}
        ),
        flat,
        render=False,
        actions=(),
    ).episode
    assert not episode.decision_fired
    assert episode.decision_s == pytest.approx(15.0, abs=0.1)


def test_the_twin_without_the_box_is_safe_for_keeping_speed(flat, result):
    twin = example_scene().twin(result.episode.decision_s)
    episode = simulate(twin, flat, render=False).episode
    assert episode.actions["keep_speed"].safe
    assert episode.decision_s == result.episode.decision_s


def test_a_refused_scene_names_every_fault(flat):
    scene = example_scene()
    actor = scene.actors[0].model_copy(
        update={"asset": "cardbord_box", "behaviour": Behaviour(name="stnd")}
    )
    with pytest.raises(SceneError) as caught:
        simulate(scene.model_copy(update={"actors": (actor,), "map": "residental"}), flat)
    assert {issue.path for issue in caught.value.issues} == {
        "map",
        "actors[0].asset",
        "actors[0].behaviour.name",
    }


@pytest.mark.parametrize(
    "changed", [{"actors": ()}, {"horizon_s": math.nan}, {"map": 5}, {"weather": None}, {"id": ""}]
)
def test_a_scene_that_was_changed_into_none_is_refused(flat, changed):
    scene = example_scene().model_copy(update=changed)
    with pytest.raises(SceneError):
        simulate(scene, flat, render=False)
    assert scene.check(flat.catalogue())


@pytest.mark.parametrize("moments", [(), ("first",), ("last", "x"), ("at-0", "last"), ("last", 5)])
def test_moments_that_there_are_not_are_refused(flat, moments):
    with pytest.raises(UsageError):
        simulate(example_scene(), flat, moments=moments)


class _Slow(FlatSimulator):
    """A simulator that varies nothing but the reaction time."""

    rehearse = None  # type: ignore[assignment]


@pytest.mark.parametrize(
    "scene", [example_scene(), example_scene().twin(2.0)], ids=["rare", "twin"]
)
def test_actions_begin_at_the_decision_in_whatever_order_the_moments_are_given(flat, scene):
    options = {"camera": SMALL, "actions": ("stop",), "traces": True}
    whole, turned = (
        simulate(scene, flat, moments=moments, **options) for moments in (MOMENTS, MOMENTS[::-1])
    )
    assert turned.episode == whole.episode
    assert turned.rollouts["stop"]["time"][0, 0] == whole.episode.decision_s


def test_labels_are_those_of_all_drivers(flat):
    early, late = (
        simulate(example_scene(), flat, render=False, reaction=(one,)).episode for one in (0.2, 1.5)
    )
    both = simulate(example_scene(), flat, render=False, reaction=(0.2, 1.5)).episode
    assert both.reaction_s == (0.2, 1.5)
    for action in ACTIONS:
        labels = {early.label(action), late.label(action)}
        assert both.label(action) == (labels.pop() if len(labels) == 1 else "marginal")
    assert not set(both.safe_set) & set(both.marginal_set)
    assert "marginal" in {both.label(action) for action in ACTIONS}


@pytest.mark.parametrize("told", [None, "False", math.nan, 1])
def test_a_rehearsal_says_yes_or_no(told):
    class Mumbles(FlatSimulator):
        def rehearse(self, *args, **kwargs):
            return told

    with Mumbles() as simulator, pytest.raises(SimulatorError, match=r"rehearse\(\) returned"):
        simulate(example_scene(), simulator, render=False)


@pytest.mark.parametrize("told", [None, "bad", [5], iter(())])
def test_a_check_of_the_simulator_s_own_returns_issues(told):
    class Mumbles(FlatSimulator):
        def check(self, scene):
            return told

    with Mumbles() as simulator, pytest.raises(SimulatorError, match=r"check\(\) returned"):
        simulate(example_scene(), simulator, render=False)


def test_without_rehearsals_only_the_reaction_time_varies(result):
    with _Slow() as simulator:
        slow = simulate(example_scene(), simulator, render=False).episode
    for action in ACTIONS:
        full = result.episode.label(action)
        assert slow.label(action) == full or full == "marginal"


def test_facts_of_the_decision_are_recorded(flat, result):
    episode = result.episode
    assert episode.ego_speed_mps == pytest.approx(float(result.states[-1].speeds[0]), abs=1e-3)
    assert [episode.frame_times_s[moment] for moment in MOMENTS] == sorted(
        episode.frame_times_s.values()
    )
    assert episode.frame_times_s["last"] == episode.decision_s
    assert episode.follower is None
    scene = example_scene()
    truck = Actor(
        id="behind",
        asset="truck",
        placement=Placement(ahead_m=-14.0),
        behaviour=Behaviour(name="follow_lane", parameters={"speed": scene.ego.speed}),
    )
    followed = scene.model_copy(update={"actors": (*scene.actors, truck)})
    near = simulate(followed, flat, render=False).episode.follower
    assert near is not None
    assert near.what == "truck"
    assert 0.0 < near.gap_m < 20.0


def test_a_follower_farther_behind_than_gaps_are_measured_has_its_gap_along_the_road(flat):
    scene = example_scene()
    behind = Actor(
        id="behind",
        asset="truck",
        placement=Placement(ahead_m=-90.0),
        behaviour=Behaviour(name="run_red", parameters={"speed": 25.0}),
    )
    decision = Trigger(kind="time", value=0.2)
    followed = scene.model_copy(update={"actors": (*scene.actors, behind), "decision": decision})
    episode = simulate(followed, flat, render=False, actions=["stop"]).episode
    assert episode.followers == ("behind",)
    assert episode.follower is not None
    assert 75.0 < episode.follower.gap_m < 90.0


@pytest.mark.parametrize("reaction", [(), (-0.1,), (9.0,), (True,), (math.nan,)])
def test_reaction_times_are_checked(flat, reaction):
    with pytest.raises(UsageError):
        simulate(example_scene(), flat, render=False, reaction=reaction)


def test_the_horizon_can_be_given(flat):
    found = simulate(example_scene(), flat, render=False, horizon=1.0)
    assert found.episode.horizon_s == 1.0
    assert found.episode.actions["stop"].final_speed > 0.0


def test_flat_things_neither_touch_nor_threaten(flat):
    """What can be driven over counts alike in contact, gap and time to collision."""
    scene = example_scene()
    puddle = {**scene.actors[0].model_dump(), "asset": "puddle", "state": ""}
    wet = Scene.model_validate({**scene.model_dump(), "actors": [puddle, *scene.actors[1:]]})
    outcome = simulate(wet, flat, render=False).episode.actions["keep_speed"]
    assert outcome.label == "safe"
    assert outcome.contacts == ()
    assert (outcome.margin_m, outcome.min_ttc_s, outcome.pet_s) == (None, None, None)


LIGHT = Asset(
    id="traffic_light",
    category="signal",
    description="a traffic light",
    length=0.5,
    width=0.5,
    height=3.5,
    states=("red", "green"),
)


class _Lit(FlatSimulator):
    """The flat simulator with a traffic light."""

    def catalogue(self):
        known = super().catalogue()
        return known.model_copy(update={"assets": (*known.assets, LIGHT)})


def at_a_light(*, kind="red_light", red_from_s=0.0):
    light = Actor(
        id="light",
        asset="traffic_light",
        placement=Placement(ahead_m=40.0, offset_m=-4.5),
        behaviour=Behaviour(trigger=Trigger(value=red_from_s)),
        state="red",
    )
    return example_scene().model_copy(
        update={
            "id": "scene~demand",
            "map": "urban_avenue",
            "actors": (light,),
            "hazard": Hazard(),
            "decision": Trigger(value=1.0),
            "demand": Demand(kind=kind, text="The traffic light is red."),
        }
    )


def labels(scene, **options):
    with _Lit() as simulator:
        return simulate(scene, simulator, render=False, **options).episode


def test_every_action_that_passes_the_stop_line_at_red_is_unsafe():
    episode = labels(at_a_light())
    assert episode.stop_line.ahead_m == 39.0
    assert Episode.parse(episode.model_dump_json()) == episode
    ran = {name for name, outcome in episode.actions.items() if outcome.ran_red}
    assert {"keep_speed", "change_lane_left"} <= ran
    assert {episode.label(name) for name in ran} <= {"unsafe", "marginal"}
    assert episode.label("keep_speed") == episode.label("change_lane_left") == "unsafe"
    assert episode.label("emergency_brake") == "safe"


def test_a_light_counts_while_it_is_red_and_where_it_is_the_demand():
    for scene in (at_a_light(red_from_s=30.0), at_a_light(kind="queue")):
        assert labels(scene).label("keep_speed") == "safe"
    paper = labels(at_a_light(), protocol="paper")
    assert paper.label("keep_speed") == "safe"
    assert paper.stop_line is None


def test_a_drive_without_a_stop_line_says_nothing_of_one(result):
    assert "stop_line" not in result.episode.model_dump_json()
    assert "ran_red" not in result.episode.model_dump_json()


@pytest.mark.parametrize("made", [None, {}, "flat"])
def test_what_is_no_catalogue_is_told_as_such(made):
    class Without(FlatSimulator):
        def catalogue(self):
            return made

    said = f"the catalogue of 'flat' is {'None' if made is None else 'of type'}"
    for render in (False, True):
        with pytest.raises(UsageError, match=said):
            simulate(example_scene(), Without(), render=render)
    (failed, *_) = drive([example_scene()], "rule-based", Without())
    assert said in failed.error


def test_a_moment_is_its_percent_of_the_steps_in_whole_numbers():
    moments = [f"at-{percent}" for percent in range(1, 100)]
    for last in range(1, 400):
        assert list(_steps_shown(last, moments).values()) == [
            last * percent // 100 for percent in range(1, 100)
        ]
