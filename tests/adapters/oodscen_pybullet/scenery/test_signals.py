"""Signals of a map, and their faults."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._land.ground import Ground
from oodscen_pybullet._land.terrain import Terrain
from oodscen_pybullet._land.theme import theme_of
from oodscen_pybullet._meshes import asset_mesh
from oodscen_pybullet._scenery.placing import Site
from oodscen_pybullet._scenery.roadside import Scenery, build_scenery
from oodscen_pybullet._scenery.signals import displace, stand_signals

from oodscen.data._map_state import MapState
from oodscen.driving._roads.building import load_corridor
from oodscen.driving.maps._shipped import SHIPPED_MAPS

JUNCTION = next(road for road in SHIPPED_MAPS if road.id == "urban_junction")
SIGN = asset_mesh("stop_sign")


@cache
def built(fault: str, *, is_dark_phase: bool = False) -> Scenery:
    """Return the scenery of a junction with a fault of its lights."""
    state = MapState.model_validate({"signals": fault}) if fault else None
    corridor = load_corridor(JUNCTION)
    return build_scenery(corridor, JUNCTION, 0, state=state, is_dark_phase=is_dark_phase)


def signal_lamps(scenery: Scenery) -> int:
    return sum(not lamp.is_street for lamp in scenery.lamps)


@given(st.floats(-math.pi, math.pi))
def test_a_turned_sign_faces_a_quarter_to_the_left(yaw: float) -> None:
    heading = (math.cos(yaw), math.sin(yaw))
    mesh, turned = displace(SIGN, heading, "turned")
    assert mesh is SIGN
    assert turned == pytest.approx((math.cos(yaw + math.pi / 2), math.sin(yaw + math.pi / 2)))


def test_a_bent_sign_is_lower_and_otherwise_the_same() -> None:
    mesh, heading = displace(SIGN, (1.0, 0.0), "bent")
    assert heading == (1.0, 0.0)
    assert mesh.bounds[1][2] < SIGN.bounds[1][2] - 0.3
    lengths = [np.sqrt((one.vertices**2).sum(axis=1)) for one in (mesh, SIGN)]
    assert np.allclose(lengths[0], lengths[1], rtol=1e-3)
    assert displace(SIGN, (1.0, 0.0), None) == (SIGN, (1.0, 0.0))


def test_faulty_lights_shine_as_their_fault_says() -> None:
    whole = signal_lamps(built(""))
    assert signal_lamps(built("off")) == signal_lamps(built("missing")) == 0
    assert signal_lamps(built("flashing")) == whole
    assert signal_lamps(built("flashing", is_dark_phase=True)) == 0
    assert signal_lamps(built("all_on")) == 3 * whole


def test_missing_lights_have_no_posts_either() -> None:
    counts = [len(built(fault).meshes[2].triangles) for fault in ("off", "missing")]
    assert counts[0] > counts[1]


@pytest.mark.parametrize("fault", ["", "bent", "turned"])
@pytest.mark.parametrize(
    "more", [{}, {"kind": "sign", "type": "206"}, {"kind": "sign", "type": "274", "value": "50"}]
)
def test_a_signal_over_a_lane_hangs_at_its_height(more, fault: str) -> None:
    corridor = load_corridor(JUNCTION)
    s = corridor.start + 40.0
    x, y, z, *_ = corridor.point(s, 0.0)
    over = replace(corridor.signals[0], x=x, y=y, z=z, s=s, t=0.0, height=5.0, **more)
    state = MapState.model_validate({"signs" if more else "signals": fault}) if fault else None
    ground, rng = Ground(replace(corridor, signals=(over,))), np.random.default_rng(0)
    site = Site(ground, Terrain(ground, theme_of(JUNCTION, corridor), rng), rng, state)
    lamps = stand_signals(site, frozenset(), is_dark_phase=False)
    corners = site.mesh().vertices
    is_near = np.hypot(corners[:, 0] - x, corners[:, 1] - y) < 1.5
    lifts = corners[is_near, 2] - z
    assert lifts.min() == pytest.approx(5.0, abs=0.3)
    assert lifts.max() < 7.0
    assert all(lamp.position[2] > z + 5.0 for lamp in lamps)
