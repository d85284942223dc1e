"""Scenes show what they claim: seen, on the ground, nothing inside something else."""

import dataclasses

import pytest

from oodscen.data._scene import Behaviour, Hazard, Trigger
from oodscen.data._weather import Weather
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


def staged(unusual, *others, **fields):
    near = Trigger(kind="distance", value=25.0, actor=unusual.id)
    hazard = Hazard(actors={unusual.id: None})
    return scene(unusual, *others, hazard=hazard, **{"decision": near, **fields})


def attached(scene_, row, other):
    """Return a scene in which an actor belongs to another."""
    actors = list(scene_.actors)
    actors[row] = actors[row].model_copy(update={"behaviour": Behaviour(other=other)})
    return scene_.model_copy(update={"actors": tuple(actors)})


def moments(scene_, *, lift=0.0):
    """Return the corridor of a scene, and its bodies at their start for all moments."""
    poses = world(scene_).poses()
    poses[1:, 2] += lift
    cast = bodies(scene_, CATALOGUE, poses)
    corridor = load_corridor(CATALOGUE.map(scene_.map))
    return corridor, {"first": cast, "middle": cast, "last": cast}


def test_a_box_ahead_is_seen():
    scene_ = staged(actor("box", "cardboard_box", ahead=50.0))
    assert check_scene(scene_, CATALOGUE) == []
    assert first_seen(scene_, *moments(scene_)) == {"box": "first"}


@pytest.mark.parametrize(
    ("seen_at", "moment"),
    [(["middle"], "middle"), (["middle", "last"], "middle"), (["last"], "last")],
)
def test_the_moment_is_the_first_at_which_a_body_is_seen(seen_at, moment):
    scene_ = staged(actor("box", "cardboard_box", ahead=-40.0))
    _, ahead = moments(staged(actor("box", "cardboard_box", ahead=50.0)))
    corridor, behind = moments(scene_)
    shown = behind | {at: ahead[at] for at in seen_at}
    assert first_seen(scene_, corridor, shown) == {"box": moment}


@pytest.mark.parametrize(
    ("scene_", "words"),
    [
        (staged(actor("box", "cardboard_box", ahead=-40.0), decision=Trigger(value=1.0)), "behind the ego"),
        (
            staged(
                actor("adult", "adult", ahead=62.0),
                actor("bus", "bus", "follow_lane", ahead=40.0, speed=10.0),
                decision=Trigger(value=1.0),
            ),
            "hidden by 'bus'",
        ),
        (staged(actor("tyre", "tyre", ahead=250.0), decision=Trigger(value=1.0)), "square pixels"),
    ],
    ids=["behind", "hidden", "small"],
)  # fmt: skip
def test_a_hazard_that_nobody_can_see_is_refused(scene_, words):
    (issue,) = check_scene(scene_, CATALOGUE)
    assert issue.path == "actors[0]"
    assert words in issue.message
    assert repr(scene_.actors[0].id) in issue.message
    assert scene_.actors[0].asset in issue.message
    assert "ahead_m" in issue.message


def test_a_load_is_hidden_by_what_stands_before_it_not_by_what_carries_it():
    scene_ = staged(
        actor("load", "cardboard_box", ahead=62.0),
        actor("lorry", "truck", ahead=62.0),
        actor("bus", "bus", ahead=40.0),
    )
    scene_ = attached(scene_, 0, "lorry")
    corridor, shown = moments(scene_)
    (issue,) = truth_issues(scene_, corridor, shown)
    assert "hidden by 'bus'" in issue.message
    assert "lorry" not in issue.message


@pytest.mark.parametrize(
    ("ahead", "offset", "words", "seen"),
    [
        (45.0, 12.0, "would be seen 36 m ahead of it at the same offset", (36.0, 12.0)),
        (20.0, 30.0, "would be seen there at offset_m 9.0 from the ego's lane", (20.0, 9.0)),
        (20.0, -30.0, "would be seen there at offset_m -9.0 from the ego's lane", (20.0, -9.0)),
    ],
)
def test_where_an_unseen_hazard_would_be_seen_is_told(ahead, offset, words, seen):
    unseen = staged(actor("tyre", "tyre", ahead=ahead, offset=offset))
    (issue,) = truth_issues(unseen, *moments(unseen))
    assert issue.message.endswith(words)
    nearer = staged(actor("tyre", "tyre", ahead=seen[0], offset=seen[1]))
    assert first_seen(nearer, *moments(nearer)) == {"tyre": "first"}


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
    scene_ = staged(actor("car"), actor("crate", "cardboard_box", ahead=60.0))
    assert floating_issues(scene_, *moments(scene_)) == []
    high = floating_issues(scene_, *moments(scene_, lift=1.0))
    assert [issue.path for issue in high] == ["actors[0].placement", "actors[1].placement"]
    assert "floats" in high[0].message
    assert "sinks" in floating_issues(scene_, *moments(scene_, lift=-1.0))[0].message
    riding = floating_issues(attached(scene_, 1, "car"), *moments(scene_, lift=1.0))
    assert [issue.path for issue in riding] == ["actors[0].placement"]


def test_what_belongs_to_another_may_touch_it():
    scene_ = staged(actor("car"), actor("door", "cardboard_box", ahead=31.0))
    corridor, shown = moments(scene_)
    (issue,) = overlap_issues(scene_, corridor, shown)
    assert issue.path == "actors[1].placement"
    assert overlap_issues(attached(scene_, 1, "car"), corridor, shown) == []


def test_what_lies_flat_may_be_stood_upon_but_not_by_the_ego():
    scene_ = staged(actor("car"), actor("puddle", "puddle"))
    _, shown = moments(scene_)
    car, puddle = shown["first"][1:]
    assert not touch(car, puddle)
    assert touch(car, puddle, ignores_flat=False)
    above = puddle._replace(solid=dataclasses.replace(car.solid, z=3.0))
    assert not touch(car, above)


def test_a_later_overlap_is_blamed_on_the_behaviour():
    scene_ = staged(actor("a"), actor("b", ahead=60.0))
    corridor, shown = moments(scene_)
    first, crashed = shown["first"], list(shown["first"])
    crashed[2] = crashed[2]._replace(solid=crashed[1].solid)
    issues = truth_issues(scene_, corridor, {"first": first, "middle": first, "last": crashed})
    assert [issue.path for issue in issues] == ["actors[1].behaviour"]
    assert "at the decision" in issues[0].message
