"""Ids of twins lead back to their scenes."""

from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._twins import is_twin, scene_of, twin_id


@given(st.text().filter(lambda name: not is_twin(name)))
def test_a_twin_and_its_scene_name_each_other(name):
    assert is_twin(twin_id(name))
    assert scene_of(twin_id(name)) == scene_of(name) == name
