import csv
import json
import re
import shutil
import struct
import sys

import numpy as np
import pytest
from click.testing import CliRunner

from oodscen import Study, make_catalogue, make_simulator
from oodscen._cli import main
from oodscen._cli.commands.export import _Writer
from oodscen._cli.export_folder import LIST
from oodscen._members import using
from oodscen.data._pairing import kind_of
from oodscen.interchange import read_openscenario
from oodscen.interchange._moving import UnrenderedSimulator
from oodscen.interchange._recording import ordinary_twin, replayed
from oodscen.interchange._traces.osi_reading import read_osi_trace
from oodscen.interchange._verdicts.poses import read_poses
from tests.interchange.playing import centres
from tests.interchange.staging import SCENES


@pytest.fixture
def study(small, tmp_path):
    return shutil.copytree(small, tmp_path / "out")


def run(*words):
    return CliRunner().invoke(main, [str(word) for word in words])


def poses(path, scene, catalogue):
    """Write the poses of a run as a player would."""
    truth = replayed(scene, UnrenderedSimulator(catalogue), "keep_speed", 0)
    with path.open("w", newline="") as out:
        table = csv.writer(out)
        table.writerow(["time", "name", "x", "y", "z", "h"])
        for step, time in enumerate(truth.time):
            for row, name in enumerate(truth.ids):
                table.writerow([time, name, *truth.poses[step, row]])


def test_a_study_is_exported_and_its_files_are_read(quick, tmp_path):
    done = run("export", quick, "-o", tmp_path / "files", "--mode", "reactive", "--no-ego")
    assert done.exit_code == 0
    opened = Study.open(quick)
    catalogue = make_catalogue("flat")
    for scene, scenario in zip(opened.scenes, opened.scenarios, strict=True):
        assert (tmp_path / "files" / f"{scene.id}~twin.xosc").exists()
        assert (tmp_path / "files" / f"{scene.id}~demand.xosc").exists()
        path = tmp_path / "files" / f"{scene.id}.xosc"
        assert read_openscenario(path, catalogue).scene == scene
        assert scenario.text.split()[0] in path.read_text()
        back = run("import", path, "--simulator", "flat")
        assert json.loads(back.stdout) == scene.model_dump(mode="json")


def test_a_text_whose_claims_could_not_be_read_is_exported_and_varied_without_any(study, tmp_path):
    rows = [json.loads(line) for line in (study / "claims.jsonl").read_text().splitlines()]
    failed = [{"id": row["id"], "status": "failed", "error": "no answer"} for row in rows]
    (study / "claims.jsonl").write_text("".join(json.dumps(row) + "\n" for row in failed))
    assert run("export", study, "-o", tmp_path / "exported", "--no-twins").exit_code == 0
    assert run("vary", study, "-n", 1).exit_code == 0


@pytest.mark.parametrize("form", ["openscenario", "osi"])
def test_a_scene_without_a_lane_for_the_action_is_reported_and_not_written(form, tmp_path):
    scenes, out = tmp_path / "scenes.jsonl", tmp_path / "out"
    without, having = SCENES[:2]
    scenes.write_text(f"{without.to_json()}\n{having.to_json()}\n")
    words = ("--simulator", "pybullet", "--no-twins", "--action", "change_lane_right")
    done = run("export", scenes, "-o", out, "--to", form, *words)
    assert done.exit_code == 1
    *_, told, summary = done.stderr.splitlines()
    assert told == f"{without.id}: the ego has no lane for its action change_lane_right"
    assert summary == f"1 written into {out}, 1 failed"
    assert {path.stem for path in out.glob("*.[xo]*s*")} == {having.id}


@pytest.mark.parametrize("mode", ["replay", "reactive"])
def test_a_logical_export_gives_back_its_scene(mode, tmp_path):
    scenes, out = tmp_path / "scenes.jsonl", tmp_path / "out"
    scenes.write_text(f"{SCENES[0].to_json()}\n")
    words = ("--simulator", "pybullet", "--no-twins", "--logical", "--mode", mode)
    assert run("export", scenes, "-o", out, *words).exit_code == 0
    back = run("import", out / f"{SCENES[0].id}.logical.xosc", "--simulator", "pybullet")
    assert json.loads(back.stdout) == SCENES[0].model_dump(mode="json")
    assert back.stderr == ""


def test_processes_write_the_same_files(tmp_path, monkeypatch):
    monkeypatch.setattr("oodscen._cli.commands.export._PART", 1)
    scenes, written = tmp_path / "scenes.jsonl", []
    scenes.write_text("".join(f"{scene.to_json()}\n" for scene in SCENES[:2]))
    for workers in (1, 2):
        out = tmp_path / str(workers)
        words = ("--simulator", "pybullet", "--no-twins", "--workers", workers)
        assert run("export", scenes, "-o", out, *words).exit_code == 0
        written.append({path.name: path.read_bytes() for path in out.iterdir()})
    assert written[0] == written[1]
    assert set(written[0]) >= {f"{scene.id}.xosc" for scene in SCENES[:2]}


def test_a_stopped_export_lists_only_what_it_wrote(tmp_path, monkeypatch):
    scenes, out = tmp_path / "scenes.jsonl", tmp_path / "out"
    scenes.write_text("".join(f"{scene.to_json()}\n" for scene in SCENES[:2]))
    write = _Writer._write

    def stopping(writer, drive, simulator):
        if drive.id == SCENES[1].id:
            raise KeyboardInterrupt
        write(writer, drive, simulator)

    monkeypatch.setattr(_Writer, "_write", stopping)
    words = ("--simulator", "pybullet", "--no-twins", "--to", "openlabel")
    assert run("export", scenes, "-o", out, *words).exit_code != 0
    assert {LIST, *(out / LIST).read_text().splitlines()[1:]} == {
        path.name for path in out.iterdir()
    }


@pytest.mark.parametrize("form", ["openscenario", "openlabel", "osi"])
def test_an_export_replaces_only_exports(form, tmp_path):
    scenes, out = tmp_path / "scenes.jsonl", tmp_path / "out"
    scenes.write_text(f"{SCENES[0].to_json()}\n")
    words = ("export", scenes, "-o", out, "--to", form, "--simulator", "pybullet")
    assert run(*words).exit_code == run(*words).exit_code == 0
    written = {path.name: path.read_bytes() for path in out.iterdir()}
    listed = (out / LIST).read_text().splitlines()
    assert set(written) <= {LIST, *listed}
    for name in set(written) - {LIST}:
        other = tmp_path / f"other-{name}"
        other.mkdir()
        (other / name).write_text("mine")
        done = run(*words[:3], other, *words[4:])
        assert done.exit_code == 2
        assert name in done.output
        assert [path.name for path in other.iterdir()] == [name]
        assert (other / name).read_text() == "mine"


def test_a_file_of_a_name_that_no_export_wrote_is_kept(tmp_path):
    scenes, out = tmp_path / "scenes.jsonl", tmp_path / "out"
    scenes.write_text(f"{SCENES[0].to_json()}\n")
    words = ("export", scenes, "-o", out, "--simulator", "pybullet")
    assert run(*words).exit_code == 0
    own = out / f"{SCENES[0].id}.logical.xosc"
    assert own.name not in (out / LIST).read_text()
    own.write_text("mine")
    done = run(*words, "--logical")
    assert done.exit_code == 2
    assert own.name in done.output
    assert own.read_text() == "mine"


@pytest.mark.parametrize(("form", "package"), [("mcap", "betterosi"), ("rerun", "rerun")])
def test_an_export_without_its_package_writes_nothing(form, package, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, package, None)
    scenes, out = tmp_path / "scenes.jsonl", tmp_path / "out"
    scenes.write_text(f"{SCENES[0].to_json()}\n")
    done = run("export", scenes, "-o", out, "--to", form, "--simulator", "pybullet")
    assert done.exit_code == 2
    assert "pip install" in done.output
    assert not out.exists()


def test_nothing_is_exported_into_a_study(study):
    for place in (study, study / "frames"):
        before = sorted(path.name for path in place.iterdir())
        assert run("export", study, "-o", place).exit_code == 2
        assert sorted(path.name for path in place.iterdir()) == before
        for words in (
            ("publish", study, "-o", place / "data"),
            ("simulate", study / "scenes.jsonl", place / "data", "--simulator", "flat"),
        ):
            if place != study:
                found = run(*words)
                assert found.exit_code == 2
                assert "frames" in found.output
                assert sorted(path.name for path in place.iterdir()) == before
    assert run("export", study, "-o", study / "exported", "--limit", 1).exit_code == 0


@pytest.mark.parametrize(
    ("other", "more"),
    [
        ("a~twin", ()),
        ("a~twin", ("--to", "openlabel")),
        ("a.logical", ("--logical",)),
        ("a.stochastic", ("--logical",)),
    ],
)
def test_two_drives_of_one_export_never_share_a_file(other, more, tmp_path):
    names, lines = ("a", other), tmp_path / "scenes.jsonl"
    for order in (names, names[::-1]):
        both = zip(SCENES, order, strict=False)
        lines.write_text("".join(f"{s.model_copy(update={'id': n}).to_json()}\n" for s, n in both))
        words = ("export", lines, "-o", tmp_path / "out", "--simulator", "pybullet")
        found = run(*words, *more)
        assert (found.exit_code, found.output.count("\n")) == (2, 1)
        assert all(repr(name) in found.output for name in names)
        assert not (tmp_path / "out").exists()


def test_a_device_is_no_folder(tmp_path):
    lines = tmp_path / "scenes.jsonl"
    lines.write_text(f"{SCENES[0].to_json()}\n")
    found = run("export", lines, "-o", "/dev/full", "--simulator", "pybullet")
    assert found.exit_code == 2
    assert "'/dev/full' is not a folder" in found.output


def test_a_field_that_is_too_long_is_named_so(study, tmp_path):
    path = tmp_path / f"{Study.open(study).scenes[0].id}.csv"
    path.write_text('time,name,x,y,h\n"' + "x" * 200_000)
    assert "a field has more than 131,072 characters" in run("verdict", study, path).output


def test_tags_are_exported(study, tmp_path):
    assert run("export", study, "-o", tmp_path / "tags", "--to", "openlabel").exit_code == 0
    for scene in Study.open(study).scenes:
        text = (tmp_path / "tags" / f"{scene.id}.json").read_text()
        assert json.loads(text)["openlabel"]["tags"]


def test_traces_are_exported_and_judged(study, tmp_path):
    done = run("export", study, "-o", tmp_path / "traces", "--to", "osi", "--action", "stop")
    assert done.exit_code == 0
    episodes = {episode.scene_id: episode for episode in Study.open(study).episodes}
    assert {path.stem for path in (tmp_path / "traces").glob("*.osi")} == set(episodes)
    for path in (tmp_path / "traces").glob("*.osi"):
        (told,) = json.loads(run("verdict", study, path, "--json").stdout)
        outcome = episodes[path.stem].actions["stop"]
        assert outcome.marginal or told["outcome"]["safe"] == outcome.safe


def test_a_trace_with_a_huge_value_leaves_the_others_judged(study, tmp_path):
    assert run("export", study, "-o", tmp_path, "--to", "osi").exit_code == 0
    first, *others = sorted(tmp_path.glob("*.osi"))
    data = first.read_bytes()
    _, name, (x, *_), *_ = next(read_osi_trace(data, first.name))
    first.write_bytes(data.replace(struct.pack("<d", x), struct.pack("<d", 1.7e308), 1))
    found = run("verdict", study, first, *others, "--json")
    assert found.exit_code == 1
    assert f"{name}: x is 1.7e+308 at 0 s" in found.stderr
    assert {one["scene_id"] for one in json.loads(found.stdout)} == {one.stem for one in others}


def test_a_played_run_enters_the_table_of_drivers(study, tmp_path):
    scene = Study.open(study).scenes[0]
    path = tmp_path / f"{scene.id}.csv"
    poses(path, scene, make_catalogue("flat"))
    done = run("verdict", study, path, "--driver", "stack")
    assert done.exit_code == 0
    assert scene.id in done.output
    (row,) = (drive for drive in Study.open(study).drives if drive.driver == "stack")
    assert row.scene_id == scene.id
    assert "stack" in (study / "report.html").read_text()
    (told,) = json.loads(run("verdict", study, path, "--json").stdout)
    assert told["outcome"]["safe"] == row.passed


def test_a_played_twin_is_paired_with_its_scene_and_a_demand_is_left_out_of_the_table(
    quick, tmp_path
):
    study = shutil.copytree(quick, tmp_path / "out")
    words = ("--to", "osi", "--action", "emergency_brake", "--limit", 2)
    assert run("export", study, "-o", tmp_path / "files", *words).exit_code == 0
    files = sorted((tmp_path / "files").glob("*.osi"))
    assert [kind_of(one.stem) for one in files].count("demand") == 2
    order = ("verdict", study, *files, "--driver", "stack")
    for _ in range(2):
        found = run(*order)
        assert found.exit_code == 0, found.output
        assert "scenes and twins only: demands (2)" in found.stderr
    played = {row.scene_id: row for row in Study.open(study).drives}
    assert {kind_of(name) for name in played} == {"rare", "twin"}
    assert run("drive", study, "--driver", "emergency_brake", "--workers", 0).exit_code == 0
    own = {row.scene_id: row for row in Study.open(study).drives if row.driver != "stack"}
    for name, row in played.items():
        assert row.brakes_needlessly == own[name].brakes_needlessly
        assert row.twin_passed == own[name].twin_passed
        assert (row.progress_lost is None) == (own[name].progress_lost is None)


def test_a_result_is_not_replaced_unasked(study, tmp_path):
    scene = Study.open(study).scenes[0]
    path, other = tmp_path / f"{scene.id}.csv", tmp_path / "cut" / f"{scene.id}.csv"
    poses(path, scene, make_catalogue("flat"))
    other.parent.mkdir()
    lines = path.read_text().splitlines()
    other.write_text("\n".join(lines[: len(lines) // 4]))
    words = ("verdict", study, "--driver", "stack")
    assert run(*words, path, other).exit_code == 2
    assert run(*words, path).exit_code == run(*words, path).exit_code == 0
    before = (study / "drives.jsonl").read_bytes()
    assert run(*words, other).exit_code == 2
    assert (study / "drives.jsonl").read_bytes() == before
    assert run(*words, other, "--replace").exit_code == 1
    (row,) = (drive for drive in Study.open(study).drives if drive.driver == "stack")
    assert (row.status, row.passed) == ("inconclusive", False)
    assert "1 inconclusive" in (study / "report.html").read_text()


def test_no_run_enters_the_table_for_a_scene_that_has_changed(study, tmp_path):
    scene = Study.open(study).scenes[0]
    path = tmp_path / f"{scene.id}.csv"
    poses(path, scene, make_catalogue("flat"))
    first, *others = (study / "scenes.jsonl").read_text().splitlines()
    edited = json.loads(first)
    edited["ego"]["speed"] += 0.2
    (study / "scenes.jsonl").write_text("\n".join([json.dumps(edited), *others, ""]))
    found = run("verdict", study, path, "--driver", "stack")
    assert found.exit_code == 2
    assert "has changed or been removed since it was run" in found.output
    assert not (study / "drives.jsonl").exists()


@pytest.mark.parametrize("name", ["", "  ", "rule-based", "RSS", "stop", "a\nb"])
def test_a_driver_that_played_has_a_name_of_its_own(name, study, tmp_path):
    path = tmp_path / "scene.csv"
    path.write_text("")
    assert run("verdict", study, path, "--driver", name).exit_code == 2


def test_what_cannot_be_judged_or_read_is_reported(study, tmp_path):
    path = tmp_path / "nobody.csv"
    path.write_text("time,name,x,y,h\n")
    found = run("verdict", study, path)
    assert found.exit_code == 1
    assert "nobody" in found.output
    odd = tmp_path / "odd.xosc"
    odd.write_text("<OpenSCENARIO/>")
    assert run("import", odd).exit_code == 1


@pytest.fixture
def files(tmp_path):
    """An export, a copy of it under another name, and two files of others of one name."""
    catalogue = make_catalogue("flat")
    scene = next(one for one in SCENES if not one.check(catalogue))
    path = scene.to_openscenario(catalogue).save(tmp_path)
    copy = shutil.copy(path, tmp_path / "copy.xosc")
    text = path.read_text().replace('"oodscen.scene"', '"other.scene"')
    others = [tmp_path / name for name in ("a/foreign.xosc", "b/foreign.xosc")]
    for other in others:
        other.parent.mkdir()
        shutil.copy(next(tmp_path.glob("*.xodr")), other.parent)
        other.write_text(text)
    return path, copy, *others


@pytest.mark.parametrize("pair", [(0, 0), (0, 1), (2, 3)])
def test_files_of_one_scene_are_refused_before_anything_is_written(pair, files):
    one, other = (files[index] for index in pair)
    name = json.loads(run("import", one, "--simulator", "flat").stdout)["id"]
    done = run("import", files[2 - pair[0]], one, other, "--simulator", "flat")
    assert (done.exit_code, done.stdout) == (2, "")
    assert f"{one} and {other} would both give a scene {name!r}" in done.stderr


@pytest.mark.parametrize("told", [("--map", "urban_avenue"), ("--hazard", "x"), ("--ego", "ego")])
def test_an_unchanged_export_takes_no_other_map_or_hazard(told, files):
    done = run("import", files[2], files[0], "--simulator", "flat", *told)
    assert (done.exit_code, done.stdout) == (2, "")
    assert f"{files[0]} is an unchanged export" in done.stderr


def test_variants_are_scenes(tmp_path):
    path = tmp_path / "scenes.jsonl"
    path.write_text("".join(scene.to_json() + "\n" for scene in SCENES[10:12]))
    done = run("vary", path, "--scene", SCENES[10].id, "-n", 2)
    assert done.exit_code == 0
    rows = [json.loads(line) for line in done.stdout.splitlines()]
    assert [row["id"] for row in rows] == [f"{SCENES[10].id}.v00{n}" for n in (1, 2)]
    assert run("vary", path, "--scene", "nobody").exit_code == 2


def test_demands_are_varied_and_twins_are_left_to_the_export(quick, tmp_path):
    demand = Study.open(quick).demands[0]
    rare = next(scene for scene in Study.open(quick).scenes if f"{scene.id}~demand" == demand.id)
    path = tmp_path / "scenes.jsonl"
    path.write_text("".join(f"{one.to_json()}\n" for one in (rare, demand, rare.twin(2.0))))
    done = run("vary", path, "-n", 1, "--simulator", "flat")
    ids = [json.loads(line)["id"] for line in done.stdout.splitlines()]
    assert ids == [f"{rare.id}.v001", f"{rare.id}.v001~demand"]
    assert "1 twins are left out" in done.stderr
    twin = run("vary", quick, "--scene", f"{rare.id}~twin", "-n", 1)
    assert json.loads(twin.stdout)["id"] == f"{rare.id}.v001~twin"


@pytest.mark.parametrize("command", [("export", "-o", "files"), ("vary",)])
def test_a_file_with_two_scenes_of_one_id_is_refused(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "scenes.jsonl"
    path.write_text(f"{SCENES[10].to_json()}\n" * 2)
    done = run(command[0], path, *command[1:])
    assert done.exit_code == 2
    assert "occurs more than once" in done.stderr
    assert list(tmp_path.iterdir()) == [path]


def test_variants_of_what_cannot_be_staged_say_why(tmp_path):
    path = tmp_path / "scenes.jsonl"
    path.write_text(SCENES[10].model_copy(update={"map": "nowhere"}).to_json())
    done = run("vary", path, "-n", 1)
    assert done.exit_code == 1
    assert "cannot be staged itself: map: unknown map 'nowhere'" in done.stderr


def test_another_simulator_than_the_study_s_own_is_refused(study):
    done = run("vary", study, "--simulator", "pybullet")
    assert done.exit_code == 2
    assert "were made for flat" in done.stderr


@pytest.mark.parametrize("form", ["openscenario", "osi"])
def test_an_export_has_the_motion_of_the_simulator_that_it_is_for(form, tmp_path):
    scene = next(scene for scene in SCENES if scene.id.startswith("heap-of-rubble"))
    scenes, out = tmp_path / "scenes.jsonl", tmp_path / "out"
    scenes.write_text(f"{scene.to_json()}\n")
    words = ("--simulator", "highway", "--action", "stop", "--to", form, "--workers", 1)
    assert run("export", scenes, "-o", out, *words).exit_code == 0
    with using(make_simulator("highway")) as simulator:
        truth = replayed(scene, simulator, "stop", 0)
        twin = ordinary_twin(scene, simulator.catalogue(), simulator=simulator)
    world = replayed(scene, UnrenderedSimulator(simulator.catalogue()), "stop", 0)
    assert len(world.time) > len(truth.time) + 10, (
        "the world of the library knows no such collision"
    )
    if form == "osi":
        played = read_poses(out / f"{scene.id}.osi")
        rows = [played.names.index(name) for name in truth.ids]
        assert np.abs(played.poses[:, rows, :3] - truth.poses[:, :, :3]).max() < 1e-6
    else:
        played = centres((out / f"{scene.id}.xosc").read_bytes(), truth.time)
        for row, name in enumerate(truth.ids):
            assert np.abs(played[name][:, :3] - truth.poses[:, row, :3]).max() < 1e-3
        written = read_openscenario(out / f"{scene.id}~twin.xosc", simulator.catalogue())
        assert written.scene == twin


def test_a_reactive_file_says_that_its_motion_is_not_that_of_the_simulator():
    with using(make_simulator("highway")) as simulator:
        scene, catalogue = SCENES[0], simulator.catalogue()
        own, world = (
            scene.to_openscenario(catalogue, mode="reactive", simulator=given).notes
            for given in (simulator, None)
        )
    assert set(own) - set(world) == {"Motion is that of the kinematic world, not of highway."}


def test_a_study_is_exported_with_the_seed_of_its_runs(study, tmp_path):
    config = json.loads((study / "study.json").read_text())
    config["config"]["seed"] = 5
    (study / "study.json").write_text(json.dumps(config))
    folders = {seed: tmp_path / str(seed) for seed in (None, 5, 0)}
    for seed, folder in folders.items():
        words = () if seed is None else ("--seed", seed)
        assert run("export", study, "-o", folder, "--limit", 1, *words).exit_code == 0
    seeds = {
        seed: {
            re.search(r'name="oodscen.seed" value="(\d+)"', path.read_text())[1]
            for path in folder.glob("*.xosc")
        }
        for seed, folder in folders.items()
    }
    assert seeds == {None: {"5"}, 5: {"5"}, 0: {"0"}}


def test_a_study_is_exported_with_the_reaction_time_of_its_drives(study, tmp_path):
    record = json.loads((study / "study.json").read_text())
    record["config"]["reaction"] = [0.3, 1.2, 1.5]
    (study / "study.json").write_text(json.dumps(record))
    words = ("--to", "osi", "--action", "stop", "--limit", 1, "--no-twins")
    found = run("export", study, "-o", tmp_path / "files", *words)
    assert found.exit_code == 0, found.output
    scene, catalogue = Study.open(study).scenes[0], make_catalogue("flat")
    written = (tmp_path / "files" / f"{scene.id}.osi").read_bytes()
    assert written == scene.to_osi(catalogue, action="stop", reaction_s=1.2)
    assert written != scene.to_osi(catalogue, action="stop")
