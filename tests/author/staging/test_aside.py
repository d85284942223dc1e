"""A thing that a text puts beside the ego's lane is staged there, by whatever name the text calls the ego."""

import pytest

from oodscen.prompts._scenario.stage_scene import StageScene

WORDINGS = (
    "the ego's lane",
    "the ego’s lane",
    "ego's own lane",
    "the ego lane",
    "the lane of the ego vehicle",
    "my lane",
    "our lane",
    "its lane",
)


@pytest.mark.parametrize("lane", WORDINGS)
def test_what_lies_beside_the_lane_is_staged_there(author, ask, rich_digest, lane):
    text = f"The ego vehicle is on a country road. A mattress lies flat beside {lane} 40 m ahead."
    draft = ask(author, StageScene(text=text, path=("Mattress",), catalogue=rich_digest))
    (name,) = draft.hazard.actors
    offsets = [actor.placement.offset_m for actor in draft.actors if actor.id == name]
    assert max(offsets) < -1.9, text
