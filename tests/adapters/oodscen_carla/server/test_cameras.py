"""Vehicles look the same to all cameras, also to those that they carry."""

import math

import numpy as np
import pytest
from oodscen_carla.server._cameras import CameraRenderer, PicturedBody, View
from oodscen_carla.server._depiction import LitVehicle, pictured_scene, street_scene

from oodscen import make_simulator
from oodscen.data import Weather
from oodscen.data._scene import MAX_ACTORS
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._sight.lamps import has_lamps_on
from oodscen.protocols import Camera
from tests.needs import needs

pytestmark = needs("pybullet", "cv2", "numba")


@pytest.fixture
def simulator():
    made = make_simulator("pybullet")
    yield made
    made.close()


def test_a_vehicle_keeps_its_paint_and_lamps_where_a_camera_is_attached_to_it(simulator):
    catalogue = simulator.catalogue()
    road_map = next(each for each in catalogue.maps if each.id == "residential_two_lane")
    taxi = next(each for each in catalogue.assets if each.id == "car")
    road = load_corridor(road_map.id, catalogue)
    x, y, z, yaw = road.point(road.start + 15.0, 0.0)
    bodies = [PicturedBody(2, "taxi7", taxi, "", (x, y, z, yaw), 5.0, 0.0)]
    behind = (x - 8.0 * math.cos(yaw), y - 8.0 * math.sin(yaw), z + 1.0, yaw)
    view = View(Camera(width=160, height=120), behind, 0.0, 0.0)
    night, renderer = Weather(sun_elevation_deg=-20.0), CameraRenderer(simulator)
    scene = pictured_scene(street_scene(road_map, catalogue), night, [LitVehicle("taxi7", "car")])
    free, _ = renderer.take(scene, 0, bodies, view, has_host=False)
    attached, _ = renderer.take(scene, 0, bodies, view, has_host=True)
    assert np.array_equal(attached.rgb, free.rgb)


def test_more_vehicles_than_a_scene_may_have_can_have_their_lamps_on(simulator):
    catalogue = simulator.catalogue()
    lit = [LitVehicle(f"car{index}", "car") for index in range(MAX_ACTORS + 1)]
    street = street_scene(catalogue.maps[0], catalogue)
    scene = pictured_scene(street, Weather(sun_elevation_deg=-20.0), lit)
    assert [actor.id for actor in scene.actors] == [vehicle.name for vehicle in lit]
    assert has_lamps_on(scene, lit[-1].name)


def test_cameras_see_by_the_beams_of_the_vehicle_that_carries_them_if_its_lamps_are_on(simulator):
    catalogue = simulator.catalogue()
    road_map = next(each for each in catalogue.maps if each.id == "residential_two_lane")
    road = load_corridor(road_map.id, catalogue)
    night = Weather(sun_elevation_deg=-20.0)
    dark, lit = (
        pictured_scene(street_scene(road_map, catalogue), night, vehicles)
        for vehicles in ([], [LitVehicle("taxi7", catalogue.ego.id)])
    )
    x, y, z, yaw = road.point(road.start + 10.0, 0.0)
    view = View(Camera(width=160, height=120, x=0.0, z=0.0), (x, y, z + 2.0, yaw), 0.0, 0.0)
    bodies = [PicturedBody(2, "taxi7", catalogue.ego, "", (x, y, z, yaw), 0.0, 0.0)]
    renderer, bright = CameraRenderer(simulator), {}
    for name, scene, shown in (("free", dark, []), ("unlit", dark, bodies), ("lit", lit, bodies)):
        frame, _ = renderer.take(scene, 0, shown, view, has_host=bool(shown))
        bright[name] = frame.rgb[88:116, 60:100].mean()
    assert bright["free"] < 20
    assert bright["unlit"] == pytest.approx(bright["free"], abs=1.0)
    assert bright["lit"] > 60


def test_no_two_bodies_of_a_picture_have_one_name(simulator, monkeypatch):
    catalogue, names = simulator.catalogue(), []
    road_map = catalogue.maps[0]
    x, y, z, yaw = load_corridor(road_map.id, catalogue).point(50.0, 0.0)
    ego = PicturedBody(1, "ego", catalogue.ego, "", (x, y, z, yaw), 0.0, 0.0)
    taxi = PicturedBody(2, "taxi7", catalogue.assets[0], "", (x + 9.0, y, z, yaw), 0.0, 0.0)
    view = View(Camera(width=64, height=48), (x, y, z + 1.0, yaw), 0.0, 0.0)
    scene = street_scene(road_map, catalogue)
    spawn = simulator.spawn
    monkeypatch.setattr(simulator, "spawn", lambda *body: names.append(body[0]) or spawn(*body))
    for has_host, n in ((True, 2), (False, 3)):
        names.clear()
        CameraRenderer(simulator).take(scene, 0, [taxi, ego], view, has_host=has_host)
        assert len(set(names)) == len(names) == n
        assert {"ego", "taxi7"} <= set(names)
