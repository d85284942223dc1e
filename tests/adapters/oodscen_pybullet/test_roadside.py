from functools import lru_cache

import numpy as np
import pytest
from oodscen_pybullet.ground import Ground
from oodscen_pybullet.roadside import Scenery, build_scenery

from oodscen.catalogue import RoadMap
from oodscen.driving import SHIPPED_MAPS, Corridor, load_corridor

each_map = pytest.mark.parametrize("road", SHIPPED_MAPS, ids=lambda road: road.id)


@lru_cache(maxsize=32)
def built(road: RoadMap) -> tuple[Corridor, Scenery]:
    corridor = load_corridor(road)
    return corridor, build_scenery(corridor, frozenset(road.traits), 0, road.id)


@each_map
def test_nothing_stands_on_any_road(road: RoadMap) -> None:
    corridor, scenery = built(road)
    ground = Ground(corridor)
    corners = scenery.meshes[2].vertices
    near = ground.near(corners[:, 0], corners[:, 1])
    is_low = (corners[:, 2] - near.z < 2.2) & (corners[:, 2] - near.z > -0.5)
    is_median = (near.ego < -0.5) & ("highway" in road.traits)
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
    for x, y in points:
        low, high = faces.min(axis=1), faces.max(axis=1)
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


def test_scenery_depends_on_the_seed_alone() -> None:
    road = SHIPPED_MAPS[1]
    corridor = load_corridor(road)
    one, two, other = (
        build_scenery(corridor, frozenset(road.traits), seed, road.id) for seed in (0, 0, 1)
    )
    for a, b in zip(one.meshes, two.meshes, strict=True):
        assert np.array_equal(a.vertices, b.vertices)
        assert np.array_equal(a.uvs, b.uvs)
    assert one.lamps == two.lamps
    assert one.meshes[2].vertices.shape != other.meshes[2].vertices.shape


def test_windows_are_lit_at_night() -> None:
    road = SHIPPED_MAPS[1]
    corridor = load_corridor(road)
    day, night = (
        build_scenery(corridor, frozenset(road.traits), 0, road.id, is_night=dark)
        for dark in (False, True)
    )
    assert len(night.meshes[2].triangles) > len(day.meshes[2].triangles)
