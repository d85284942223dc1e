from hypothesis import given
from hypothesis import strategies as st

from oodscen.driving._sight.outlines import area, clipped, hull

points = st.lists(st.tuples(st.floats(-900, 900), st.floats(-900, 900)), min_size=3, max_size=12)


@given(points)
def test_clipping_keeps_what_is_inside(outline):
    whole = hull(outline)
    shown = clipped(whole, 640, 480)
    assert area(shown) <= min(area(whole), 640 * 480) * (1 + 1e-9) + 1e-6
    assert all(-1e-6 <= u <= 640 + 1e-6 and -1e-6 <= v <= 480 + 1e-6 for u, v in shown)
