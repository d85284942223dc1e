from typing import Any

import numpy as np
import pytest

from oodscen._seeding import stream
from oodscen._words.text import folded_words
from oodscen.author._builtin import BuiltinAuthor
from oodscen.author._knowledge.base import Counterpart, Knowledge, Recipe
from oodscen.author._staging.lanes import with_ego_lane, with_variant
from oodscen.prompts._digest import CatalogueDigest, MapLine
from oodscen.prompts._scenario.stage_scene import SceneDraft, StageScene

ROAD = MapLine(
    id="x", description="", lanes=3, oncoming_lanes=0, speed_limit=14.0, traits=("one_way",)
)


def recipe_of(ego_lane: str, **actor: Any) -> Recipe:
    one = {"id": "a", "asset": "adult", "ahead": 60.0, **actor}
    return Recipe.parse(
        {
            "speed": 10.0,
            "decision": {"kind": "ttc", "value": 2.5},
            "ego_lane": ego_lane,
            "actors": [one],
        }
    )


def chosen(recipe: Recipe, text: str = "x") -> list[tuple[Recipe, int]]:
    return [with_ego_lane(recipe, ROAD, text, stream(seed, "lane")) for seed in range(60)]


def test_the_rightmost_lane_unless_the_recipe_allows_others() -> None:
    assert {lane for _, lane in chosen(recipe_of("right"))} == {0}
    assert {lane for _, lane in chosen(recipe_of("any"))} == {0, 1, 2}
    assert {lane for _, lane in chosen(recipe_of("mirror"))} == {0, 2}


@pytest.mark.parametrize(
    "text",
    ["A car stands in the nearside lane.", "A car in the lane to its left.", "The slow lane."],
)
@pytest.mark.parametrize("key", ["any", "mirror"])
def test_a_lane_in_the_text_holds(key: str, text: str) -> None:
    assert {lane for _, lane in chosen(recipe_of(key), text)} == {0}


def test_a_side_in_the_text_forbids_mirroring() -> None:
    assert {lane for _, lane in chosen(recipe_of("mirror"), "It comes from the left.")} == {0}


def test_who_crosses_from_the_kerb_has_further_to_go_and_starts_sooner() -> None:
    recipe = recipe_of(
        "any",
        offset=[-3.8, -3.6],
        behaviour="cross_road",
        parameters={"speed": 1.4, "distance": 9.0},
        trigger={"kind": "ttc", "value": 3.0},
        ordinary={"behaviour": "stand"},
    )
    for other, lane in chosen(recipe):
        actor = other.actors[0]
        assert actor.lane == (-lane,)
        assert actor.offset == recipe.actors[0].offset
        assert actor.parameters["distance"][0] == pytest.approx(9.0 + 3.5 * lane)
        assert actor.trigger.value[0] == pytest.approx(3.0 + 2.5 * lane)


def test_a_counterpart_beside_the_road_stays_there() -> None:
    for other, lane in chosen(recipe_of("any", ordinary={"offset": -4.3})):
        assert other.actors[0].lane == (0,)
        twin = other.actors[0].ordinary
        assert isinstance(twin, Counterpart)
        assert (twin.lane or 0) == -lane


def test_mirroring_exchanges_left_and_right() -> None:
    recipe = recipe_of(
        "mirror",
        lane=1,
        offset=[0.1, 0.2],
        heading_deg=[-5.0, 10.0],
        behaviour="cut_in",
        parameters={"speed": 7.0, "lanes": -1},
        state="indicate_right",
        ordinary={"behaviour": "follow_lane", "lane": 1},
    )
    other = next(found for found, lane in chosen(recipe) if lane == 2).actors[0]
    assert other.lane == (-1,)
    assert other.offset == (-0.2, -0.1)
    assert other.heading_deg == (-10.0, 5.0)
    assert other.parameters == {"speed": (7.0, 7.0), "lanes": (1.0, 1.0)}
    assert other.state == "indicate_left"
    assert isinstance(other.ordinary, Counterpart)
    assert other.ordinary.lane == -1


def test_mirroring_exchanges_defaults_and_the_ordinary_counterpart_too() -> None:
    recipe = recipe_of(
        "mirror",
        behaviour="fall",
        parameters={"lateral": [0.2, 0.4]},
        ordinary={
            "behaviour": "cut_in",
            "parameters": {"speed": 7.0, "lanes": 1},
            "state": "indicate_left",
        },
    )
    other = next(found for found, lane in chosen(recipe) if lane == 2).actors[0]
    assert other.parameters == {"lateral": (-0.4, -0.2), "spin_deg": (-60.0, -60.0)}
    assert isinstance(other.ordinary, Counterpart)
    assert other.ordinary.parameters == {"speed": (7.0, 7.0), "lanes": (-1.0, -1.0)}
    assert other.ordinary.state == "indicate_right"


def test_a_variant_goes_with_its_words() -> None:
    recipe = recipe_of("any", offset=0.0, parameters={"speed": 1.0}).model_copy(
        update={
            "variants": Recipe.parse(
                {
                    "speed": 1.0,
                    "decision": {},
                    "variants": [
                        {
                            "words": "on the verge",
                            "actors": {"a": {"offset": -3.0, "parameters": {"distance": 2.0}}},
                        }
                    ],
                }
            ).variants
        }
    )
    assert with_variant(recipe, "It stands in the lane.") == recipe
    actor = with_variant(recipe, "It stands on the verge.").actors[0]
    assert actor.offset == (-3.0, -3.0)
    assert actor.parameters == {"speed": (1.0, 1.0), "distance": (2.0, 2.0)}


def test_every_variant_is_told_by_an_event_of_its_hazard(knowledge: Knowledge) -> None:
    seen = 0
    for hazard in knowledge.hazards:
        for variant in hazard.stage.variants if hazard.stage else ():
            events = [folded_words(event) for event in hazard.events]
            told = [e for e in events if any(folded_words(word) in e for word in variant.words)]
            assert told, hazard.id
            assert len(told) < len(hazard.events)
            seen += 1
    assert seen >= 20


def drafts(author: BuiltinAuthor, ask, digest: CatalogueDigest, text: str) -> list[SceneDraft]:
    return [
        ask(
            author,
            StageScene(text=f"{text} {'.' * number}", path=(), catalogue=digest),
        )
        for number in range(24)
    ]


def test_scenes_have_company_unless_the_text_says_that_there_is_none(
    author: BuiltinAuthor, ask, digest: CatalogueDigest
) -> None:
    for text, expected in (
        ("Ego drives on a three-lane urban road. A sofa stands in its lane.", True),
        (
            "Ego drives on a three-lane urban road, with no other traffic nearby. A sofa stands in "
            "its lane.",
            False,
        ),
    ):
        scenes = drafts(author, ask, digest, text)
        found = [a for s in scenes for a in s.actors if a.id.endswith("-traffic")]
        assert bool(found) is expected
        for scene in scenes:
            beside = {a.id: a for a in scene.actors if a.id.endswith("-traffic")}
            assert not set(beside) & set(scene.hazard.actors)
            for actor in beside.values():
                assert 0 <= scene.ego.lane + actor.placement.lane < 3
        lanes = {scene.ego.lane for scene in scenes}
        assert lanes == {0, 1, 2}


def test_the_choice_is_reproducible() -> None:
    recipe = recipe_of("any")
    rng = np.random.default_rng(3)
    again = np.random.default_rng(3)
    assert with_ego_lane(recipe, ROAD, "x", rng) == with_ego_lane(recipe, ROAD, "x", again)


@pytest.mark.parametrize("hazard_id", ["oncoming-drift", "u-turn-across", "oncoming-spin"])
def test_who_comes_the_other_way_on_an_avenue_starts_in_an_oncoming_lane(
    author: BuiltinAuthor, ask, digest: CatalogueDigest, knowledge: Knowledge, hazard_id: str
) -> None:
    hazard = next(hazard for hazard in knowledge.hazards if hazard.id == hazard_id)
    event = hazard.events[0].replace(" {where}", "")
    text = f"The ego vehicle drives on an avenue with two lanes each way. {event}."
    for scene in drafts(author, ask, digest, text)[:6]:
        road = next(road for road in digest.maps if road.id == scene.map)
        assert road.lanes == 2
        (actor,) = (actor for actor in scene.actors if actor.id in scene.hazard.actors)
        assert scene.ego.lane + actor.placement.lane >= road.lanes
