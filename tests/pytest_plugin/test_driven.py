"""The words for a drive: its outcome, its figures, and the moments up to the one that matters."""

import numpy as np
import pytest

from oodscen.data._drive_result import DriveResult
from oodscen.protocols import State
from oodscen.pytest_plugin._driven import Driven
from oodscen.testing import example_scene

SCENE = example_scene()
ACTOR = SCENE.actors[0]


def driven(speeds, gap=np.inf, **fields) -> Driven:
    """Return a drive with a state every second at these speeds, and one actor."""
    states = tuple(
        State(
            step=step,
            time=float(step),
            ids=("ego", ACTOR.id),
            poses=np.zeros((2, 4)),
            speeds=np.array([speed, 0.0]),
            gaps=np.array([np.inf, gap]),
            off_road=False,
        )
        for step, speed in enumerate(speeds)
    )
    result = DriveResult(
        id="a@d", scene_id=SCENE.id, driver="d", seconds=len(states) - 1.0, **fields
    )
    return Driven(result=result, scene=SCENE, states=states, text="", path=())


@pytest.mark.parametrize(
    ("fields", "outcome"),
    [
        ({"passed": True}, "is safe; least time to collision none"),
        ({"passed": True, "min_ttc_s": 1.49}, "is safe; least time to collision 1.49 s"),
        (
            {"passed": True, "brakes_needlessly": True},
            "is safe, braking hard after 2.00 s although keeping the speed is safe; "
            "least time to collision none",
        ),
        ({"off_road": True}, "leaves the road after 3.00 s at 3.0 m/s"),
        (
            {"collisions": (ACTOR.id, "x")},
            f"touches {ACTOR.id} ({ACTOR.asset}) and x (?) after 3.00 s at 3.0 m/s",
        ),
    ],
)
def test_an_outcome_is_told_in_a_few_words(fields, outcome) -> None:
    drive = driven([9.0, 8.0, 3.0, 3.0], **fields)
    assert drive.outcome == outcome
    assert repr(drive) == f"<d in {SCENE.id}: {outcome}>"


@pytest.mark.parametrize(
    ("fields", "time"),
    [
        ({"passed": True, "brakes_needlessly": True}, 2.0),
        ({"passed": True}, 3.0),
        ({"brakes_needlessly": True}, 3.0),
    ],
)
def test_the_shown_moment_is_where_needless_braking_begins_or_else_the_end(fields, time) -> None:
    assert driven([9.0, 8.0, 3.0, 3.0], **fields).shown.time == time


def test_a_report_has_a_line_per_known_fact_and_none_twice() -> None:
    lines = driven([9.0], gap=4.0, passed=True, min_gap_m=4.0).report(["stop", "pull_over"])
    assert lines.splitlines() == [
        f"scene      {SCENE.id}",
        "outcome    is safe; least time to collision none",
        "figures    least gap 4.00 m, least time to collision none, hardest braking 0.0 m/s2, "
        "0% of the way at constant speed",
        "safe here  stop, pull_over",
        f"before       0.00 s    9.0 m/s    4.0 m from {ACTOR.id}",
    ]
