import itertools
import math
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._catalogue import load_catalogue
from oodscen_pybullet._meshes import FLASHING, GAITS, SMOKING, asset_mesh
from oodscen_pybullet._meshes.living.poses import load_poses
from oodscen_pybullet._meshes.look import Appearance, reacting
from oodscen_pybullet._rendering.appearance import (
    Look,
    SceneBodies,
    beat_of,
    frame_of,
    mesh_of,
    phase_of,
    seen_coming,
)

from oodscen.data._details import Details
from oodscen.data._scene import Actor, Scene, Trigger
from oodscen.driving._sight.lamps import BRAKING

CATALOGUE = load_catalogue()
ASSETS = {asset.id: asset for asset in CATALOGUE.assets}
LIGHT = ASSETS["traffic_light"]

places = st.floats(-300, 300)
yaws = st.floats(-math.pi, math.pi)


@given(st.sampled_from(sorted(GAITS)), places, places, yaws, st.floats(0, 40))
def test_who_stands_does_not_step(asset: str, x: float, y: float, yaw: float, time: float) -> None:
    assert frame_of(asset, "", (x, y, 0.0, yaw), 0.0, time) == 0


@given(st.sampled_from(sorted(GAITS)), places, places, yaws, st.booleans(), st.floats(0, 40))
def test_a_stride_has_eight_steps_in_their_order_whatever_the_time(
    asset: str, x: float, y: float, yaw: float, runs: bool, time: float
) -> None:
    stride = GAITS[asset]
    speed = stride * (4.0 if runs else 1.0)
    length = stride * (1.7 if runs else 1.0)
    steps = []
    for index in range(64):
        way = length * (index + 0.5) / 64
        pose = (x + way * math.cos(yaw), y + way * math.sin(yaw), 0.0, yaw)
        steps.append(frame_of(asset, "", pose, speed, time + index) - (9 if runs else 1))
    assert set(steps) == set(range(8))
    assert all((two - one) % 8 <= 1 for one, two in itertools.pairwise(steps))


@given(st.sampled_from(sorted(FLASHING & {"hazard", "beacon", "flashing"})), st.integers(0, 600))
def test_lamps_flash_three_times_in_two_seconds_lit_for_two_thirds(state: str, tick: int) -> None:
    start = tick * 0.05
    phases = [frame_of("x", state, (0, 0, 0, 0), 0.0, start + 2.0 * k / 120) for k in range(120)]
    assert 76 <= phases.count(0) <= 84
    assert sum(a != b for a, b in zip(phases, phases[1:] + phases[:1], strict=True)) == 6


@pytest.mark.parametrize("asset", sorted(SMOKING))
def test_smoke_goes_round_in_eight_pictures(asset: str) -> None:
    shown = [frame_of(asset, "", (0, 0, 0, 0), 0.0, 0.05 * tick) for tick in range(200)]
    assert set(shown) == set(range(8))


def looks(
    make_scene: Callable[..., Scene], actor: Actor, speed: float, acceleration: float, **sky: float
) -> Look:
    cast = SceneBodies(make_scene(actor, **sky), 3)
    cast.add("ego", CATALOGUE.ego, "")
    cast.add(actor.id, ASSETS[actor.asset], actor.state)
    pose = (10.0, 0.0, 0.0, 0.0)
    return cast.looks([pose, pose], [0.0, speed], [0.0, acceleration], [0.0, 0.0], 0.0)[1]


@given(acceleration=st.floats(-9, 4), state=st.sampled_from(["", "off", "hazard", "indicate_left"]))
def test_who_slows_down_shows_it_besides_what_else_is_lit(
    acceleration: float,
    state: str,
    make_scene: Callable[..., Scene],
    make_actor: Callable[..., Actor],
) -> None:
    actor = make_actor("car", 10.0, state=state, behaviour="follow_lane")
    look = looks(make_scene, actor, 8.0, acceleration)
    assert ("brake" in look.state) == (acceleration < BRAKING)
    assert look.state.removesuffix("+brake").replace("brake", "off") == (state or look.state) or (
        state in ("", "off")
    )
    bare = mesh_of(look._replace(state=state or "off"))
    extra = len(mesh_of(look).lamps) - len(bare.lamps)
    assert extra == (2 if acceleration < BRAKING else 0)


@pytest.mark.parametrize(
    ("behaviour", "is_lit"), [("hard_brake", True), ("stop_and_go", True), ("stand", False)]
)
def test_drivers_in_traffic_hold_the_brake_while_they_stand(
    behaviour: str,
    is_lit: bool,
    make_scene: Callable[..., Scene],
    make_actor: Callable[..., Actor],
) -> None:
    actor = make_actor("car", 10.0, behaviour=behaviour)
    assert (looks(make_scene, actor, 0.0, 0.0).state == "brake") == is_lit


def test_lamps_run_in_the_dark_and_glow_where_the_body_is(
    make_scene: Callable[..., Scene], make_actor: Callable[..., Actor]
) -> None:
    actor = make_actor("car", 10.0, behaviour="follow_lane")
    assert not looks(make_scene, actor, 8.0, 0.0).running
    look = looks(make_scene, actor, 8.0, 0.0, sun_elevation_deg=-20.0)
    assert look.running
    lamps = [lamp.placed((50.0, 20.0, 1.0), (0.0, 1.0)) for lamp in mesh_of(look).lamps]
    for lamp in lamps:
        x, y, z = lamp.position
        assert abs(x - 50.0) <= 1.0
        assert abs(y - 20.0) <= 2.3
        assert 1.0 < z < 2.5
    assert {round(lamp.facing[1]) for lamp in lamps} == {-1, 1}


@given(st.sampled_from(["red", "green", "amber", "off", "flashing"]), st.floats(0, 30))
def test_a_signal_whose_trigger_fires_at_the_start_keeps_its_state(state: str, time: float) -> None:
    assert phase_of(LIGHT, state, Trigger(), 0.0, time) == state


@given(st.floats(3.0, 20.0), st.sampled_from(["time", "distance", "ttc"]))
def test_a_light_turns_from_green_over_amber_to_red_and_stays_red(at: float, kind: str) -> None:
    trigger = Trigger.model_validate({"kind": kind, "value": at})
    fired = at if kind == "time" else at - 2.0
    times = [index * 0.05 for index in range(500)]
    shown = [phase_of(LIGHT, "red", trigger, fired if now >= fired else -1.0, now) for now in times]
    assert [state for state, _ in itertools.groupby(shown)] == ["green", "amber", "red"]
    assert times[shown.index("red")] == pytest.approx(at, abs=0.051)
    assert shown.count("amber") == pytest.approx(40, abs=1)
    assert "amber" not in [phase_of(LIGHT, "green", trigger, fired, now) for now in times]


@given(
    st.sampled_from([("green", "red"), ("amber", "green"), ("off", "off")]),
    st.floats(3.0, 20.0),
    st.sampled_from(["time", "distance", "ttc"]),
    st.floats(0.0, 30.0),
)
def test_a_light_that_does_not_turn_red_changes_at_its_trigger(
    states: tuple[str, str], at: float, kind: str, time: float
) -> None:
    state, before = states
    trigger = Trigger.model_validate({"kind": kind, "value": at})
    shown = phase_of(LIGHT, state, trigger, at if time >= at else -1.0, time)
    assert shown == (state if time >= at - 1e-6 * (kind == "time") else before)


@pytest.mark.parametrize("kind", ["time", "distance", "ttc"])
def test_a_light_shows_none_but_its_own_states(kind: str) -> None:
    trigger = Trigger.model_validate({"kind": kind, "value": 5.0})
    for asset in CATALOGUE.assets:
        if asset.category == "signal":
            for state, tick in itertools.product(asset.states, range(200)):
                time = 0.05 * tick
                shown = phase_of(asset, state, trigger, 5.0 if time >= 5.0 else -1.0, time)
                assert shown in asset.states


@given(places, places, yaws, st.floats(-2.1, 2.1), st.floats(1.0, 20.0), st.floats(-0.4, 0.4))
def test_people_in_the_way_see_what_comes_except_from_behind(
    x: float, y: float, yaw: float, aside: float, ahead: float, turn: float
) -> None:
    def facing(angle: float) -> tuple[float, float, float, float]:
        s, c = math.sin(yaw), math.cos(yaw)
        towards = math.atan2(-aside, -ahead)
        return x + ahead * c - aside * s, y + ahead * s + aside * c, 0.0, yaw + towards + angle

    ego = (x, y, 0.0, yaw)
    assert seen_coming(facing(turn), ego, 10.0) == "ahead"
    assert seen_coming(facing(math.pi + turn), ego, 10.0) is None
    assert seen_coming(facing(-math.pi / 2 + turn), ego, 10.0) == "left"
    assert seen_coming(facing(math.pi / 2 + turn), ego, 10.0) == "right"
    assert seen_coming(facing(turn), ego, 2.0) is None
    assert seen_coming(facing(turn), ego, ahead / 4.0) is None


@pytest.mark.parametrize("frame", [0, 3, 12])
def test_a_reaction_raises_hands_and_keeps_the_step(frame: int) -> None:
    top = asset_mesh("adult", frame=frame).bounds[1][2]
    for direction in ("ahead", "left", "right"):
        there = reacting(frame, direction)
        assert Appearance(frame=there).gait == Appearance(frame=frame).gait
        assert Appearance(frame=there).warned == direction
        assert asset_mesh("adult", frame=there).bounds[1][2] > top
    assert Appearance(frame=frame).warned is None


@given(st.integers(0, 400), st.sampled_from(["wave_on", "wave_arms"]))
def test_a_gesture_goes_on_by_time_and_crawling_by_the_way(tick: int, pose: str) -> None:
    time, here = 0.05 * tick, (0.05 * tick, 2.0, 0.0, 0.0)
    period = load_poses()[pose].period_s
    assert period is not None
    details, away = Details(pose=pose), (99.0, 9.0, 0.0, 1.0)
    assert beat_of(details, here, 0.0, time) == beat_of(details, away, 3.0, time + period)
    crawl = Details(pose="crawl")
    assert beat_of(crawl, here, 0.5, time) == beat_of(crawl, here, 0.5, 0.0)
    assert beat_of(crawl, here, 0.0, time) == 0
    assert beat_of(Details(pose="kneel"), here, 0.5, time) == 0


def test_details_reach_the_mesh_and_nobody_else(
    make_scene: Callable[..., Scene], make_actor: Callable[..., Actor]
) -> None:
    plain = make_actor("adult", 10.0)
    actor = plain.model_copy(update={"details": Details(pose="wave_on")})
    assert looks(make_scene, plain, 0.0, 0.0).details is None
    look = looks(make_scene, actor, 0.0, 0.0)
    assert look.details == actor.details
    assert len(mesh_of(look).triangles) > 0
