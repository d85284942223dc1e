"""Traces: what states imply, as a table that survives being written."""

import errno
import os
from dataclasses import replace

import numpy as np
import pytest

from oodscen import simulate
from oodscen.data._scene import Actor, Behaviour, Ego, Hazard, Placement, Scene, Trigger
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.projection import places
from oodscen.driving._trace import Course, Trace, least_time_to_collision
from oodscen.driving._trace_table import COLUMNS, from_arrow
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.errors import DataError, FolderTaken, OodscenError, UsageError
from oodscen.protocols import Control
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE
from oodscen.testing._scenes import example_scene


def actor(name, asset, behaviour, ahead, **place):
    return Actor(
        id=name,
        asset=asset,
        placement=Placement(ahead_m=ahead, **place),
        behaviour=Behaviour(name=behaviour),
    )


SCENE = Scene(
    id="busy",
    scenario_id="busy",
    map="urban_avenue",
    ego=Ego(speed=10.0),
    actors=(
        actor("lead", "car", "hard_brake", 22.0),
        actor("beside", "truck", "follow_lane", -10.0, lane=1),
        actor("pot", "plant_pot", "stand", 90.0),
    ),
    hazard=Hazard(actors={"lead": None}),
    decision=Trigger(value=1.0),
)


@pytest.fixture(scope="module")
def states():
    with FlatSimulator() as simulator:
        found = [simulator.reset(SCENE, 1)]
        for step in range(100):
            control = Control(-1.0 if step > 60 else 0.5, 0.01 if step % 20 < 10 else -0.01)
            found.append(simulator.step(control))
    return found


@pytest.fixture(scope="module")
def trace(states):
    return Trace.of(states, SCENE, FLAT_CATALOGUE)


def test_it_holds_what_the_states_hold(trace, states):
    assert trace.ids == states[0].ids
    assert trace.steps == len(states)
    for row in (0, 40, 100):
        state = states[row]
        for axis, name in enumerate(("x", "y", "z", "yaw")):
            np.testing.assert_array_equal(trace[name][row], state.poses[:, axis])
        np.testing.assert_array_equal(trace["speed"][row], state.speeds)
        np.testing.assert_array_equal(trace["gap_m"][row], state.gaps)
        assert (trace["time"][row] == state.time).all()


def test_velocities_and_accelerations_add_up(trace):
    dt = trace["time"][1, 0] - trace["time"][0, 0]
    for place, rate in (("x", "vx"), ("y", "vy"), ("speed", "acceleration")):
        total = trace[place][0] + trace[rate][1:].sum(axis=0) * dt
        np.testing.assert_allclose(total, trace[place][-1], atol=1e-9)
    beside = np.hypot(trace["vx"], trace["vy"])[:, 1]
    np.testing.assert_allclose(beside[1:], trace["speed"][1:, 1], atol=0.5)


def test_lanes_count_to_the_left_of_the_ego(trace):
    assert trace["lane"][0].tolist() == [0, 0, 1, 0]


def test_the_conflict_shows(trace):
    lead = trace.summary()["lead"]
    assert lead.min_ttc_s is not None
    assert lead.max_deceleration > 3.0
    assert trace.summary()["beside"].min_time_headway_s is None
    assert np.isinf(trace["ttc_s"][:, 0]).all()


@pytest.mark.parametrize("turned_from", [1.0, -1.0])
def test_braking_is_a_loss_of_speed_in_either_direction(trace, turned_from):
    """Driving off backwards is none."""
    speed = turned_from * np.repeat([0.0, 0.0, 1.0, 3.0, 2.5, 0.0], 4).reshape(6, 4)
    acceleration = np.vstack([np.zeros((1, 4)), np.diff(speed, axis=0)])
    columns = {name: column[:6] for name, column in trace.columns.items()}
    for steps, wanted in ((6, 2.5), (5, 0.5), (4, 0.0), (1, 0.0)):
        rates = {"speed": speed, "acceleration": acceleration}
        part = {name: column[:steps] for name, column in (columns | rates).items()}
        found = [one.max_deceleration for one in Trace(trace.ids, part).summary().values()]
        assert found == [wanted] * 3


def test_the_least_time_to_collision_of_a_state_is_that_of_its_row(trace, states):
    course = Course.of(SCENE, FLAT_CATALOGUE)
    for row in (0, 1, 30, 60, 100):
        before = states[row - 1] if row else None
        found = least_time_to_collision(before, states[row], course)
        assert found == pytest.approx(trace["ttc_s"][row, 1:].min())


def test_contact_has_no_time_left():
    with FlatSimulator() as simulator:
        hit = simulate(example_scene(), simulator, render=False, traces=True).rollouts["keep_speed"]
    met = hit.summary()["box"]
    assert (met.min_gap_m, met.min_ttc_s, met.pet_s) == (0.0, 0.0, 0.0)
    assert hit["contact"][-1].tolist() == [True, True]
    assert not hit["contact"][0].any()


@pytest.mark.parametrize("suffix", [".parquet", ".arrow", ".csv"])
def test_what_is_written_is_read(trace, tmp_path, suffix):
    again = Trace.load(trace.save(tmp_path / "new" / f"a{suffix}"))
    assert again.ids == trace.ids
    for name in COLUMNS:
        if name != "id":
            np.testing.assert_array_equal(again[name], trace[name])
    assert again.summary() == trace.summary()


def test_the_table_has_a_row_per_step_and_body(trace):
    table = trace.to_pandas()
    assert list(table) == list(COLUMNS)
    assert len(table) == len(trace) == trace.steps * 4
    assert table["off_road"].isna().sum() == trace.steps * 3
    assert table["ttc_s"].isna().sum() > 0
    assert not np.isinf(table["gap_m"]).any()


def test_files_that_are_no_trace_are_refused(trace, tmp_path):
    with pytest.raises(UsageError):
        trace.save(tmp_path / "a.txt")
    (tmp_path / "file").touch()
    with pytest.raises(OodscenError, match="cannot write"):
        trace.save(tmp_path / "file" / "a.csv")
    with pytest.raises(UsageError):
        Trace.of([], SCENE, FLAT_CATALOGUE)
    (tmp_path / "b.csv").write_text("step,time\n1,2\n")
    with pytest.raises(DataError) as caught:
        Trace.load(tmp_path / "b.csv")
    assert "id" in {issue.path for issue in caught.value.issues}
    (tmp_path / "c.parquet").write_bytes(b"nothing")
    with pytest.raises(DataError, match="malformed trace"):
        Trace.load(tmp_path / "c.parquet")
    for suffix in ("parquet", "arrow", "csv"):
        with pytest.raises(DataError, match=r"unreadable trace .*\n.*No such file"):
            Trace.load(tmp_path / f"missing.{suffix}")
        os.mkfifo(tmp_path / f"pipe.{suffix}")
        with pytest.raises(DataError, match=r"unreadable trace .*\n.*a pipe"):
            Trace.load(tmp_path / f"pipe.{suffix}")
    (tmp_path / "d.csv").write_bytes(b"\xff,x\n1,2\n")
    with pytest.raises(DataError, match="a column's name"):
        Trace.load(tmp_path / "d.csv")


@pytest.mark.parametrize(
    ("column", "index", "values"),
    [
        ("time", 1, [0.2] * 4 + [0.1] * 4),
        ("time", 1, [0.1] * 8),
        ("time", 1, [0.1] * 3 + [0.15] + [0.2] * 4),
        ("id", 2, ["lead", "ego", "beside", "pot"] * 2),
    ],
)
def test_a_table_that_no_states_imply_is_refused(trace, column, index, values):
    table = trace.to_arrow().slice(0, 8).set_column(index, column, [values])
    with pytest.raises(DataError) as caught:
        from_arrow(table, "memory")
    assert [issue.path for issue in caught.value.issues] == [column]


def test_a_file_stays_as_it_was_where_it_cannot_be_written_whole(trace, tmp_path, monkeypatch):
    file = trace.save(tmp_path / "a.parquet")
    before = file.read_bytes()

    def fail(_):
        raise OSError(errno.ENOSPC, "the disk is full")

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(OodscenError, match="the disk is full"):
        trace.save(file)
    assert file.read_bytes() == before
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.parametrize(
    ("column", "value", "fault"),
    [
        *((column, "abc", "must hold") for column in ("x", "step", "lane", "contact", "off_road")),
        *((column, "", "some rows have no value") for column in ("x", "step", "time", "contact")),
        *((column, "2.5", "must hold") for column in ("step", "lane", "contact")),
        ("y", "1e400", "some rows have no value"),
        ("id", "", "not every body's"),
    ],
)
def test_a_value_that_a_column_cannot_have_is_refused_and_the_column_named(
    trace, tmp_path, column, value, fault
):
    header, first, *rest = trace.save(tmp_path / "a.csv").read_text().splitlines()
    cells = first.split(",")
    cells[list(COLUMNS).index(column)] = value
    (tmp_path / "b.csv").write_text("\n".join([header, ",".join(cells), *rest]))
    with pytest.raises(DataError) as caught:
        Trace.load(tmp_path / "b.csv")
    ((issue),) = caught.value.issues
    assert issue.path == column
    assert fault in issue.message


def test_every_faulty_column_is_told(trace):
    table = trace.to_arrow()
    rows = len(table)
    bad = table.set_column(3, "x", [["a"] * rows]).set_column(4, "y", [[None] * rows])
    bad = bad.set_column(2, "id", [[[1]] * rows])
    with pytest.raises(DataError) as caught:
        from_arrow(bad, "memory")
    assert [issue.path for issue in caught.value.issues] == ["id", "x", "y"]
    with pytest.raises(DataError, match="2 times"):
        from_arrow(table.append_column("x", table["x"]), "memory")


def test_states_of_another_scene_or_out_of_order_are_refused(states):
    with pytest.raises(UsageError, match="busy"):
        Trace.of([*states[:2], replace(states[2], ids=("ego", "a"))], SCENE, FLAT_CATALOGUE)
    for order in (states[1::-1], [states[0], states[0]]):
        with pytest.raises(UsageError, match="order"):
            Trace.of(order, SCENE, FLAT_CATALOGUE)


@pytest.mark.parametrize("road", SHIPPED_MAPS, ids=lambda road: road.id)
def test_places_are_where_the_corridor_says(road):
    corridor = load_corridor(road)
    rng = np.random.Generator(np.random.PCG64(1))
    s = rng.uniform(-20.0, corridor.length + 20.0, 60)
    t = rng.uniform(-6.0, 6.0, 60)
    points = np.array([corridor.point(a, b) for a, b in zip(s.tolist(), t.tolist(), strict=True)])
    found = places(corridor, points[:, 0].copy(), points[:, 1].copy())
    for index, (x, y, _, heading) in enumerate(points.tolist()):
        expected = corridor.locate(x, y)
        np.testing.assert_allclose((found[0][index], found[1][index]), expected, atol=1e-6)
        cosine = found[2][index] * np.cos(heading) + found[3][index] * np.sin(heading)
        assert cosine == pytest.approx(1.0, abs=1e-6)


def test_a_trace_is_not_written_into_a_study(trace, tmp_path):
    (tmp_path / "study.json").write_text("{}")
    with pytest.raises(FolderTaken):
        trace.save(tmp_path / "frames" / "a.csv")
    assert not (tmp_path / "frames").exists()
