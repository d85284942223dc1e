import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.numerics import _exact as exact
from oodscen.numerics._kernels import Kernel, seen

ANGLE = st.floats(-1e6, 1e6)
NUMBER = st.floats(-1e6, 1e6)
SHARE = st.floats(-1.0, 1.0)


def close(mine: float, theirs: float) -> bool:
    return abs(mine - theirs) <= 1e-12 * max(1.0, abs(theirs))


@given(ANGLE)
def test_sine_and_cosine(x: float) -> None:
    assert close(exact.sin(x), math.sin(x))
    assert close(exact.cos(x), math.cos(x))
    assert exact.sincos(x) == (exact.sin(x), exact.cos(x))


@given(st.floats(-1.5, 1.5))
def test_tangent(x: float) -> None:
    assert close(exact.tan(x), math.tan(x))


@given(NUMBER, NUMBER)
def test_angles_and_lengths_of_vectors(x: float, y: float) -> None:
    assert close(exact.hypot(x, y), math.hypot(x, y))
    angle = math.atan2(y, x)
    turned = exact.atan2(y, x)
    assert close(turned, angle) or (abs(y) < 1e-300 and close(abs(turned), abs(angle)))
    assert close(exact.atan(x), math.atan(x))


@given(SHARE)
def test_inverse_sine(x: float) -> None:
    assert abs(exact.asin(x) - math.asin(x)) < 1e-12


@given(st.floats(-690, 700))
def test_exponential(x: float) -> None:
    assert math.isclose(exact.exp(x), math.exp(x), rel_tol=1e-12)


@given(st.floats(1e-300, 1e300))
def test_logarithm(x: float) -> None:
    assert close(exact.log(x), math.log(x))


@given(st.floats(1e-3, 1e3), st.floats(-3, 3))
def test_powers(base: float, exponent: float) -> None:
    assert math.isclose(exact.power(base, exponent), base**exponent, rel_tol=1e-12)


@given(ANGLE)
def test_wrapped_angles_are_the_same_angles(x: float) -> None:
    angle = exact.wrapped(x)
    assert -math.pi <= angle <= math.pi
    turns = (x - angle) / math.tau
    assert abs(turns - round(turns)) < 1e-9


@given(NUMBER)
def test_rounding(x: float) -> None:
    assert abs(exact.quantised(x) - x) <= 0.5e-6 + 1e-9
    assert exact.quantised(exact.quantised(x)) == exact.quantised(x)
    assert math.copysign(1.0, exact.quantised(-0.0)) == 1.0


@pytest.mark.parametrize(
    ("function", "argument", "value"),
    [(exact.sin, 0.0, 0.0), (exact.cos, 0.0, 1.0), (exact.exp, 0.0, 1.0), (exact.log, 1.0, 0.0),
     (exact.asin, 1.0, exact.HALF_PI), (exact.exp, 710.0, math.inf),
     (exact.exp, -701.0, 0.0)],
)  # fmt: skip
def test_corners(function, argument: float, value: float) -> None:
    assert function(argument) == value


@Kernel
def everything(numbers, results) -> None:
    """Fill a row with every function's value."""
    for row in range(numbers.shape[0]):
        x, y = numbers[row, 0], numbers[row, 1]
        share = x / (1.0 + abs(x))
        results[row, 0] = exact.sin(x)
        results[row, 1] = exact.cos(x)
        results[row, 2] = exact.tan(x)
        results[row, 3] = exact.atan2(y, x)
        results[row, 4] = exact.asin(share)
        results[row, 5] = exact.exp(0.05 * x)
        results[row, 6] = exact.log(1e-9 + abs(y))
        results[row, 7] = exact.hypot(x, y)
        results[row, 8] = exact.wrapped(x)
        results[row, 9] = exact.quantised(y)
        results[row, 10] = exact.power(abs(x) + 0.1, share)


def test_compiled_and_plain_give_the_same_bits() -> None:
    pytest.importorskip("numba")
    rng = np.random.default_rng(5)
    numbers = rng.normal(0.0, 1.0, (3000, 2)) * 10.0 ** rng.uniform(-6, 4, (3000, 2))
    compiled, plain = np.zeros((3000, 11)), np.zeros((3000, 11))
    everything(numbers, compiled)
    everything.plain(memoryview(numbers), memoryview(plain))
    assert compiled.tobytes() == plain.tobytes()
    assert seen(numbers) is numbers
