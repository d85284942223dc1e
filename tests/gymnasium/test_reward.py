import json
from dataclasses import fields

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.driving._motion.bodies import GRAVITY
from oodscen.errors import UnknownComponent, UsageError
from oodscen.gymnasium._reward import CRITICAL_TTC_S, Reward

STEP = {
    "progress": 0.5,
    "offset_m": 0.0,
    "deceleration": 0.0,
    "ttc_s": 9.0,
    "collision": False,
    "off_road": False,
}


@given(st.floats(0.01, 10.0), st.floats(-5.0, 5.0), st.floats(-20.0, 20.0))
def test_every_weight_has_a_term_that_is_proportional_to_it(seconds, weight, deceleration):
    names = [field.name for field in fields(Reward)]
    step = {
        "progress": 0.7,
        "offset_m": -1.5,
        "deceleration": deceleration,
        "ttc_s": 0.0,
        "collision": True,
        "off_road": True,
    }
    unit = Reward(**dict.fromkeys(names, 1.0)).terms(seconds, **step)
    scaled = Reward(**dict.fromkeys(names, weight)).terms(seconds, **step)
    assert list(unit) == names
    assert scaled == pytest.approx({name: weight * term for name, term in unit.items()})
    braking = max(0.0, deceleration) / GRAVITY
    assert unit == pytest.approx(
        {
            "progress": 0.7 * seconds,
            "offset": 1.5 * seconds,
            "braking": braking * braking * seconds,
            "critical": seconds,
            "collision": 1.0,
            "off_road": 1.0,
        }
    )


def test_faster_than_at_first_earns_no_more_and_backwards_costs():
    progress = [
        Reward().terms(1.0, **{**STEP, "progress": share})["progress"] for share in (1.0, 3.0, -0.5)
    ]
    assert progress == [1.0, 1.0, -0.5]


def test_a_time_to_collision_at_the_limit_is_not_critical():
    for ttc_s, term in ((CRITICAL_TTC_S, 0.0), (CRITICAL_TTC_S - 1e-9, -1.0)):
        assert Reward().terms(1.0, **{**STEP, "ttc_s": ttc_s})["critical"] == term


def test_weights_that_do_not_exist_or_are_no_numbers_are_refused():
    assert Reward.of({"offset": 0.0}) == Reward(offset=0.0)
    with pytest.raises(UnknownComponent, match="speed"):
        Reward.of({"offset": 0.0, "speed": 1.0})
    with pytest.raises(UsageError, match="offset"):
        Reward.of({"offset": "much"})


def test_weights_of_numpy_become_numbers_of_python():
    reward = Reward.of({"collision": np.float32(-20), "progress": 2})
    terms = reward.terms(
        0.1, progress=1, offset_m=0, deceleration=0, ttc_s=9, collision=True, off_road=False
    )
    assert {type(term) for term in terms.values()} == {float}
    assert json.loads(json.dumps(terms)) == terms
