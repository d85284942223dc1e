from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.errors import UsageError
from oodscen.judging._leaderboard.power import distinct_percents, power_of, scenes_needed

RATES = st.tuples(st.floats(0.05, 0.95), st.floats(0.05, 0.95)).filter(
    lambda pair: abs(pair[0] - pair[1]) > 0.02
)

SHARES = st.integers(0, 10**9).map(lambda number: number / 10**9)


def test_how_many_scenes_tell_66_from_51() -> None:
    assert scenes_needed(0.66, 0.51, paired=False).scenes == 169
    assert scenes_needed(0.66, 0.51).scenes == 171
    clustered = scenes_needed(0.66, 0.51, per_path=10, icc=0.2)
    assert clustered.design_effect == pytest.approx(2.8)
    assert (clustered.paths, clustered.scenes) == (48, 480)
    assert "480 scenes = 48 paths of 10" in str(clustered)
    assert power_of(0.66, 0.51, 130) < 0.7


@given(RATES, st.booleans(), st.floats(0, 0.8), st.integers(1, 20), st.floats(0, 1))
def test_that_many_scenes_have_that_power_and_fewer_less(
    rates: tuple[float, float], paired: bool, agreement: float, per_path: int, icc: float
) -> None:
    how: dict[str, Any] = {
        "paired": paired, "agreement": agreement, "per_path": per_path, "icc": icc,
    }  # fmt: skip
    found = scenes_needed(*rates, **how)
    assert found.scenes % per_path == 0
    assert power_of(*rates, found.scenes, **how) >= 0.8 - 1e-6
    assert found.power_of(10) == pytest.approx(power_of(*rates, 10, **how), abs=1e-9)
    if found.paths > 1:
        assert power_of(*rates, found.scenes - per_path, **how) < 0.8 + 1e-6
    assert scenes_needed(*rates, **how, comparisons=5).scenes >= found.scenes
    assert scenes_needed(*rates, **{**how, "icc": 0.0}).scenes <= found.scenes


@given(RATES, st.floats(1e-6, 0.9), st.floats(1e-6, 0.9), st.booleans(), st.integers(1, 9))
def test_no_power_needs_more_scenes_than_a_greater_one(
    rates: tuple[float, float], power: float, alpha: float, paired: bool, per_path: int
) -> None:
    how: dict[str, Any] = {"alpha": alpha, "paired": paired, "per_path": per_path}
    found = scenes_needed(*rates, power=power, **how)
    assert found.power_of(found.scenes) >= power - 1e-5
    assert found.paths == 1 or found.power_of(found.scenes - per_path) < power + 1e-5
    assert found.scenes <= scenes_needed(*rates, power=0.95, **how).scenes


def test_the_power_of_any_number_that_is_needed_can_be_told() -> None:
    found = scenes_needed(0.66, 0.6601)
    assert found.scenes > 10**8
    assert found.power_of(found.scenes) == pytest.approx(0.8, abs=1e-3)


def test_a_single_scene_or_path_is_one_in_words() -> None:
    assert "  1 scene if all" in str(scenes_needed(0.5, 0.6, power=0.01))
    assert " = 1 path of 9 (" in str(scenes_needed(0.01, 0.99, per_path=9))


@given(RATES, st.integers(1, 30), st.integers(1, 30), st.floats(0, 1))
def test_a_path_has_no_more_scenes_than_there_are(
    rates: tuple[float, float], scenes: int, per_path: int, icc: float
) -> None:
    power = power_of(*rates, scenes, per_path=per_path, icc=icc)
    assert power == power_of(*rates, scenes, per_path=min(per_path, scenes), icc=icc)
    assert power <= power_of(*rates, scenes + 1, per_path=per_path, icc=icc) + 1e-12


def test_agreement_saves_scenes() -> None:
    sizes = [scenes_needed(0.66, 0.51, agreement=value).scenes for value in (0, 0.2, 0.4, 0.6)]
    assert sizes == sorted(sizes, reverse=True)


def test_power_is_what_simulation_says() -> None:
    rng = np.random.default_rng(0)
    first = rng.random((2000, 171)) < 0.66
    second = rng.random((2000, 171)) < 0.51
    split = (first & ~second).sum(axis=1), (~first & second).sum(axis=1)
    z = (split[0] - split[1]) / np.sqrt(split[0] + split[1])
    assert (np.abs(z) > 1.96).mean() == pytest.approx(0.8, abs=0.03)


@pytest.mark.parametrize(
    "wrong",
    [
        {"first": 0.0}, {"second": 1.0}, {"first": 0.5}, {"power": 1.0}, {"alpha": 0.0},
        {"agreement": 2.0}, {"icc": -0.1}, {"per_path": 0}, {"comparisons": 0},
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(UsageError):
        scenes_needed(**{"first": 0.7, "second": 0.5, **wrong})


def test_no_scene_has_no_power() -> None:
    with pytest.raises(UsageError):
        power_of(0.7, 0.5, 0)


@given(st.floats(0.05, 0.5), st.floats(0.55, 0.95), st.floats(-1, 1))
def test_answers_agree_no_more_than_their_rates_allow(first, second, agreement):
    least, asked, most = (
        scenes_needed(first, second, agreement=value) for value in (-1.0, agreement, 1.0)
    )
    between = np.clip(agreement, least.agreement, most.agreement)
    assert asked.agreement == pytest.approx(between, abs=1e-5)
    assert most.discordant == pytest.approx(second - first, abs=1e-5)


@given(SHARES, SHARES, st.integers(0, 2))
def test_different_shares_are_told_apart_in_words(first: float, second: float, digits: int) -> None:
    told = distinct_percents(first, second, digits=digits)
    assert (told[0] == told[1]) == (first == second)
    for share, said in zip((first, second), told, strict=True):
        value = float(said.removesuffix("%")) / 100
        assert (value in (0.0, 1.0)) == (share in (0.0, 1.0))
        assert abs(value - share) <= 0.0051
    assert distinct_percents(0.66, 0.51, digits=1) == ["66.0%", "51.0%"]
    assert distinct_percents(0.0001, 0.0002, digits=1) == ["0.01%", "0.02%"]
