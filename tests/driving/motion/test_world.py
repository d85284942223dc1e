import hashlib
import math
import subprocess
import sys
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.data._scene import Behaviour, Trigger
from oodscen.driving import KinematicWorld
from oodscen.driving._motion.actions import Cruise
from oodscen.driving._motion.columns import SPEED, YAW, X, Y
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.errors import UnknownComponent, UsageError
from oodscen.protocols import Control
from tests.driving.staging import actor, scene, world

controls = st.lists(
    st.builds(Control, st.floats(-8, 3), st.floats(-0.2, 0.2)), min_size=1, max_size=25
)
BUSY = scene(
    actor("a", "car", "follow_lane", ahead=40.0, speed=8.0),
    actor("b", "car", "cut_in", lane=1, ahead=15.0, speed=12.0, lanes=-1),
    actor("c", "cyclist", "wobble", ahead=70.0, offset=-0.6),
    actor("d", "dog", "bolt", ahead=60.0, offset=-4.0, heading=90.0,
          trigger=Trigger(kind="distance", value=50.0)),
    actor("e", "truck", "follow_lane", ahead=150.0, lane=2, speed=11.0),
    actor("f", "adult", "hesitate", ahead=25.0, offset=-3.2, heading=80.0,
          trigger=Trigger(kind="ttc", value=4.0)),
)  # fmt: skip


def trace(result: KinematicWorld, steps: int = 100) -> bytes:
    driver, rows = Cruise(), []
    for _ in range(steps):
        rows += [result.poses().tobytes(), result.speeds().tobytes()]
        result.step(driver.act(result.observe()))
    return b"".join(rows)


@settings(max_examples=25)
@given(controls, controls)
def test_a_restored_snapshot_goes_on_exactly_as_before(
    before: list[Control], after: list[Control]
) -> None:
    one = world(BUSY)
    for control in before:
        one.step(control)
    kept = one.snapshot()
    ends = []
    for _ in range(2):
        for control in after:
            one.step(control)
        ends.append((one.snapshot(), one.poses().tobytes(), one.speeds().tobytes(), one.time))
        one.restore(kept)
    assert ends[0] == ends[1]
    other = world(BUSY)
    other.restore(kept)
    for control in after:
        other.step(control)
    assert other.snapshot() == ends[0][0]


def test_the_same_seed_gives_the_same_bytes_and_another_does_not() -> None:
    assert trace(world(BUSY, seed=1)) == trace(world(BUSY, seed=1))
    assert trace(world(BUSY, seed=1)) != trace(world(BUSY, seed=2))


def test_a_fresh_process_gives_the_same_bytes() -> None:
    code = (
        "import hashlib; from tests.driving.motion.test_world import *;"
        "print(hashlib.sha256(trace(world(BUSY, seed=4))).hexdigest())"
    )
    fresh = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert fresh.stdout.strip() == hashlib.sha256(trace(world(BUSY, seed=4))).hexdigest()


def test_removing_an_actor_shifts_no_other() -> None:
    fewer = BUSY.model_copy(update={"actors": BUSY.actors[2:]})
    full, thinned = world(BUSY, seed=5), world(fewer, seed=5)
    for _ in range(60):
        full.step(Control())
        thinned.step(Control())
    for body in "cde":
        assert full.motion(body) == thinned.motion(body)


@settings(max_examples=20)
@given(controls)
def test_all_state_is_quantised(demands: list[Control]) -> None:
    one = world(BUSY)
    for control in demands:
        one.step(control)
    for array in (one.poses(), one.speeds()):
        assert np.array_equal(array, np.round(array, 6) + 0.0)
        assert np.isfinite(array).all()


@pytest.mark.parametrize("road", SHIPPED_MAPS, ids=lambda road: road.id)
def test_a_blind_driver_keeps_its_lane(road) -> None:
    for lane in range(road.lanes):
        one = world(scene(map=road.id, speed=road.speed_limit, lane=lane))
        driver = Cruise()
        within = 0.1 if np.abs(one.corridor.curvature).max() < 0.02 else 0.6
        for _ in range(round(0.9 * road.length_m / road.speed_limit / one.dt)):
            one.step(driver.act(one.observe()))
            told = one.observe()
            assert abs(told.offset_m) < within
            assert not one.is_off_road()
        assert math.isclose(one.ego.speed, min(road.speed_limit, told.curve_speed), abs_tol=0.05)


def test_the_driver_is_told_about_the_lanes_beside_it() -> None:
    avenue = world(scene(lane=1)).observe()
    assert (avenue.lane_left_m, avenue.lane_right_m) == pytest.approx((3.4, -3.4))
    street = world(scene(map="residential_two_lane")).observe()
    assert (street.lane_left_m, street.lane_right_m) == (3.25, None)
    highway = world(scene(map="highway", lane=1)).observe()
    assert highway.lane_left_m is None
    assert highway.roadside_m < -3.75 - 1.875


def put(one: KinematicWorld, x: float, y: float, yaw: float) -> None:
    """Put the ego somewhere and let it settle for a step."""
    kept = one.snapshot()
    state = np.frombuffer(kept.state).copy()
    state[[X, Y, YAW, SPEED]] = x, y, yaw, 0.0
    one.restore(kept._replace(state=state.tobytes()))
    one.step(Control())


def test_off_road_begins_where_the_footprint_leaves_the_road() -> None:
    one = world(scene(speed=10.0))
    right = one.corridor.drivable_range(one.ego.s, one.ego.t)[0]
    while not one.is_off_road():
        x, y, _, yaw = one.corridor.point(one.ego.s, one.ego.t - 0.01)
        put(one, x, y, yaw)
    assert math.isclose(one.ego.t - 0.925, right, abs_tol=0.011)


def test_the_oncoming_lane_is_road() -> None:
    one = world(scene(map="rural_curve"))
    x, y, _, yaw = one.corridor.point(one.ego.s, one.ego.t + 3.25)
    put(one, x, y, yaw)
    assert not one.is_off_road()


@pytest.mark.parametrize("lane", [2, 6])
def test_a_lane_that_does_not_exist_is_refused(lane: int) -> None:
    with pytest.raises(ValueError, match="lanes"):
        world(scene(lane=lane))


CONVOY = (
    actor("car", "car", "follow_lane", ahead=40.0, speed=8.0),
    actor("trailer", "car", "towed", ahead=34.0).model_copy(
        update={"behaviour": Behaviour(name="towed", other="car")}
    ),
    actor("last", "car", "towed", ahead=28.0).model_copy(
        update={"behaviour": Behaviour(name="towed", other="trailer")}
    ),
)


@pytest.mark.parametrize("order", list(permutations(range(3))), ids=str)
def test_what_is_towed_moves_alike_wherever_the_scene_names_it(order) -> None:
    one, other = (world(scene(*(CONVOY[i] for i in rows))) for rows in ((0, 1, 2), order))
    for _ in range(40):
        one.step(Control())
        other.step(Control())
    for body in ("car", "trailer", "last"):
        assert one.motion(body) == other.motion(body)


def test_actors_that_tow_each_other_in_a_ring_are_refused() -> None:
    ring = [
        one.model_copy(update={"behaviour": Behaviour(name="towed", other=other)})
        for one, other in zip(CONVOY, ("last", "car", "trailer"), strict=True)
    ]
    with pytest.raises(ValueError, match="in a ring"):
        world(scene(*ring))


NOT_NUMBERS = st.sampled_from([math.nan, math.inf, -math.inf])


@given(NOT_NUMBERS, st.integers(0, 6), st.integers(0, 4))
def test_measured_poses_that_are_no_numbers_move_nothing(value: float, row: int, column: int):
    busy = world(BUSY)
    before = busy.snapshot()
    poses, speeds = busy.poses(), busy.speeds()
    if column < 4:
        poses[row, column] = value
    else:
        speeds[row] = value
    for call in (
        lambda: busy.set_poses(poses, speeds),
        lambda: busy.follow(poses, speeds),
        lambda: busy.set_pose(row, poses[row], speeds[row]),
        lambda: busy.alter(speed=value),
        lambda: busy.alter(friction=value, speed=1.0),
    ):
        with pytest.raises(UsageError, match="finite"):
            call()
    assert busy.snapshot() == before


@given(st.integers(0, 9), st.integers(0, 6))
def test_measured_poses_have_a_row_for_every_body(count: int, width: int):
    busy = world(BUSY)
    poses, before = np.zeros((count, width)), busy.snapshot()
    if (count, width) != (len(busy.ids), 4):
        with pytest.raises(UsageError, match="shape"):
            busy.set_poses(poses, np.zeros(count))
    if width != 4:
        with pytest.raises(UsageError, match="shape"):
            busy.set_pose(0, np.zeros(width), 0.0)
    for row in (-1, len(busy.ids) + count):
        with pytest.raises(UsageError, match="row"):
            busy.set_pose(row, np.zeros(4), 0.0)
    with pytest.raises(UsageError, match="numbers"):
        busy.set_pose(0, "here", 0.0)
    assert busy.snapshot() == before


@given(st.text())
def test_an_unknown_body_is_named(name: str):
    busy = world(BUSY)
    for call in (busy.motion, busy.lanes, busy.free_road):
        if name not in busy.ids:
            with pytest.raises(UnknownComponent, match="unknown body"):
                call(name)


@given(st.floats(max_value=0.0) | st.floats(min_value=1.6))
def test_a_friction_is_one_of_a_road(friction: float):
    busy = world(BUSY)
    with pytest.raises(UsageError, match="friction"):
        busy.alter(friction=friction)
    assert busy.friction == world(BUSY).friction
