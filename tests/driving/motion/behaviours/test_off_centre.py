"""Road users drive a little beside the middle of their lanes; whatever has its exact place keeps it."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._scene import Actor, Behaviour, Placement
from oodscen.driving._motion.behaviours.off_centre import OFF_CENTRE_M, off_centre
from oodscen.driving._motion.behaviours.table import BUILT_IN

DRIVES = {"follow_lane", "halt", "cut_in", "wrong_way", "hard_brake", "overtake"}
STAYS = {"stand", "towed", "fall", "cross_road", "walk_along", "pull_out", "run_red", "open_door"}


def actor(does: str, offset: float = 0.0, other: str | None = None) -> Actor:
    return Actor(
        id="a",
        asset="car",
        placement=Placement(ahead_m=40.0, lane=1, offset_m=offset, heading_deg=3.0),
        behaviour=Behaviour(name=does, other=other),
    )


def moved(one: Actor, seed: int = 0) -> Actor:
    return off_centre(one, np.random.default_rng(seed))


@given(st.sampled_from(sorted(DRIVES)), st.integers(0, 1_000))
def test_only_the_offset_changes_and_the_same_draw_gives_the_same(does: str, seed: int) -> None:
    one = actor(does)
    there = moved(one, seed)
    assert abs(there.placement.offset_m) <= OFF_CENTRE_M
    assert moved(one, seed) == there
    back = there.placement.model_copy(update={"offset_m": 0.0})
    assert there.model_copy(update={"placement": back}) == one


def test_offsets_lie_on_both_sides_and_hardly_ever_in_the_middle() -> None:
    found = [moved(actor("follow_lane"), seed).placement.offset_m for seed in range(200)]
    assert min(found) < -0.2
    assert max(found) > 0.2
    assert sum(abs(one) < 0.005 for one in found) < 10


@given(st.sampled_from(sorted(BUILT_IN)), st.sampled_from([-4.0, -0.35, 0.2, 1.5]))
def test_a_place_that_was_chosen_stays(does: str, offset: float) -> None:
    one = actor(does, offset)
    assert moved(one) == one


def test_what_does_not_drive_in_a_lane_or_belongs_to_another_stays() -> None:
    for does in STAYS:
        assert moved(actor(does)) == actor(does)
    ridden = actor("follow_lane", other="b")
    assert moved(ridden) == ridden


@given(st.sampled_from(sorted(BUILT_IN)))
def test_one_number_is_drawn_in_every_case(does: str) -> None:
    rng, other = np.random.default_rng(7), np.random.default_rng(7)
    off_centre(actor(does), rng)
    other.random()
    assert rng.random() == other.random()
