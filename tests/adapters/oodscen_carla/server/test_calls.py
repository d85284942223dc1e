"""Calls change the served world as CARLA's would, and whatever is wrong has a clear answer."""

import math
import re
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from oodscen_carla.server._actor_calls import ActorCalls
from oodscen_carla.server._calls import EMPTY, WITHOUT_EFFECT, Calls
from oodscen_carla.server._commands import REFUSED
from oodscen_carla.server._episode_calls import EpisodeCalls
from oodscen_carla.server._motion_calls import MotionCalls
from oodscen_carla.server._traffic_manager_calls import TrafficManagerCalls

PAGE = Path(__file__).parents[4] / "docs/carla.md"
CAR = "vehicle.tesla.model3"
PROCEDURES = sorted(
    name[4:]
    for group in (ActorCalls, Calls, EpisodeCalls, MotionCalls, TrafficManagerCalls)
    for name in dir(group)
    if name.startswith("rpc_")
)
CONTROL = [0.8, 0.0, 0.0, False, False, False, 0]


def test_an_unknown_procedure_is_refused_by_name(served):
    message = served.error("set_traffic_light_state")
    assert "'set_traffic_light_state' is not supported" in message
    assert served.told == [f"refused set_traffic_light_state: {message}"]


UNANSWERED = """
    cast_ray disable_sensor_for_ros enable_environment_objects enable_sensor_for_ros
    freeze_all_traffic_lights get_all_level_BBs get_environment_objects get_group_traffic_lights
    get_light_boxes get_names_of_all_objects set_actor_dead set_annotations_traverse_translucency
    set_replayer_time_factor show_vehicle_debug_telemetry
""".split()


@pytest.mark.parametrize("name", UNANSWERED)
def test_what_the_server_cannot_answer_or_do_is_refused_by_name(served, name):
    assert f"{name!r} is not supported" in served.error(name, 1, 2)


IN_PYTHON = {
    "apply_physics_control": "apply_physics_control",
    "draw_debug_shape": "world.debug",
    "get_required_files": "get_required_files",
    "query_lights_state": "get_lightmanager",
    "reset_all_traffic_lights": "reset_all_traffic_lights",
    "set_actor_autopilot": "set_autopilot",
    "set_actor_collisions": "set_collisions",
    "set_actor_enable_gravity": "set_enable_gravity",
    "set_pedestrians_cross_factor": "set_pedestrians_cross_factor",
    "set_pedestrians_seed": "set_pedestrians_seed",
    "set_wheel_steer_direction": "set_wheel_steer_direction",
    "update_day_night_cycle": "get_lightmanager",
    "update_lights_state": "get_lightmanager",
}
"""Names in the client's Python of the calls that are accepted and do nothing."""


def test_the_page_lists_every_call_that_does_nothing():
    page = PAGE.read_text(encoding="utf-8")
    assert IN_PYTHON.keys() == WITHOUT_EFFECT | EMPTY
    assert [name for name in IN_PYTHON.values() if f"`{name}`" not in page] == []


def test_the_page_lists_no_command_that_python_cannot_send():
    commands = pytest.importorskip("carla").command
    (row,) = re.findall(r"^\| batches \| (.*) \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    listed = re.findall(r"`(\w+)`", row)
    assert len(listed) > 5
    assert [name for name in listed if not hasattr(commands, name)] == []


def test_what_has_no_effect_succeeds_and_what_is_missing_is_empty(served):
    assert {served.get(name, 1, 2, 3) for name in WITHOUT_EFFECT} == {None}
    assert all(served.get(name) == [] for name in EMPTY)


def test_every_vehicle_recommends_a_colour(served):
    for _, name, _, attributes in served.get("get_actor_definitions"):
        colours = [attribute[3] for attribute in attributes if attribute[0] == "color"]
        assert name.startswith("vehicle.") == bool(colours), name
        assert all(colours), name


def test_a_driven_car_moves_brakes_and_reverses(served):
    car = served.spawn(CAR, 100.0, 1.7)
    served.get("apply_control_to_vehicle", car, CONTROL)
    for _ in range(40):
        served.get("tick_cue")
    actor = served.world.actors[car]
    assert 4.0 < actor.speed < 8.0
    assert actor.place.location[0] > 105.0
    served.get("apply_control_to_vehicle", car, [0.0, 0.0, 1.0, False, False, False, 0])
    for _ in range(40):
        served.get("tick_cue")
    assert actor.speed == 0.0
    served.get("apply_control_to_vehicle", car, [0.5, 0.0, 0.0, False, True, False, -1])
    for _ in range(20):
        served.get("tick_cue")
    assert actor.speed < -0.5


def test_steering_to_the_right_turns_right_and_ice_widens_the_bend(served):
    turns = []
    for wetness in (0.0, 90.0):
        weather = list(served.world.weather)
        weather[9] = wetness
        served.get("set_weather_parameters", weather)
        car = served.spawn(CAR, 100.0, 1.7)
        served.world.actors[car].speed = 15.0
        served.get("apply_control_to_vehicle", car, [0.0, 1.0, 0.0, False, False, False, 0])
        for _ in range(10):
            served.get("tick_cue")
        turns.append(served.world.actors[car].place.rotation[1])
        served.get("destroy_actor", car)
    assert turns[0] > 3.0 * turns[1] > 0.0


def test_a_friction_trigger_works_like_ice(served):
    served.spawn(
        "static.trigger.friction", 0.0, 0.0, friction=0.0, extent_x=9e3, extent_y=9e3, extent_z=9e3
    )
    car = served.spawn(CAR)
    served.get("apply_control_to_vehicle", car, CONTROL)
    served.get("tick_cue")
    assert served.world.actors[car].speed == 0.0


def test_a_car_stops_where_it_would_hit_something(served):
    car, hay = served.spawn(CAR, 100.0), served.spawn("static.prop.haybale", 112.0)
    served.get("apply_control_to_vehicle", car, CONTROL)
    hits = []
    for _ in range(120):
        served.get("tick_cue")
        hits += served.world.collisions
    assert {(a.id, b.id) for a, b in hits} == {(car, hay)}
    assert served.world.actors[car].place.location[0] < 110.0


def test_wrecks_and_machines_are_no_traffic(served):
    defaults = {
        name: {attribute[0]: attribute[2] for attribute in attributes}
        for _, name, _, attributes in served.get("get_actor_definitions")
    }
    assert defaults[CAR]["base_type"] == "car"
    assert defaults["vehicle.carlamotors.firetruck"]["base_type"] == "truck"
    assert defaults["vehicle.oodscen.trailer"]["base_type"] == ""


@pytest.mark.parametrize("prop", ["static.prop.puddle", "static.prop.dirtdebris01"])
def test_a_car_drives_over_what_is_flat(served, prop):
    car, _ = served.spawn(CAR, 100.0), served.spawn(prop, 112.0)
    served.get("apply_control_to_vehicle", car, CONTROL)
    for _ in range(120):
        served.get("tick_cue")
        assert not served.world.collisions
    assert served.world.actors[car].place.location[0] > 115.0


def test_a_spawn_needs_a_blueprint_a_parent_and_room(served):
    place = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
    assert "lidar" in served.error("spawn_actor", [1, "sensor.lidar.ray_cast", []], place)
    served.spawn(CAR)
    assert "collision at spawn position" in served.error("spawn_actor", [1, CAR, []], place)
    camera = [1, "sensor.camera.rgb", [["image_size_x", 2, "99999"]]]
    assert "pixels" in served.error("spawn_actor_with_parent", camera, place, 24, 0, "")
    assert "parent" in served.error(
        "spawn_actor_with_parent", [1, "sensor.other.imu", []], place, 999
    )


def test_what_is_attached_takes_no_room_at_its_relative_place(served):
    car, bale = served.spawn(CAR, 100.0, 1.7), [1, "static.prop.haybale", []]
    place = [[0.0, 0.0, 3.0], [0.0, 0.0, 0.0]]
    for _ in range(2):
        served.get("spawn_actor_with_parent", bale, place, car, 0, "")
    free = served.get("spawn_actor", bale, place)[0]
    assert "collision at spawn position" in served.error("spawn_actor", bale, place)
    served.get("spawn_actor_with_parent", bale, place, car, 0, "")
    assert not served.world.actors[free].parent


def test_what_hangs_on_a_vehicle_goes_with_it(served):
    car = served.spawn(CAR)
    place = [[1.0, 0.0, 2.0], [0.0, 0.0, 0.0]]
    sensor = served.get("spawn_actor_with_parent", [1, "sensor.other.imu", []], place, car, 0, "")[
        0
    ]
    assert served.world.place_of(served.world.actors[sensor]).location == pytest.approx(
        (1.0, 0.0, 2.0)
    )
    assert served.get("destroy_actor", car) is True
    assert served.get("destroy_actor", car) is False
    assert set(served.world.actors) == {23}
    assert "spectator" in served.error("destroy_actor", 23)


def test_a_batch_answers_every_command_for_itself(served):
    place = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
    spawn = [[0, [[1, CAR, []], place, [False], 216, "", [[[14, [0, False]]]]]]]
    answers = served.ask("apply_batch", [spawn, spawn, [[1, [999]]], [[10, [24, [1, 1, 1]]]]], True)
    assert answers[0] == [[1, 24]]
    errors = [answer[0][1][0] for answer in answers[1:]]
    assert ["collision" in errors[0], "999" in errors[1], REFUSED[10] in errors[2]] == [True] * 3
    assert not served.world.actors[24].has_physics
    assert served.world.frame == 1


def test_a_batch_that_is_refused_as_a_whole_answers_every_command(served):
    """A client reads a list of responses, and looks up the response of each of its commands."""
    answers = served.ask("apply_batch", [[[1, [999]]]] * 10_001, False)
    assert len(answers) == 10_001
    (message,) = {message for ((kind, (message,)),) in answers if kind == 0}
    assert "at most 10,000 values, not 10,001" in message


@pytest.mark.parametrize("arguments", [(), ("all", False), ([], "soon")])
def test_a_batch_that_is_none_has_a_response(served, arguments):
    (((kind, (message,)),),) = served.ask("apply_batch", *arguments)
    assert kind == 0
    assert message


def test_a_batch_with_bad_arguments_runs_no_command(served):
    car = served.spawn(CAR)
    (((kind, _),),) = served.ask("apply_batch", [[[1, [car]]]], "soon")
    assert kind == 0
    assert car in served.world.actors


@pytest.mark.parametrize("control", [CONTROL[:3], [*CONTROL, 0]])
def test_a_vehicles_control_has_seven_values(served, control):
    car = served.spawn(CAR)
    message = served.error("apply_control_to_vehicle", car, control)
    assert f"list of 7 values, not {len(control)}" in message


def test_only_vehicles_are_driven_and_lit(served):
    for number in (23, served.spawn("static.prop.puddle")):
        assert "is no vehicle" in served.error("apply_control_to_vehicle", number, CONTROL)
        assert "is no vehicle" in served.error("set_vehicle_light_state", number, [1])
        assert "is no vehicle" in served.error("get_vehicle_light_state", number)


def test_only_walkers_walk(served):
    control = [[1.0, 0.0, 0.0], 5.0, False]
    for number in (served.spawn(CAR, 100.0), served.spawn("static.prop.haybale", 120.0)):
        assert "is no walker" in served.error("apply_control_to_walker", number, control)
        before = served.world.actors[number].place
        served.get("tick_cue")
        assert served.world.actors[number].place == before
    walker = served.spawn("walker.pedestrian.0001", 50.0, 1.7)
    served.get("apply_control_to_walker", walker, control)
    served.get("tick_cue")
    assert served.world.actors[walker].place.location[0] == pytest.approx(50.25)


@pytest.mark.parametrize("states", [[], [1, 2]])
def test_a_vehicle_has_one_light_state(served, states):
    car = served.spawn(CAR)
    assert f"not {len(states)}" in served.error("set_vehicle_light_state", car, states)
    assert served.get("get_vehicle_light_state", car) == [0]


@pytest.mark.parametrize(("count", "words"), [(0, "missing"), (4, "too many")])
def test_a_call_with_too_few_or_too_many_arguments_is_refused(served, count, words):
    message = served.error("set_actor_location", *[1] * count)
    assert message.startswith("set_actor_location: ")
    assert words in message


def test_every_shipped_map_loads_and_its_cars_stand_on_the_road(served):
    for name in served.get("get_available_maps"):
        served.get("load_new_episode", name, True, 0)
        shown, points = served.get("get_map_info")
        assert shown == f"Carla/Maps/{name.rsplit('/', 1)[-1]}"
        assert points
        for (x, y, z), (_, yaw, _) in points:
            ground, heading, _ = served.world.map.ground(x, -y)
            assert z - ground == pytest.approx(0.3, abs=0.05)
            # The nearest line of a car beside an exit may be the ramp's.
            within = 0.35 if name.endswith("exit_ramp") else 0.2
            assert abs(math.sin(math.radians(-yaw) - heading)) < within
    assert "no map" in served.error("load_new_episode", "Town99", True, 0)
    assert "OpenDRIVE" in served.error("copy_opendrive_to_file", "<OpenDRIVE/>", [])


def test_a_staged_scene_moves_its_actors_and_obeys_the_hero(staged):
    world = staged.world
    hero = next(
        actor for actor in world.actors.values() if actor.attributes.get("role_name") == "hero"
    )
    speed = hero.speed
    assert "staged" in staged.error("set_actor_transform", hero.id, [[0, 0, 0], [0, 0, 0]])
    synchronous = [True, *staged.world.settings.wire()[1:]]
    staged.get("tick_cue")
    assert staged.world.staged.world.time == 0.0
    staged.get("set_episode_settings", synchronous)
    for _ in range(10):
        staged.get("tick_cue")
    assert hero.speed == pytest.approx(speed, abs=0.2)
    staged.get("apply_control_to_vehicle", hero.id, [0.0, 0.0, 1.0, False, False, False, 0])
    for _ in range(10):
        staged.get("tick_cue")
    assert hero.speed < speed - 3.0
    assert world.staged.world.time == pytest.approx(1.0)


def test_the_bodies_of_a_staged_scene_stay(staged):
    world = staged.world
    bodies = [actor.id for actor in world.actors.values() if actor.staged]
    assert len(bodies) > 1
    place = [[1.0, 0.0, 2.0], [0.0, 0.0, 0.0]]
    sensor = ["sensor.other.imu", place, bodies[0]]
    camera = staged.get("spawn_actor_with_parent", [1, sensor[0], []], *sensor[1:], 0, "")[0]
    for number in bodies:
        assert staged.get("destroy_actor", number) is False
        assert f"actor {number} belongs to the staged scene" in staged.told[-1]
        ((answer,),) = staged.ask("apply_batch", [[[1, [number]]]], False)
        assert answer[0] == 0
        assert f"actor {number} belongs to the staged scene" in answer[1][0]
    assert {*bodies, camera} < set(world.actors)
    assert staged.get("destroy_actor", camera) is True


def test_the_lamps_of_a_staged_scene_are_its_own(staged):
    (hero, *_) = (actor.id for actor in staged.world.actors.values() if actor.staged)
    assert "moved by the staged scene" in staged.error("set_vehicle_light_state", hero, [3])
    assert staged.get("get_vehicle_light_state", hero) == [0]


def test_a_clients_vehicle_is_lit_in_a_staged_scene_too(staged):
    car = staged.spawn(CAR, 500.0, 500.0)
    plain = staged.world.scene()
    assert plain.actors == staged.world.staged.scene.actors
    staged.get("set_vehicle_light_state", car, [3])
    *before, lit = staged.world.scene().actors
    assert tuple(before) == plain.actors
    assert lit.id == staged.world.actors[car].name


def test_a_client_sets_the_heros_speed_and_the_friction_of_a_staged_scene(staged):
    world = staged.world
    hero = next(
        actor for actor in world.actors.values() if actor.attributes.get("role_name") == "hero"
    )
    other = next(actor for actor in world.actors.values() if actor.staged and actor is not hero)
    staged.get("set_episode_settings", [True, *world.settings.wire()[1:]])
    assert "staged" in staged.error("set_actor_target_velocity", other.id, [1.0, 0.0, 0.0])
    yaw = math.radians(hero.place.rotation[1])
    ahead = [math.cos(yaw), math.sin(yaw), 0.0]
    lost = {}
    for wetness in (0.0, 70.0):
        weather = [*staged.get("get_weather_parameters")]
        weather[9] = wetness
        staged.get("set_weather_parameters", weather)
        staged.get("set_actor_target_velocity", hero.id, [12.0 * one for one in ahead])
        staged.get("apply_control_to_vehicle", hero.id, [0.0, 0.0, 0.0, False, False, False, 0])
        staged.get("tick_cue")
        assert hero.speed == pytest.approx(12.0, abs=0.1)
        staged.get("apply_control_to_vehicle", hero.id, [0.0, 0.0, 1.0, False, False, False, 0])
        staged.get("tick_cue")
        lost[wetness] = -hero.acceleration_along
    assert lost[0.0] == pytest.approx(8.2, abs=0.1)
    assert lost[70.0] == pytest.approx(0.3 * 9.81, abs=0.1)
    for far in (1e6, -1e6):
        staged.get("set_actor_target_velocity", hero.id, [far * one for one in ahead])
        for _ in range(5):
            staged.get("tick_cue")
        assert all(map(math.isfinite, (*hero.place.location, hero.speed)))


@pytest.mark.parametrize("ticks_before", [0, 1])
def test_the_hero_keeps_the_speed_that_it_was_given_until_the_first_control(staged, ticks_before):
    hero = next(actor for actor in staged.world.actors.values() if actor.staged)
    staged.get("set_episode_settings", [True, *staged.world.settings.wire()[1:]])
    for _ in range(ticks_before):
        staged.get("tick_cue")
    yaw = math.radians(hero.place.rotation[1])
    velocity = [12.0 * math.cos(yaw), 12.0 * math.sin(yaw), 0.0]
    staged.get("set_actor_target_velocity", hero.id, velocity)
    for _ in range(20):
        staged.get("tick_cue")
    assert hero.speed == pytest.approx(12.0, abs=0.1)


def test_after_the_last_client_the_world_begins_again(staged):
    first = list(staged.world.actors.values())[1].place
    settings_ = staged.world.settings.wire()
    settings_[0] = True
    staged.get("set_episode_settings", settings_)
    for _ in range(10):
        staged.get("tick_cue")
    staged.spawn("static.prop.haybale", 500.0, 500.0)
    count = len(staged.world.actors)
    staged.world.leave()
    assert list(staged.world.actors.values())[1].place == first
    assert len(staged.world.actors) == count - 1
    assert not staged.world.is_synchronous


JUNK = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**63), 2**63) | st.floats() | st.text(max_size=20),
    lambda inner: st.lists(inner, max_size=12),
    max_leaves=25,
)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=75)
@given(method=st.sampled_from(PROCEDURES) | st.text(max_size=10), values=st.lists(JUNK, max_size=5))
def test_junk_is_refused_and_never_fails_the_server(staged, method, values):
    answer = staged.ask(method, *values)
    assert isinstance(answer, list)
    staged.tick()


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=75)
@given(kind=st.integers(-1, 24), values=st.lists(st.just(24) | JUNK, max_size=6))
def test_junk_in_batches_is_refused(staged, kind, values):
    assert isinstance(staged.ask("apply_batch", [[[kind, values]]], False), list)
    staged.tick()


@pytest.mark.parametrize("count", [10_001, 100_000])
def test_too_many_ids_are_refused_as_too_many(served, count):
    assert served.get("get_actors_by_id", list(range(5_000, 15_000))) == []
    message = served.error("get_actors_by_id", list(range(count)))
    assert f"at most 10,000 values, not {count:,}" in message
    assert served.error("get_actors_by_id", "all").endswith("list of at most 10,000 values")
