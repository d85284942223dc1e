import itertools
import math
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._catalogue import load_catalogue
from oodscen_pybullet._meshes import FLASHING, GAITS, SMOKING
from oodscen_pybullet._rendering.appearance import BRAKING, Cast, Look, frame_of, mesh_of

from oodscen.data._scene import Actor, Scene

CATALOGUE = load_catalogue()
ASSETS = {asset.id: asset for asset in CATALOGUE.assets}

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
) -> tuple[Cast, Look]:
    cast = Cast(make_scene(actor, **sky), 3)
    cast.add("ego", CATALOGUE.ego, "")
    cast.add(actor.id, ASSETS[actor.asset], actor.state)
    assert len(cast) == 2
    pose = (10.0, 0.0, 0.0, 0.0)
    return cast, cast.looks([pose, pose], [0.0, speed], [0.0, acceleration], 0.0)[1]


@given(acceleration=st.floats(-9, 4), state=st.sampled_from(["", "off", "hazard", "indicate_left"]))
def test_who_slows_down_shows_it_besides_what_else_is_lit(
    acceleration: float,
    state: str,
    make_scene: Callable[..., Scene],
    make_actor: Callable[..., Actor],
) -> None:
    actor = make_actor("car", 10.0, state=state, behaviour="follow_lane")
    _, look = looks(make_scene, actor, 8.0, acceleration)
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
    assert (looks(make_scene, actor, 0.0, 0.0)[1].state == "brake") == is_lit


def test_lamps_run_in_the_dark_and_glow_where_the_body_is(
    make_scene: Callable[..., Scene], make_actor: Callable[..., Actor]
) -> None:
    actor = make_actor("car", 10.0, behaviour="follow_lane")
    assert not looks(make_scene, actor, 8.0, 0.0)[1].running
    cast, look = looks(make_scene, actor, 8.0, 0.0, sun_elevation_deg=-20.0)
    assert look.running
    pose = (50.0, 20.0, 1.0, math.pi / 2)
    for glow in cast.glows([Look("ego_car"), look], [(0.0, 0.0, 0.0, 0.0), pose]):
        x, y, z = glow.position
        assert abs(x - 50.0) <= 1.0
        assert abs(y - 20.0) <= 2.3
        assert 1.0 < z < 2.5
    facing = {round(glow.facing[1]) for glow in cast.glows([look, look], [pose, pose])}
    assert facing == {-1, 1}
