"""Left and right exchanged give the mirrored road, the mirrored motion and the mirrored control."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.data._designs.motion import Motion
from oodscen.data._scene import Scene
from oodscen.driving._drivers.r157 import R157Driver
from oodscen.driving._drivers.rss import RSSDriver
from oodscen.driving._drivers.rule_based import RuleBasedDriver
from oodscen.driving._motion.actions import ActionDriver
from oodscen.driving._motion.behaviours.table import BUILT_IN
from oodscen.driving._motion.rollouts import Variation
from oodscen.driving._motion.world import KinematicWorld
from oodscen.driving._roads.building import load_corridor, read_map
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE
from tests.mirrors import mirrored, mirrored_map, swapped
from tests.motions import sound_motions

MAPS = {road.id: road for road in SHIPPED_MAPS}
MIRROR = np.array([1.0, -1.0, 1.0, -1.0])
ROUNDING = 1e-4
"""Positions are rounded to 1e-6 in every step, half upwards, m."""
BY_CHANCE = {"wander", "swerve", "wobble", "blown"}
TO_THE_LEFT = {"u_turn", "open_door"}
"""Behaviours that turn left by convention, or to one side where they are in the very middle."""


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    """Load a map as it is and mirrored."""
    folder = tmp_path_factory.mktemp("mirrored")

    @cache
    def roads(name):
        path = folder / f"{name}.xodr"
        path.write_bytes(mirrored_map(read_map(MAPS[name].file)))
        road = MAPS[name]
        return load_corridor(road), load_corridor(road.model_copy(update={"file": str(path)}))

    return roads


@pytest.mark.parametrize("name", ["urban_junction", "roundabout", "exit_ramp"])
def test_a_mirrored_map_has_the_mirrored_road(pair, name):
    road, other = pair(name)
    for column, sign in (("x", 1), ("y", -1), ("cos", 1), ("sin", -1), ("curvature", -1)):
        assert np.array_equal(getattr(road, column), sign * getattr(other, column))
    for strip, twin in zip(road.strips, other.strips[::-1], strict=True):
        assert np.array_equal(strip.right, -twin.left)
        assert (strip.kind, strip.direction) == (twin.kind, twin.direction)
        assert (strip.mark, strip.right_mark) == (twin.right_mark, twin.mark)
    for light, twin in zip(road.signals, other.signals, strict=True):
        assert (light.x, light.y, light.yaw) == pytest.approx((twin.x, -twin.y, -twin.yaw))
    rng = np.random.default_rng(1)
    near = rng.integers(0, len(road.s), 200)
    x, y = (line[near] + rng.normal(0.0, 20.0, 200) for line in (road.x, road.y))
    (s, t), (twin_s, twin_t) = road.locate_all(x, y), other.locate_all(x, -y)
    assert np.abs(s - twin_s).max() < 1e-9
    assert np.abs(t + twin_t).max() < 1e-9
    for one, aside in zip(s.tolist(), t.tolist(), strict=True):
        assert road.is_on_map(one, aside) == other.is_on_map(one, -aside)
        low, high = aside - 1.0, aside + 1.0
        assert road.is_drivable(one, low, high) == other.is_drivable(one, -high, -low)


@st.composite
def scenes(draw, name):
    """Draw a scene whose actors do anything that is neither chance nor always to the left."""
    lanes = MAPS[name].lanes
    ego = draw(st.integers(0, lanes - 1))
    beside = st.integers(-ego, lanes + MAPS[name].oncoming_lanes - 1 - ego)
    metres = st.integers(-150, 150).map(lambda centimetres: centimetres / 25)
    actors = []
    for behaviour in draw(
        st.lists(st.sampled_from(sorted({*BUILT_IN} - BY_CHANCE - TO_THE_LEFT)), max_size=4)
    ):
        lane, parameters = draw(beside), {}
        for key, limits in BUILT_IN[behaviour].kind.parameters.items():
            if key == "lanes":
                parameters[key] = (
                    float(draw(beside.filter(lambda to, lane=lane: abs(to - lane) < 4))) - lane
                )
            elif draw(st.booleans()):
                parameters[key] = draw(st.integers(1, 9)) / 10 * (limits.maximum - limits.minimum)
                parameters[key] = round(parameters[key] + limits.minimum, 3)
        if BUILT_IN[behaviour].needs_other and not actors:
            continue
        actors.append(
            {
                "id": f"actor-{len(actors)}",
                "asset": "car",
                "placement": {
                    "ahead_m": draw(st.integers(-60, 90)) + 0.37,
                    "lane": lane,
                    "offset_m": draw(metres),
                    "heading_deg": draw(st.sampled_from([0, 0, 90, -90, 17, -121.3])),
                },
                "behaviour": {
                    "name": behaviour,
                    "parameters": parameters,
                    "trigger": {"kind": draw(st.sampled_from(["time", "ttc"])), "value": 1.5},
                    "other": actors[-1]["id"] if BUILT_IN[behaviour].needs_other else None,
                },
            }
        )
    return scene_of(name, ego, actors, draw(st.floats(0.0, 20.0)))


def scene_of(name, ego, actors, speed, **more):
    return Scene.parse(
        {
            "id": "a",
            "scenario_id": "a",
            "map": name,
            "ego": {"speed": speed, "lane": ego},
            "actors": actors,
            "hazard": {"weather": {"cloud_cover": 1.0}},
            "decision": {"kind": "time", "value": 2.0},
            **more,
        }
    )


def assert_mirrored(roads, scene, drivers, steps=80):
    """Drive a scene and its mirror image, and compare them step by step."""
    lanes = len(roads[0].ego_lanes)
    worlds = [
        KinematicWorld(road, one, FLAT_CATALOGUE, 1)
        for road, one in zip(roads, (scene, mirrored(scene, lanes)), strict=True)
    ]
    for _ in range(steps):
        state, twin = (world.state() for world in worlds)
        apart = state.poses - MIRROR * twin.poses
        apart[:, 3] -= 2.0 * np.pi * np.rint(apart[:, 3] / (2.0 * np.pi))
        assert np.abs(apart).max() < ROUNDING
        assert np.abs(state.speeds - twin.speeds).max() < ROUNDING
        assert np.allclose(state.gaps, twin.gaps, atol=ROUNDING)
        assert state.off_road == twin.off_road
        for world, driver, now in zip(worlds, drivers, (state, twin), strict=True):
            if hasattr(driver, "look"):
                driver.look(now)
            world.step(driver.act(world.observe()))
    return worlds


@given(
    named=st.sampled_from(["urban_three_lane", "rural_curve"]).flatmap(
        lambda name: st.tuples(st.just(name), scenes(name))
    ),
    action=st.sampled_from(["keep_speed", "change_lane_left", "emergency_brake"]),
)
@settings(max_examples=30)
def test_mirrored_scenes_move_in_mirror_images(pair, named, action):
    name, scene = named
    drivers = [ActionDriver(one, 0.3) for one in (action, swapped(action))]
    worlds = assert_mirrored(pair(name), scene, drivers)
    for tried in ("change_lane_left", "change_lane_right", "stop"):
        passes = [
            world.is_passed(way, Variation(0.5, 1.0, 1.0), 4.0)
            for world, way in zip(worlds, (tried, swapped(tried)), strict=True)
        ]
        assert passes[0] == passes[1]


@given(motion=sound_motions(), heading=st.sampled_from([0.0, 12.5, -101.0]))
@settings(max_examples=30)
def test_mirrored_motions_move_in_mirror_images(pair, motion: Motion, heading):
    if motion.swing or motion.drift or (motion.walk and motion.walk.back):
        return  # They begin or turn to one side.
    carrier = {
        "id": "carrier",
        "asset": "car",
        "placement": {"ahead_m": 30.0, "offset_m": 0.3},
        "behaviour": {"name": "follow_lane", "parameters": {"speed": 6.0}},
    }
    mover = {
        "id": "mover",
        "asset": "adult",
        "placement": {"ahead_m": 30.1, "offset_m": 0.5, "heading_deg": heading},
        "behaviour": {
            "name": motion.id,
            "trigger": {"value": 0.5},
            "other": "carrier" if motion.frame == "other" else None,
        },
    }
    scene = scene_of("rural_curve", 0, [carrier, mover], 8.0, motions=[motion.model_dump()])
    assert_mirrored(pair("rural_curve"), scene, [ActionDriver("keep_speed") for _ in range(2)])


@given(
    scene=scenes("urban_three_lane"),
    driver=st.sampled_from([RSSDriver, R157Driver, RuleBasedDriver]),
)
@settings(max_examples=15)
def test_drivers_in_mirror_images_drive_alike(pair, scene, driver):
    assert_mirrored(pair("urban_three_lane"), scene, [driver(), driver()])
