"""Laws of the ids of scenes, twins and demands."""

from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._pairing import (
    demand_id,
    is_ordinary,
    is_twin,
    kind_of,
    leaf_in,
    scene_of,
    twin_id,
)


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


@given(st.from_regex(r"[a-z]+(-[a-z]+)?", fullmatch=True), st.integers(0, 999))
def test_an_id_begins_with_its_leaf_and_one_without_a_number_stands_for_itself(name, number):
    for suffix in ("", ".v001"):
        assert leaf_in(twin_id(f"{name}-{number:03d}{suffix}")) == name
    assert leaf_in(name) == leaf_in(demand_id(name)) == name
