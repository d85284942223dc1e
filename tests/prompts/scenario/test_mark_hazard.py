import pytest

from oodscen.prompts._scenario.mark_hazard import ActorLine, MarkedHazard, MarkHazard

LINES = tuple(
    ActorLine(id=name, what="a deer", does="bolt: runs", ahead_m=60.5, left_m=-4.25)
    for name in ("stag", "doe")
)


@pytest.mark.parametrize(
    ("actors", "places"),
    [
        (["stag"], []),
        (["doe", "stag"], []),
        (["elk", "stag", "fox"], ["actors[0]", "actors[2]"]),
        (["stag", "stag"], ["actors"]),
    ],
)
def test_marked_actors_are_those_of_the_scene_and_named_once(actors, places):
    issues = MarkHazard(title="x", actors=LINES).check(MarkedHazard(reasoning="", actors=actors))
    assert [issue.path for issue in issues] == places
