"""CARLA's own map reads what the library wrote: crosswalks, and roads that end in each other."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_carla._opendrive import for_carla

from oodscen.driving._roads.building import read_map
from oodscen.driving._roads.opendrive import read_network
from oodscen.driving.maps._shipped import SHIPPED_MAPS

TEXTS = {road.id: read_map(road.file).decode() for road in SHIPPED_MAPS}


@given(st.sampled_from(list(TEXTS.values())) | st.text(alphabet="<>/header outlines=\"' \n"))
def test_a_second_time_changes_nothing(text):
    assert for_carla(for_carla(text)) == for_carla(text)


@pytest.mark.parametrize("name", TEXTS)
def test_our_own_reader_reads_the_same_roads(name):
    assert read_network(for_carla(TEXTS[name]).encode()) == read_network(TEXTS[name].encode())


@pytest.mark.parametrize("name", TEXTS)
def test_carla_finds_the_crosswalks(name, capfd):
    carla = pytest.importorskip("carla")
    found = carla.Map(name, for_carla(TEXTS[name]))
    crosswalks = TEXTS[name].count('type="crosswalk"')
    assert bool(found.get_crosswalks()) == bool(crosswalks)
    assert len(found.get_crosswalks()) >= 4 * crosswalks
    assert "georeference" not in "".join(capfd.readouterr())
