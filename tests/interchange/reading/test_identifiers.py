import re

from hypothesis import given
from hypothesis import strategies as st

from oodscen._words.wording import is_left_out
from oodscen.interchange._reading.identifiers import identifier, identifiers, scene_identifier

ACCEPTED = re.compile(r"[a-z0-9][a-z0-9_-]{0,40}")
NAMES = st.lists(
    st.text() | st.sampled_from(["Ego", "ego", "NA", "x" * 50, "x" * 60, "a b", "a-b"]), unique=True
)


@given(NAMES)
def test_every_name_gets_an_id_of_its_own(names):
    ids = identifiers(names)
    assert list(ids) == names
    assert len({"ego", *ids.values()}) == len(names) + 1
    assert all(ACCEPTED.fullmatch(one) and not is_left_out(one) for one in ids.values())


@given(st.from_regex(r"[a-z0-9][a-z0-9_-]{0,38}[a-z0-9]", fullmatch=True))
def test_an_id_is_its_own(name):
    assert identifier(name) == name


@given(st.from_regex(r"[a-z0-9][a-z0-9_-]{0,198}[a-z0-9]", fullmatch=True))
def test_the_id_of_a_scene_is_not_cut(name):
    assert scene_identifier(name) == name
