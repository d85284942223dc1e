"""Islands: the land within a ring of road is one unless it is as wide as countryside."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._land.islands import Islands

ROAD_M = 8.0
"""Width of the road."""


class Ring:
    """A square road around the origin, as wide inside as twice a distance, m."""

    def __init__(self, within: float) -> None:
        self.within = within

    def near(self, x: np.ndarray, y: np.ndarray) -> SimpleNamespace:
        out = np.maximum(np.abs(x), np.abs(y))
        return SimpleNamespace(
            asphalt=np.maximum(self.within - out, out - self.within - ROAD_M),
        )


def islands_within(within: float) -> Islands:
    corner = within + ROAD_M / 2
    corners = [(x, y) for x in (-corner, corner) for y in (-corner, corner)]
    return Islands.of(Ring(within), np.array(corners))


@given(
    st.integers(1, 75).filter(lambda within: within not in (4, 60)),
    st.floats(-0.9, 0.9),
    st.floats(-0.9, 0.9),
)
def test_enclosed_land_is_an_island_unless_it_is_countryside(within, x, y):
    islands = islands_within(within)
    inside, outside = (x * within, y * within), (within + ROAD_M + 3.0, y * within)
    assert islands.covers(np.array([inside, outside])).tolist() == [within < 60, False]
    assert len(islands.circles) == (3 < within < 60)


def test_the_circle_of_an_island_is_the_largest_that_its_land_holds():
    ((x, y, radius),) = islands_within(20.0).circles
    assert (x, y) == pytest.approx((0.0, 0.0), abs=0.5)
    assert radius == pytest.approx(20.0, abs=0.5)


@pytest.mark.parametrize("corners", [np.zeros((0, 2)), np.array([[0.0, 0.0], [400.0, 400.0]])])
def test_without_corners_or_with_too_much_land_between_them_there_are_no_islands(corners):
    islands = Islands.of(Ring(20.0), corners)
    assert islands.circles == ()
    assert not islands.covers(np.zeros((1, 2))).any()
