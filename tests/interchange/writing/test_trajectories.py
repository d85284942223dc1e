"""Courses as polylines: their vertices, their phases, and positions in the world and relative to a body itself."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from lxml import etree

from oodscen.data import Actor, Behaviour, Ego, Hazard, Placement, Scene, Trigger
from oodscen.driving._roads.building import load_corridor
from oodscen.interchange._writing.entities import entities
from oodscen.interchange._writing.reactions import reactions
from oodscen.interchange._writing.scenario import to_openscenario
from oodscen.interchange._writing.trajectories import (
    own_position,
    phases,
    reference_poses,
    vertices,
    world_position,
    write_trajectory,
)
from tests.interchange.staging import catalogue

STEP_S = 0.05
EXACT = 2e-5
POSES = st.tuples(*[st.floats(-200.0, 200.0)] * 3, st.floats(-7.0, 7.0), st.floats(-0.3, 0.3)).map(
    np.array
)
PUSHES = arrays(np.float64, st.tuples(st.integers(1, 40), st.just(5)), elements=st.floats(-5, 5))
"""Accelerations of x, y, z, heading and pitch, each held for some steps."""


def course(pushes, held=4):
    speeds = np.cumsum(np.repeat(pushes, held, axis=0), axis=0) * STEP_S
    poses = np.cumsum(speeds, axis=0) * STEP_S
    return STEP_S * np.arange(len(poses)), poses


def between(time, vertex_times, vertex_poses):
    columns = [np.interp(time, vertex_times, column) for column in vertex_poses.T]
    return np.array(columns).T


def written(write, pose):
    """Return the numbers that a writer gives a position."""
    position = etree.Element("Position")
    write(position, pose)
    return numbers(position)


def numbers(position):
    """Return the numbers of a position and its orientation by name."""
    return {
        name: float(text)
        for element in position.iter()
        for name, text in element.attrib.items()
        if name not in ("entityRef", "type")
    }


def composed(origin, relative):
    """Return the pose that is relative to an origin, turned about z, then about y, as ISO 8855 has it."""
    h, p = origin[3:]
    about_z = np.array([[math.cos(h), -math.sin(h), 0], [math.sin(h), math.cos(h), 0], [0, 0, 1]])
    about_y = np.array([[math.cos(p), 0, math.sin(p)], [0, 1, 0], [-math.sin(p), 0, math.cos(p)]])
    place = origin[:3] + about_z @ about_y @ [relative[key] for key in ("dx", "dy", "dz")]
    return np.array([*place, h + relative["h"], p + relative.get("p", 0.0)])


@given(PUSHES)
def test_the_lines_between_vertices_are_the_course(pushes):
    time, poses = course(pushes)
    times, kept = vertices(time, poses)
    assert (times[0], times[-1]) == (time[0], time[-1])
    assert np.all(np.diff(times) > 0.0)
    assert np.abs(between(time, times, kept) - poses).max() <= 2 * EXACT + 1e-9


@given(st.lists(st.floats(1.0, 30.0), min_size=1, max_size=4), st.integers(2, 60))
def test_only_turns_in_space_and_time_need_vertices(speeds, held):
    x = np.cumsum([0.0, *np.repeat(speeds, held)]) * STEP_S
    poses = np.zeros((len(x), 5))
    poses[:, 0] = x
    times, kept = vertices(STEP_S * np.arange(len(x)), poses)
    assert len(times) <= len(speeds) + 1
    assert np.abs(between(STEP_S * np.arange(len(x)), times, kept) - poses).max() <= EXACT + 1e-9


@given(st.floats(0.01, 1.0))
def test_a_body_that_turns_on_the_spot_moves_by_a_hair(rate):
    poses = np.zeros((40, 5))
    poses[:, 3] = rate * STEP_S * np.arange(40)
    _, kept = vertices(STEP_S * np.arange(40), poses)
    assert np.hypot(*np.diff(kept[:, :2], axis=0).T).min() > 0.0
    assert np.hypot(*kept[:, :2].T).max() <= EXACT + 1e-12


@given(st.lists(st.booleans(), max_size=60))
def test_phases_are_parted_by_four_steps_of_rest(moves):
    poses = np.zeros((len(moves) + 1, 5))
    poses[1:, 0] = np.cumsum(moves)
    spans = phases(poses)
    inside = np.zeros(len(moves), dtype=bool)
    for first, last in spans:
        assert moves[first]
        assert moves[last - 1]
        assert not inside[max(0, first - 4) : last].any()
        inside[first:last] = True
        runs = "".join("x" if one else " " for one in moves[first:last]).split("x")
        assert max(map(len, runs)) < 4
    assert not (np.array(moves, dtype=bool) & ~inside).any()


@given(POSES, POSES)
def test_a_relative_position_added_to_its_origin_is_the_pose(origin, pose):
    found = composed(origin, written(own_position("car", origin), pose))
    assert np.abs(found - pose).max() < 2e-6


def test_ahead_is_along_the_slope():
    uphill = np.array([5.0, 6.0, 7.0, math.pi / 2, -0.1])
    pose = uphill + np.array([0.0, 10 * math.cos(0.1), 10 * math.sin(0.1), 0.2, 0.04])
    found = written(own_position("car", uphill), pose)
    assert found == pytest.approx({"dx": 10.0, "dy": 0.0, "dz": 0.0, "h": 0.2, "p": 0.04}, abs=1e-6)


@given(POSES, POSES)
def test_on_the_level_a_relative_position_has_no_pitch(origin, pose):
    origin[4] = pose[4] = 0.0
    found = written(own_position("car", origin), pose)
    assert set(found) == {"dx", "dy", "dz", "h"}
    assert found["dz"] == pytest.approx(pose[2] - origin[2], abs=1e-6)


@given(POSES)
def test_a_position_in_the_world_is_the_pose(pose):
    found = written(world_position, pose)
    assert found == pytest.approx(dict(zip("xyzhp", pose, strict=True)) | {"r": 0.0}, abs=1e-6)


@pytest.mark.parametrize("is_relative", [False, True])
def test_vertices_have_the_times_that_are_given(is_relative):
    time = 2.0 + STEP_S * np.arange(21)
    poses = np.zeros((21, 5))
    poses[:, 0] = np.arange(21)
    action = etree.Element("Action")
    write_trajectory(action, "course", time, poses, is_relative=is_relative)
    assert [float(one.get("time")) for one in action.iter("Vertex")] == [2.0, 3.0]
    timing = action.find(".//Timing")
    assert timing.get("domainAbsoluteRelative") == ("relative" if is_relative else "absolute")
    assert (timing.get("scale"), timing.get("offset")) == ("1", "0")


def test_a_car_that_brakes_on_a_hill_keeps_its_pitch():
    """The reaction, added to the pose at the trigger, is the course of the run, pitch included."""
    scene = Scene(
        id="hill",
        scenario_id="hill",
        map="rural_hill",
        ego=Ego(speed=15.0),
        actors=(
            Actor(
                id="car",
                asset="car",
                placement=Placement(ahead_m=120.0),
                behaviour=Behaviour(
                    name="hard_brake",
                    trigger=Trigger(kind="distance", value=110.0, actor="car"),
                    parameters={"speed": 10.0},
                ),
            ),
        ),
        hazard=Hazard(actors={"car": None}),
        decision=Trigger(kind="distance", value=108.0, actor="car"),
    )
    run = reactions(scene, catalogue(), 0)
    step = run.triggered["car"]
    corridor = load_corridor("rural_hill", catalogue())
    poses = reference_poses(run.nominal, 1, entities(scene, catalogue())[1], corridor)[step:]
    assert np.ptp(poses[:, 4]) > 0.01
    time = run.nominal.time[step:] - run.nominal.time[step]

    root = etree.fromstring(to_openscenario(scene, catalogue(), mode="reactive").xosc)
    line = [one for one in root.iter("Vertex") if one.find(".//RelativeObjectPosition") is not None]
    assert line
    for vertex in line:
        relative = numbers(vertex.find("Position"))
        now = between([float(vertex.get("time"))], time, poses)[0]
        assert np.abs(composed(poses[0], relative) - now).max() < EXACT
