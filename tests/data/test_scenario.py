"""What a scenario may be."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._scenario import Scenario
from oodscen.errors import DataError

TEXTS = st.text(st.characters(exclude_characters="\0", exclude_categories=["Cs"]), max_size=2_000)


@given(TEXTS.filter(str.strip))
def test_any_text_of_sane_length_is_a_scenario(text):
    scenario = Scenario(id="fog-001", text=text)
    assert Scenario.parse(scenario.to_json()) == scenario


@pytest.mark.parametrize(
    ("changes", "path"),
    [
        ({"text": ""}, "text"),
        ({"text": " \n"}, "text"),
        ({"text": "Fog.\0"}, "text"),
        ({"text": "x" * 2_001}, "text"),
        ({"id": ""}, "id"),
        ({"id": "a/b"}, "id"),
        ({"id": ".hidden"}, "id"),
        ({"id": "a\n"}, "id"),
        ({"path": "a > b"}, "path"),
        ({"oodness": 1}, "oodness"),
    ],
)
def test_anything_else_is_refused_with_its_path(changes, path):
    with pytest.raises(DataError) as caught:
        Scenario.parse({"id": "fog-001", "text": "Thick fog.", **changes})
    assert [issue.path for issue in caught.value.issues] == [path]
