"""Claims about single actors, each at the border of its test."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.claims._actors import judge_actor
from oodscen.claims._observation import ObservedActor
from oodscen.data._claim import VALUES, Claim
from tests.claims.observations import observed


def holds(kind: str, value: str, actor: ObservedActor, *others: Claim) -> bool | None:
    claim = Claim(kind=kind, value=value, subject="it")
    return judge_actor(claim, actor, (claim, *others))[0]


OFF = Claim(kind="state", value="off", subject="it")
CLAIMED = [("off",), ("hazard",), ("red",), ("red", "green"), ("all_on", "green")]

BORDERS: list[tuple[str, str, dict[str, Any], dict[str, Any]]] = [
    ("place", "ahead", {"ahead_m": (-5, 0.1)}, {"ahead_m": (-5, 0, 9)}),
    ("place", "behind", {"ahead_m": (5, -0.1)}, {"ahead_m": (5, 0, -9)}),
    ("place", "in_lane", {"lane_share": (0, 0, 0.3)}, {"lane_share": (0.29,)}),
    ("place", "clear_of_lane", {"aside_m": (-2.1, 2.1, 0)}, {"aside_m": (-2.1, 2.0)}),
    ("place", "left", {"aside_m": (0, 0.51)}, {"aside_m": (0, 0.5, 2)}),
    ("place", "right", {"aside_m": (0, -0.51)}, {"aside_m": (0, -0.5, -2)}),
    ("place", "left_lane", {"lane": (0, 1)}, {"lane": (0, np.nan, 1)}),
    ("place", "left_lane", {"share_of_left_lane": 0.5}, {"share_of_left_lane": 0.49}),
    ("place", "right_lane", {"lane": (0, -1)}, {"lane": (0, np.nan, -1)}),
    ("place", "right_lane", {"share_of_right_lane": 0.5}, {"share_of_left_lane": 0.9}),
    ("place", "oncoming_lane", {"lane": (0, 2)}, {"lane": (0, 1, 2)}),
    ("place", "oncoming_lane", {"share_of_oncoming_lane": 0.5}, {"share_of_left_lane": 0.9}),
    ("motion", "stationary", {"speed_mps": (0.49, 0.49, 9)}, {"speed_mps": (0, 0.5)}),
    ("motion", "moving", {"speed_mps": (0, 0, 0.31)}, {"speed_mps": (0.3,)}),
    ("motion", "slow", {"speed_mps": (0.1, 6.9, 9)}, {"speed_mps": (0.1, 7)}),
    ("motion", "slow", {"speed_mps": (0, 0, 0.31)}, {"speed_mps": (0.3,)}),
    ("motion", "slow", {"speed_mps": (0, 0, 6.9)}, {"speed_mps": (0, 0, 7)}),
    ("motion", "oncoming", {"along_mps": (0, 0, -0.31)}, {"along_mps": (-0.3, 9)}),
    ("motion", "same_way", {"along_mps": (0, 0, 0.31)}, {"along_mps": (0.3, -9)}),
    ("motion", "crossing", {"aside_m": (0.5, 0, -0.31)}, {"aside_m": (0.8, 0)}),
    ("motion", "from_left", {"aside_m": (0.51, 0.9, 0.2)}, {"aside_m": (0.5, 0)}),
    ("motion", "from_left", {"aside_m": (9, 8.69)}, {"aside_m": (9, 8.71)}),
    ("motion", "from_right", {"aside_m": (-0.51, -0.9, -0.2)}, {"aside_m": (-0.5, 0)}),
    ("motion", "from_right", {"aside_m": (-9, -8.69)}, {"aside_m": (-9, -8.71)}),
    ("motion", "into_lane", {"lane_share": (0.3, 0.41, 0)}, {"lane_share": (0.3, 0.39, 0)}),
    ("motion", "into_lane", {"lane_share": (0.3,), "is_carried": True}, {"lane_share": (0.3,)}),
    ("motion", "out_of_lane", {"lane_share": (0, 0.5, 0.39)}, {"lane_share": (0, 0.5, 0.41)}),
    ("motion", "reversing", {"forward_mps": (1, 1, -0.21)}, {"forward_mps": (1, -0.2)}),
    ("motion", "braking", {"speed_mps": (8, 5.9, 9)}, {"speed_mps": (8, 6.1, 9)}),
    ("motion", "braking", {"speed_mps": (1, 0.1)}, {"speed_mps": (1, 0.3)}),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "value", "within", "beyond"), BORDERS)
def test_a_claim_ends_at_its_border(kind, value, within, beyond):
    assert holds(kind, value, observed(**within)) is True
    assert holds(kind, value, observed(**beyond)) is False


def test_every_place_and_motion_has_a_border():
    tested = {(kind, value) for kind, value, *_ in BORDERS}
    assert tested == {(kind, value) for kind in ("place", "motion") for value in VALUES[kind]}


@pytest.mark.parametrize(("claimed", "low", "high"), [("20", 14.0, 26.0), ("100", 80.0, 120.0)])
def test_a_distance_is_to_the_middle_or_the_body_at_any_time_up_to_the_decision(claimed, low, high):
    for near in (low, high):
        assert holds("distance", claimed, observed(ahead_m=(500, near), gap_m=(500,)))
        assert holds("distance", claimed, observed(ahead_m=(500, -near), gap_m=(500,)))
        assert holds("distance", claimed, observed(ahead_m=(500,), gap_m=(500, near)))
        assert not holds("distance", claimed, observed(ahead_m=(500, 500, near), gap_m=(500,)))
    for far in (low - 0.1, high + 0.1):
        assert not holds("distance", claimed, observed(ahead_m=(far,), gap_m=(500,)))


@pytest.mark.parametrize(("claimed", "low", "high"), [("20", 15.0, 25.0), ("100", 80.0, 120.0)])
def test_a_speed_may_differ_by_five_kmh_or_a_fifth(claimed, low, high):
    for kmh in (low + 0.1, high - 0.1):
        assert holds("speed", claimed, observed(speed_mps=(0, 0, kmh / 3.6)))
    for kmh in (low - 0.1, high + 0.1):
        assert not holds("speed", claimed, observed(speed_mps=(kmh / 3.6,)))


def test_what_also_moves_is_stationary_only_at_first():
    actor = observed(speed_mps=(0, 2))
    crossing = Claim(kind="motion", value="crossing", subject="it")
    assert holds("motion", "stationary", actor) is False
    assert holds("motion", "stationary", actor, crossing) is True
    assert holds("motion", "stationary", observed(speed_mps=(2, 0)), crossing) is False


def test_what_walks_backwards_reverses_when_it_goes_forward():
    backwards = {"asset": "adult", "tags": ("backwards",)}
    assert holds("motion", "reversing", observed(forward_mps=(0.21,), **backwards)) is True
    assert holds("motion", "reversing", observed(forward_mps=(-9.0,), **backwards)) is False


@pytest.mark.parametrize("value", ["crossing", "from_left", "into_lane", "out_of_lane"])
def test_of_what_spreads_no_sideways_motion_is_decided(value):
    spreading = observed(tags=("obscured",), aside_m=(9, 0), lane_share=(0, 1, 0))
    assert holds("motion", value, spreading) is None


def test_a_vehicle_without_lights_stands_or_is_unlit():
    assert holds("state", "off", observed(state="unlit", speed_mps=(9,))) is True
    assert holds("state", "off", observed(state="off", speed_mps=(0.49,))) is True
    assert holds("state", "off", observed(state="off", speed_mps=(0, 0, 0.5))) is False
    assert holds("state", "off", observed(state="hazard")) is False


def test_a_moving_vehicle_is_told_why_its_lamps_are_on():
    for state in ("", "off"):
        holds, found = judge_actor(OFF, observed(state=state, speed_mps=(9,)), (OFF,))
        assert (holds, "it moves" in found) == (False, True)
    assert "it moves" not in judge_actor(OFF, observed(state="hazard", speed_mps=(9,)), (OFF,))[1]


@given(
    st.permutations(["off", "hazard", "unlit", "all_on", "red", "green"]), st.sampled_from(CLAIMED)
)
def test_a_state_left_out_is_the_first_one_for_every_claim(states, claimed):
    claims = [Claim(kind="state", value=value, subject="it") for value in claimed]
    for claim in claims:
        left_out, stated = (
            judge_actor(claim, observed(states=tuple(states), state=state), claims)
            for state in ("", states[0])
        )
        assert left_out == stated


def test_a_signal_of_several_colours_shows_all_of_them():
    red, green = (Claim(kind="state", value=value, subject="it") for value in ("red", "green"))
    for state, alone, together in (("red", True, False), ("all_on", False, True)):
        light = observed(states=("red", "green", "all_on"), state=state)
        assert judge_actor(red, light, (red,))[0] is alone
        assert judge_actor(red, light, (red, green))[0] is together
    light = observed(states=("red", "green"), state="red")
    assert judge_actor(red, light, (red, green))[0] is True


def test_a_state_that_the_asset_cannot_show_is_not_decided():
    assert holds("state", "closed", observed()) is None
    assert holds("state", "closed", observed(asset="cardboard_box")) is None


@given(st.lists(st.floats(-20, 20), min_size=1, max_size=4))
def test_left_and_right_mirror_each_other(aside):
    mirrored = [-value for value in aside]
    for left, right, kind in (("left", "right", "place"), ("from_left", "from_right", "motion")):
        assert holds(kind, left, observed(aside_m=aside)) == holds(
            kind, right, observed(aside_m=mirrored)
        )
