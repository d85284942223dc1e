"""States and observations from outside are refused by the method's name if they are not what they promise."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from oodscen.driving._states import check_observation, own_state
from oodscen.errors import SimulatorError
from oodscen.testing import example_scene
from oodscen.testing._flat import FlatSimulator

SCENE = example_scene()
IDS = ("ego", *(actor.id for actor in SCENE.actors))


@pytest.fixture(scope="module")
def good():
    with FlatSimulator() as simulator:
        return simulator.reset(SCENE, 0)


def test_a_good_state_is_copied(good) -> None:
    mine = own_state(good, IDS, "engine: step()")
    assert mine.fingerprint() == good.fingerprint()
    assert (mine.step, mine.time, mine.ids) == (good.step, good.time, good.ids)
    for name in ("poses", "speeds", "gaps", "accelerations", "places"):
        assert not np.shares_memory(getattr(mine, name), getattr(good, name))


BAD_STATES = {
    "nothing": lambda one: None,
    "NaN gaps": lambda one: replace(one, gaps=one.gaps * np.nan),
    "NaN poses": lambda one: replace(one, poses=one.poses * np.nan),
    "infinite speeds": lambda one: replace(one, speeds=one.speeds + np.inf),
    "infinite places": lambda one: replace(one, places=one.places + np.inf),
    "a list": lambda one: replace(one, poses=one.poses.tolist()),
    "words": lambda one: replace(one, poses=one.poses.astype(str)),
    "too few": lambda one: replace(one, gaps=one.gaps[:0]),
    "flat": lambda one: replace(one, poses=one.poses.ravel()),
    "other order": lambda one: replace(one, ids=one.ids[::-1]),
    "a ghost": lambda one: replace(one, ids=(*one.ids, "ghost")),
    "off nothing": lambda one: replace(one, off_road=None),
    "off a word": lambda one: replace(one, off_road="no"),
    "a time in words": lambda one: replace(one, time="1"),
    "no time": lambda one: replace(one, time=float("nan")),
    "a time beyond all floats": lambda one: replace(one, time=10**400),
    "a step of a half": lambda one: replace(one, step=0.5),
    "a step that is true": lambda one: replace(one, step=True),
    "a time that is true": lambda one: replace(one, time=True),
    "a time before the start": lambda one: replace(one, time=-0.05),
    "an endless time": lambda one: replace(one, time=math.inf),
    "ids in an array": lambda one: replace(one, ids=np.array(one.ids)),
    "ids in a list": lambda one: replace(one, ids=list(one.ids)),
    "negative gaps": lambda one: replace(
        one, gaps=np.array([np.inf, *(-3.0 for _ in one.gaps[1:])])
    ),
    "gaps of minus infinity": lambda one: replace(one, gaps=np.full(len(one.ids), -np.inf)),
    "a gap of the ego to itself": lambda one: replace(one, gaps=np.array([0.0, *one.gaps[1:]])),
    "poses beyond all doubles": lambda one: replace(
        one, poses=one.poses.astype(np.longdouble) + np.longdouble("1e400")
    ),
}


@pytest.mark.parametrize("fault", BAD_STATES)
def test_another_state_is_refused_by_the_method_s_name(good, fault: str) -> None:
    with pytest.raises(SimulatorError, match=r"^engine: step\(\) returned "):
        own_state(BAD_STATES[fault](good), IDS, "engine: step()")


def test_the_message_says_what_is_wrong_with_gaps(good) -> None:
    for fault, said in (
        ("NaN gaps", "not numbers from 0 to infinity"),
        ("negative gaps", "not numbers from 0 to infinity"),
        ("a gap of the ego to itself", "first is 0, not infinity"),
    ):
        with pytest.raises(SimulatorError, match=said):
            own_state(BAD_STATES[fault](good), IDS, "engine: step()")


@given(arrays(np.float64, len(IDS) - 1, elements=st.floats(0.0)))
def test_gaps_from_contact_to_infinity_are_copied(good, gaps) -> None:
    gaps = np.array([np.inf, *gaps])
    assert (own_state(replace(good, gaps=gaps), IDS, "engine: step()").gaps == gaps).all()


@pytest.mark.parametrize(
    "value", [np.nan, None, "3", 1j, 10**400, True, -np.inf, Fraction(10) ** 400]
)
def test_an_observation_without_numbers_is_refused(value) -> None:
    with FlatSimulator() as simulator:
        simulator.reset(SCENE, 0)
        seen = simulator.observe()
    check_observation(replace(seen, speed=np.float32(3.0), friction=Fraction(1, 2)), "engine")
    for name in ("speed", "friction", "curve_speed"):
        with pytest.raises(SimulatorError, match=rf"^engine returned {name}: "):
            check_observation(replace(seen, **{name: value}), "engine")


def test_only_what_nothing_limits_is_infinite() -> None:
    with FlatSimulator() as simulator:
        simulator.reset(SCENE, 0)
        seen = simulator.observe()
    check_observation(replace(seen, curve_speed=np.inf, visual_range_m=np.inf), "engine")
    for name in ("time", "speed", "friction", "lane_left_m"):
        with pytest.raises(SimulatorError, match=rf"^engine returned {name}: inf, not a finite"):
            check_observation(replace(seen, **{name: np.inf}), "engine")
