import math
from dataclasses import FrozenInstanceError

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from oodscen.driving._roads.geometry import (
    Arc,
    Cubic,
    Curve,
    Line,
    ParamPoly3,
    Poly3,
    Spiral,
    piecewise,
    piecewise_all,
)

coordinate = st.floats(-1e3, 1e3)
heading = st.floats(-3, 3)
length = st.floats(1, 300)
bend = st.floats(-0.02, 0.02)
curves = st.one_of(
    st.builds(Line, st.just(0.0), coordinate, coordinate, heading, length),
    st.builds(Arc, st.just(0.0), coordinate, coordinate, heading, length, bend),
    st.builds(Spiral, st.just(0.0), coordinate, coordinate, heading, length, bend, bend),
)


@given(curves, st.floats(-0.05, 1.05))
def test_curves_are_measured_by_arc_length(curve: Curve, fraction: float) -> None:
    along = fraction * (curve.length - 0.01)
    a, b = curve.at(along), curve.at(along + 0.01)
    assert math.isclose(math.dist(a[:2], b[:2]), 0.01, rel_tol=1e-4)
    assert math.isclose(
        math.remainder(math.atan2(b.y - a.y, b.x - a.x) - a.heading, math.tau),
        0.005 * a.curvature,
        abs_tol=1e-4,
    )
    assert math.isclose(b.heading - a.heading, 0.01 * a.curvature, abs_tol=1e-5)


POLYNOMIALS = (
    Poly3(0.0, 1.0, 2.0, 0.3, 60.0, (0.0, 0.1, 0.003, -1e-5)),
    ParamPoly3(0.0, 1.0, 2.0, 0.3, 60.0, (0.0, 60.0, 1.0, -2.0), (0.0, 0.0, 9.0, -4.0), 1.0),
)


@given(curves | st.sampled_from(POLYNOMIALS), st.lists(st.floats(0, 1), min_size=1))
def test_many_points_have_the_bits_of_single_ones(curve: Curve, fractions: list[float]) -> None:
    along = np.array(fractions) * curve.length
    single = [curve.at(one) for one in along.tolist()]
    assert np.array(curve.at_all(along)).tobytes() == np.array(single).T.tobytes()


def test_every_part_of_a_long_spiral_has_the_bits_of_single_points() -> None:
    curve = Spiral(0.0, 1.0, 2.0, 0.3, 60.0, 0.001, 0.02)
    along = np.linspace(-20.0, 80.0, 200)
    single = [curve.at(one) for one in along.tolist()]
    assert np.array(curve.at_all(along)).tobytes() == np.array(single).T.tobytes()


@given(coordinate, coordinate, heading, length, bend, st.floats(0, 1))
def test_a_spiral_without_change_is_an_arc(x, y, angle, size, curvature, fraction) -> None:
    spiral = Spiral(0.0, x, y, angle, size, curvature, curvature)
    arc = Arc(0.0, x, y, angle, size, curvature)
    for a, b in zip(spiral.at(fraction * size), arc.at(fraction * size), strict=True):
        assert math.isclose(a, b, abs_tol=1e-6)


def test_a_spiral_agrees_with_the_fresnel_integrals() -> None:
    # C(1) and S(1) of the normalised Fresnel integrals (Abramowitz and Stegun, table 7.7).
    end = Spiral(0.0, 0.0, 0.0, 0.0, 1.0, 0.0, math.pi).at(1.0)
    assert math.isclose(end.x, 0.7798934, abs_tol=1e-7)
    assert math.isclose(end.y, 0.4382591, abs_tol=1e-7)


@pytest.mark.parametrize("size", [5.0, 40.0])
def test_straight_polynomials_are_lines(size: float) -> None:
    line = Line(0.0, 3.0, 4.0, 0.5, size)
    for other in (
        Poly3(0.0, 3.0, 4.0, 0.5, size, (0.0, 0.0, 0.0, 0.0)),
        ParamPoly3(0.0, 3.0, 4.0, 0.5, size, (0.0, size, 0.0, 0.0), (0.0,) * 4, 1.0),
        ParamPoly3(0.0, 3.0, 4.0, 0.5, size, (0.0, 1.0, 0.0, 0.0), (0.0,) * 4, size),
    ):
        for fraction in (0.0, 0.3, 1.0):
            expected = line.at(fraction * size)
            found = other.at(fraction * size)
            assert all(
                math.isclose(a, b, abs_tol=1e-9) for a, b in zip(found, expected, strict=True)
            )


polynomials = st.one_of(
    st.builds(
        lambda c, d: Poly3(0.0, 5.0, -3.0, 0.7, 60.0, (0.0, 0.0, c, d)),
        st.floats(-0.01, 0.01),
        st.floats(-1e-4, 1e-4),
    ),
    st.builds(
        lambda u, v, d: ParamPoly3(
            0.0, 5.0, -3.0, 0.7, 60.0, (0.0, 30.0, u, 0.0), (0.0, 0.0, v, d), 1.0
        ),
        st.floats(10, 60),
        st.floats(-30, 30),
        st.floats(-20, 20),
    ),
)


@given(polynomials, st.floats(0.02, 0.98))
def test_headings_and_curvatures_of_polynomials_are_derivatives(
    curve: Poly3 | ParamPoly3, fraction: float
) -> None:
    along, h = fraction * curve.length, 0.01
    before, here, after = (curve.at(along + shift) for shift in (-h, 0.0, h))
    way = math.dist(before[:2], after[:2])
    direction = math.atan2(after.y - before.y, after.x - before.x)
    assert math.remainder(direction - here.heading, math.tau) == pytest.approx(0.0, abs=1e-4)
    turned = math.remainder(after.heading - before.heading, math.tau)
    assert turned / way == pytest.approx(here.curvature, rel=0.02, abs=1e-4)


@example(
    32.0, 0.0, 0.0, 0.0078125
)  # The parameter runs ten times as fast at the end as at the start.
@given(st.floats(10, 60), st.floats(-30, 30), st.floats(-20, 20), st.floats(0.0, 1.0))
def test_a_parametric_cubic_is_measured_by_its_arc(
    u: float, v: float, d: float, fraction: float
) -> None:
    curve = ParamPoly3(0.0, 0.0, 0.0, 0.0, 8.0, (0.0, 3.0, u, 0.0), (0.0, 0.0, v, d), 1.0)
    p = np.linspace(0.0, 1.0, 20_001)
    points = np.stack([3.0 * p + u * p**2, v * p**2 + d * p**3])
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points)))])
    found = curve.at(fraction * 8.0)
    x, y = (np.interp(fraction * arc[-1], arc, axis) for axis in points)
    assert math.dist((found.x, found.y), (x, y)) < 1e-4
    assert curve.arc == pytest.approx(arc[-1], rel=1e-6)


@example(1e4, 0.5)
@given(st.floats(0.1, 1e4), st.floats(0, 1))
def test_the_scale_of_the_parameter_changes_no_point(scale: float, fraction: float) -> None:
    one, other = (
        ParamPoly3(0.0, 1.0, 2.0, 0.3, 60.0, *(
            tuple(k / end**power for power, k in enumerate(axis))
            for axis in ((0.0, 60.0, 1.0, -2.0), (0.0, 0.0, 9.0, -4.0))
        ), end).at(fraction * 60.0)
        for end in (1.0, scale)
    )  # fmt: skip
    assert one == pytest.approx(other, abs=1e-6)


@given(st.floats(-0.004, 0.004), st.floats(-2e-5, 2e-5), st.floats(0.01, 1.0))
def test_poly3_is_measured_by_arc_length(c: float, d: float, fraction: float) -> None:
    curve = Poly3(0.0, 0.0, 0.0, 0.0, 60.0, (0.0, 0.0, c, d))
    u = np.linspace(0.0, curve.at(fraction * 60.0).x, 20_001)
    arc = np.hypot(np.diff(u), np.diff(c * u**2 + d * u**3)).sum()
    assert arc == pytest.approx(fraction * 60.0, abs=1e-4)


@pytest.mark.parametrize("bend", [1.0, -1.0])
def test_a_tight_poly3_is_measured_from_its_first_step_to_its_last(bend: float) -> None:
    curve = Poly3(0.0, 0.0, 0.0, 0.0, 3.0, (0.0, 0.0, bend, 0.0))
    for along in np.linspace(0.0, 3.0, 61):
        u = curve.at(along).x
        arc = 0.5 * u * math.hypot(1.0, 2.0 * u) + 0.25 * math.asinh(2.0 * u)
        assert arc == pytest.approx(along, abs=0.01)


def test_a_poly3_too_steep_for_a_road_stays_within_one_step() -> None:
    steep, wall = (Poly3(0.0, 0.0, 0.0, 0.0, 3.0, (0.0, k, 0.0, 0.0)) for k in (999_999.0, 1e6))
    assert steep.at(3.0).x == pytest.approx(3.0 / 999_999.0)
    assert wall.at(3.0).x == pytest.approx(0.25 * 3.0 / 4.0)


@given(st.lists(st.floats(0, 100), min_size=1, max_size=5, unique=True), st.floats(0, 120))
def test_the_last_polynomial_that_began_holds(starts: list[float], s: float) -> None:
    pieces = tuple(Cubic(start, float(index)) for index, start in enumerate(sorted(starts), 1))
    expected = max((i for i, p in enumerate(pieces, 1) if p.start <= s + 1e-9), default=0.0)
    assert piecewise(pieces, s) == float(expected)


@given(
    st.lists(st.builds(Cubic, *[st.floats(-10, 10)] * 5), max_size=4),
    st.lists(st.floats(-20, 20)),
)
def test_many_values_of_polynomials_are_the_single_ones(
    pieces: list[Cubic], s: list[float]
) -> None:
    known = tuple(sorted(pieces, key=lambda piece: piece.start))
    assert piecewise_all(known, np.array(s)).tolist() == [piecewise(known, one) for one in s]


NUMBERS = st.floats(-10, 10)


@given(NUMBERS, NUMBERS, NUMBERS, NUMBERS, NUMBERS, NUMBERS)
def test_a_cubic_is_a_polynomial_of_the_way_from_its_start(start, a, b, c, d, s):
    expected = np.polyval([d, c, b, a], s - start)
    assert Cubic(start, a, b, c, d).at(s) == pytest.approx(expected, abs=1e-9)
    assert Cubic(start, a).at(s) == a
    assert piecewise((Cubic(start, a, b, c, d),), start - 1.0) == 0.0
    assert piecewise((Cubic(start, a, b, c, d),), start + 5.0) == pytest.approx(
        np.polyval([d, c, b, a], 5.0)
    )


@given(coordinate, coordinate, heading, length, st.floats(0, 1))
def test_an_arc_without_a_bend_is_a_line(x, y, angle, size, fraction):
    line, arc = Line(0.0, x, y, angle, size), Arc(0.0, x, y, angle, size, 0.0)
    assert arc.at(fraction * size) == line.at(fraction * size)


@pytest.mark.parametrize(("start", "end"), [(0.0, 0.5), (-0.3, 0.4), (0.5, 0.0), (0.01, -0.6)])
def test_a_tight_spiral_is_the_integral_of_its_heading(start, end):
    curve = Spiral(0.0, 1.0, 2.0, 0.3, 100.0, start, end)
    s = np.linspace(0.0, 100.0, 200_001)
    middle = 0.5 * (s[1:] + s[:-1])
    turn = 0.3 + start * middle + (end - start) / 200.0 * middle**2
    for index in (20_000, 90_000, 200_000):
        x = 1.0 + np.cos(turn[:index]).sum() * 5e-4
        y = 2.0 + np.sin(turn[:index]).sum() * 5e-4
        found = curve.at(s[index])
        assert (found.x, found.y) == pytest.approx((x, y), abs=1e-6)


def test_a_curve_that_goes_nowhere_turns_with_its_parameter():
    curve = ParamPoly3(0.0, 3.0, 4.0, 0.0, 5.0, (0.0,) * 4, (0.0, 0.0, 1e-12, 0.0), 2.0)
    assert [curve._parameter(part * 5.0) for part in (0.0, 0.5, 1.0)] == [0.0, 1.0, 2.0]
    assert curve.at(2.5).curvature == 0.0


def inflected(scale):
    """Return a cubic of 5,000 m along x that rests in the middle, where it goes as `(p - middle)^3`."""
    a, h = 2_500.0, 0.5 * scale
    return ParamPoly3(
        0.0, 0.0, 0.0, 0.0, 5_000.0, (-a, 3 * a / h, -3 * a / h**2, a / h**3), (0.0,) * 4, scale
    )


@pytest.mark.parametrize("scale", [0.1, 1.0, 10.0])
@pytest.mark.parametrize(("parts", "is_resting"), [(0, True), (2, False), (5, False)])
def test_the_parameter_is_shared_out_evenly_where_a_curve_rests(scale, parts, is_resting):
    curve = inflected(scale)
    begin, end = 2 * parts / 5_000, 2 * (parts + 1) / 5_000
    for share in (0.25, 0.5, 0.75):
        cubed = begin**3 + share * (end**3 - begin**3)
        expected = begin + share * (end - begin) if is_resting else cubed ** (1 / 3)
        found = curve._parameter(2_500.0 * (1.0 + cubed))
        assert found / (0.5 * scale) - 1.0 == pytest.approx(expected, abs=2e-6)


def test_a_curve_whose_length_is_no_number_still_has_places():
    curve = ParamPoly3(0.0, 0.0, 0.0, 0.0, 8.0, (0.0, 1e200, 0.0, 0.0), (0.0,) * 4, 1.0)
    assert curve.arc == math.inf
    assert np.isfinite(curve.at_all(np.linspace(0.0, 8.0, 9)[1:])).all()


@pytest.mark.parametrize(("size", "parts"), [(2.0, 8), (8.5, 9), (60.0, 60), (6_000.0, 5_000)])
def test_a_parametric_cubic_is_integrated_in_a_part_per_metre_within_bounds(size, parts):
    curve = ParamPoly3(0.0, 0.0, 0.0, 0.0, size, (0.0, size, 0.0, 0.0), (0.0,) * 4, 1.0)
    assert len(curve._nodes) - 1 == parts


@pytest.mark.parametrize(
    ("size", "bend", "parts"), [(2.0, 0.0, 1), (100.0, 0.0, 10), (99.0, 0.25, 109)]
)
def test_a_spiral_is_integrated_in_more_parts_the_longer_and_tighter_it_is(size, bend, parts):
    for ends in ((bend, 0.0), (0.0, -bend)):
        assert len(Spiral(0.0, 0.0, 0.0, 0.0, size, *ends)._nodes) - 1 == parts


@pytest.mark.parametrize(
    ("size", "slope", "parts"), [(0.1, 0.0, 1), (5.0, 0.0, 20), (5.0, 0.75, 16), (2e4, 0.0, 40_000)]
)
def test_a_cubic_over_its_axis_is_measured_in_steps_along_it(size, slope, parts):
    curve = Poly3(0.0, 0.0, 0.0, 0.0, size, (0.0, slope, 0.0, 0.0))
    assert len(curve._nodes) - 1 == parts


@pytest.mark.parametrize(
    "curve",
    [
        Cubic(0.0, 1.0),
        Line(0.0, 1.0, 2.0, 0.0, 5.0),
        Spiral(0.0, 1.0, 2.0, 0.0, 5.0, 0.0, 0.1),
        Poly3(0.0, 1.0, 2.0, 0.0, 5.0, (0.0,) * 4),
        ParamPoly3(0.0, 1.0, 2.0, 0.0, 5.0, (0.0, 1.0, 0.0, 0.0), (0.0,) * 4, 5.0),
    ],
)
def test_a_curve_is_a_value_that_shows_what_it_was_made_of(curve):
    assert "_nodes" not in repr(curve)
    with pytest.raises(FrozenInstanceError):
        curve.x = 0.0
