import math

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st

from oodscen.numerics._arrays import interpolated, rounded, sincos_all, sincos_each
from oodscen.numerics._exact import sincos

NUMBERS = st.one_of(
    st.floats(-1e6, 1e6),
    st.floats(),
    st.integers(-(10**8), 10**8).map(lambda n: (n + 0.5) / 1e6),
)


def bits(values: object) -> bytes:
    """Return the bytes of numbers, which tell zeros with different signs apart."""
    return np.array(values, np.float64).tobytes()


@given(st.lists(st.floats(-1e6, 1e6)))
def test_sines_and_cosines_have_the_bits_of_single_ones(angles: list[float]) -> None:
    sine, cosine = sincos_each(np.array(angles))
    single = [sincos(angle) for angle in angles]
    assert bits(sine) == bits([one[0] for one in single])
    assert bits(cosine) == bits([one[1] for one in single])


@given(st.lists(NUMBERS))
@example([0.5e-6, -0.5e-6, 1.0000005, 2.6750005, -1e-9, 1e300, 1e17])
def test_numbers_are_rounded_as_python_rounds_them(values: list[float]) -> None:
    assert bits(rounded(np.array(values))) == bits([round(value, 6) for value in values])


@given(st.lists(st.floats(-1e3, 1e3), min_size=2, unique=True), st.lists(st.floats(-2e3, 2e3)))
def test_interpolation_agrees_with_numpy(ends: list[float], values: list[float]) -> None:
    nodes = np.sort(ends)
    heights = np.sin(nodes)
    inside = np.clip(values, nodes[0], nodes[-1])
    np.testing.assert_allclose(
        interpolated(inside, nodes, heights), np.interp(inside, nodes, heights), atol=1e-6
    )


@given(st.floats(0.1, 10.0), st.floats(-5.0, 5.0), st.lists(st.floats(-50.0, 50.0)))
def test_the_first_and_the_last_line_go_on(span: float, slope: float, values: list[float]) -> None:
    nodes = np.array([0.0, 0.5 * span, span])
    at = np.array(values)
    np.testing.assert_allclose(interpolated(at, nodes, slope * nodes), slope * at, atol=1e-9)
    steps = interpolated(np.array([-1.0, span]), np.array([0.0, span, span]), np.array([0, 1, 2]))
    assert np.isfinite(steps).all()


@given(st.lists(st.floats(-500, 500), min_size=1))
def test_sines_and_cosines_of_an_array(angles: list[float]) -> None:
    sine, cosine = sincos_all(np.array(angles))
    np.testing.assert_allclose(sine, [math.sin(a) for a in angles], atol=1e-15)
    np.testing.assert_allclose(cosine, [math.cos(a) for a in angles], atol=1e-15)
