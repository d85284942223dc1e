import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.driving import BEHAVIOURS, KinematicWorld
from oodscen.driving.behaviours import BEHAVE, MOVES_BEFORE_TRIGGER
from oodscen.driving.bodies import ActorBody
from oodscen.protocols import Control
from oodscen.scene import Actor, Trigger
from tests.driving.staging import CATALOGUE, actor, scene, world

LATER = Trigger(kind="time", value=2.0)


def run(staged: Actor, seconds: float, *others: Actor, map: str = "urban_avenue") -> KinematicWorld:
    """Let an actor act while the ego stands still."""
    result = world(scene(staged, *others, map=map, speed=0.0))
    for _ in range(round(seconds / result.dt)):
        result.step(Control())
    return result


def offset(result: KinematicWorld, body: ActorBody) -> float:
    return body.t - result.corridor.centre(body.lane, body.s)


def test_every_behaviour_is_described_and_done() -> None:
    assert {kind.id for kind in BEHAVIOURS} == set(BEHAVE)
    assert set(BEHAVE) >= MOVES_BEFORE_TRIGGER


@pytest.mark.parametrize("kind", BEHAVIOURS, ids=lambda kind: kind.id)
def test_everybody_moves_without_leaps(kind) -> None:
    for category in kind.categories:
        if category == "signal":
            continue
        asset = next(one for one in CATALOGUE.assets if one.category == category)
        staged = actor("a", asset.id, kind.id, trigger=Trigger(kind="time", value=1.0))
        result = world(scene(staged, speed=0.0))
        body = result.actors[0]
        for _ in range(160):
            before = (body.s, body.t, body.heading, body.speed)
            result.step(Control())
            far = math.hypot(body.s - before[0], body.t - before[1])
            faster = max(abs(body.speed), abs(before[3]))
            assert far <= 1.2 * faster * result.dt + 1e-4
            assert abs(body.speed - before[3]) <= 10.0 * result.dt + 1e-6 or body.speed == 0.0


@pytest.mark.parametrize("name", sorted(MOVES_BEFORE_TRIGGER - {"wrong_way"}))
def test_drivers_keep_their_lane_until_the_trigger(name: str) -> None:
    asset = "cyclist" if name == "wobble" else "car"
    result = run(actor("a", asset, name, speed=4.0, trigger=LATER), 1.9)
    other = run(actor("a", asset, "follow_lane", speed=4.0, trigger=LATER), 1.9)
    assert result.actors[0].snapshot()[:4] == other.actors[0].snapshot()[:4]


@pytest.mark.parametrize("name", sorted(set(BEHAVE) - MOVES_BEFORE_TRIGGER))
def test_others_stand_until_the_trigger(name: str) -> None:
    result = run(actor("a", "dog", name, heading=40.0, trigger=LATER), 1.9)
    assert result.actors[0].s == 230.0
    assert result.actors[0].speed == 0.0


@settings(max_examples=25)
@given(st.floats(1, 30), st.floats(1, 30), st.floats(0, 12))
def test_followers_never_touch_whoever_is_ahead(own: float, ahead: float, brake: float) -> None:
    gap = 10.0 + 2.0 * own + own * own / 8.0
    lead = actor(
        "lead", "car", "hard_brake", ahead=20.0 + gap, speed=ahead, deceleration=max(1.0, min(brake, 9)),
        trigger=LATER,
    )  # fmt: skip
    result = world(
        scene(actor("a", "car", "follow_lane", ahead=20.0, speed=own), lead, map="highway")
    )
    first, second = result.actors
    for _ in range(300):
        result.step(Control())
        assert second.s - first.s > 4.3


def test_followers_react_to_the_ego() -> None:
    result = run(actor("a", "car", "follow_lane", ahead=-60.0, speed=12.0), 20.0)
    body = result.actors[0]
    assert body.speed < 0.05
    assert 1.0 < result.ego.s - body.s - 4.4 < 4.0


@pytest.mark.parametrize("lanes", [1, -1])
def test_cut_in_moves_over_in_its_time(lanes: int) -> None:
    staged = actor(
        "a", "car", "cut_in", lane=0 if lanes > 0 else 1, speed=12.0, lanes=lanes, trigger=LATER
    )
    result = run(staged, 2.0 + 1.55)
    body = result.actors[0]
    assert abs(body.t - result.corridor.centre(body.target_lane, body.s)) < 0.02
    assert abs(body.heading) < 0.1


def test_hard_brake_stops_after_the_braking_distance() -> None:
    result = run(actor("a", "car", "hard_brake", speed=14.0, trigger=LATER, deceleration=7.0), 6.0)
    assert result.actors[0].speed == 0.0
    driven = result.actors[0].s - 230.0
    assert math.isclose(driven, 2.0 * 14.0 + 14.0**2 / 14.0, abs_tol=0.6)


def test_nobody_brakes_harder_than_the_road_allows() -> None:
    staged = actor("a", "car", "hard_brake", speed=14.0, deceleration=9.0)
    result = world(scene(staged, friction=0.2))
    result.step(Control())
    result.step(Control())
    assert 14.0 - result.actors[0].speed <= 2 * 0.2 * 9.81 * 0.05 + 1e-6


def test_stop_and_go_stops_and_goes() -> None:
    result = world(scene(actor("a", "car", "stop_and_go", speed=6.0, period=8.0), speed=0.0))
    speeds = []
    for _ in range(400):
        result.step(Control())
        speeds.append(result.actors[0].speed)
    assert min(speeds[:80]) == 0.0
    assert max(speeds[80:160]) > 4.0
    assert min(speeds[160:240]) == 0.0


def test_wrong_way_drivers_face_the_ego_whatever_the_heading() -> None:
    for lane, sign in ((0, -1), (2, 1)):
        for heading in (0.0, 180.0):
            staged = actor("a", "car", "wrong_way", lane=lane, heading=heading, speed=10.0)
            result = run(staged, 2.0)
            assert math.isclose(result.actors[0].s, 230.0 + sign * 20.0, abs_tol=1e-3)


def test_reverse_goes_backwards() -> None:
    result = run(actor("a", "car", "reverse", speed=3.0, trigger=LATER), 4.0)
    assert result.actors[0].speed == -3.0
    assert result.actors[0].s < 230.0
    assert result.actors[0].heading == 0.0


def test_pull_out_ends_in_the_lane_at_its_speed() -> None:
    staged = actor("a", "car", "pull_out", offset=-2.7, speed=6.0, trigger=LATER)
    result = run(staged, 9.0, map="residential_two_lane")
    body = result.actors[0]
    assert abs(offset(result, body)) < 0.02
    assert math.isclose(body.speed, 6.0, abs_tol=0.5)


def test_u_turn_drives_back_on_the_left() -> None:
    result = run(actor("a", "car", "u_turn", lane=1, ahead=40.0, trigger=LATER), 9.0)
    body = result.actors[0]
    assert math.isclose(abs(body.heading), math.pi, abs_tol=1e-3)
    assert math.isclose(offset(result, body), 2 * 5.0 * 4.0 / math.pi, abs_tol=0.5)
    assert body.speed == 5.0


def test_walkers_cover_their_distance_and_stop() -> None:
    result = run(actor("a", "adult", "cross_road", offset=-4, heading=90.0, distance=9.0), 12.0)
    body = result.actors[0]
    assert body.speed == 0.0
    assert math.isclose(offset(result, body), -4 + 9.0, abs_tol=1e-3)


def test_the_hesitant_come_back() -> None:
    staged = actor("a", "child", "hesitate", offset=-4, heading=90.0, distance=3.0, pause=1.0)
    result = world(scene(staged, speed=0.0))
    offsets = []
    for _ in range(200):
        result.step(Control())
        offsets.append(offset(result, result.actors[0]))
    assert math.isclose(max(offsets), -1.0, abs_tol=1e-3)
    assert offsets.count(max(offsets)) >= 20
    assert math.isclose(offsets[-1], -4.0, abs_tol=1e-3)


def test_weaving_stays_within_its_amplitude_and_uses_it() -> None:
    staged = actor("a", "cyclist", "wobble", amplitude=0.6, period=2.0, speed=5.0)
    result = world(scene(staged, speed=0.0))
    offsets = []
    for _ in range(200):
        result.step(Control())
        offsets.append(offset(result, result.actors[0]))
    assert max(map(abs, offsets)) <= 0.6 + 1e-6
    assert max(offsets[40:]) > 0.55
    assert min(offsets[40:]) < -0.55


@pytest.mark.parametrize("lateral", [-0.6, 0.6])
def test_drifting_ends_at_the_edge_of_the_road(lateral: float) -> None:
    result = run(actor("a", "car", "drift", speed=8.0, lateral=lateral), 30.0)
    body = result.actors[0]
    limits = result.corridor.drivable_range(body.s, body.t)
    assert limits is not None
    edge = limits[1] - 0.9 if lateral > 0 else limits[0] + 0.9
    assert math.isclose(body.t, edge, abs_tol=0.02)


def test_oncoming_traffic_keeps_to_its_lane_on_a_curve() -> None:
    result = run(actor("a", "truck", "follow_lane", ahead=250.0, lane=1, speed=20.0), 10.0,
                 map="rural_curve")  # fmt: skip
    body = result.actors[0]
    assert math.isclose(body.s, 450.0 - 200.0, abs_tol=4.0)
    assert abs(offset(result, body)) < 1e-6
    assert abs(math.remainder(body.heading - math.pi, math.tau)) < 0.01
