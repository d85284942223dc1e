import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.driving._motion.bodies import GRAVITY, MAX_DRIVE, MAX_STEERING
from oodscen.errors import UsageError
from oodscen.protocols import Control

pytest.importorskip("gymnasium")

from oodscen.gymnasium._acting import (
    as_action,
    as_control,
    read_continuous,
    read_discrete,
)

FINITE = st.floats(allow_nan=False, allow_infinity=False, width=32)


@given(FINITE, FINITE)
def test_a_control_of_an_action_is_within_the_limits_and_has_its_action(along, turn):
    control = as_control(np.array([along, turn]))
    assert -GRAVITY <= control.acceleration <= MAX_DRIVE
    assert abs(control.steering) <= MAX_STEERING
    assert as_action(control) == pytest.approx(np.clip([along, turn], -1.0, 1.0), abs=1e-6)


@given(FINITE, FINITE)
def test_an_action_of_any_control_is_in_the_space(acceleration, steering):
    action = as_action(Control(acceleration, steering))
    assert action.dtype == np.float32
    assert (np.abs(action) <= 1.0).all()


@given(FINITE, FINITE)
def test_two_finite_numbers_are_read_from_any_sequence(one, two):
    for action in ([one, two], (one, two), np.array([one, two], np.float32)):
        assert read_continuous(action, "x").tolist() == [one, two]


@pytest.mark.parametrize("action", [[10**400, 0], [10**5000, 0], [math.nan, 0.0], [True, False]])
def test_what_is_no_finite_pair_of_numbers_is_refused_in_one_line(action):
    with pytest.raises(UsageError, match=r"^policy\(\): an action must be") as caught:
        read_continuous(action, "policy()")
    assert len(str(caught.value)) < 200


@pytest.mark.parametrize("action", [10**400, -(10**5000), 7, 0.0], ids=["huge", "long", "7", "0.0"])
def test_a_number_without_an_action_is_refused_with_the_actions(action):
    with pytest.raises(UsageError, match="0 keep_speed, 1 slow_down"):
        read_discrete(action, "policy()")
