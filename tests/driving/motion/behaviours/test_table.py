import ast
import math
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from oodscen.data._scene import Actor, Trigger
from oodscen.data._weather import Weather
from oodscen.driving import KinematicWorld
from oodscen.driving._motion import columns as col
from oodscen.driving._motion.actions import Cruise
from oodscen.driving._motion.behaviours.codes import Code
from oodscen.driving._motion.behaviours.row import BehaviourRow
from oodscen.driving._motion.behaviours.table import BEHAVIOURS, BUILT_IN, MOVES_BEFORE_TRIGGER
from oodscen.protocols import Control
from tests.driving.staging import CATALOGUE, actor, scene, world

LATER = Trigger(kind="time", value=2.0)


def run(staged: Actor, seconds: float, *others: Actor, map: str = "urban_avenue") -> KinematicWorld:
    """Let an actor act while the ego stands still."""
    result = world(scene(staged, *others, map=map, speed=0.0))
    for _ in range(round(seconds / result.dt)):
        result.step(Control())
    return result


def offset(result: KinematicWorld, name: str = "a") -> float:
    body = result.motion(name)
    return body.t - result.corridor.centre(result.lanes(name)[0], body.s)


def test_every_behaviour_is_described_and_done() -> None:
    assert [row.code.name.lower() for row in BUILT_IN.values()] == [kind.id for kind in BEHAVIOURS]
    assert {row.code for row in BUILT_IN.values()} == set(Code) - {Code.KEYED}
    assert all(row.doing for row in BUILT_IN.values())


@pytest.mark.parametrize("row", BUILT_IN.values(), ids=lambda row: row.kind.id)
def test_what_a_row_says_fits_together(row: BehaviourRow) -> None:
    given = set(row.parameters)
    needed = {"stop": {"deceleration"}, "lane_change": {"lanes", "duration"}, "walk": {"speed"}}
    assert needed.get(row.plain_action, set()) <= given
    assert "speed" in given or row.needs_other or row.course in ("", "place")
    assert row.keeps_heading or row.plain_action != "walk"
    assert row.keeps_heading or row.course != "heading"
    assert not row.reaches_farther or {"speed", "distance"} <= given
    assert row.moves_before_trigger or not row.holds_brake
    assert not (row.moves_before_trigger and row.drives_from_rest)
    assert row.has_trigger or row.plain_action in ("", "none")
    assert all(tag.startswith("Motion") for tag in row.tags)


LISTS_BEHAVIOURS = {
    "adapters/oodscen_highway/_catalogue.py": "what highway-env is able to drive",
    "adapters/oodscen_sumo/_catalogue.py": "what SUMO is able to drive",
    "oodscen/data/_detail_checks.py": "lies below the rows",
    "oodscen/testing/_kit/behaviours.py": "a run for every row",
    "oodscen/testing/_kit/following.py": "what a probe tries in turn",
    "oodscen/testing/_kit/measures.py": "what a probe tries in turn",
    "oodscen/testing/_kit/reactions.py": "what a probe tries in turn",
    "oodscen/testing/_kit/runs.py": "what a probe tries in turn",
    "oodscen/testing/_kit/samples.py": "what a probe tries in turn",
    "oodscen/testing/_new/adapter.py": "the vocabulary of a new adapter",
}


def behaviours_listed(tree: ast.AST) -> Iterator[set[str]]:
    """Yield the behaviours that each collection, or each string of words, has in it."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Tuple | ast.List | ast.Set):
            parts: list[ast.expr | None] = list(node.elts)
        elif isinstance(node, ast.Dict):
            parts = list(node.keys)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            words = set(node.value.split())
            yield words if words <= set(BUILT_IN) else set()
            continue
        else:
            continue
        yield {part.value for part in parts if isinstance(part, ast.Constant)} & set(BUILT_IN)


def test_only_the_rows_list_behaviours() -> None:
    root = Path(__file__).parents[4]
    files = [
        file
        for folder in ("oodscen", "adapters", "tools")
        for file in (root / folder).rglob("*.py")
    ]
    texts = {file.relative_to(root).as_posix(): file.read_text("utf-8") for file in files}
    found = {
        file
        for file, text in texts.items()
        if sum(name in text for name in BUILT_IN) > 1
        and any(len(names) > 1 for names in behaviours_listed(ast.parse(text)))
    }
    assert found == set(LISTS_BEHAVIOURS)


@pytest.mark.parametrize("code", [-1, max(Code) + 1])
def test_a_behaviour_without_a_kernel_fails(code: int) -> None:
    result = world(scene(actor("a", "car", "follow_lane"), speed=0.0))
    result._codes[1, col.BEHAVIOUR] = code
    with pytest.raises(ValueError, match="without a kernel"):
        result.step(Control())


def test_the_page_on_motion_lists_every_behaviour_as_it_is() -> None:
    page = (Path(__file__).parents[4] / "docs" / "motion.md").read_text(encoding="utf-8")
    for kind in BEHAVIOURS:
        (row,) = [line for line in page.splitlines() if line.startswith(f"| `{kind.id}` |")]
        assert f"| {kind.description} |" in row
        for name, one in kind.parameters.items():
            limits = f"({one.minimum:g} to {one.maximum:g} {one.description})"
            assert f"`{name}` {one.default:g} {limits}" in row


def staged(name: str, asset: str, **options) -> list[Actor]:
    """Return an actor, after the one to which it belongs where it needs one."""
    needs = {kind.id for kind in BEHAVIOURS if kind.needs_other}
    if name not in needs:
        return [actor("a", asset, name, **options)]
    one = actor("a", asset, name, **{"ahead": 23.0, **options})
    behaviour = one.behaviour.model_copy(update={"other": "carrier"})
    return [actor("carrier", "truck", "follow_lane", ahead=30.0, speed=9.0),
            one.model_copy(update={"behaviour": behaviour})]  # fmt: skip


@pytest.mark.parametrize("kind", BEHAVIOURS, ids=lambda kind: kind.id)
def test_everybody_moves_without_leaps(kind) -> None:
    for category in kind.categories:
        if category == "signal":
            continue
        asset = next(one for one in CATALOGUE.assets if one.category == category)
        actors = staged(kind.id, asset.id, trigger=Trigger(kind="time", value=1.0))
        result = world(scene(*actors, speed=0.0))
        body = result.motion("a")
        for _ in range(160):
            before = body
            result.step(Control())
            body = result.motion("a")
            far = math.hypot(body.x - before.x, body.y - before.y)
            faster = max(abs(body.speed), abs(before.speed))
            if kind.id not in ("fall", "open_door"):
                assert far <= 1.2 * faster * result.dt + 1e-4
                faster = abs(body.speed - before.speed)
                assert faster <= 10.0 * result.dt + 1e-6 or body.speed == 0.0
            else:
                assert far <= 12.0 * result.dt
            turn = abs(math.remainder(body.yaw - before.yaw, math.tau))
            assert turn < 0.4 or kind.id == "hesitate"
            change = (body.speed - before.speed) / result.dt
            assert math.isclose(body.acceleration, change, abs_tol=2e-5)


@pytest.mark.parametrize("name", sorted(MOVES_BEFORE_TRIGGER - {"wrong_way", "run_red"}))
def test_drivers_keep_their_lane_until_the_trigger(name: str) -> None:
    asset = "cyclist" if name == "wobble" else "car"
    result = run(actor("a", asset, name, speed=4.0, trigger=LATER), 1.9)
    other = run(actor("a", asset, "follow_lane", speed=4.0, trigger=LATER), 1.9)
    assert result.motion("a") == other.motion("a")


@pytest.mark.parametrize(
    "name",
    sorted(
        set(BUILT_IN) - MOVES_BEFORE_TRIGGER - {kind.id for kind in BEHAVIOURS if kind.needs_other}
    ),
)
def test_others_stand_until_the_trigger(name: str) -> None:
    result = run(actor("a", "dog", name, heading=40.0, trigger=LATER), 1.9)
    assert result.motion("a").s == result.corridor.start + 30.0
    assert result.motion("a").speed == 0.0


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
    for _ in range(300):
        result.step(Control())
        assert result.motion("lead").s - result.motion("a").s > 4.3


def test_followers_react_to_the_ego() -> None:
    result = run(actor("a", "car", "follow_lane", ahead=-60.0, speed=12.0), 20.0)
    body = result.motion("a")
    assert body.speed < 0.05
    assert 1.0 < result.ego.s - body.s - 4.4 < 4.0


@pytest.mark.parametrize("lanes", [1, -1])
def test_cut_in_moves_over_in_its_time(lanes: int) -> None:
    staged = actor(
        "a", "car", "cut_in", lane=0 if lanes > 0 else 1, speed=12.0, lanes=lanes, trigger=LATER
    )
    result = run(staged, 2.0 + 1.55)
    body = result.motion("a")
    assert abs(body.t - result.corridor.centre(result.lanes("a")[1], body.s)) < 0.02
    assert abs(body.heading) < 0.1


def test_hard_brake_stops_after_the_braking_distance() -> None:
    result = run(actor("a", "car", "hard_brake", speed=14.0, trigger=LATER, deceleration=7.0), 6.0)
    assert result.motion("a").speed == 0.0
    driven = result.motion("a").s - result.corridor.start - 30.0
    assert math.isclose(driven, 2.0 * 14.0 + 14.0**2 / 14.0, abs_tol=0.6)


def test_nobody_brakes_harder_than_the_road_allows() -> None:
    staged = actor("a", "car", "hard_brake", speed=14.0, deceleration=9.0)
    result = world(scene(staged, friction=0.2))
    result.step(Control())
    result.step(Control())
    assert 14.0 - result.motion("a").speed <= 2 * 0.2 * 9.81 * 0.05 + 1e-6


def test_stop_and_go_stops_and_goes() -> None:
    result = world(scene(actor("a", "car", "stop_and_go", speed=6.0, period=8.0), speed=0.0))
    speeds = []
    for _ in range(400):
        result.step(Control())
        speeds.append(result.motion("a").speed)
    assert min(speeds[:80]) == 0.0
    assert max(speeds[80:160]) > 4.0
    assert min(speeds[160:240]) == 0.0


@settings(max_examples=15)
@given(
    friction=st.floats(0.1, 1.2),
    speed=st.floats(1.0, 12.0),
    deceleration=st.floats(0.5, 4.0),
    pause=st.floats(0.0, 4.0),
)
def test_who_halts_stands_for_the_pause_and_goes_on_even_on_ice(
    friction: float, speed: float, deceleration: float, pause: float
) -> None:
    halting = actor("a", "car", "halt", speed=speed, deceleration=deceleration, pause=pause)
    result = world(scene(halting, friction=friction, speed=0.0))
    stopping = speed / min(deceleration, 0.9 * 9.81 * friction)
    speeds = []
    for _ in range(math.ceil((stopping + pause + 1.0) / result.dt)):
        result.step(Control())
        speeds.append(result.motion("a").speed)
    assert abs(speeds.count(0.0) - pause / result.dt) <= 2
    assert speeds.index(0.0) * result.dt == pytest.approx(stopping, abs=0.2)
    assert speeds[-1] > 0.0


def test_wrong_way_drivers_face_the_ego_whatever_the_heading() -> None:
    for lane, sign in ((0, -1), (2, 1)):
        for heading in (0.0, 180.0):
            staged = actor("a", "car", "wrong_way", lane=lane, heading=heading, speed=10.0)
            result = run(staged, 2.0)
            assert math.isclose(
                result.motion("a").s, result.corridor.start + 30.0 + sign * 20.0, abs_tol=1e-3
            )


def test_reverse_goes_backwards() -> None:
    result = run(actor("a", "car", "reverse", speed=3.0, trigger=LATER), 4.0)
    assert result.motion("a").speed == -3.0
    assert result.motion("a").s < result.corridor.start + 30.0
    assert result.motion("a").heading == 0.0


def test_pull_out_ends_in_the_lane_at_its_speed() -> None:
    staged = actor("a", "car", "pull_out", offset=-2.7, speed=6.0, trigger=LATER)
    result = run(staged, 9.0, map="residential_two_lane")
    body = result.motion("a")
    assert abs(offset(result)) < 0.02
    assert math.isclose(body.speed, 6.0, abs_tol=0.5)


def test_u_turn_drives_back_on_the_left() -> None:
    result = run(actor("a", "car", "u_turn", lane=1, ahead=40.0, trigger=LATER), 9.0)
    body = result.motion("a")
    assert math.isclose(abs(body.heading), math.pi, abs_tol=1e-3)
    assert math.isclose(offset(result), 2 * 5.0 * 4.0 / math.pi, abs_tol=0.5)
    assert body.speed == 5.0


@settings(max_examples=40)
@example("pull_out", 2.5, 2.4, 1.0, 30.0)
@example("cut_in", 5.0, 0.5, 1.0, 30.0)
@given(
    st.sampled_from(["pull_out", "cut_in", "cut_out"]),
    st.floats(0.5, 20.0),
    st.floats(1.0, 6.0),
    st.floats(0.2, 1.0),
    st.floats(8.0, 30.0),
)
def test_vehicles_change_lanes_smoothly_and_only_as_far_as_they_roll(
    name: str, speed: float, duration: float, friction: float, gap: float
) -> None:
    parameters = {"speed": speed, "lanes": 1.0, "duration": duration}
    car = actor("a", "car", name, trigger=LATER, **parameters)
    slow = actor("b", "car", "follow_lane", lane=1, ahead=30.0 + gap, speed=1.0)
    result = world(scene(car, slow, speed=0.0, friction=friction))
    grip, before, aside = 0.9 * 9.81 * friction, result.motion("a"), 0.0
    for _ in range(round(7.0 / result.dt)):
        result.step(Control())
        after = result.motion("a")
        rolled, moved = 0.5 * (before.speed + after.speed) * result.dt, after.t - before.t
        assert abs(moved) <= 0.5 * rolled + 1e-5
        # A change of speed turns up to half as much of it sideways.
        assert abs(moved / result.dt - aside) <= (1.55 * grip + 0.1) * result.dt
        before, aside = after, moved / result.dt


@pytest.mark.parametrize("name", ["drift", "overtake"])
def test_a_truck_beyond_the_edge_of_the_road_is_not_drawn_onto_it(name) -> None:
    truck = actor("a", "truck", name, offset=-2.0, trigger=LATER, lateral=-1.0)
    for seconds in (1.5, 4.0):
        assert offset(run(truck, seconds, map="rural_hill")) == pytest.approx(-2.0, abs=1e-3)


@given(st.floats(0, 10), st.floats(2, 12), st.floats(6, 30))
def test_no_vehicle_turns_round_faster_than_its_arc_lets_it(speed, duration, gap) -> None:
    turning = {"speed": speed, "duration": duration}
    car = actor("a", "car", "u_turn", lane=1, ahead=60.0, trigger=LATER, **turning)
    result = world(scene(car, actor("b", lane=1, ahead=60.0 - gap), speed=0.0))
    before = result.motion("a")
    for _ in range(round(8.0 / result.dt)):
        result.step(Control())
        after = result.motion("a")
        distance = 0.5 * (before.speed + after.speed) * result.dt
        if result.time > LATER.value + 1e-6:
            turned = abs(math.remainder(after.heading - before.heading, math.tau))
            assert turned * speed * duration <= math.pi * distance + 1e-3
            assert distance > 0.0 or turned == 0.0
        before = after


def test_walkers_cover_their_distance_and_stop() -> None:
    result = run(actor("a", "adult", "cross_road", offset=-4, heading=90.0, distance=9.0), 12.0)
    body = result.motion("a")
    assert body.speed == 0.0
    assert math.isclose(offset(result), -4 + 9.0, abs_tol=1e-3)


@settings(max_examples=10)
@example(10 / 3)
@given(st.floats(1.0, 4.0))
def test_the_hesitant_come_back(distance: float) -> None:
    staged = actor("a", "child", "hesitate", offset=-4, heading=90.0, distance=distance, pause=1.0)
    result = world(scene(staged, speed=0.0))
    offsets = []
    for _ in range(200):
        result.step(Control())
        offsets.append(offset(result))
    assert math.isclose(max(offsets), -4.0 + distance, abs_tol=1e-3)
    assert 20 <= offsets.count(max(offsets)) < 100
    assert math.isclose(offsets[-1], -4.0, abs_tol=1e-3)


def test_weaving_stays_within_its_amplitude_and_uses_it() -> None:
    staged = actor("a", "cyclist", "wobble", amplitude=0.6, period=2.0, speed=5.0)
    result = world(scene(staged, speed=0.0))
    offsets = []
    for _ in range(200):
        result.step(Control())
        offsets.append(offset(result))
    assert max(map(abs, offsets)) <= 0.6 + 1e-6
    assert max(offsets[40:]) > 0.55
    assert min(offsets[40:]) < -0.55


@pytest.mark.parametrize("lateral", [-0.6, 0.6])
def test_drifting_ends_at_the_edge_of_the_road(lateral: float) -> None:
    result = run(actor("a", "car", "drift", speed=8.0, lateral=lateral), 30.0)
    body = result.motion("a")
    limits = result.corridor.drivable_range(body.s, body.t)
    assert limits is not None
    edge = limits[1] - 0.9 if lateral > 0 else limits[0] + 0.9
    assert math.isclose(body.t, edge, abs_tol=0.02)


def test_oncoming_traffic_keeps_to_its_lane_on_a_curve() -> None:
    result = run(actor("a", "truck", "follow_lane", ahead=250.0, lane=1, speed=20.0), 10.0,
                 map="rural_curve")  # fmt: skip
    body = result.motion("a")
    assert math.isclose(body.s, result.corridor.start + 250.0 - 200.0, abs_tol=4.0)
    assert abs(offset(result)) < 1e-6
    assert abs(math.remainder(body.heading - math.pi, math.tau)) < 0.01


# ------------------------------------------------------------------ what was added to traffic


def test_cut_out_reveals_what_it_hid() -> None:
    box = actor("box", "cardboard_box", ahead=100.0)
    near = Trigger(kind="distance", value=60.0, actor="box")
    cutting = actor("a", "van", "cut_out", ahead=18.0, speed=12.0, lanes=1, trigger=near)
    result = world(scene(box, cutting, speed=12.0))
    for _ in range(140):
        result.step(Control())
    body = result.motion("a")
    assert math.isclose(body.speed, 12.0, abs_tol=0.1)
    assert abs(body.t - result.corridor.centre(result.lanes("a")[1], body.s)) < 0.05


@pytest.mark.parametrize("side", [90.0, -90.0])
def test_who_runs_the_red_light_yields_to_nobody(side: float) -> None:
    offset = -40.0 if side > 0 else 40.0
    crossing = actor("a", "car", "run_red", ahead=60.0, offset=offset, heading=side, speed=15.0,
                     trigger=LATER)  # fmt: skip
    result = world(scene(crossing, actor("wall", "truck", ahead=60.0), speed=0.0))
    first = result.motion("a")
    for _ in range(80):
        result.step(Control())
    last = result.motion("a")
    assert last.speed == first.speed == 15.0
    assert last.yaw == first.yaw
    assert math.isclose(math.dist((first.x, first.y), (last.x, last.y)), 60.0, abs_tol=1e-3)
    assert abs(last.s - first.s) < 0.01


def test_rolling_away_follows_the_heading_to_its_speed() -> None:
    for speed in (3.0, -3.0):
        rolling = actor("a", "car", "roll_away", heading=20.0, speed=speed, acceleration=0.5,
                        trigger=LATER)  # fmt: skip
        result = run(rolling, 2.0 + 4.0)
        body = result.motion("a")
        assert math.isclose(body.speed, speed / 3.0 * 2.0, abs_tol=0.03)
        assert math.isclose(result.corridor.start + 30.0 - body.s, -speed / 3.0 * 4.0 * math.cos(
            math.radians(20.0)), abs_tol=0.15)  # fmt: skip


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 99), st.floats(0.5, 6.0))
def test_crowds_stay_about_their_place_and_move(seed: int, radius: float) -> None:
    crowd = [actor(f"p{i}", "adult", "wander", offset=-1.0 + i, radius=radius) for i in range(3)]
    result = world(scene(*crowd, speed=0.0), seed)
    homes = [result.motion(f"p{i}") for i in range(3)]
    moved = 0.0
    for _ in range(300):
        result.step(Control())
        for i, home in enumerate(homes):
            now = result.motion(f"p{i}")
            assert math.dist((now.x, now.y), (home.x, home.y)) <= radius + 0.8
            moved += abs(now.speed) * result.dt
    assert moved > 1.0
    places = {round(result.motion(f"p{i}").x, 3) for i in range(3)}
    assert len(places) > 1


def test_darting_is_sudden_and_ends() -> None:
    result = run(actor("a", "child", "dart", offset=-4.0, heading=90.0, speed=4.0, distance=6.0,
                       trigger=LATER), 2.0 + 0.9)  # fmt: skip
    assert result.motion("a").speed == 4.0
    result = run(actor("a", "child", "dart", offset=-4.0, heading=90.0, speed=4.0, distance=6.0), 4)
    assert math.isclose(offset(result), 2.0, abs_tol=1e-3)
    assert result.motion("a").speed == 0.0


def test_cargo_rides_falls_and_slides_to_rest() -> None:
    carrier, box = staged("fall", "sofa", trigger=LATER, height=1.5, spin_deg=90.0)
    result = world(scene(carrier, box, speed=0.0))
    apart = result.motion("carrier").s - result.motion("a").s
    lifts = []
    for _ in range(40):
        result.step(Control())
        assert math.isclose(result.motion("carrier").s - result.motion("a").s, apart, abs_tol=1e-5)
        assert result.motion("a").lift == 1.5
        assert result.poses()[2, 2] == result.poses()[0, 2] + 1.5
    left = result.motion("a")
    for _ in range(200):
        result.step(Control())
        lifts.append(result.motion("a").lift)
    landed = lifts.index(0.0) + 1
    assert math.isclose(landed * result.dt, math.sqrt(2 * 1.5 / 9.81), abs_tol=0.1)
    body = result.motion("a")
    assert (body.speed, body.lift) == (0.0, 0.0)
    assert body.yaw != left.yaw
    slide = 9.0**2 / (2 * 0.5 * 0.9 * 9.81)
    assert 0.5 < math.dist((left.x, left.y), (body.x, body.y)) - slide < 9.0


@pytest.mark.parametrize("map", ["urban_avenue", "rural_curve"])
def test_what_is_towed_keeps_its_distance_and_its_track(map: str) -> None:
    carrier, trailer = staged("towed", "car")
    result = world(scene(carrier, trailer, map=map, speed=0.0))
    pole = None
    for _ in range(200):
        result.step(Control())
        front, rear = result.motion("carrier"), result.motion("a")
        hitch = (front.x - 4.5 * math.cos(front.yaw), front.y - 4.5 * math.sin(front.yaw))
        apart = math.dist(hitch, (rear.x, rear.y))
        pole = pole or apart
        assert math.isclose(apart, pole, abs_tol=1e-5)
        assert abs(rear.t - front.t) < 0.5
    assert math.isclose(rear.speed, front.speed, abs_tol=0.05)


def test_a_door_swings_about_its_front_edge() -> None:
    for side in (1.0, -1.0):
        door = actor("a", "car_door", "open_door", ahead=30.3, offset=side * 0.95, trigger=LATER)
        behaviour = door.behaviour.model_copy(update={"other": "parked"})
        parked = actor("parked", "car", ahead=30.0)
        actors = (parked, door.model_copy(update={"behaviour": behaviour}))
        result = world(scene(*actors, speed=0.0))
        half = 0.5 * result.sizes[2][0]
        first = result.motion("a")
        for _ in range(70):
            result.step(Control())
        last = result.motion("a")
        for axis in (math.cos, math.sin):
            assert math.isclose((first.x if axis is math.cos else first.y) + half * axis(first.yaw),
                                (last.x if axis is math.cos else last.y) + half * axis(last.yaw),
                                abs_tol=1e-5)  # fmt: skip
        assert math.isclose(last.heading, -side * math.radians(65.0), abs_tol=1e-5)
        assert side * (last.t - first.t) > 0.3


@pytest.mark.parametrize("lateral", [2.4, -2.4])
def test_emergency_vehicles_pass_at_the_side_and_move_back(lateral: float) -> None:
    siren = actor("a", "car", "overtake", ahead=-60.0, speed=20.0, lateral=lateral)
    result = world(scene(siren, speed=10.0, lane=1, map="urban_three_lane"))
    own, passed = [], False
    driver = Cruise()
    for _ in range(300):
        result.step(driver.act(result.observe()))
        body = result.motion("a")
        if abs(body.s - result.ego.s) < 4.0:
            own.append(body.t - result.ego.t)
            passed = True
    assert passed
    assert own == pytest.approx([lateral] * len(own), abs=0.2)
    assert abs(offset(result)) < 0.05
    assert result.motion("a").speed > 19.0


def test_the_wind_comes_in_gusts() -> None:
    result = world(scene(actor("a", "cardboard_box", "blown", speed=6.0, lift=0.5), speed=0.0))
    speeds, lifts = [], []
    for _ in range(200):
        result.step(Control())
        speeds.append(result.motion("a").speed)
        lifts.append(result.motion("a").lift)
    assert max(speeds[40:]) > 5.0 > 3.0 > min(speeds[40:]) > 1.0
    assert 0.45 < max(lifts) <= 0.5
    assert min(lifts[5:]) < 0.05


# ------------------------------------------------------------------ road and weather


@settings(max_examples=15, deadline=None)
@given(st.floats(0.15, 1.0), st.floats(5.0, 35.0), st.sampled_from(["follow_lane", "wrong_way"]))
def test_drivers_slow_down_for_curves_to_stay_within_the_grip(
    friction: float, speed: float, name: str
) -> None:
    lane = 0 if name == "follow_lane" else 1
    driving = actor("a", "car", name, ahead=-100.0, lane=lane, speed=speed, heading=180.0 * lane)
    result = world(scene(driving, map="rural_curve", friction=friction, speed=0.0))
    kept = result.snapshot()
    result.restore(kept)
    for _ in range(200):
        before = result.motion("a").yaw
        result.step(Control())
        body = result.motion("a")
        across = body.speed * math.remainder(body.yaw - before, math.tau) / result.dt
        assert abs(across) <= friction * 9.81 * 1.02 + 0.3
        assert abs(body.acceleration) <= friction * 9.81


def test_nobody_sees_through_fog() -> None:
    for fog, seen in ((40.0, False), (10_000.0, True)):
        staged = scene(
            actor("a", "car", "follow_lane", ahead=20.0, speed=15.0),
            actor("box", "car", ahead=90.0),
        )
        weather = Weather(fog_visual_range_m=fog)
        result = world(staged.model_copy(update={"weather": weather}))
        assert math.isfinite(result.free_road("a")[0]) == seen
        assert math.isclose(result.observe().visual_range_m, fog, rel_tol=1e-3)
        result.step(Control())
        assert (result.motion("a").acceleration < -0.5) == seen


def test_at_night_what_has_no_lamps_is_seen_in_the_beam_only() -> None:
    for asset, seen in (("car", True), ("deer", False)):
        staged = scene(
            actor("a", "car", "follow_lane", ahead=20.0, speed=15.0),
            actor("b", asset, ahead=120.0),
            actor("c", asset, ahead=80.0, lane=1),
        )
        night = Weather(sun_elevation_deg=-20.0)
        result = world(staged.model_copy(update={"weather": night}))
        assert math.isfinite(result.free_road("a")[0]) == seen


def test_slippery_roads_stretch_what_drivers_do() -> None:
    def crossed(friction: float) -> float:
        cutting = actor("a", "car", "cut_in", lane=1, speed=12.0, lanes=-1, duration=1.0)
        result = world(scene(cutting, friction=friction, speed=0.0))
        first = result.motion("a").t
        while abs(result.motion("a").t - first) < 3.0:
            result.step(Control())
        return result.time

    assert crossed(0.15) > 1.8 * crossed(1.0)


def test_pedestrians_and_cross_traffic_do_not_react_to_the_ego() -> None:
    actors = (
        actor("walker", "adult", "cross_road", ahead=20.0, offset=-4.0, heading=90.0),
        actor("crossing", "car", "run_red", ahead=40.0, offset=-30.0, heading=90.0),
        actor("oncoming", "car", "wrong_way", ahead=90.0),
    )
    ends = []
    for speed in (0.0, 15.0):
        result = world(scene(*actors, speed=speed))
        for _ in range(60):
            result.step(Control())
        ends.append([result.motion(one.id) for one in actors])
    assert ends[0] == ends[1]


def test_actors_that_belong_to_nobody_are_refused() -> None:
    with pytest.raises(ValueError, match="needs"):
        world(scene(actor("a", "sofa", "fall")))
    carrier, box = staged("fall", "sofa")
    looped = carrier.model_copy(
        update={"behaviour": carrier.behaviour.model_copy(update={"other": "a"})}
    )
    with pytest.raises(ValueError, match="ring"):
        world(scene(looped, box))


def test_what_lies_flat_does_not_slow_a_driver_down() -> None:
    car = actor("a", "car", "follow_lane", ahead=30.0, speed=9.0)
    free = run(car, 5.0).motion("a")
    flat = run(car, 5.0, actor("b", "puddle", ahead=60.0)).motion("a")
    assert flat == free
    assert run(car, 5.0, actor("b", "sofa", ahead=60.0)).motion("a").speed < free.speed


def test_what_falls_from_high_up_bounces_once_or_more_and_rests() -> None:
    carrier, box = staged("fall", "sofa", trigger=LATER, height=3.0)
    result = world(scene(carrier, box, speed=0.0))
    lifts = []
    for _ in range(160):
        result.step(Control())
        lifts.append(result.motion("a").lift)
    landed = lifts.index(0.0)
    assert 0.1 < max(lifts[landed:]) < 1.0
    assert lifts[-20:] == [0.0] * 20


def test_drivers_brake_earlier_where_it_is_slippery() -> None:
    cars = actor("a", "car", "follow_lane", speed=12.0), actor("b", "car", "stand", ahead=130.0)
    gaps = []
    for friction in (1.0, 0.3):
        result = world(scene(*cars, speed=0.0, friction=friction))
        while result.motion("a").acceleration > -0.5:
            result.step(Control())
        gaps.append(result.motion("b").s - result.motion("a").s)
    assert gaps[1] > 1.1 * gaps[0]
