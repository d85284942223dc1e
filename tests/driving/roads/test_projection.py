"""Projections of points are where the road says that they are, beyond the centre of a bend as well."""

import numpy as np
import pytest

from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.projection import places
from oodscen.driving.maps._shipped import SHIPPED_MAPS


@pytest.mark.parametrize("road", SHIPPED_MAPS, ids=lambda road: road.id)
@pytest.mark.parametrize("reach_m", [15.0, 150.0])
def test_every_place_leads_back_to_its_point(road, reach_m):
    corridor = load_corridor(road)
    draws = np.random.Generator(np.random.PCG64(5))
    samples = draws.integers(0, len(corridor.x), 400)
    beside = draws.uniform(-reach_m, reach_m, 400)
    x = corridor.x[samples] - beside * corridor.sin[samples]
    y = corridor.y[samples] + beside * corridor.cos[samples]
    s, t, _, _ = places(corridor, x, y)
    leads_back(corridor, zip(s, t, strict=True), x, y)
    leads_back(corridor, map(corridor.locate, x, y), x, y)
    near = samples * corridor.step + draws.uniform(-60.0, 60.0, 400)
    leads_back(corridor, map(corridor.locate, x, y, near), x, y)


def leads_back(corridor, found, x, y):
    points = np.array([corridor.point(*place)[:2] for place in found])
    np.testing.assert_allclose(points, np.stack([x, y], axis=1), atol=0.01)
