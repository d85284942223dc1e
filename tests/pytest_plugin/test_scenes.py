"""Scenes have marks whatever the language of the tree's labels, and demands texts of their own."""

import pytest

from oodscen.data._scene import Demand
from oodscen.pytest_plugin._scenes import Scenes, _slug


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


def test_a_demand_has_its_own_text_and_the_path_of_its_scene(study):
    rare = study.scenes[0]
    event = Demand(kind="queue", text="Cars queue\nahead.")
    demand = rare.model_copy(update={"id": f"{rare.id}~demand", "demand": event})
    scenes = Scenes(study, 0, None)
    assert scenes.text(rare) == "A box, box-001."
    assert scenes.text(demand) == "Cars queue ahead."
    assert scenes.path(demand) == scenes.path(rare) != ()
