"""The surface of the ground: what lies at a place is found from the triangle above it."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from oodscen_pybullet._land.ground import Ground
from oodscen_pybullet._land.terrain import Terrain
from oodscen_pybullet._land.theme import Theme
from oodscen_pybullet._meshes.atlas import COLOURS, REGIONS, region_uv, swatch_uv

from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor, LaneStrip, Structure
from oodscen.driving.maps._shipped import SHIPPED_MAPS

WIDTH = 7.0
"""Width of the road, m."""
LENGTH = 400.0
"""Length of the road, m; it lies along x from 0, with y = 0 as its left edge."""
OFF = math.pi / 1000.0
"""Added to coordinates, since a place on the edge of a triangle is in none, m."""
CROPS = {"field", "grass", "grass_dark", "earth"}


def straight(edge: str, structures: tuple[Structure, ...] = ()) -> Corridor:
    s = np.linspace(0.0, LENGTH, 801)
    flat = np.zeros_like(s)
    return Corridor(
        s=s,
        x=s,
        y=flat,
        z=flat,
        cos=flat + 1.0,
        sin=flat,
        curvature=flat,
        strips=(LaneStrip("driving", 1, flat - WIDTH, flat, edge, right_mark=edge),),
        start=60.0,
        speed_limit=13.9,
        structures=structures,
    )


class Probe:
    """The ground of a map, asked for its triangles at a place."""

    def __init__(self, corridor: Corridor, theme: Theme) -> None:
        self.ground = Ground(corridor)
        self.terrain = Terrain(self.ground, theme, np.random.default_rng(0))
        mesh = self.terrain.mesh()
        faces = mesh.vertices[mesh.triangles]
        is_level = mesh.normals[mesh.triangles[:, 0], 2] > 0.1
        self.faces, self.upright = faces[is_level], faces[~is_level]
        self.uvs = mesh.uvs[mesh.triangles][is_level].mean(axis=1)

    def at(self, x: float, y: float) -> list[tuple[str, float]]:
        """Return the surface and height of every triangle at a place."""
        a = self.faces[:, :, :2] - (x, y)
        b = np.roll(a, -1, axis=1)
        inside = (a[..., 0] * b[..., 1] > a[..., 1] * b[..., 0]).all(axis=1)
        rows = np.flatnonzero(inside)
        return [(surface(self.uvs[row]), float(self.faces[row, :, 2].mean())) for row in rows]

    def surfaces(self, x: float, y: float) -> list[str]:
        return [name for name, _ in self.at(x, y)]


def surface(uv: np.ndarray) -> str:
    """Return the region or colour of the atlas at a coordinate."""
    for name in REGIONS:
        low, _, high, _ = region_uv(name)
        if ((low <= uv) & (uv <= high)).all():
            return name
    return next(name for name in COLOURS if np.allclose(swatch_uv(name), uv))


@cache
def probe(theme: Theme, edge: str, *structures: Structure) -> Probe:
    return Probe(straight(edge, structures), theme)


PLACES: dict[Theme, dict[float, set[str]]] = {
    "residential": {8.0: {"turf"}, 30.0: {"grass"}, 150.0: {"hill"}},
    "urban": {2.0: {"paving"}, 30.0: {"concrete_dark"}, 150.0: {"hill"}},
    "highway": {8.0: {"turf"}, 50.0: CROPS, 150.0: {"hill"}},
    "rural": {5.0: {"turf"}, 50.0: CROPS, 150.0: {"hill"}},
}
"""Surfaces by the distance from the road, m."""
ALONG = [float(x) + OFF for x in range(100, 300, 14)]


@pytest.mark.parametrize("edge", ["curb", "solid"])
@pytest.mark.parametrize("theme", PLACES)
def test_land_changes_with_the_distance_from_the_road(theme, edge):
    ground = probe(theme, edge)
    for away, expected in PLACES[theme].items():
        found = {one for x in ALONG for one in ground.surfaces(x, away + OFF)}
        assert found <= expected
        assert len(found) > 1 or expected != CROPS


@settings(max_examples=60)
@given(st.integers(0, int(LENGTH)), st.integers(-200, 200), st.sampled_from([*PLACES]))
def test_every_place_beside_the_road_has_one_surface_and_the_road_has_none(x, y, theme):
    assume(y not in (-WIDTH, 0))
    is_road = -WIDTH < y < 0
    assert len(probe(theme, "curb").surfaces(x + OFF, y + math.e * OFF)) == (not is_road)


def test_a_kerb_rises_between_the_road_and_the_land():
    kerbed, plain = probe("urban", "curb"), probe("urban", "solid")
    assert kerbed.surfaces(200.0 + OFF, 0.1) == ["kerb"]
    assert plain.surfaces(200.0 + OFF, 0.1) == ["paving"]
    assert not len(plain.upright)
    for y in (-WIDTH, 0.0):
        sides = kerbed.upright[(np.abs(kerbed.upright[:, :, 1] - y) < 0.01).all(axis=1)]
        assert (sides[:, :, 2].min(), sides[:, :, 2].max()) == pytest.approx((-0.03, 0.1))
        assert np.ptp(sides[:, :, 0]) >= LENGTH


def test_there_is_no_ground_below_the_ends_of_a_bridge():
    bridge = probe("rural", "solid", Structure("bridge", 150.0, 250.0))
    for x in (151.0, 155.0, 159.0, 241.0, 245.0, 249.0):
        assert not bridge.at(x + OFF, -WIDTH / 2)
        assert len(bridge.at(x + OFF, 5.0 + OFF)) == 1
    for x in (161.0, 200.0, 239.0):
        ((surface, z),) = bridge.at(x + OFF, -WIDTH / 2)
        assert surface in CROPS
        assert z < -4.0


def test_the_ground_covers_a_tunnel():
    tunnel = probe("rural", "solid", Structure("tunnel", 150.0, 250.0))
    for x in (151.0, 200.0, 249.0):
        ((_, z),) = tunnel.at(x + OFF, -WIDTH / 2)
        assert z > 5.0
    assert not tunnel.at(149.0, -WIDTH / 2)
    assert not tunnel.at(251.0, -WIDTH / 2)


@given(st.floats(10.0, 200.0), st.integers(1, 399), st.integers(-100, 100))
def test_the_land_is_as_high_at_a_tunnel_wherever_the_next_one_is(gap, x, y):
    first, second = Structure("tunnel", 100.0, 150.0), Structure("tunnel", 150.0 + gap, 380.0)
    both, *each = (
        Terrain(Ground(straight("solid", some)), "rural", np.random.default_rng(0)).height(x, y)
        for some in ((first, second), (first,), (second,))
    )
    assert both == max(each)


def test_an_island_is_turf_within_a_paved_rim():
    road = next(road for road in SHIPPED_MAPS if road.id == "roundabout")
    island = Probe(load_corridor(road), "urban")
    ((x, y, radius),) = island.terrain.islands.circles
    for turn in np.arange(0.0, math.tau, 0.5):
        away = np.arange(OFF, radius, 0.4)
        xs, ys = x + away * math.cos(turn), y + away * math.sin(turn)
        for px, py, gap in zip(xs, ys, island.ground.asphalt(xs, ys), strict=True):
            if gap > 0.3 and abs(gap - 1.6) > 0.2:
                assert island.surfaces(px, py) == ["paving" if gap < 1.6 else "turf"]


def test_the_ground_beside_a_junction_is_paved():
    road = straight("curb")
    is_inside = np.abs(road.s - 200.0) < 20.0
    ground = Probe(replace(road, in_junction=is_inside), "residential")
    for x in (190.0, 200.0, 210.0):
        for away in (0.5, 1.5, 2.0):
            assert ground.surfaces(x + OFF, -WIDTH - away - OFF) == ["paving"]
            assert ground.surfaces(x + OFF, away + OFF) == ["paving"]
        assert ground.surfaces(x + OFF, -WIDTH - 3.5) == ["turf"]
    assert ground.surfaces(250.0 + OFF, -WIDTH - 1.5) == ["turf"]
