import csv
import re
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._episode import ACTIONS
from oodscen.driving._roads.building import find_map, load_corridor
from oodscen.errors import DataError
from oodscen.interchange import verdict
from oodscen.interchange._moving import UnrenderedSimulator
from oodscen.interchange._recording import replayed
from oodscen.interchange._traces.osi_writing import osi_trace
from oodscen.interchange._verdicts.plausibility import (
    check_motion,
    check_steps,
)
from oodscen.interchange._verdicts.poses import PlayedPoses, read_poses
from oodscen.interchange._verdicts.verdict import _speeds
from oodscen.interchange._writing.scenario import to_openscenario
from oodscen.stages._simulate import simulate
from tests.interchange.playing import centres
from tests.interchange.staging import SCENES, catalogue


def played(scene, action):
    """Return the poses that a player makes of the exported replay."""
    truth = replayed(scene, UnrenderedSimulator(catalogue()), action, 0)
    poses = centres(to_openscenario(scene, catalogue(), action=action).xosc, truth.time)
    names = tuple(sorted(poses))
    return PlayedPoses(names, truth.time, np.stack([poses[name] for name in names], axis=1))


@pytest.mark.parametrize("scene", SCENES[::3], ids=lambda one: one.id)
def test_a_played_replay_has_the_verdict_of_the_simulation(scene):
    action = ACTIONS[SCENES.index(scene) % 4]
    ours = simulate(
        scene, UnrenderedSimulator(catalogue()), actions=(action,), render=False
    ).episode
    found = verdict(scene, played(scene, action), catalogue(), driver="player")
    outcome = ours.actions[action]
    assert (found.decision_s, found.decision_fired) == (ours.decision_s, ours.decision_fired)
    assert found.is_complete
    passed = not outcome.contacts and not outcome.off_road
    assert found.outcome.safe == passed
    assert found.outcome.contacts == outcome.contacts
    assert found.outcome.off_road == outcome.off_road
    assert found.outcome.margin_m == pytest.approx(outcome.margin_m, abs=0.01)
    assert found.drive.passed == passed
    assert found.drive.driver == "player"


def along(x):
    """Return the speeds found for one body on a straight road."""
    poses = np.zeros((len(x), 1, 4))
    poses[:, 0, 0] = x
    road = load_corridor(find_map("urban_avenue", catalogue()))
    return _speeds(0.05 * np.arange(len(x)), poses, road, ())[:, 0]


@given(
    st.lists(st.tuples(st.integers(3, 20), st.floats(-8, 4)), min_size=1, max_size=6),
    st.floats(0, 40),
)
def test_speeds_of_poses_are_exact_where_acceleration_changes(stretches, speed):
    accelerations = np.repeat([a for _, a in stretches], [count for count, _ in stretches])
    speeds = speed + 0.05 * np.r_[0.0, np.cumsum(accelerations)]
    speeds -= min(0.0, speeds.min())
    found = along(np.r_[0.0, np.cumsum(0.025 * (speeds[1:] + speeds[:-1]))])
    assert found[4:] == pytest.approx(speeds[4:], abs=1e-6)


@given(
    st.floats(-8.0, 4.0).filter(lambda value: abs(value) > 0.1),
    st.integers(4, 30),
    st.floats(0.5, 30.0),
)
def test_a_body_that_moves_by_the_speed_before_each_step_brakes_no_harder(
    acceleration, at, slowest
):
    steps = np.arange(40)
    speeds = 0.05 * acceleration * np.maximum(steps - at, 0)
    speeds += slowest - speeds.min()
    found = along(np.r_[0.0, np.cumsum(0.05 * speeds[:-1])])
    assert np.abs(found[4:] - speeds[4:]).max() <= 0.05 * abs(acceleration) + 1e-9
    assert np.abs(np.diff(found[4:])).max() <= 0.05 * abs(acceleration) + 1e-9


@given(st.floats(0.1, 40), st.floats(0.0, 1.0))
def test_a_body_that_stops_within_a_step_is_at_rest_at_its_end(speed, share):
    ways = 0.05 * speed * np.r_[np.ones(8), share * 0.5, np.zeros(4)]
    assert along(np.r_[0.0, np.cumsum(ways)])[9:] == pytest.approx(0.0, abs=1e-9)


def rows(poses):
    for step, time in enumerate(poses.time):
        for row, name in enumerate(poses.names):
            yield float(time), name, tuple(map(float, poses.poses[step, row]))


def same(one, other):
    order = [one.names.index(name) for name in other.names]
    return np.allclose(one.poses[:, order], other.poses, atol=1e-6) and np.allclose(
        one.time, other.time, atol=1e-6
    )


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_poses_come_back_from_csv(tmp_path, end):
    poses = played(SCENES[0], "stop")
    path = tmp_path / "scene.csv"
    lines = ["time, name, x, y, z, h"]
    lines += [f"{time:.6f},{name},{x},{y},{z},{h}" for time, name, (x, y, z, h) in rows(poses)]
    path.write_text(end.join(lines), newline="")
    assert same(poses, read_poses(path))


def test_poses_come_back_from_the_log_of_esmini(tmp_path):
    poses = played(SCENES[0], "stop")
    path = tmp_path / "scene.csv"
    columns = (
        "Entity_Name [-]",
        "bb_x [m]",
        "World_Position_X [m]",
        "World_Position_Y [m]",
        "World_Position_Z [m]",
        "World_Heading_Angle [rad]",
        "World_Pitch_Angle [rad]",
    )
    head = ["Index [-]", "TimeStamp [s]"]
    head += [f"#{n + 1} {name}" for n in range(len(poses.names)) for name in columns]
    lines = ["esmini GIT REV: x", "Number of Vehicles: 2", ", ".join(head)]
    for step, time in enumerate(poses.time):
        cells = [str(step), f"{time:.6f}"]
        for name, (x, y, z, h) in zip(poses.names, poses.poses[step], strict=True):
            x, y = x - 1.5 * np.cos(h), y - 1.5 * np.sin(h)
            cells += [name, "1.5", *(f"{value:.8f}" for value in (x, y, z, h, 0.0))]
        lines += [", ".join(cells), ""]
    path.write_text("\n".join(lines))
    assert same(poses, read_poses(path))


def test_a_name_without_end_in_the_log_of_esmini_is_refused(tmp_path):
    head = (
        "Entity_Name [-],bb_x [m],World_Position_X [m],World_Position_Y [m],World_Position_Z [m],"
    )
    head += "World_Heading_Angle [rad],World_Pitch_Angle [rad]"
    columns = ["Index [-]", "TimeStamp [s]", *(f"#1 {name}" for name in head.split(","))]
    path = tmp_path / "scene.csv"
    cells = f"0, 0.0, {'e' * 9999}, 1.5, 0, 0, 0, 0, 0"
    path.write_text(
        "\n".join(["esmini GIT REV: x", "Number of Vehicles: 1", ", ".join(columns), cells])
    )
    with pytest.raises(DataError, match="a name has 9,999 characters"):
        read_poses(path)


def test_a_short_line_of_the_log_of_esmini_is_named_so(tmp_path):
    columns = ("Entity_Name [-]", "bb_x [m]", "World_Position_X [m]", "World_Position_Y [m]")
    columns += ("World_Position_Z [m]", "World_Heading_Angle [rad]", "World_Pitch_Angle [rad]")
    head = ["Index [-]", "TimeStamp [s]", *(f"#{n} {name}" for n in (1, 2) for name in columns)]
    cells = ["0", "0.0", *(["ego"] + ["0"] * 6), *(["other"] + ["0"] * 6)]
    path = tmp_path / "scene.csv"
    for count in range(1, len(cells)):
        lines = ("esmini GIT REV: x", ", ".join(head), ", ".join(cells), ", ".join(cells[:count]))
        path.write_text("\n".join(lines))
        with pytest.raises(DataError, match="line 4: is short"):
            read_poses(path)
    path.write_text("\n".join(lines).replace("#2 bb_x", "#2 box"))
    with pytest.raises(DataError, match="no column '#2 bb_x"):
        read_poses(path)


def test_bodies_that_come_and_go_are_too_many_before_memory_ends(tmp_path):
    path = tmp_path / "scene.csv"
    rows = "".join(f"{number},body {number},0,0,0\n" for number in range(5_000))
    path.write_text(f"time,name,x,y,h\n{rows}")
    with pytest.raises(DataError, match="5,000 bodies at 5,000 moments are too many"):
        read_poses(path)


def test_a_trace_is_known_by_its_suffix_in_any_case(tmp_path):
    lower, upper = tmp_path / "run.osi", tmp_path / "RUN.OSI"
    for path in (lower, upper):
        path.write_bytes(osi_trace(SCENES[0], catalogue()))
    assert same(read_poses(lower), read_poses(upper))


def test_poses_come_back_from_osi(tmp_path):
    path = tmp_path / "scene.osi"
    for scene in SCENES[::10]:
        truth = replayed(scene, UnrenderedSimulator(catalogue()), "stop", 0)
        trace = osi_trace(scene, catalogue(), action="stop")
        path.write_bytes(trace)
        assert same(PlayedPoses(truth.ids, truth.time, truth.poses), read_poses(path))
    for end in (1, 5, 20, 100):
        path.write_bytes(trace[:-end])
        with pytest.raises(DataError):
            read_poses(path)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "time,name,x,y\n0,ego,1,2",
        "time,name,x,y,h\n0,ego,1,2,3",
        "time,name,x,y,h\n0,ego,1,2,3\n1,ego,nan,2,3",
        "time,name,x,y,h\n0,ego,1,2,3\n1,ego,1,2",
        "time,name,x,y,h\n0,ego,1,2,3\n1,ego,1,2,3\n1,ego,1,5,3",
        "time,name,x,y,h\n0,ego,1,2,3\n1,ego,1,2,3,4",
        "time,name,x,y,h,z\n0,ego,1,2,3,4\n1,ego,1,2,3",
        "time,name,x,y,h,x\n0,ego,1,2,3,1\n1,ego,1,2,3,1",
        "time,name,x,y,h\n0,ego,1,2,3\n1,ego,1,1_0,3",
        "time,name,x,y,h\n0,ego,1,2,3\n١,ego,1,1,3",
        f"time,name,x,y,h\n0,ego,1,2,3\n1,{'x' * 200_000},1,1,3",
        "esmini GIT REV: x\nno columns",
        "esmini GIT REV: x\nIndex [-], TimeStamp [s], #1 Entity_Name [-]\n0, 0.0, ego",
    ],
)
def test_faulty_files_are_refused(text, tmp_path):
    path = tmp_path / "scene.csv"
    path.write_text(text)
    with pytest.raises(DataError):
        read_poses(path)


def test_a_long_name_is_refused_whatever_the_limit_of_the_process(tmp_path):
    path = tmp_path / "scene.csv"
    path.write_text(f"time,name,x,y,h\n0,ego,1,2,3\n1,{'x' * 200_000},1,1,3")
    before = csv.field_size_limit(10_000_000)
    try:
        with pytest.raises(DataError, match="200,000 characters"):
            read_poses(path)
    finally:
        csv.field_size_limit(before)


def test_a_run_without_an_actor_is_refused():
    scene = SCENES[0]
    poses = played(scene, "stop")
    alone = poses.names.index("ego")
    with pytest.raises(DataError):
        verdict(scene, PlayedPoses(("ego",), poses.time, poses.poses[:, [alone]]), catalogue())


def change(poses, kept=slice(None), time=lambda one: one, pose=lambda one: one):
    """Return a run with other rows, times and poses."""
    return PlayedPoses(poses.names, time(poses.time[kept]), pose(poses.poses[kept].copy()))


@cache
def crash():
    """Return a scene that ends in a contact when the speed is kept, the run, and its verdict."""
    for scene in SCENES[2:]:
        poses = played(scene, "keep_speed")
        found = verdict(scene, poses, catalogue())
        hit = set(found.outcome.contacts) & set(scene.hazard.actors)
        if hit and found.decision_s > 1.5 and np.ptp(poses.poses[0, :, 1]) > 1.0:
            return scene, poses, found
    raise AssertionError("no scene ends in a contact")


def moved(poses, rows, by):
    poses[:, rows] += by
    return poses


def others(poses):
    return [row for row, name in enumerate(poses.names) if name != "ego"]


def still(poses):
    poses[:] = poses[:1]
    return poses


def swapped(poses):
    row, ego = others(poses)[0], poses.names.index("ego")
    names = list(poses.names)
    names[row], names[ego] = names[ego], names[row]
    return PlayedPoses(tuple(names), poses.time, poses.poses)


INCONCLUSIVE = {
    "first second": lambda one: change(one, one.time <= 1.0),
    "standing": lambda one: change(one, pose=still),
    "elsewhere": lambda one: change(one, pose=lambda p: moved(p, others(one), [300.0, 0, 0, 0])),
    "above": lambda one: change(one, pose=lambda p: moved(p, others(one), [0, 0, 30.0, 0])),
    "mirrored": lambda one: change(one, pose=lambda p: p * [1, -1, 1, -1]),
    "turned": lambda one: change(one, pose=lambda p: moved(p, others(one), [0, 0, 0, 1.5])),
    "rear axle": lambda one: change(
        one, pose=lambda p: moved(p, one.names.index("ego"), [-1.35, 0, 0, 0])
    ),
    "slow motion": lambda one: change(one, time=lambda t: 2.0 * t),
    "fast motion": lambda one: change(one, time=lambda t: 0.5 * t),
    "swapped": swapped,
}


@pytest.mark.parametrize("name", INCONCLUSIVE)
def test_a_run_that_is_not_of_the_scene_or_not_whole_is_inconclusive(name):
    scene, poses, _ = crash()
    found = verdict(scene, INCONCLUSIVE[name](poses), catalogue())
    assert found.inconclusive
    assert found.outcome is None
    assert (found.drive.status, found.drive.passed) == ("inconclusive", False)
    assert found.drive.error == found.inconclusive


def test_a_hazard_that_leaves_its_course_makes_a_run_inconclusive():
    scene, poses, _ = crash()
    row = poses.names.index(next(iter(scene.hazard.actors)))
    away = np.linspace(0.0, 40.0, len(poses.time))[:, None] * [0.0, 1.0, 0.0, 0.0]
    strays = change(poses, pose=lambda p: moved(p, row, away))
    assert "from its course" in verdict(scene, strays, catalogue()).inconclusive


@cache
def stopping():
    """Return a scene in which stopping is safe, the run, and its verdict."""
    for scene in SCENES:
        poses = played(scene, "stop")
        found = verdict(scene, poses, catalogue())
        if found.outcome.safe:
            return scene, poses, found
    raise AssertionError("stopping is nowhere safe")


def test_five_poses_a_second_can_be_judged():
    scene, poses, whole = stopping()
    found = verdict(scene, change(poses, slice(None, None, 4)), catalogue())
    assert found.outcome.safe
    assert found.decision_s == pytest.approx(whole.decision_s, abs=0.2)


def test_a_run_that_ends_before_the_horizon_is_inconclusive():
    scene, poses, whole = stopping()
    early = change(poses, poses.time < whole.decision_s + 0.5 * scene.horizon_s)
    found = verdict(scene, early, catalogue())
    assert "before the horizon" in found.inconclusive
    assert not found.is_complete


def leaping(poses):
    """Let the ego leap over 30 m."""
    _, _, found = crash()
    row = poses.names.index("ego")
    after = poses.time > found.decision_s + 0.2
    return change(
        poses, pose=lambda p: moved(p, row, np.where(after, 30.0, 0.0)[:, None] * [1, 0, 0, 0])
    )


def across(poses, row, since):
    """Let a body head across its motion from a time on."""
    turned = np.where(poses.time > since, np.pi / 2, 0.0)[:, None] * [0, 0, 0, 1]
    return change(poses, pose=lambda p: moved(p, row, turned))


UNUSABLE = {
    "height": lambda one: change(
        one,
        pose=lambda p: moved(p, one.names.index("ego"), (one.time > 1.0)[:, None] * [0, 0, 9, 0]),
    ),
    "sideways": lambda one: across(one, one.names.index("ego"), 1.0),
    "milliseconds": lambda one: change(one, time=lambda t: 1000.0 * t),
    "minutes": lambda one: change(one, time=lambda t: t / 60.0),
    "hole": lambda one: change(one, np.abs(one.time - one.time[-1] + 0.6) > 0.3),
    "degrees": lambda one: change(one, pose=lambda p: p * [1, 1, 1, np.degrees(1.0)]),
    "leap": leaping,
}


@pytest.mark.parametrize("name", UNUSABLE)
def test_a_run_with_a_hole_a_leap_or_a_wrong_unit_is_refused(name):
    scene, poses, _ = crash()
    if name == "degrees":  # Headings along the x axis are the same in degrees.
        scene, poses = oblique()
    with pytest.raises(DataError):
        verdict(scene, UNUSABLE[name](poses), catalogue())


@pytest.mark.parametrize("angle", [25, 30, 90, 180])
def test_an_ego_that_is_turned_all_the_way_is_not_taken_for_one_in_degrees(angle):
    scene, poses, _ = crash()
    ego = poses.names.index("ego")
    turned = change(poses, pose=lambda p: moved(p, ego, [0, 0, 0, np.radians(angle)]))
    try:
        told = verdict(scene, turned, catalogue()).inconclusive
    except DataError as error:
        told = str(error)
    assert f"{angle} degrees" in told


def oblique():
    for scene in SCENES:
        poses = played(scene, "keep_speed")
        if np.abs(poses.poses[0, :, 3]).max() > 0.5:
            return scene, poses
    raise AssertionError("all bodies head along the x axis")


def test_the_first_hole_is_named_by_its_time():
    scene, poses, _ = crash()
    with pytest.raises(DataError, match=r"from 0.95 s to 1.5 s"):
        verdict(scene, change(poses, (poses.time < 0.97) | (poses.time > 1.48)), catalogue())


@pytest.mark.filterwarnings("error")
@given(
    st.data(),
    st.sampled_from("xyzh"),
    st.floats(1.1e7, exclude_min=True) | st.floats(max_value=-1.1e7),
)
def test_a_value_that_no_run_has_is_refused_with_its_body_and_time(data, column, value):
    scene, poses, _ = crash()
    step, row = (data.draw(st.integers(0, size - 1)) for size in poses.poses.shape[:2])
    wrong = change(poses)
    wrong.poses[step, row, "xyzh".index(column)] = value
    with pytest.raises(
        DataError, match=f"{poses.names[row]}: {column} is .* at {poses.time[step]:g} s"
    ):
        verdict(scene, wrong, catalogue())


@given(st.floats(0.2001, 10.0))
def test_steps_are_refused_only_if_they_are_told_to_be_too_long(step_s):
    told = re.compile(r"steps are ([\d.e+]+) s, and at most ([\d.]+) s")
    try:
        check_steps(step_s * np.arange(10))
    except DataError as error:
        found = told.search(str(error))
        assert float(found[1]) > float(found[2])
    else:
        assert step_s <= 0.2003


@given(st.sampled_from([0.02, 0.05, 0.1, 0.2]), st.floats(0.0, 1.1), st.floats(5.0, 40.0))
def test_vehicles_turn_only_so_fast_at_speed_and_as_they_like_at_rest(step_s, excess, speed):
    time = step_s * np.arange(40)
    heading = np.where(time > time[20], np.pi * step_s + 0.36 + excess, 0.0)
    poses = np.zeros((40, 2, 4))
    poses[:, :, 0] = speed * time[:, None]
    poses[:, 1, 3] = heading
    names = ("ego", "other")
    check_motion(names, time, poses, steered=[0])
    with pytest.raises(DataError, match=r"other: turns by \d+ degrees"):
        check_motion(names, time, poses, steered=[0, 1])
    poses[:, 1, 0] = 0.0
    check_motion(names, time, poses, steered=[0, 1])


@given(st.floats(0.0, 3.0), st.floats(0.05, 3.0), st.floats(-1.5, 1.5), st.floats(0.0, 20.0))
def test_headings_off_the_motion_are_noted_with_their_time(since, lasts, angle, speed):
    time = 0.05 * np.arange(160)
    poses = np.zeros((160, 4))
    poses[:, 0] = speed * time
    poses[(time >= since) & (time < since + lasts), 3] = angle
    note = check_motion(["ego"], time, poses[:, None], [])
    if lasts > 0.6 and abs(angle) > 0.36 and speed > 2.1:
        told = re.fullmatch(r"ego heads (\d+) degrees off its motion for (.*) s from (.*) s", note)
        assert float(told[1]) == pytest.approx(abs(np.degrees(angle)), abs=1.0)
        assert [float(told[2]), float(told[3])] == pytest.approx([lasts, since], abs=0.4)
    elif lasts < 0.2 or abs(angle) < 0.34 or speed < 1.9:
        assert not note


def noisy(time):
    jitter = np.random.default_rng(0).uniform(-0.01, 0.01, len(time))
    jitter[[0, -1]] = 0.0
    return np.sort(time + jitter)


def resampled(poses, time):
    flat = poses.poses.reshape(len(poses.time), -1)
    flat = np.stack([np.interp(time, poses.time, one) for one in flat.T], axis=1)
    return PlayedPoses(poses.names, time, flat.reshape(len(time), *poses.poses.shape[1:]))


def every(dt, poses):
    """Return times at even steps to the last pose."""
    return np.linspace(0.0, poses.time[-1], round(poses.time[-1] / dt) + 1)


HONEST = {
    "second step": lambda one: change(one, slice(1, None)),
    "half a second": lambda one: change(one, slice(10, None)),
    "first pose twice": lambda one: PlayedPoses(
        one.names,
        np.append(one.time, 2.0 * one.time[-1] - one.time[-2]),
        np.concatenate([one.poses[:1], one.poses]),
    ),
    "millimetres": lambda one: change(one, pose=lambda p: p.round(3)),
    "jitter": lambda one: resampled(one, noisy(one.time)),
    "fine": lambda one: resampled(one, every(0.02, one)),
    "coarse": lambda one: resampled(one, every(0.1, one)),
}


@pytest.mark.parametrize("name", HONEST)
def test_small_differences_of_players_do_not_change_a_verdict(name):
    scene, poses, expected = crash()
    found = verdict(scene, HONEST[name](poses), catalogue())
    assert found.outcome.contacts == expected.outcome.contacts
    assert not found.inconclusive
    assert not found.notes


@pytest.mark.parametrize("since", [-100.0, 1_700_000_000.0])
def test_another_start_of_time_is_noted(since):
    scene, poses, expected = crash()
    found = verdict(scene, change(poses, time=lambda t: t + since), catalogue())
    assert found.decision_s == pytest.approx(expected.decision_s, abs=1e-5)
    assert found.outcome.contacts == expected.outcome.contacts
    assert f"{since:g}" in found.notes[0]


def test_bodies_beside_the_scene_are_noted():
    scene, poses, _ = crash()
    more = PlayedPoses(
        (*poses.names, "x"), poses.time, poses.poses[:, [*range(len(poses.names)), 0]]
    )
    assert "x" in verdict(scene, more, catalogue()).notes[0]


def test_bodies_without_a_name_are_noted(tmp_path):
    scene, poses, _ = crash()
    path = tmp_path / "scene.csv"
    lines = ["time,name,x,y,z,h"]
    for time, name, (x, y, z, h) in rows(poses):
        lines += [f"{time},{name},{x},{y},{z},{h}"]
        lines += [f"{time},,{x + away},{y},{z},{h}" for away in (3, 6) if name == "ego"]
    path.write_text("\n".join(lines))
    assert read_poses(path).unnamed == 2
    assert "2 without a name" in verdict(scene, path, catalogue()).notes[0]
