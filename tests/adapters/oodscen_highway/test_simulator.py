import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oodscen_highway import HighwaySimulator
from oodscen_highway._catalogue import _DRIVEN, load_catalogue

from oodscen import make_catalogue
from oodscen.data import Actor, Behaviour, Placement, Trigger
from oodscen.driving._roads.building import load_corridor
from oodscen.protocols import Control
from oodscen.testing import check_simulator
from oodscen.testing._check import QUICK
from oodscen.testing._kit.samples import plain_scene, sample_scene
from tests.adapters.missing import told_without
from tests.needs import needs

pytestmark = needs("highway_env")

CATALOGUE = load_catalogue()


def test_its_six_roads_are_nearly_level_and_all_its_behaviours_exist() -> None:
    assert len(CATALOGUE.maps) == 6
    for road in CATALOGUE.maps:
        corridor = load_corridor(road)
        assert np.abs(np.diff(corridor.z) / np.diff(corridor.s)).max() < 0.01
    assert {kind.id for kind in CATALOGUE.behaviours} == _DRIVEN


@pytest.mark.parametrize("part", QUICK)
def test_it_keeps_the_protocols_promises(part) -> None:
    # One street and one road that bends: what does not repeat does so on any road.
    scenes = [
        plain_scene(CATALOGUE, CATALOGUE.map(road)) for road in ("urban_avenue", "rural_curve")
    ]
    check_simulator(HighwaySimulator, scenes=scenes, parts=(part,))


@settings(max_examples=15, deadline=None)
@given(
    acceleration=st.floats(-20.0, 20.0),
    steering=st.floats(-2.0, 2.0),
    behaviour=st.sampled_from([kind.id for kind in CATALOGUE.behaviours]),
)
def test_the_ego_never_reverses_and_a_restored_run_repeats(
    acceleration, steering, behaviour
) -> None:
    kind = CATALOGUE.behaviour(behaviour)
    asset = next(one for one in CATALOGUE.assets if one.category in kind.categories)
    actor = Actor(
        id="a", asset=asset.id, placement=Placement(ahead_m=20.0), behaviour=Behaviour(name=kind.id)
    )
    with HighwaySimulator() as simulator:
        simulator.reset(sample_scene(CATALOGUE.map("urban_avenue"), (actor,)), 0)
        simulator.step(Control(acceleration, steering))
        kept, runs = simulator.snapshot(), []
        for _ in range(2):
            simulator.restore(kept)
            states = [simulator.step(Control(acceleration, steering)) for _ in range(20)]
            assert min(state.speeds[0] for state in states) >= 0.0
            runs.append([state.fingerprint() for state in states])
        assert runs[0] == runs[1]


def runs(*actors, seconds, friction=1.0):
    """Return the states of a scene in which the ego stands."""
    scene = sample_scene(CATALOGUE.map("urban_avenue"), actors)
    weather = scene.weather.model_copy(update={"friction": friction})
    ego = scene.ego.model_copy(update={"speed": 0.0})
    with HighwaySimulator() as simulator:
        simulator.reset(scene.model_copy(update={"weather": weather, "ego": ego}), 0)
        steps = round(seconds / simulator.dt)
        return [simulator.state(), *(simulator.step(Control()) for _ in range(steps))]


@settings(max_examples=15, deadline=None)
@given(
    kind=st.sampled_from([("cross_road", "adult"), ("bolt", "deer"), ("dart", "child")]),
    speed=st.floats(1.0, 10.0),
    distance=st.floats(0.5, 15.0),
    friction=st.floats(0.1, 1.0),
)
def test_a_body_goes_its_distance_and_stops_there_on_ice_too(kind, speed, distance, friction):
    behaviour = Behaviour(name=kind[0], parameters={"speed": speed, "distance": distance})
    placement = Placement(ahead_m=30.0, offset_m=-4.0, heading_deg=90.0)
    actor = Actor(id="a", asset=kind[1], placement=placement, behaviour=behaviour)
    states = runs(actor, seconds=1.0 + distance / speed + speed / friction, friction=friction)
    start, end = states[0].poses[1], states[-1].poses[1]
    assert np.hypot(*(end - start)[:2]) == pytest.approx(distance, abs=1e-5)
    assert states[-1].speeds[1] == 0.0


def test_a_driver_who_cuts_out_does_not_brake_for_what_it_hides() -> None:
    cuts_out = Behaviour(name="cut_out", trigger=Trigger(value=4.0), parameters={"speed": 12.0})
    hides = Actor(id="a", asset="car", placement=Placement(ahead_m=30.0), behaviour=cuts_out)
    hidden = Actor(id="b", asset="car", placement=Placement(ahead_m=90.0))
    states = runs(hides, hidden, seconds=8.0)
    assert min(state.speeds[1] for state in states) > 11.5
    slow = Behaviour(name="follow_lane", parameters={"speed": 4.0})
    states = runs(hides, hidden.model_copy(update={"behaviour": slow}), seconds=4.0)
    assert min(state.speeds[1] for state in states) < 11.0


def test_a_driver_who_brakes_gently_accelerates_as_others_do() -> None:
    halt = Behaviour(name="halt", parameters={"speed": 8.0, "deceleration": 4.0, "pause": 4.0})
    ahead = Actor(id="b", asset="car", placement=Placement(ahead_m=70.0), behaviour=halt)
    most = []
    for deceleration in (1.0, 6.0):
        follow = {"speed": 10.0, "deceleration": deceleration}
        behaviour = Behaviour(name="follow_lane", parameters=follow)
        actor = Actor(id="a", asset="car", placement=Placement(ahead_m=30.0), behaviour=behaviour)
        speeds = np.array([state.speeds[1] for state in runs(actor, ahead, seconds=15.0)])
        changes = np.diff(speeds) / 0.05
        assert changes.min() > -deceleration - 1e-6
        most.append(changes.max())
    assert min(most) > 1.2


@pytest.mark.parametrize(
    ("duration", "friction", "least", "most"),
    [
        (0.5, 1.0, 1.2, 1.6),
        (1.5, 1.0, 1.2, 1.6),
        (2.0, 1.0, 1.8, 2.2),
        (4.0, 1.0, 3.7, 4.2),
        (0.5, 0.3, 2.4, 3.0),
    ],
)
def test_a_lane_change_takes_its_duration_or_what_the_tyres_need(duration, friction, least, most):
    cuts_in = Behaviour(name="cut_in", parameters={"speed": 12.0, "duration": duration})
    actor = Actor(id="a", asset="car", placement=Placement(ahead_m=30.0), behaviour=cuts_in)
    states = runs(actor, seconds=10.0, friction=friction)
    way = np.array([state.poses[1, 1] for state in states])
    share = (way - way[0]) / (way[-1] - way[0])
    assert least < 0.05 * ((share > 0.95).argmax() - (share > 0.05).argmax()) < most
    assert np.abs(np.diff(way, 2)).max() < 9.0 * friction * 0.05**2


@pytest.mark.parametrize("friction", [1.0, 0.1])
def test_a_driver_that_halts_stands_for_the_pause_and_goes_on_even_on_ice(friction) -> None:
    halt = Behaviour(name="halt", parameters={"speed": 8.0, "deceleration": 4.0, "pause": 2.0})
    actor = Actor(id="a", asset="car", placement=Placement(ahead_m=60.0), behaviour=halt)
    speeds = [state.speeds[1] for state in runs(actor, seconds=15.0, friction=friction)[1:]]
    assert 1.9 < 0.05 * sum(speed < 0.1 for speed in speeds) < 2.3
    assert speeds[-1] > 1.0


def test_the_catalogue_needs_no_highway_env_and_a_run_says_how_to_get_it() -> None:
    told = told_without("highway_env", "oodscen_highway:HighwaySimulator")
    assert told == ["highway", "highway_env"]


def test_the_registered_catalogue_is_the_simulators() -> None:
    assert make_catalogue("oodscen_highway:HighwaySimulator") == CATALOGUE
