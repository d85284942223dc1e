"""A draft may leave blank what it does not need, turn as it likes, or say that it cannot be."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from oodscen.data._claim import Claim
from oodscen.prompts._scenario.stage_scene import SceneDraft, StageScene
from tests.prompts.samples import DIGEST

ACTOR = {
    "id": "deer",
    "asset": "deer",
    "placement": {"ahead_m": 50.0},
    "behaviour": {"name": "bolt", "trigger": {"kind": "time", "value": 1.0}},
}
DRAFT = {
    "map": "avenue",
    "ego": {"speed": 8.0},
    "actors": [ACTOR],
    "hazard": {"actors": {"deer": None}},
    "decision": {"kind": "distance", "value": 30.0, "actor": "deer"},
}
PROMPT = StageScene(
    text="A deer.",
    path=("x",),
    claims=(Claim(kind="thing", value="present", subject="deer"),),
    catalogue=DIGEST,
)
blank = st.sampled_from([None, ""])


@given(st.dictionaries(st.sampled_from(["state", "behaviour"]), blank), blank, blank)
def test_null_and_empty_mean_left_out(actor, weather, inner):
    filled = {
        **DRAFT,
        "weather": {"fog_visual_range_m": inner},
        "reasoning": weather,
        "cannot_show": inner,
        "stands_for": None,
        "horizon_s": None,
        "actors": [{**ACTOR, **actor}],
        "hazard": {"actors": {"deer": None}, "weather": weather},
    }
    bare = {**DRAFT, "actors": [{k: v for k, v in ACTOR.items() if k not in actor}]}
    assert SceneDraft.model_validate(filled) == SceneDraft.model_validate(bare)


@given(st.floats(-2000, 2000))
def test_headings_wrap(heading):
    turned = {**ACTOR, "placement": {"ahead_m": 50.0, "heading_deg": heading}}
    draft = SceneDraft.model_validate(
        {**DRAFT, "actors": [turned], "hazard": {"actors": {"deer": turned}}}
    )
    ordinary = draft.hazard.actors["deer"]
    assert ordinary is not None
    for actor in (draft.actors[0], ordinary):
        found = actor.placement.heading_deg
        assert -180 <= found <= 180
        assert math.isclose(math.remainder(found - heading, 360.0), 0.0, abs_tol=1e-6)


@pytest.mark.parametrize("heading", [10**400, 1e300, math.inf, math.nan])
def test_a_heading_that_is_no_turn_is_a_fault(heading):
    turned = {**ACTOR, "placement": {"ahead_m": 50.0, "heading_deg": heading}}
    with pytest.raises(ValidationError, match="heading_deg"):
        SceneDraft.model_validate({**DRAFT, "actors": [turned]})


@pytest.mark.parametrize("rest", [{}, DRAFT, {"actors": "none", "map": None}])
def test_what_cannot_be_shown_needs_nothing_else(rest):
    draft = SceneDraft.model_validate({**rest, "cannot_show": "there is no ship"})
    assert draft.cannot_show == "there is no ship"
    assert PROMPT.check(draft) == []


@pytest.mark.parametrize(
    ("shown", "faults"),
    [
        ({"deer": "deer"}, []),
        ({"deer": ["deer"], "street lamp": "map"}, []),
        ({}, []),
        ({"deer": ["stag", "deer"]}, ["stands_for.deer"]),
    ],
)
def test_only_actors_of_the_scene_stand_for_something(shown, faults):
    draft = SceneDraft.model_validate({**DRAFT, "stands_for": shown})
    assert [issue.path for issue in PROMPT.check(draft)] == faults


@given(st.recursive(st.none() | st.text() | st.integers(), lambda one: st.lists(one)))
def test_no_answer_breaks_the_tidying(value):
    for name in ("actors", "hazard", "stands_for", "weather"):
        try:
            SceneDraft.model_validate({**DRAFT, name: value})
        except ValueError:
            continue
