"""Tunnels and bridges of a straight road along x."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oodscen_pybullet._land.ground import Ground
from oodscen_pybullet._meshes.atlas import swatch_uv
from oodscen_pybullet._scenery.structures import CEILING_M, build_structures

from oodscen.driving._roads.corridor import Corridor, LaneStrip, Structure

S = np.linspace(0.0, 600.0, 601)
FLAT = np.zeros(len(S))
ROAD = Corridor(
    s=S, x=S, y=FLAT, z=FLAT, cos=FLAT + 1.0, sin=FLAT, curvature=FLAT,
    strips=(LaneStrip("driving", 1, FLAT - 7.0, FLAT, "solid"),), start=60.0, speed_limit=14.0,
)  # fmt: skip


def built(*structures: Structure):
    return build_structures(Ground(replace(ROAD, structures=structures)))


@settings(max_examples=20)
@given(st.floats(1.0, 200.0))
def test_lamps_hang_in_pairs_below_the_ceiling_of_a_tunnel(length: float) -> None:
    (mesh,), lamps = built(Structure("tunnel", 100.0, 100.0 + length))
    assert len(lamps) == 2 * len(np.arange(3.0, length, 10.0))
    for x, y, z in lamps:
        assert 100.0 < x < 100.0 + length
        assert -7.0 < y < 0.0
        assert z == pytest.approx(CEILING_M - 0.1)
    assert np.isfinite(mesh.vertices).all()


@pytest.mark.parametrize("end", ["start", "end"])
def test_drivers_see_the_face_of_the_portal_before_them(end: str) -> None:
    tunnel = Structure("tunnel", 100.0, 200.0)
    (mesh,), _ = built(tunnel)
    place, outwards = getattr(tunnel, end), -1.0 if end == "start" else 1.0
    is_face = np.abs(mesh.vertices[:, 0] - place - 0.25 * outwards) < 1e-6
    is_dark = (mesh.uvs == swatch_uv("concrete_dark")).all(axis=1)
    assert (mesh.normals[is_face & is_dark, 0] * outwards > 0.99).all()
    low, high = (rows(mesh.vertices[is_face & is_dark], axis=0) for rows in (np.min, np.max))
    assert low[1] + high[1] == pytest.approx(-7.0)


@pytest.mark.parametrize(("length", "has_arch"), [(50.0, False), (60.0, True)])
def test_only_a_long_bridge_has_arches(length: float, has_arch: bool) -> None:
    (mesh,), lamps = built(Structure("bridge", 100.0, 100.0 + length))
    assert lamps == []
    assert bool((mesh.uvs == swatch_uv("steel")).all(axis=1).any()) == has_arch


@settings(max_examples=10)
@given(st.floats(0.0, 5.0))
def test_the_shortest_bridge_has_water_below(length: float) -> None:
    (mesh,), _ = built(Structure("bridge", 100.0, 100.0 + length))
    water = mesh.vertices[(mesh.uvs == swatch_uv("water")).all(axis=1)]
    assert np.allclose(water[:, 2], -5.5)
