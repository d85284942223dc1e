"""Numbers as decimal text."""

from hypothesis import given
from hypothesis import strategies as st

from oodscen._words.decimals import exact, speed, tenths


@given(st.integers(-100_000, 100_000))
def test_steps_of_a_simulation_are_rounded_as_people_do(hundredths: int) -> None:
    size = (abs(hundredths) + 5) // 10
    sign = "-" if hundredths < 0 and size else ""
    assert tenths(hundredths / 100) == f"{sign}{size // 10}.{size % 10}"


@given(st.integers(0, 100_000))
def test_sums_of_steps_are_rounded_like_their_decimal_values(steps: int) -> None:
    assert tenths(steps * 0.05) == tenths(5 * steps / 100)


@given(st.floats(-1e9, 1e9))
def test_the_text_lies_within_half_a_tenth(value: float) -> None:
    assert abs(float(tenths(value)) - value) <= 0.05 + 1e-6


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_an_exact_number_is_read_back_and_has_no_empty_decimals(value: float) -> None:
    assert float(exact(value)) == value
    assert not exact(value).endswith(".0")


def test_huge_numbers_are_shown_all_the_same() -> None:
    assert tenths(1e28) == f"{1e28:.1f}"
    assert tenths(float("inf")) == "inf"


@given(st.floats(-0.1, 0.1))
def test_no_speed_is_minus_nothing(value: float) -> None:
    assert "-0 " not in speed(value)
