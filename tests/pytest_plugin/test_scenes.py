"""Scenes have marks whatever the language of the tree's labels."""

import pytest

from oodscen.pytest_plugin._scenes import _slug


@pytest.mark.parametrize(
    ("label", "slug"),
    [
        ("Box in the lane", "box_in_the_lane"),
        ("Lorry (jack-knifed), 40 t", "lorry_jack_knifed_40_t"),
        ("Straße mit Glätte", "straße_mit_glätte"),
        ("路上有雪", "路上有雪"),
    ],
)
def test_a_label_makes_a_mark_of_its_own(label, slug):
    assert _slug(label) == slug
