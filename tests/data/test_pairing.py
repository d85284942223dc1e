"""Laws of the ids of scenes, twins and demands."""

from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._pairing import demand_id, is_ordinary, is_twin, kind_of, scene_of, twin_id


@given(st.text().filter(lambda name: not is_ordinary(name)))
def test_ids_tell_the_scene_and_the_kind(name: str) -> None:
    assert kind_of(name) == "rare"
    assert not is_twin(name)
    assert scene_of(name) == name
    for made, kind in ((twin_id(name), "twin"), (demand_id(name), "demand")):
        assert kind_of(made) == kind
        assert is_ordinary(made)
        assert is_twin(made) is (kind == "twin")
        assert scene_of(made) == name
