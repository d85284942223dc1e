"""Scenes show what they claim: seen, on the ground, nothing inside something else."""

import dataclasses

import pytest

from oodscen.data._scene import Behaviour, Hazard, Trigger, Weather
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._sight.placement import check_scene
from oodscen.driving._sight.scene_checks import (
    bodies,
    first_seen,
    floating_issues,
    overlap_issues,
    touch,
    truth_issues,
)
from tests.driving.staging import CATALOGUE, actor, scene, world


def staged(*actors, **fields):
    near = Trigger(kind="distance", value=25.0, actor=actors[0].id)
    unusual = Hazard(actors={actors[0].id: None})
    return scene(*actors, hazard=unusual, **{"decision": near, **fields})


def moments(one, *, lift=0.0):
    poses = world(one).poses()
    poses[1:, 2] += lift
    cast = bodies(one, CATALOGUE, poses)
    return load_corridor(CATALOGUE.map(one.map)), {"first": cast, "middle": cast, "last": cast}


def test_a_box_ahead_is_seen():
    one = staged(actor("box", "cardboard_box", ahead=50.0))
    assert check_scene(one, CATALOGUE) == []
    assert first_seen(one, *moments(one)) == {"box": "first"}


@pytest.mark.parametrize(
    ("one", "words"),
    [
        (staged(actor("box", "cardboard_box", ahead=-40.0), decision=Trigger(value=1.0)), "behind the ego"),
        (
            staged(
                actor("child", "adult", ahead=62.0),
                actor("bus", "bus", "follow_lane", ahead=40.0, speed=10.0),
                decision=Trigger(value=1.0),
            ),
            "hidden by 'bus'",
        ),
        (staged(actor("tyre", "tyre", ahead=250.0), decision=Trigger(value=1.0)), "square pixels"),
    ],
    ids=["behind", "hidden", "small"],
)  # fmt: skip
def test_a_hazard_that_nobody_can_see_is_refused(one, words):
    (issue,) = check_scene(one, CATALOGUE)
    assert issue.path == "actors[0]"
    assert words in issue.message
    assert repr(one.actors[0].id) in issue.message
    assert one.actors[0].asset in issue.message
    assert "ahead_m" in issue.message


def test_fog_that_hides_the_hazard_is_refused():
    thick = staged(actor("box", "cardboard_box", ahead=60.0), decision=Trigger(value=1.0))
    foggy = thick.model_copy(update={"weather": Weather(fog_visual_range_m=30.0)})
    assert check_scene(thick, CATALOGUE) == []
    assert "visual range" in check_scene(foggy, CATALOGUE)[0].message


def test_weather_that_is_no_hazard_is_refused():
    same = scene(hazard=Hazard(weather=Weather(cloud_cover=0.2)))
    (issue,) = check_scene(same, CATALOGUE)
    assert issue.path == "hazard.weather"
    assert (
        check_scene(scene(hazard=Hazard(weather=Weather(sun_elevation_deg=-20))), CATALOGUE) == []
    )


def test_what_floats_or_sinks_is_named_unless_it_is_carried():
    one = staged(actor("car"), actor("crate", "cardboard_box", ahead=60.0))
    assert floating_issues(one, *moments(one)) == []
    high = floating_issues(one, *moments(one, lift=1.0))
    assert [issue.path for issue in high] == ["actors[0].placement", "actors[1].placement"]
    assert "floats" in high[0].message
    assert "sinks" in floating_issues(one, *moments(one, lift=-1.0))[0].message
    carried = one.actors[1].model_copy(update={"behaviour": Behaviour(other="car")})
    riding = one.model_copy(update={"actors": (one.actors[0], carried)})
    corridor, shown = moments(one, lift=1.0)
    assert [issue.path for issue in floating_issues(riding, corridor, shown)] == [
        "actors[0].placement"
    ]


def test_what_belongs_to_another_may_touch_it():
    one = staged(actor("car"), actor("door", "cardboard_box", ahead=31.0))
    corridor, shown = moments(one)
    (issue,) = overlap_issues(one, corridor, shown)
    assert issue.path == "actors[1].placement"
    attached = one.actors[1].model_copy(update={"behaviour": Behaviour(other="car")})
    assert (
        overlap_issues(
            one.model_copy(update={"actors": (one.actors[0], attached)}), corridor, shown
        )
        == []
    )


def test_what_lies_flat_may_be_stood_upon_but_not_by_the_ego():
    one = staged(actor("car"), actor("puddle", "puddle"))
    _, shown = moments(one)
    car, puddle = shown["first"][1:]
    assert not touch(car, puddle)
    assert touch(car, puddle, is_tall=False)
    above = puddle._replace(solid=dataclasses.replace(car.solid, z=3.0))
    assert not touch(car, above)


def test_a_later_overlap_is_the_behaviour_s_fault():
    one = staged(actor("a"), actor("b", ahead=60.0))
    corridor, shown = moments(one)
    first, crashed = shown["first"], list(shown["first"])
    crashed[2] = crashed[2]._replace(solid=crashed[1].solid)
    issues = truth_issues(one, corridor, {"first": first, "middle": first, "last": crashed})
    assert [issue.path for issue in issues] == ["actors[1].behaviour"]
    assert "at the decision" in issues[0].message
