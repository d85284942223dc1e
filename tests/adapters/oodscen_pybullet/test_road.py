import numpy as np
import pytest
from oodscen_pybullet.road import Course, Ribbons, extents, lay_road
from oodscen_pybullet.roadside import build_scenery

from oodscen.catalogue import RoadMap
from oodscen.driving import SHIPPED_MAPS, load_corridor


@pytest.mark.parametrize("road", SHIPPED_MAPS, ids=lambda road: road.id)
def test_the_surface_covers_the_whole_cross_section(road: RoadMap) -> None:
    corridor = load_corridor(road)
    course = Course.of(corridor)
    ribbons = Ribbons(course)
    lay_road(corridor, ribbons, frozenset(road.traits))
    mesh = ribbons.mesh()
    right, left = extents(corridor, course)
    whole = float((left - right)[:-1].sum()) * 3.0
    faces = mesh.vertices[mesh.triangles]
    flat = mesh.normals[mesh.triangles[:, 0]][:, 2] > 0.5
    normal = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    assert np.abs(normal[flat, 2]).sum() / 2 == pytest.approx(whole, rel=0.01)
    assert (normal[flat, 2] > 0).all()


@pytest.mark.parametrize("road", SHIPPED_MAPS, ids=lambda road: road.id)
def test_nothing_but_the_road_is_on_the_road(road: RoadMap) -> None:
    corridor = load_corridor(road)
    scenery = build_scenery(corridor, frozenset(road.traits), 0, road.id)
    corners = scenery.meshes[1].vertices
    low = corners[corners[:, 2] < 2.5][::7]
    for x, y, _ in low.tolist():
        s, t = corridor.locate(x, y)
        if corridor.start < s < corridor.length:
            assert not corridor.is_drivable(s, t, t)


def test_scenery_depends_on_the_seed_alone() -> None:
    road = SHIPPED_MAPS[1]
    corridor = load_corridor(road)
    built = [build_scenery(corridor, frozenset(road.traits), seed, road.id) for seed in (0, 0, 1)]
    assert np.array_equal(built[0].meshes[1].vertices, built[1].meshes[1].vertices)
    assert built[0].meshes[1].vertices.shape != built[2].meshes[1].vertices.shape
    assert built[0].lamps == built[1].lamps
