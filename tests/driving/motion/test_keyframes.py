import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from oodscen.data._designs.motion import ABILITIES, Motion
from oodscen.data._scene import Scene
from oodscen.driving._motion.world import KinematicWorld
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._sight.placement import staging_issues
from oodscen.protocols import Control
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE
from tests.motions import sound_motions

Pose = np.ndarray[Any, Any]

_ASSETS = {
    "person": "adult", "animal": "dog", "cyclist": "cyclist", "car": "car", "truck": "truck",
    "loose": "cone", "flying": "cone",
}  # fmt: skip


def scene_of(motion: Motion | dict[str, Any], *, speed: float = 8.0, **more: Any) -> Scene:
    """Return a scene in which one actor moves so, beside a car that it may follow."""
    made = motion if isinstance(motion, Motion) else Motion.parse(motion)
    lead = more.pop("lead", {"name": "follow_lane", "parameters": {"speed": 7.0}})
    other = "lead" if made.frame == "other" else None
    placement = more.pop("placement", {"ahead_m": 25.0, "offset_m": -0.5})
    return Scene.parse(
        {
            "id": "moves",
            "scenario_id": "moves",
            "map": "urban_three_lane",
            "ego": {"speed": speed},
            "actors": [
                {
                    "id": "lead",
                    "asset": "car",
                    "placement": {"ahead_m": 40.0, "lane": 1},
                    "behaviour": lead,
                },
                {
                    "id": "thing",
                    "asset": more.pop("asset", _ASSETS[made.body]),
                    "placement": placement,
                    "behaviour": {"name": made.id, "other": other, **more},
                },
            ],
            "hazard": {"actors": {"thing": None, "lead": None}},
            "decision": {"kind": "time", "value": 2.0},
            "motions": [made.model_dump(mode="json")],
        }
    )


def world_of(scene: Scene, seed: int = 0) -> KinematicWorld:
    return KinematicWorld(load_corridor(scene.map, FLAT_CATALOGUE), scene, FLAT_CATALOGUE, seed)


LEADS = [
    {"name": "follow_lane", "parameters": {"speed": 7.0}},
    {"name": "follow_lane", "parameters": {"speed": 40.0}},
    {"name": "swerve", "parameters": {"speed": 2.0, "amplitude": 2.0, "period": 2.0}},
    {"name": "u_turn", "trigger": {"kind": "time", "value": 0.5}},
]
"""What a body may stand on or follow: at its pace, faster than any, turning, and turning round."""
PLACES = [
    {"ahead_m": 25.0, "offset_m": -0.5},
    {"ahead_m": 25.0, "offset_m": -0.5, "heading_deg": 90.0},
    {"ahead_m": 39.5, "lane": 1, "heading_deg": 20.0},
]
"""Behind the other body, across, and on it."""


@settings(max_examples=25, deadline=None)
@given(sound_motions(), st.integers(0, 5), st.sampled_from([0.0, 1.0]))
def test_every_motion_is_finite_and_repeats(motion: Motion, seed: int, begins: float) -> None:
    scene = scene_of(motion, trigger={"kind": "time", "value": begins})
    world = world_of(scene, seed)
    trace = []
    for k in range(70):
        if k == 30:
            saved = world.snapshot()
        world.step(Control(0.5 if k < 40 else -2.0, 0.01))
        state = world.state()
        assert np.isfinite(state.poses[2]).all()
        assert state.gaps[2] >= 0.0
        trace.append(state.poses[2])
    world.restore(saved)
    again = world_of(Scene.parse(scene.to_json()), seed)
    for k in range(70):
        again.step(Control(0.5 if k < 40 else -2.0, 0.01))
        assert (again.poses()[2] == trace[k]).all()
        if k >= 30:
            world.step(Control(0.5 if k < 40 else -2.0, 0.01))
            assert (world.poses()[2] == trace[k]).all()


def spot_on(body: Pose, place: Pose) -> Pose:
    """Return a place in the coordinates of a body."""
    dx, dy = place[0] - body[0], place[1] - body[1]
    sine, cosine = math.sin(body[3]), math.cos(body[3])
    return np.array([dx * cosine + dy * sine, dy * cosine - dx * sine])


@settings(max_examples=30, deadline=None)
@given(
    sound_motions(), st.integers(0, 5), st.sampled_from(LEADS), st.sampled_from(PLACES),
    st.sampled_from([0.0, 1.0]),
)  # fmt: skip
def test_no_body_moves_faster_than_it_can(
    motion: Motion, seed: int, lead: dict[str, Any], place: dict[str, Any], begins: float
) -> None:
    """Along the ground and up or down, but for what it stands on, and for what is let go and falls."""
    trigger = {"kind": "time", "value": begins}
    scene = scene_of(motion, speed=14.0, trigger=trigger, lead=lead, placement=place)
    world = world_of(scene, seed)
    _, lead_asset, _ = FLAT_CATALOGUE.bodies(scene)[1]
    able, dt = ABILITIES[motion.body], world.dt
    most, flying = motion.fastest * dt + 1e-5, None
    length, width = lead_asset.length, lead_asset.width
    for _ in range(160):
        before, at = world.poses(), world.time
        world.step(Control(1.0))
        after = world.poses()
        moved = math.dist(after[2][:2], before[2][:2])
        if motion.let_go is not None and at >= begins + motion.let_go:
            # What has been let go at some pace never moves faster.
            assert flying is None or moved <= flying + 1e-4
            flying = moved
            continue
        assert abs(after[2][2] - before[2][2]) <= able.climb * dt + 1e-5
        spot = spot_on(before[1], before[2])
        if motion.frame == "other" and abs(spot[0]) <= length / 2 and abs(spot[1]) <= width / 2:
            moved = min(moved, math.dist(spot, spot_on(after[1], after[2])))
        assert moved <= most
    assert abs(world.motion("thing").speed) * dt <= most or motion.frame == "other"


@settings(max_examples=15, deadline=None)
@given(
    sound_motions(frame="start", by="time"),
    st.integers(0, 5),
    st.sampled_from([0.0, 1.0]),
)
def test_no_body_gathers_or_loses_pace_faster_than_it_can(
    motion: Motion, seed: int, begins: float
) -> None:
    """Whatever its delay and pace, and whether it comes on before or begins at rest."""
    scene = scene_of(motion, trigger={"kind": "time", "value": begins}, placement=PLACES[1])
    world = world_of(scene, seed)
    rows = [world.poses()[2][:2]]
    for _ in range(200):
        world.step(Control())
        rows.append(world.poses()[2][:2])
    changes = np.diff(np.array(rows), n=2, axis=0) / world.dt**2
    # The places are rounded to 1e-6 m.
    assert np.hypot(*changes.T).max() <= ABILITIES[motion.body].acceleration + 0.01


def test_what_comes_on_keeps_coming_through_its_delay() -> None:
    keys = [{"at": 0}, {"at": 2, "ahead": 12}]
    motion = made(body="truck", keys=keys, begins="moving", then="go_on", delay=3)
    seen = course(scene_of(motion, trigger={"kind": "time", "value": 1.0}), 120)
    steps = np.hypot(*np.diff(seen[:, :2], axis=0).T) / 0.05
    assert np.allclose(steps, 6.0, atol=0.01)


@settings(max_examples=25, deadline=None)
@given(
    st.sampled_from(["start", "lane"]), st.floats(-180.0, 180.0), st.integers(-8, 8),
    st.integers(-8, 8), st.integers(-180, 180), st.sampled_from([0, 0.3]),
    st.sampled_from(["fixed", "along", "against"]),
)  # fmt: skip
def test_what_comes_on_has_its_speed_and_faces_its_way_from_the_start(
    frame: str, heading_deg: float, ahead: int, left: int, yaw: int, pace: float, facing: str
) -> None:
    assume(ahead or left)
    keys = [{"at": 0, "yaw": yaw}, {"at": 2, "ahead": ahead, "left": left, "yaw": yaw}]
    motion = made(body="loose", frame=frame, facing=facing, begins="moving", pace=pace, keys=keys)
    placement = {"ahead_m": 25.0, "heading_deg": heading_deg}
    world = world_of(scene_of(motion, trigger={"kind": "time", "value": 1.0}, placement=placement))
    speed, facing_rad = world.motion("thing").speed, world.poses()[2, 3]
    world.step(Control(0.0))
    assert world.motion("thing").speed == pytest.approx(speed, abs=1e-4)
    assert math.remainder(world.poses()[2, 3] - facing_rad, math.tau) == pytest.approx(0, abs=1e-4)


def test_what_nobody_carries_is_refused_by_the_name_of_its_motion() -> None:
    motion = made(body="loose", frame="other", keys=[{"at": 0, "up": 1.0}])
    with pytest.raises(ValueError, match="'thing' needs another actor to do 'moves'"):
        world_of(scene_of(motion, other=None))


def test_what_another_body_carries_goes_at_that_ones_speed_and_steps_off_at_its_own() -> None:
    motion = made(
        body="person", frame="other", keys=[{"at": 0, "up": 1.4}, {"at": 2, "left": -3, "up": 1}]
    )
    lead = {"name": "follow_lane", "parameters": {"speed": 14.0}}
    scene = scene_of(motion, lead=lead, placement=PLACES[2], trigger={"kind": "time", "value": 1.0})
    steps = np.hypot(*np.diff(course(scene, 120)[:, :2], axis=0).T) / 0.05
    assert steps[:19].min() > 13.0
    assert np.allclose(steps[-20:], 8.0, atol=0.01)


def course(scene: Scene, steps: int, control: Control | None = None) -> np.ndarray[Any, Any]:
    """Return the poses of the thing and its gap to the ego at every step: [steps, 5]."""
    world = world_of(scene)
    rows = []
    for _ in range(steps):
        world.step(control or Control())
        rows.append([*world.poses()[2], world.state().gaps[2]])
    return np.array(rows)


def made(**members: Any) -> dict[str, Any]:
    return {"id": "moves", "description": "moves somehow", **members}


def test_keys_are_reached_at_their_times() -> None:
    keys = [
        {"at": 0},
        {"at": 2, "ahead": 3, "left": 1},
        {"at": 4, "ahead": 3, "left": 1},
        {"at": 6},
    ]
    start = world_of(scene_of(made(body="person", keys=keys))).poses()[2]
    seen = course(scene_of(made(body="person", keys=keys)), 140)
    apart = seen[:, :2] - start[:2]
    assert np.allclose(apart[39], [3, 1], atol=0.02)
    assert np.allclose(apart[79], [3, 1], atol=0.02)
    assert np.allclose(apart[130], [0, 0], atol=0.02)


def test_nothing_moves_before_its_trigger() -> None:
    scene = scene_of(
        made(body="loose", keys=[{"up": -0.9}, {"at": 1}]), trigger={"kind": "time", "value": 1.0}
    )
    seen = course(scene, 60)
    assert (seen[:18, 2] == -0.9).all()
    assert seen[-1, 2] == 0.0


@pytest.mark.parametrize("frame", ["start", "lane", "other", "ego"])
def test_the_pose_of_the_first_key_is_there_from_the_start(frame: str) -> None:
    first = {"at": 0, "up": 0.5, "yaw": 150, "pitch": 20}
    motion = made(body="loose", frame=frame, keys=[first, {**first, "at": 1, "yaw": 120}])
    world = world_of(scene_of(motion, trigger={"kind": "time", "value": 1.0}))
    begun, speed = world.poses()[2], world.motion("thing").speed
    world.step(Control())
    assert begun[3] == pytest.approx(math.radians(150))
    assert world.poses()[2][2:] == pytest.approx(begun[2:])
    assert world.motion("thing").speed == pytest.approx(speed, abs=0.02)


def test_what_has_sunk_blocks_nobody_until_it_rises() -> None:
    motion = made(body="loose", keys=[{"up": -0.9}, {"at": 1}])
    place = {"ahead_m": 6.0}
    sunk = scene_of(motion, trigger={"kind": "time", "value": 50.0}, placement=place)
    assert (course(sunk, 40)[:, 4] == math.inf).all()
    assert course(scene_of(motion, placement=place), 40)[:, 4].min() == 0.0


def test_a_fall_reaches_what_an_upright_box_does_not() -> None:
    fall = made(body="person", keys=[{"at": 0}, {"at": 1, "pitch": 90}])
    still = made(body="person", keys=[{"at": 0}, {"at": 1, "roll": 1}])
    beside = {"ahead_m": 16.0, "offset_m": 2.3, "heading_deg": -90.0}
    assert course(scene_of(still, placement=beside), 60)[:, 4].min() > 0.0
    assert course(scene_of(fall, placement=beside), 60)[:, 4].min() == 0.0


def test_what_is_towed_is_let_go() -> None:
    motion = made(body="car", frame="other", let_go=2.0, keys=[{"at": 0}])
    scene = scene_of(
        motion, asset="car", placement={"ahead_m": 33.0, "lane": 1, "heading_deg": 180.0}
    )
    seen = course(scene, 200)
    assert np.ptp(np.diff(seen[:38, 0])) < 0.02
    assert np.diff(seen[-5:, 0]).max() < np.diff(seen[:38, 0]).min()
    assert abs(abs(seen[-1, 3]) - math.pi) < 1e-3


def test_a_crowd_differs_by_actor_and_seed() -> None:
    motion = made(body="person", delay=4, pace=0.3, walk={"distance": 8})
    one = scene_of(motion)
    assert (course(one, 80)[:, :2] == course(one, 80)[:, :2]).all()
    world, other = world_of(one, 0), world_of(one, 1)
    for _ in range(80):
        world.step(Control())
        other.step(Control())
    assert (world.poses()[2] != other.poses()[2]).any()


def test_the_ego_drives_a_motion_over_its_distance() -> None:
    motion = made(body="loose", by="ego", keys=[{"at": 0}, {"at": 10, "left": 2}])
    assert np.ptp(course(scene_of(motion, speed=0.0), 40)[:, 1]) == 0.0
    assert np.ptp(course(scene_of(motion, speed=8.0), 40)[:, 1]) == pytest.approx(2.0, abs=0.02)


def test_a_motion_off_the_map_is_refused_with_its_key() -> None:
    far = made(
        body="car", keys=[{"at": 0}, {"at": 20, "ahead": 190}, {"at": 40, "left": 99, "ahead": 190}]
    )
    (fault,) = staging_issues(scene_of(far), FLAT_CATALOGUE)
    assert fault.path == "motions[0].keys[2]"
