import pytest

from oodscen.data._scene import Hazard, Trigger
from oodscen.data._weather import Weather
from oodscen.driving._sight.placement import check_scene, staging_issues, vocabulary_advice
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from tests.driving.staging import CATALOGUE, actor, scene


def paths(staged) -> list[str]:
    return [issue.path for issue in check_scene(staged, CATALOGUE)]


def test_a_good_scene_has_no_issue() -> None:
    box = actor("box", "cardboard_box", ahead=80.0)
    near = Trigger(kind="distance", value=25.0, actor="box")
    good = scene(box, hazard=Hazard(actors={"box": None}), decision=near)
    assert check_scene(good, CATALOGUE) == []
    assert check_scene(good.twin(5.0), CATALOGUE) == []


@pytest.mark.parametrize("road", SHIPPED_MAPS, ids=lambda road: road.id)
def test_the_whole_range_of_placements_is_on_every_map(road) -> None:
    for ahead in (-150.0, 300.0):
        staged = scene(actor("a", "car", "follow_lane", ahead=ahead), map=road.id)
        assert check_scene(staged, CATALOGUE) == []


@pytest.mark.parametrize(
    ("staged", "path"),
    [
        (scene(actor("a", "unicorn")), "actors[0].asset"),
        (scene(actor("a", "car", "fly")), "actors[0].behaviour.name"),
        (scene(actor("a", "car", "cut_in", speed=99.0)), "actors[0].behaviour.parameters.speed"),
        (scene(map="nowhere"), "map"),
        (scene(map="/no/such/file.xodr"), "map"),
        (scene(lane=2), "ego.lane"),
        (scene(actor("a", lane=4)), "actors[0].placement.lane"),
        (scene(actor("a", lane=-1)), "actors[0].placement.lane"),
        (scene(actor("a", "cone", offset=16.0)), "actors[0].placement.offset_m"),
        (
            scene(actor("a", "car", "cut_in", lanes=-1, ahead=50)),
            "actors[0].behaviour.parameters.lanes",
        ),
        (
            scene(actor("a", "car", "cut_in", lanes=0.5, ahead=50)),
            "actors[0].behaviour.parameters.lanes",
        ),
        (scene(actor("a", "car", "follow_lane", offset=-3.0)), "actors[0].placement"),
        (scene(actor("a", ahead=2.0)), "actors[0].placement"),
        (scene(actor("a"), actor("b", ahead=33.0)), "actors[1].placement"),
        (
            scene(actor("a"), decision=Trigger(kind="distance", value=3.0, actor="a")),
            "decision",
        ),
        (
            scene(
                actor("a", ahead=290.0),
                decision=Trigger(kind="distance", value=3.0, actor="a"),
            ),
            "decision",
        ),
        (scene(map="rural_curve", speed=28.0, friction=0.1,
               decision=Trigger(value=14.0)), "decision"),
    ],
)  # fmt: skip
def test_faults_are_found_where_they_are(staged, path: str) -> None:
    assert path in paths(staged)


def test_standing_things_may_be_beside_the_road() -> None:
    staged = scene(
        actor("a", "car", offset=-3.6, ahead=40.0),
        actor("b", "adult", "cross_road", offset=-3.6, heading=90.0, ahead=50.0),
        actor("c", "deer", "bolt", offset=15.0, heading=-90.0, ahead=60.0),
        map="rural_curve",
    )
    assert paths(staged.model_copy(update={"actors": staged.actors[:2]})) == []
    assert paths(staged) == ["actors[2].placement.offset_m"]


def test_an_overlap_names_both_and_where_they_are() -> None:
    (issue,) = check_scene(scene(actor("a"), actor("b", ahead=31.0)), CATALOGUE)
    for part in ("'a'", "'b'", "ahead_m 31.0", "heading"):
        assert part in issue.message


def test_faults_of_the_twin_have_their_path_in_the_scene() -> None:
    ordinary = actor("w", "car", "follow_lane", ahead=40.0, lane=1, speed=8.0)
    staged = scene(
        actor("x", "car", ahead=42.0, lane=1),
        actor("w", "car", "wrong_way", ahead=90.0, speed=8.0),
        hazard=Hazard(actors={"w": ordinary}),
        decision=Trigger(kind="ttc", value=3.0, actor="w"),
    )
    assert paths(staged) == ["hazard.actors.w.placement"]


def test_early_contact_is_named() -> None:
    staged = scene(actor("a"), decision=Trigger(value=10.0))
    (issue,) = check_scene(staged, CATALOGUE)
    assert "'a'" in issue.message


def test_the_weather_of_the_twin_is_checked() -> None:
    staged = scene(hazard=Hazard(weather=Weather(fog_visual_range_m=1.0)))
    assert paths(staged) == ["hazard.weather.fog_visual_range_m"]


def test_all_issues_are_listed_at_once() -> None:
    staged = scene(actor("a", lane=5), actor("b", "cone", offset=20.0), actor("c", lane=-3))
    assert len(staging_issues(staged, CATALOGUE)) == 3


@pytest.mark.parametrize(
    ("asset", "is_foreign"), [("cardboard_box", False), ("cardbord_box", False), ("qqqqq", True)]
)
def test_a_scene_in_the_words_of_another_catalogue_is_told_what_to_do(asset, is_foreign) -> None:
    staged = scene(actor("a", asset), actor("b", asset))
    advice = vocabulary_advice(staged, CATALOGUE)
    assert len(advice) == is_foreign
    assert all(repr(CATALOGUE.simulator) in issue.message for issue in advice)
