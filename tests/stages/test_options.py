"""Options: one frozen value, or single names; what does not exist is refused with its name."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen import Describer, RedTeamer
from oodscen.errors import UsageError
from oodscen.stages._options import DescribeOptions, RedTeamOptions
from oodscen.testing import ScriptedLLM

LLM = ScriptedLLM(lambda request: {})


@given(st.integers(0, 9), st.booleans(), st.integers(1, 9))
def test_names_and_one_value_say_the_same(iterations, closed_loop, in_flight):
    named = {"iterations": iterations, "closed_loop": closed_loop, "in_flight": in_flight}
    options = RedTeamOptions(**named)
    assert RedTeamer(LLM, **named).options == RedTeamer(LLM, options=options).options == options
    assert RedTeamer(LLM, options=options, patience=3).options == options.model_copy(
        update={"patience": 3}
    )


def test_what_is_left_out_has_its_default():
    assert RedTeamer(LLM).options == RedTeamOptions()
    assert Describer(LLM).options == DescribeOptions()
    assert DescribeOptions(band=(-math.inf, 0.5)).band == (-math.inf, 0.5)


@pytest.mark.parametrize("maker", [RedTeamer, Describer])
def test_an_option_that_does_not_exist_is_named(maker):
    with pytest.raises(UsageError, match="nearst"):
        maker(LLM, nearst=0.5)


@pytest.mark.parametrize(
    ("maker", "name", "value"),
    [
        (RedTeamer, "iterations", -1),
        (RedTeamer, "patience", 0),
        (RedTeamer, "coverage", 1.0),
        (RedTeamer, "in_flight", 0),
        (RedTeamer, "in_flight", 10**12),
        (RedTeamer, "iterations", True),
        (RedTeamer, "nearest", True),
        (RedTeamer, "tokens", 0),
        (RedTeamer, "broadenings", -1),
        (RedTeamer, "nearest", 62),
        (RedTeamer, "nearest_label", -3),
        (RedTeamer, "rarity", (1e6, 1e5)),
        (RedTeamer, "rarity", (0.0, 1e5)),
        (RedTeamer, "rarity", (True, 1e5)),
        (Describer, "batch", 0),
        (Describer, "per_path", 0),
        (Describer, "per_path", 10**12),
        (Describer, "threads", 10**30),
        (Describer, "sample", -1),
        (Describer, "sample", 2**63),
        (Describer, "batch", True),
        (Describer, "nearest", 93),
        (Describer, "band", (0.9, 0.1)),
        (Describer, "band", (0.5, math.nan)),
        (Describer, "band", [False, 0.5]),
    ],
)
def test_a_value_that_is_not_allowed_is_refused_with_its_name(maker, name, value):
    with pytest.raises(UsageError, match=name):
        maker(LLM, **{name: value})
