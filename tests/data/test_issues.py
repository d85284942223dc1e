"""Faults become issues with paths, wherever validation finds them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import Field

from oodscen.data._base import Data
from oodscen.data._catalogue import BehaviourKind
from oodscen.data._issues import IssuesError, below, dotted
from oodscen.errors import DataError, Issue


class Several(Data):
    values: tuple[int, ...] = Field(min_length=2)


def test_every_fault_has_its_path():
    with pytest.raises(DataError) as caught:
        BehaviourKind.parse(
            {
                "id": 1,
                "categories": ["vehicle", "ghost"],
                "parameters": {"speed": {"minimum": "fast", "maximum": 1, "default": 1}},
            },
            source="kinds.json",
        )
    error = caught.value
    assert (error.noun, error.source) == ("behaviour", "kinds.json")
    assert {issue.path for issue in error.issues} == {
        "id",
        "description",
        "categories[1]",
        "parameters.speed.minimum",
    }


@pytest.mark.parametrize(
    ("given", "places"),
    [(["x", "y"], ["values[0]", "values[1]"]), ([1], ["values"]), ([], ["values"])],
)
def test_faulty_elements_are_not_called_missing(given, places):
    with pytest.raises(DataError) as caught:
        Several.parse({"values": given})
    assert [issue.path for issue in caught.value.issues] == places


def test_faults_of_a_whole_are_listed_below_its_place():
    class Whole(Data):
        parts: list[int] = []

        def model_post_init(self, context):
            raise IssuesError([Issue("parts[0]", "a"), Issue("[1]", "b"), Issue("", "c")])

    class Holder(Data):
        wholes: list[Whole]

    with pytest.raises(DataError) as caught:
        Holder.parse({"wholes": [{}]})
    assert caught.value.issues == (
        Issue("wholes[0].parts[0]", "a"),
        Issue("wholes[0][1]", "b"),
        Issue("wholes[0]", "c"),
    )


@given(st.lists(st.sampled_from(["", "a", "[0]", "b.c"])), st.sampled_from(["", "whole"]))
def test_issues_are_moved_below_a_place_from_any_iterable(paths, place):
    issues = [Issue(path, "x") for path in paths]
    assert below(place, iter(issues)) == below(place, issues)
    assert [len(issue.path) >= len(place) for issue in below(place, issues)] == [True] * len(paths)


def test_locations_read_like_code():
    assert dotted(("actors", 2, "placement", "lane")) == "actors[2].placement.lane"
    assert dotted((0, "a")) == "[0].a"
    assert dotted(()) == ""
