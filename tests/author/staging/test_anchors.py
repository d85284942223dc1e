import pytest

from oodscen.author._knowledge.base import Knowledge, Recipe
from oodscen.author._staging.anchors import (
    ahead_of_start,
    anchors,
    has_landmarks,
    landmarks_needed,
    marks,
)
from oodscen.errors import LLMError
from oodscen.prompts._digest import MapLine
from oodscen.prompts._landmarks import Landmark

RECIPE = Recipe.parse(
    {
        "speed": [8.0, 10.0],
        "decision": {"kind": "ttc", "value": 3.0},
        "actors": [
            {"id": "car", "asset": "car", "ahead": [40.0, 50.0]},
            {"id": "trailer", "asset": "trailer", "ahead": -5.0, "at": "car"},
            {"id": "box", "asset": "crate", "ahead": [-1.0, 0.0], "at": "trailer"},
            {"id": "signal", "asset": "traffic_light", "ahead": 0.0, "at": "traffic_light"},
        ],
    }
)


def road(*found: Landmark) -> MapLine:
    return MapLine(
        id="x",
        description="",
        lanes=2,
        oncoming_lanes=2,
        speed_limit=14.0,
        traits=(),
        landmarks=found,
    )


LIGHTS = (
    Landmark(kind="traffic_light", ahead_m=90.0, left_m=-2.4),
    Landmark(kind="junction", ahead_m=110.0, length_m=27.0),
    Landmark(kind="traffic_light", ahead_m=124.0, left_m=-2.4),
)


def test_a_chain_of_actors_begins_where_the_first_is() -> None:
    car, trailer, box, signal = RECIPE.actors
    assert anchors(RECIPE, box)[-1] is car
    assert ahead_of_start(RECIPE, trailer) == (35.0, 45.0)
    assert ahead_of_start(RECIPE, box) == (34.0, 45.0)
    assert ahead_of_start(RECIPE, signal) is None


def test_landmarks_decide_which_maps_will_do() -> None:
    signal = RECIPE.actors[-1]
    assert landmarks_needed(RECIPE) == ("traffic_light",)
    assert has_landmarks(road(*LIGHTS), RECIPE)
    assert not has_landmarks(road(), RECIPE)
    assert marks(road(*LIGHTS), signal) == (LIGHTS[0], LIGHTS[2])
    with pytest.raises(LLMError, match="traffic light"):
        marks(road(), signal)


def test_texts_name_no_distance_where_the_map_decides_it(knowledge: Knowledge) -> None:
    for hazard in knowledge.hazards:
        if hazard.stage is not None and landmarks_needed(hazard.stage):
            assert not any("{where}" in event for event in hazard.events), hazard.id
