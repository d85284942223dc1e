"""The official client, version 0.9.16, takes the server for CARLA."""

import queue

import numpy as np
import pytest

from oodscen.testing import example_scene

carla = pytest.importorskip("carla")

KINDS = ("rgb", "depth", "instance_segmentation", "semantic_segmentation")


@pytest.fixture
def client(server):
    made = carla.Client("127.0.0.1", server.port)
    made.set_timeout(20.0)
    return made


@pytest.fixture
def world(client):
    made = client.load_world("urban_avenue")
    settings = made.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, 0.05
    made.apply_settings(settings)
    return made


def start_of(world) -> object:
    return world.get_map().get_spawn_points()[0]


def spawn(world, name: str, place, parent=None) -> object:
    return world.spawn_actor(world.get_blueprint_library().find(name), place, attach_to=parent)


def listened(sensor) -> "queue.SimpleQueue":
    found = queue.SimpleQueue()
    sensor.listen(found.put)
    return found


@pytest.mark.parametrize(("step", "ticks"), [(0.05, 1), (0.1, 2)])
def test_applying_synchronous_settings_takes_known_ticks(client, step, ticks):
    world = client.load_world("urban_avenue")
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, step
    before = world.apply_settings(settings)
    assert world.get_snapshot().frame - before == ticks


def test_cameras_show_bodies_where_they_are(world):
    place = start_of(world)
    ego = spawn(world, "vehicle.tesla.model3", place)
    ahead = world.get_map().get_waypoint(place.location).next(25.0)[0].transform
    truck = spawn(world, "vehicle.carlamotors.firetruck", ahead)
    mount = carla.Transform(carla.Location(x=1.5, z=1.6), carla.Rotation(pitch=-5.0))
    sensors = {kind: spawn(world, f"sensor.camera.{kind}", mount, ego) for kind in KINDS}
    streams = {kind: listened(sensor) for kind, sensor in sensors.items()}
    frame = world.tick()
    images = {kind: stream.get(timeout=20) for kind, stream in streams.items()}
    assert {image.frame for image in images.values()} == {frame}
    raw = {
        kind: np.frombuffer(image.raw_data, np.uint8).reshape(600, 800, 4).astype(int)
        for kind, image in images.items()
    }
    depth, instance = raw["depth"], raw["instance_segmentation"]
    metres = (depth[..., 2] + 256 * depth[..., 1] + 65536 * depth[..., 0]) * 1000 / (2**24 - 1)
    on = instance[..., 1] + 256 * instance[..., 0] == truck.id
    assert on.sum() > 1000
    label = carla.CityObjectLabel
    seen = raw["semantic_segmentation"][..., 2]
    assert set(seen[on]) == {int(label.Truck)}
    assert np.array_equal(seen, instance[..., 2])
    assert {int(label.Roads), int(label.RoadLines), int(label.Sky)} <= set(seen[~on].ravel())
    eye = ego.get_transform().transform(mount.location)
    assert images["rgb"].transform.location.distance(eye) < 0.01
    tail = truck.get_location().distance(eye) - truck.bounding_box.extent.x
    assert abs(metres[on].min() - tail) < 0.5
    for sensor in sensors.values():
        sensor.stop()


def test_a_camera_may_look_anywhere(world):
    place = start_of(world)
    car = spawn(world, "vehicle.tesla.model3", place)
    yaw = place.rotation.yaw
    for offset, rotation in (
        (carla.Location(z=30.0), carla.Rotation(pitch=-90.0)),
        (carla.Location(x=-8.0, z=3.0), carla.Rotation(pitch=-10.0, yaw=yaw)),
        (carla.Location(y=-6.0, z=1.0), carla.Rotation(yaw=yaw + 90.0)),
    ):
        view = carla.Transform(place.transform(offset), rotation)
        camera = spawn(world, "sensor.camera.instance_segmentation", view)
        images = listened(camera)
        world.tick()
        raw = np.frombuffer(images.get(timeout=20).raw_data, np.uint8).reshape(600, 800, 4)
        seen = raw[..., 1] + 256 * raw[..., 0].astype(int) == car.id
        rows, columns = np.nonzero(seen)
        assert len(rows) > 200
        assert abs(columns.mean() - 400) < 40
        camera.stop()
        camera.destroy()


def test_events_and_measurements_arrive(world):
    place = start_of(world)
    car = spawn(world, "vehicle.tesla.model3", place)
    hay = spawn(
        world,
        "static.prop.haybale",
        world.get_map().get_waypoint(place.location).next(20.0)[0].transform,
    )
    kinds = ("collision", "lane_invasion", "imu", "gnss")
    sensors = [spawn(world, f"sensor.other.{kind}", carla.Transform(), car) for kind in kinds]
    hits, lanes, turns, places = map(listened, sensors)
    car.apply_control(carla.VehicleControl(throttle=0.7))
    for _ in range(90):
        world.tick()
    event = hits.get(timeout=20)
    assert (event.actor.id, event.other_actor.id) == (car.id, hay.id)
    assert turns.get(timeout=20).accelerometer.z == pytest.approx(9.81, abs=0.1)
    assert abs(places.get(timeout=20).latitude) < 1.0
    car.set_transform(place)
    car.apply_control(carla.VehicleControl(throttle=0.6, steer=0.3))
    hay.destroy()
    for _ in range(60):
        world.tick()
    assert lanes.get(timeout=20).crossed_lane_markings
    for sensor in sensors:
        sensor.stop()


def test_batches_weather_lights_and_the_spectator(client, world):
    command = carla.command
    blueprint = world.get_blueprint_library().find("vehicle.audi.tt")
    places = [
        generate_waypoint.transform
        for generate_waypoint in world.get_map().generate_waypoints(12)[:40]
    ]
    orders = [
        command.SpawnActor(blueprint, place).then(
            command.SetSimulatePhysics(command.FutureActor, False)
        )
        for place in (*places, places[0])
    ]
    answers = client.apply_batch_sync(orders, True)
    assert [answer.has_error() for answer in answers] == [False] * 40 + [True]
    ids = [answer.actor_id for answer in answers[:-1]]
    moved = carla.Transform(carla.Location(5.0, 6.0, 7.0), carla.Rotation(yaw=8.0))
    client.apply_batch_sync([command.ApplyTransform(ids[0], moved)], True)
    assert world.get_actor(ids[0]).get_transform() == moved
    assert world.try_spawn_actor(blueprint, places[1]) is None
    with pytest.raises(IndexError):
        world.get_blueprint_library().find("sensor.lidar.ray_cast")
    gone = client.apply_batch_sync([command.DestroyActor(one) for one in (*ids, 9999)], True)
    assert [one.has_error() for one in gone] == [False] * 40 + [True]
    rain = carla.WeatherParameters(precipitation=50.0, sun_altitude_angle=20.0)
    world.set_weather(rain)
    assert world.get_weather() == rain
    world.get_spectator().set_transform(moved)
    world.tick()
    assert world.get_spectator().get_transform() == moved


def test_a_second_client_sees_what_the_first_does(server, world):
    other = carla.Client("127.0.0.1", server.port)
    other.set_timeout(20.0)
    watching = other.get_world()
    car = spawn(world, "vehicle.tesla.model3", start_of(world))
    car.apply_control(carla.VehicleControl(throttle=0.5))
    frames = [world.tick()]
    while watching.get_snapshot().frame not in frames and len(frames) < 1000:
        frames.append(world.tick())
    assert len(frames) < 1000
    assert watching.get_map().name == world.get_map().name
    assert watching.get_actor(car.id).type_id == "vehicle.tesla.model3"


def test_a_batch_that_is_too_long_is_refused_in_words(client, world):
    orders = [carla.command.DestroyActor(9999)] * 10_001
    answers = client.apply_batch_sync(orders, False)
    assert len(answers) == 10_001
    assert "at most 10,000 values" in answers[-1].error


def test_a_script_that_destroys_all_vehicles_leaves_those_of_a_scene(client):
    world = client.load_world(example_scene().id)
    every = list(world.get_actors().filter("vehicle.*"))
    assert every
    assert not any(vehicle.destroy() for vehicle in every)
    answers = client.apply_batch_sync([carla.command.DestroyActor(one) for one in every], False)
    assert all("staged scene" in answer.error for answer in answers)
    assert {one.id for one in every} <= {actor.id for actor in world.get_actors()}
