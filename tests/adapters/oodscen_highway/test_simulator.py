import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oodscen_highway import HighwaySimulator
from oodscen_highway._catalogue import _DRIVEN, load_catalogue

from oodscen import make_catalogue
from oodscen.data import Actor, Behaviour, Placement
from oodscen.driving._roads.building import load_corridor
from oodscen.protocols import Control
from oodscen.testing import simulator_checks
from oodscen.testing._kit.samples import sample_scene
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


@pytest.mark.parametrize("check", simulator_checks(HighwaySimulator, quick=True), ids=str)
def test_it_keeps_the_protocols_promises(check) -> None:
    check()


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


@pytest.mark.parametrize("friction", [1.0, 0.1])
def test_a_driver_that_halts_stands_for_the_pause_and_goes_on_even_on_ice(friction) -> None:
    halt = Behaviour(name="halt", parameters={"speed": 8.0, "deceleration": 4.0, "pause": 2.0})
    actor = Actor(id="a", asset="car", placement=Placement(ahead_m=60.0), behaviour=halt)
    scene = sample_scene(CATALOGUE.map("urban_avenue"), (actor,))
    weather = scene.weather.model_copy(update={"friction": friction})
    ego = scene.ego.model_copy(update={"speed": 0.0})
    with HighwaySimulator() as simulator:
        simulator.reset(scene.model_copy(update={"weather": weather, "ego": ego}), 0)
        speeds = [simulator.step(Control()).speeds[1] for _ in range(300)]
    assert 1.9 < simulator.dt * sum(speed < 0.1 for speed in speeds) < 2.3
    assert speeds[-1] > 1.0


def test_the_catalogue_needs_no_highway_env_and_a_run_says_how_to_get_it() -> None:
    told = told_without("highway_env", "oodscen_highway:HighwaySimulator")
    assert told == ["highway", "highway_env"]


def test_the_registered_catalogue_is_the_simulators() -> None:
    assert make_catalogue("oodscen_highway:HighwaySimulator") == CATALOGUE
