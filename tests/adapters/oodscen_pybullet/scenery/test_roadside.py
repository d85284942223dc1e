import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from oodscen_pybullet._land.ground import Ground
from oodscen_pybullet._land.terrain import Terrain
from oodscen_pybullet._meshes.atlas import draw_atlas, swatch_uv
from oodscen_pybullet._meshes.tags import Tag
from oodscen_pybullet._rendering.triangles import Triangles
from oodscen_pybullet._scenery.furniture import LIMITS, speed_sign
from oodscen_pybullet._scenery.placing import Site
from oodscen_pybullet._scenery.roadside import Scenery, build_scenery
from oodscen_pybullet._scenery.signals import limit_of, replaced_signals
from oodscen_pybullet._scenery.structures import CEILING_M
from oodscen_pybullet._scenery.themes.country import _add_power_line

from oodscen.data._catalogue import RoadMap
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor, RoadSignal, Structure
from oodscen.driving.maps._shipped import SHIPPED_MAPS

each_map = pytest.mark.parametrize("road", SHIPPED_MAPS, ids=lambda road: road.id)


@lru_cache(maxsize=32)
def built(road: RoadMap) -> tuple[Corridor, Scenery]:
    corridor = load_corridor(road)
    return corridor, build_scenery(corridor, road, 0)


@each_map
def test_nothing_stands_on_any_road(road: RoadMap) -> None:
    corridor, scenery = built(road)
    ground = Ground(corridor)
    corners = np.unique(scenery.meshes[2].vertices, axis=0)
    near = ground.near(corners[:, 0], corners[:, 1])
    is_low = (corners[:, 2] - near.z < 2.2) & (corners[:, 2] - near.z > -0.5)
    is_median = (near.ego_asphalt < -0.5) & ("highway" in road.traits)
    on_road = is_low & (near.asphalt < -0.05) & ~is_median
    assert not on_road.any(), corners[on_road][:5]


@each_map
def test_the_ground_has_no_holes(road: RoadMap) -> None:
    corridor, scenery = built(road)
    rng = np.random.default_rng(3)
    s = rng.uniform(corridor.start - 20.0, min(corridor.length, corridor.start + 300.0), 150)
    t = rng.uniform(-80.0, 80.0, len(s))
    points = np.array([corridor.point(a, b)[:2] for a, b in zip(s, t, strict=True)])
    faces = np.concatenate(
        [m.vertices[m.triangles] for m in (*scenery.meshes[:2], *scenery.meshes[3:])]
    )
    normal = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    faces = faces[normal[:, 2] > 1e-9][:, :, :2]
    low, high = faces.min(axis=1), faces.max(axis=1)
    for x, y in points:
        some = faces[(low <= (x, y)).all(axis=1) & (high >= (x, y)).all(axis=1)]
        a = some - np.array([x, y])
        b = np.roll(a, -1, axis=1)
        sides = a[:, :, 0] * b[:, :, 1] - a[:, :, 1] * b[:, :, 0]
        assert (sides >= -1e-9).all(axis=1).any(), (x, y)


@each_map
def test_scenery_is_large_enough_to_be_rich_and_small_enough_to_be_quick(road: RoadMap) -> None:
    count = sum(len(mesh.triangles) for mesh in built(road)[1].meshes)
    assert 9_000 < count < 60_000


@each_map
def test_every_face_has_a_unit_normal(road: RoadMap) -> None:
    for mesh in built(road)[1].meshes:
        assert np.allclose((mesh.normals**2).sum(axis=1), 1.0, atol=1e-6)
        assert np.isfinite(mesh.vertices).all()


@each_map
def test_every_face_has_a_semantic_class(road: RoadMap) -> None:
    meshes = built(road)[1].meshes
    found = [Triangles.of(mesh, draw_atlas(), is_chunked=True).tags for mesh in meshes]
    ground = {Tag.ROADS, Tag.ROAD_LINES, Tag.SIDEWALKS, Tag.TERRAIN, Tag.GROUND, Tag.RAIL_TRACK}
    assert {Tag.ROADS, Tag.ROAD_LINES} <= set(found[0]) <= ground
    assert Tag.TERRAIN in found[1]
    assert set(found[1]) <= ground - {Tag.ROADS, Tag.ROAD_LINES}
    assert {Tag.VEGETATION, Tag.POLES} <= set(found[2])
    assert not {Tag.NONE, *ground - {Tag.GROUND}} & set(found[2])
    assert (Tag.BUILDINGS in found[2]) == bool({"residential", "urban", "rural"} & {*road.traits})


def test_scenery_depends_on_the_seed_alone() -> None:
    road = SHIPPED_MAPS[1]
    corridor, one = built(road)
    two, other = (build_scenery(corridor, road, seed) for seed in (0, 1))
    for a, b in zip(one.meshes, two.meshes, strict=True):
        assert np.array_equal(a.vertices, b.vertices)
        assert np.array_equal(a.uvs, b.uvs)
    assert one.lamps == two.lamps
    assert one.meshes[2].vertices.shape != other.meshes[2].vertices.shape


def test_windows_and_street_lamps_are_lit_at_night() -> None:
    road = SHIPPED_MAPS[1]
    corridor, day = built(road)
    night = build_scenery(corridor, road, 0, is_night=True)
    assert len(night.meshes[2].triangles) > len(day.meshes[2].triangles)
    assert not any(lamp.is_street for lamp in day.lamps)
    assert any(lamp.is_street for lamp in night.lamps)


@pytest.mark.parametrize("end", [1_100.0, 2_000.0])
def test_power_lines_have_wires_also_where_the_last_pole_has_no_room(end: float) -> None:
    road = next(road for road in SHIPPED_MAPS if road.id == "rural_curve")
    bridge = Structure("bridge", end, end + 200.0)
    ground = Ground(replace(load_corridor(road), structures=(bridge,)))
    rng = np.random.default_rng(0)
    site = Site(ground, Terrain(ground, "rural", rng), rng)
    _add_power_line(site, ground.ego)
    mesh = site.mesh()
    spans = np.ptp(mesh.vertices[mesh.triangles], axis=1).max(axis=1)
    assert (spans > 15.0).sum() > 100


@each_map
def test_marks_lie_on_the_edges_of_lanes(road: RoadMap) -> None:
    corridor, scenery = built(road)
    mesh = scenery.meshes[0]
    is_mark = (np.abs(mesh.uvs - swatch_uv("mark")) < 1e-9).all(axis=1)
    corners = mesh.vertices[is_mark][::37]
    outlines = [np.asarray(crosswalk.points) for crosswalk in corridor.crosswalks]
    has_all = "highway" in road.traits
    roads = [corridor, *(o.corridor for o in corridor.others if has_all or not o.is_connecting)]
    for x, y, _ in corners.tolist():
        in_outline = any(
            (o.min(axis=0) - 0.1 <= (x, y)).all() and (o.max(axis=0) + 0.1 >= (x, y)).all()
            for o in outlines
        )
        assert in_outline or any(_is_on_edge(one, x, y) for one in roads), (x, y)


def _is_on_edge(road: Corridor, x: float, y: float) -> bool:
    s, t = road.locate(x, y)
    edges = [edge for strip in range(len(road.strips)) for edge in road.edges(strip, s)]
    return min(abs(t - edge) for edge in edges) < 0.26


def test_a_scenes_own_signal_stands_in_for_the_maps() -> None:
    corridor, _ = built(next(road for road in SHIPPED_MAPS if road.id == "urban_junction"))
    first, *others = corridor.signals
    near = replaced_signals(corridor, [(first.x + 2.0, first.y)])
    assert first.id in near
    assert near != {signal.id for signal in corridor.signals}
    assert replaced_signals(corridor, [(first.x + 300.0, first.y)]) == frozenset()
    assert others


def test_traffic_lights_are_green_for_the_ego_and_red_for_who_crosses() -> None:
    road = next(road for road in SHIPPED_MAPS if road.id == "urban_junction")
    corridor, scenery = built(road)
    signals = [one for one in scenery.lamps if not one.is_street]
    green = [signal for signal in signals if signal.colour[1] > signal.colour[0]]
    red = [signal for signal in signals if signal.colour[0] > signal.colour[1]]
    ahead = corridor.heading(corridor.start)
    along = np.array([math.cos(ahead), math.sin(ahead)])
    assert green
    assert red
    for lamps, is_along in ((green, True), (red, False)):
        for lamp in lamps:
            cosine = abs(float((np.array(lamp.facing[:2]) * along).sum()))
            assert (cosine > 0.7) == is_along
    omitted = frozenset(signal.id for signal in corridor.signals)
    bare = build_scenery(corridor, road, 0, omitted=omitted)
    assert all(lamp.is_street for lamp in bare.lamps)


def test_the_ground_rises_with_the_road() -> None:
    road = next(road for road in SHIPPED_MAPS if road.id == "rural_hill")
    corridor, scenery = built(road)
    for s in np.linspace(corridor.start, corridor.start + 300.0, 13).tolist():
        left, right = corridor.extent(s)[1] + 1.0, corridor.extent(s)[0] - 1.0
        for t in (left, right):
            x, y, z, _ = corridor.point(s, t)
            assert abs(scenery.terrain.height(x, y) - z) < 0.6


def test_ground_lifts_what_stands_on_a_pavement_and_nothing_on_the_road() -> None:
    corridor, scenery = built(SHIPPED_MAPS[1])
    strip = next(i for i, one in enumerate(corridor.strips) if one.kind == "sidewalk")
    s = corridor.start + 20.0
    places = [corridor.point(s, corridor.centre(i, s)) for i in (strip, corridor.ego_lanes[0])]
    lifts = scenery.terrain.lifts(
        np.array([place[0] for place in places]), np.array([place[1] for place in places])
    )
    assert lifts.tolist() == pytest.approx([0.1, 0.0])


def test_a_roundabouts_middle_is_an_island() -> None:
    road = next(road for road in SHIPPED_MAPS if road.id == "roundabout")
    _, scenery = built(road)
    islands = scenery.terrain.islands
    assert len(islands.circles) == 1
    x, y, radius = islands.circles[0]
    assert radius > 5.0
    assert islands.covers(np.array([[x, y]])).all()
    assert not built(SHIPPED_MAPS[0])[1].terrain.islands.circles


@pytest.mark.parametrize(
    ("value", "limit"),
    [("30", 30), ("70.0", 70), ("120", 120), ("37", None), ("", None), ("inf", None), ("x", None)],
)
def test_a_sign_never_shows_another_limit_than_the_maps(value: str, limit: int | None) -> None:
    signal = RoadSignal("1", "sign", "274", value, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    assert limit_of(signal) == limit


def test_speed_signs_differ_and_face_who_drives_up() -> None:
    meshes = [speed_sign(limit) for limit in sorted(LIMITS)]
    assert len({mesh.vertices.tobytes() for mesh in meshes}) == len(LIMITS)
    for mesh in meshes:
        is_black = (np.abs(mesh.uvs - swatch_uv("black")) < 1e-9).all(axis=1)
        assert (mesh.normals[is_black, 0] < -0.99).all()


def test_the_lining_of_a_tunnel_is_as_wide_before_its_portals_as_in_them() -> None:
    road = next(road for road in SHIPPED_MAPS if road.id == "tunnel")
    corridor, scenery = built(road)
    (tunnel,) = corridor.structures
    points = scenery.meshes[3].vertices
    for face, portal in ((tunnel.start - 0.45, tunnel.start), (tunnel.end + 0.45, tunnel.end)):
        knees = [
            sorted(
                {
                    round(float(y), 2)
                    for x, y, z in points
                    if abs(x - at) < 0.01 and abs(z - CEILING_M + 1.3) < 0.02
                }
            )
            for at in (face, portal)
        ]
        assert len(knees[0]) == 2
        assert set(knees[0]) <= set(knees[1])


def test_bus_stops_stand_at_different_places() -> None:
    places = set()
    for road in SHIPPED_MAPS:
        if "urban" in road.traits:
            corridor, scenery = built(road)
            mesh = scenery.meshes[2]
            signs = mesh.vertices[mesh.triangles][
                np.isclose(mesh.uvs[mesh.triangles], swatch_uv("awning_green")).all(axis=(1, 2))
            ]
            small = signs[np.ptp(signs, axis=1).max(axis=1) < 0.8]
            middle = small.reshape(-1, 3).mean(axis=0)
            places.add(round(corridor.locate(*middle[:2].tolist())[0] - corridor.start))
    assert len(places) >= 3
