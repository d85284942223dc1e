"""CARLA's own map reads what the library wrote: crosswalks, and all lanes to their ends."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_carla._opendrive import for_carla

from oodscen.driving._roads.building import read_map
from oodscen.driving._roads.network import Network
from oodscen.driving._roads.opendrive import read_network
from oodscen.driving.maps._shipped import SHIPPED_MAPS

TEXTS = {road.id: read_map(road.file).decode() for road in SHIPPED_MAPS}


@given(st.sampled_from(list(TEXTS.values())) | st.text(alphabet="<>/header outlines=\"' \n"))
def test_a_second_time_changes_nothing(text):
    assert for_carla(for_carla(text)) == for_carla(text)


@pytest.mark.parametrize("name", TEXTS)
def test_our_own_reader_reads_the_same_roads(name):
    assert rounded(for_carla(TEXTS[name])) == rounded(TEXTS[name])


def rounded(text: str) -> Network:
    """Return a document's roads with their lengths to the millimetre."""
    network = read_network(text.encode())
    roads = network.roads.items()
    return replace(
        network, roads={name: replace(road, length=round(road.length, 3)) for name, road in roads}
    )


@given(st.floats(0.01, 4000.0))
def test_a_road_grows_by_a_fraction_of_a_millimetre_until_a_float_lies_within(length):
    text = for_carla(f'<road name="a" length="{length!r}" id="1">')
    served = float(text.split('"')[3])
    assert float(np.float32(served)) < served
    assert length <= served < length + 2e-4


@pytest.mark.parametrize("name", TEXTS)
def test_every_driving_lane_is_in_carlas_topology(name):
    carla = pytest.importorskip("carla")
    made = carla.Map(name, for_carla(TEXTS[name]))
    begun = {(str(one.road_id), one.section_id, one.lane_id) for one, _ in made.get_topology()}
    lanes = {
        (road.id, number, lane.id)
        for road in read_network(TEXTS[name].encode()).roads.values()
        for number, section in enumerate(road.sections)
        for lane in section.lanes
        if lane.type == "driving"
    }
    assert begun == lanes


@pytest.mark.parametrize("name", TEXTS)
def test_carla_finds_the_crosswalks(name, capfd):
    carla = pytest.importorskip("carla")
    found = carla.Map(name, for_carla(TEXTS[name]))
    crosswalks = TEXTS[name].count('type="crosswalk"')
    assert bool(found.get_crosswalks()) == bool(crosswalks)
    assert len(found.get_crosswalks()) >= 4 * crosswalks
    assert "georeference" not in "".join(capfd.readouterr())
