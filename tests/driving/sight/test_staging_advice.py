"""Advice to stagers: what cannot be named, why, and what would do."""

import pytest

from oodscen.data._scene import Hazard, Trigger
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._sight.decision_view import drawn
from oodscen.driving._sight.placement import check_scene
from oodscen.driving._sight.scene_checks import bodies
from oodscen.driving._sight.staging_advice import AdvisingCheck, visibility_issues
from oodscen.driving._sight.visibility import Eye
from oodscen.protocols import Camera
from tests.driving.staging import CATALOGUE, actor, scene, world


def staged(*actors, after=1.0, **fields):
    hazard = Hazard(actors={actors[0].id: None})
    return scene(*actors, hazard=hazard, decision=Trigger(value=after), **fields)


def test_what_can_be_named_and_what_a_later_decision_shows_is_accepted():
    assert visibility_issues(staged(actor("box", "cardboard_box", ahead=25.0)), CATALOGUE) == []
    assert visibility_issues(staged(actor("box", "cardboard_box", ahead=60.0)), CATALOGUE) == []


@pytest.mark.parametrize(
    ("one", "words"),
    [
        (staged(actor("box", "cardboard_box", ahead=-40.0)), ("outside", "never")),
        (staged(actor("bag", "cardboard_box", ahead=25.0, offset=60.0)), ("outside", "never")),
        (
            staged(
                actor("child", "adult", ahead=50.0),
                actor("bus", "bus", "follow_lane", ahead=40.0, speed=10.0),
            ),
            ("'bus'",),
        ),
    ],
    ids=["behind", "aside", "hidden"],
)
def test_the_cause_and_the_remedy_are_told(one, words):
    (issue,) = visibility_issues(one, CATALOGUE)
    assert issue.path == "actors[0]"
    assert all(word in issue.message for word in words)


def test_advice_is_given_once_per_scene():
    check = AdvisingCheck()
    one = staged(actor("child", "adult", ahead=50.0), actor("bus", "bus", ahead=43.0))
    if check_scene(one, CATALOGUE) == []:
        assert len(check(one, CATALOGUE)) == 1
    assert check(one, CATALOGUE) == check_scene(one, CATALOGUE)


def test_a_group_counts_as_one_thing_as_high_as_its_largest_member():
    herd = [actor(f"dog-{n}", "dog", ahead=40.0, offset=1.5 * n - 3.0) for n in range(5)]
    several = scene(*herd, hazard=Hazard(actors={one.id: None for one in herd}))
    one = scene(herd[2], hazard=Hazard(actors={herd[2].id: None}))
    looks = []
    for staging in (several, one):
        cast = bodies(staging, CATALOGUE, world(staging).poses())
        looks.append(drawn(staging, cast, load_corridor(CATALOGUE.map(staging.map)), Camera()))
    assert looks[0].height_px == pytest.approx(looks[1].height_px, rel=0.05)
    assert looks[0].size_px > 1.5 * looks[1].size_px
    assert looks[1].distance_m == round(Eye(Camera(), cast[0].solid).distance(cast[1].solid), 1)
