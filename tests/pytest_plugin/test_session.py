"""Sessions of a toy stack's tests: their reports, grades, baselines and options."""

import json
import os
import re
import shutil
from pathlib import Path
from xml.etree import ElementTree

import pytest

from oodscen import Study, make_driver, make_simulator
from oodscen._display import png
from oodscen.errors import UsageError
from oodscen.protocols import Camera
from oodscen.stages._drive import NEEDLESS_BRAKING, DrivePlan
from oodscen.study._stale import refuse_stale
from oodscen.testing import example_scene

pytest_plugins = ["pytester"]

ROOT = Path(__file__).parents[2]


def test_a_stack_that_keeps_its_speed_fails_and_the_report_tells_why(session, study, pytester):
    result = session("Blind", "--junitxml=reports/junit.xml", "-k", "test_safe")
    scene, known = study.scenes[0], study.scenarios[0]
    assert result.ret == pytest.ExitCode.TESTS_FAILED
    result.stdout.fnmatch_lines(
        [
            f"*False = <Stack in {scene.id}: touches * m/s>.is_safe",
            f"scene *{scene.id}",
            f"path *{known.path[-1]}",
            f"text *{known.text}",
            "outcome *touches*",
            "safe here *",
            "before * s * m/s * m from *",
            "frame */reports/oodscen/*.frame.png",
            "plan view */reports/oodscen/*.plan.png",
            "Stack, scenes: *",
        ]
    )
    cases = ElementTree.parse(pytester.path / "reports" / "junit.xml").iter("testcase")
    said = [{one.get("name"): one.get("value") for one in case.iter("property")} for case in cases]
    assert [one["oodscen.scene"] for one in said] == [scene.id for scene in study.scenes]
    assert said[0]["oodscen.drive.safe"] == "false"
    assert said[0]["oodscen.path"] == " > ".join(known.path)
    assert said[0]["oodscen.picture"].endswith(".plan.png")


def test_scenes_have_readable_ids_and_marks(session, study):
    def collected(*options):
        found = session("Blind", "--collect-only", "-q", "-k", "test_safe", *options).outlines
        return [line.partition("::")[2] for line in found if "::" in line]

    box, other, kerb = (f"test_safe[{scene.id}]" for scene in study.scenes)
    assert collected() == [box, other, kerb]
    assert collected("-m", "path_box_in_the_lane") == [box, other]
    assert collected("-m", "path_boxes and not path_box_in_the_lane") == [kerb]
    assert collected("-m", "tag_RoadTypeMinor") == [box, other, kerb]
    assert collected("--oodscen-per-path=1") == [box, kerb]
    marks = session("Blind", "--markers").stdout.str()
    assert "path_box_at_the_kerb:" in marks
    assert "tag_RoadTypeMinor:" in marks


def test_an_edited_study_is_refused_in_the_words_of_drive(session, quick, pytester):
    edited = Path(shutil.copytree(quick, pytester.path / "edited"))
    first, *others = (edited / "scenes.jsonl").read_text(encoding="utf-8").splitlines()
    slow = json.loads(first)
    slow["ego"]["speed"] = 3.0
    lines = "\n".join([json.dumps(slow), *others, ""])
    (edited / "scenes.jsonl").write_text(lines, encoding="utf-8")
    study = Study.open(edited)
    with pytest.raises(UsageError, match="has changed or been removed since it was run") as said:
        refuse_stale(study, study.episodes, study.scenes)
    words = (f"--oodscen={edited}", "--oodscen-require=safe>=0", "-k", "test_safe")
    refused = session("'rule-based'", *words, named=False)
    assert refused.ret in (pytest.ExitCode.INTERRUPTED, pytest.ExitCode.TESTS_FAILED)
    assert str(said.value) in refused.stdout.str()
    assert "Traceback" not in refused.stdout.str()
    assert " safe, " not in refused.stdout.str(), "a stack has figures"


def test_a_scene_that_no_argument_names_is_explained(session, pytester):
    pytester.makepyfile(
        test_stack="""
def test_late(request):
    request.getfixturevalue("drive")
"""
    )
    result = session("'rule-based'")
    assert result.ret == pytest.ExitCode.TESTS_FAILED
    result.stdout.fnmatch_lines(["*is an argument of it*"])
    result.stdout.no_fnmatch_line("*SubRequest*")


def test_an_error_of_the_stack_is_shown_as_its_own(session):
    result = session("Broken", "-k", "test_safe", "--oodscen-require=safe>=0.5")
    assert result.ret == pytest.ExitCode.TESTS_FAILED
    result.stdout.fnmatch_lines(["*RuntimeError: no map", "Stack, scenes: 0 of 3 *3 failed"])
    assert result.parseoutcomes()["failed"] == 3


@pytest.mark.parametrize(
    "skip", ["unittest.SkipTest", "pytest.skip.Exception", "pytest.xfail.Exception"]
)
def test_a_stack_cannot_skip_the_drives_that_a_requirement_counts(session, skip):
    result = session("Skips", "-k", "test_safe", "--oodscen-require=safe>=0.5", skip=skip)
    assert result.ret == pytest.ExitCode.TESTS_FAILED
    assert result.parseoutcomes()["failed"] == 3
    result.stdout.fnmatch_lines(
        ["*Stack skips the scene: no GPU;*", "Stack, scenes: 0 of 3 *3 failed"]
    )


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("@pytest.mark.xfail(reason='known')", "assert drive(Blind).is_safe"),
        ("", "drive(Blind).is_safe or pytest.skip('known')"),
        ("", "drive(Blind).is_safe or pytest.xfail('known')"),
    ],
)
def test_drives_count_whatever_pytest_makes_of_their_test(session, pytester, before, after):
    def figures(text):
        pytester.makepyfile(test_other=f"import pytest\nfrom stack import Blind\n{text}")
        options = ("--oodscen-require=safe>=0.5", "--junitxml=junit.xml")
        found = session("Blind", "-k", "test_other", *options)
        assert found.ret == pytest.ExitCode.TESTS_FAILED
        cases = ElementTree.parse(pytester.path / "junit.xml").iter("testcase")
        names = [{each.get("name") for each in case.iter("property")} for case in cases]
        assert all({"oodscen.scene", "oodscen.path"} < found for found in names)
        return [line for line in found.outlines if "scenes: " in line]

    plain = figures("def test_other(drive):\n    assert drive(Blind).is_safe\n")
    assert figures(f"{before}\ndef test_other(drive):\n    {after}\n") == plain != []


def test_needless_braking_in_a_twin_fails_with_pictures_of_where_it_begins(session, pytester):
    result = session("Startled", "-k", "test_twin and box-001", "--oodscen-pictures=shown")
    with make_simulator("flat") as simulator:
        plan = DrivePlan(example_scene(), simulator, 0)
        keep, brake, camera = (
            make_driver("keep_speed"),
            make_driver("emergency_brake"),
            Camera(),
        )
        state = simulator.reset(plan.twin, 0)
        while not (braking := state.time > 2.0):
            state = simulator.step(keep.act(simulator.observe()))
        while (speed := state.speeds[0]) and braking:
            state = simulator.step(brake.act(simulator.observe()))
            braking = (speed - state.speeds[0]) / simulator.dt <= NEEDLESS_BRAKING
        frame, plan_view = (
            simulator.render(camera).rgb,
            plan.twin.birds_eye(state, simulator.catalogue()),
        )
    result.stdout.fnmatch_lines(
        [
            f"*braking hard after {state.time:.2f} s although keeping the speed is safe*",
            f" * {state.time:.2f} s * m/s*",
            "frame *.frame.png",
        ]
    )
    (shown,) = (pytester.path / "shown").glob("*~twin*.frame.png")
    assert shown.read_bytes() == png(frame)
    assert Path(str(shown).replace(".frame.", ".plan.")).read_bytes() == png(plan_view)


def test_a_baseline_that_cannot_be_written_fails_the_session(session, pytester):
    (pytester.path / "file").write_text("")
    write = ("--oodscen-baseline=file/known.json", "--oodscen-baseline-mode=write")
    result = session("'rule-based'", *write, "--junitxml=junit.xml", "-k", "kerb")
    assert result.ret == pytest.ExitCode.TESTS_FAILED
    result.stdout.fnmatch_lines(["oodscen: cannot write *known.json*"])
    assert (pytester.path / "junit.xml").exists()


def test_only_regressions_fail_against_a_baseline(session, pytester):
    baseline = "--oodscen-baseline=known.json"
    write = session("Blind", baseline, "--oodscen-baseline-mode=write")
    assert write.ret == 0
    rows = json.loads((pytester.path / "known.json").read_text())["tests"]
    failed = [name for name, row in rows.items() if row["outcome"] == "failed"]
    assert failed
    assert {name.partition("::")[0] for name in rows} == {"test_stack.py"}

    same = session("Blind", baseline)
    assert (same.ret, same.parseoutcomes()["xfailed"]) == (0, len(failed))

    worse = session("Cautious", baseline)
    assert worse.ret == pytest.ExitCode.TESTS_FAILED
    worse.stdout.fnmatch_lines(["* regressions, 0 new failures, *", "  regression: *test_twin*"])

    better = session("'rule-based'", baseline)
    assert better.ret == 0
    better.stdout.fnmatch_lines(["*0 regressions*improved", "*baseline-mode update"])
    session("'rule-based'", baseline, "--oodscen-baseline-mode=update", "-k", "test_safe")
    updated = json.loads((pytester.path / "known.json").read_text())["tests"]
    assert updated.keys() == rows.keys()
    assert sum(row["outcome"] == "failed" for row in updated.values()) < len(failed)
    assert session("Blind", baseline).ret == pytest.ExitCode.TESTS_FAILED


def test_a_requirement_counts_failures_instead_of_failing_each(session):
    result = session("Blind", "--oodscen-require=safe>=0")
    assert result.ret == 0
    assert "xfailed" in result.parseoutcomes()
    result.stdout.fnmatch_lines(["requirement met: safe>=0*"])
    short = session("Blind", "--oodscen-require=safe>=0.99")
    assert short.ret == pytest.ExitCode.TESTS_FAILED
    short.stdout.fnmatch_lines(
        ["Stack: * (safe *)", "requirement not met, so the session fails: safe>=0.99"]
    )


def test_a_failure_that_no_bar_counts_in_the_end_fails_the_session(session):
    """The bar on both counts a scene only if its twin is driven, in whichever test."""
    both = session("Blind", "--oodscen-require=safe-both>=0")
    assert both.ret == 0
    assert "xfailed" in both.parseoutcomes()
    alone = session("Blind", "--oodscen-require=safe-both>=0", "-k", "test_safe or kerb")
    assert alone.ret == pytest.ExitCode.TESTS_FAILED
    alone.stdout.fnmatch_lines(
        [
            "requirement not met, so the session fails: safe-both>=0*",
            "safe-both counts no failure without a drive of scene and twin: box-001, box-002",
        ]
    )


UNCOUNTED = """
import stack


def test_drives_nothing(scene):
    assert len(scene.id) == 3


def test_something_else(drive):
    assert drive(stack.Stack, name="Stack").is_safe
    assert 1 == 2
"""


def test_a_failure_that_the_requirement_does_not_count_fails(session, pytester):
    pytester.makepyfile(test_stack=UNCOUNTED)
    result = session("'rule-based'", "--oodscen-require=safe>=0", "-k", "kerb")
    assert result.parseoutcomes() == {"failed": 2, "deselected": 4}


OWN_SCENE = """
import pytest
from oodscen.testing import example_scene
from stack import Stack


@pytest.fixture
def scene():
    return example_scene()


def test_own(drive):
    assert drive(Stack).is_safe
"""


def test_drives_in_a_scene_of_ones_own_count_and_are_shown(session, pytester):
    pytester.makepyfile(test_stack=OWN_SCENE)
    result = session("Blind", "--oodscen-require=safe>=0.5")
    result.stdout.fnmatch_lines(["Blind, scenes: 0 of 1 safe, 1 collisions, *"])
    assert result.parseoutcomes() == {"xfailed": 1}
    session("Blind", "--oodscen-baseline=known.json", "--oodscen-baseline-mode=write")
    assert session("Blind", "--oodscen-baseline=known.json").ret == pytest.ExitCode.OK
    result = session("Blind")
    result.stdout.fnmatch_lines(["scene      example-001", "outcome    touches box *"])
    pytester.makepyfile(test_stack=OWN_SCENE.replace("example_scene()", "'box-001'"))
    session("Blind").stdout.fnmatch_lines(["scene must be a Scene, not 'box-001'"])


def test_a_requirement_without_a_drive_fails_and_says_so(session, pytester):
    pytester.makepyfile(test_stack="def test_plain(): pass")
    result = session("Blind", "--oodscen-require=safe>=0")
    assert result.ret == pytest.ExitCode.TESTS_FAILED
    result.stdout.fnmatch_lines(["no stack drove a scene, *"])
    assert session("Blind", "--oodscen-require=safe>=0", "--collect-only").ret == 0
    pytester.makepyfile(test_stack="def test_plain(): assert False\ndef test_more(): pass")
    result = session("Blind", "--oodscen-require=safe>=0", "-x")
    result.stdout.fnmatch_lines(["not all tests ran, *"])


def test_a_baseline_holds_tests_whose_file_has_no_name_in_utf_8(session, pytester):
    tests = pytester.path / "test_stack.py"
    tests.rename(tests.with_name(os.fsdecode(b"test_\xff_test.py")))
    # Pytest's own cache cannot write the name.
    chosen = ("-p", "no:cacheprovider", "-k", "test_safe and kerb", "--oodscen-baseline=known.json")
    write = ("--oodscen-baseline-mode=write",)
    for options in (write, write, ()):
        result = session("'rule-based'", *chosen, *options)
        assert result.ret == pytest.ExitCode.OK
    result.stdout.fnmatch_lines(["*known.json: 0 regressions, 0 new failures*"])


@pytest.mark.parametrize("code", [None, 0, 1])
def test_an_interrupted_session_says_that_nothing_is_written(session, pytester, code):
    with (pytester.path / "test_stack.py").open("a") as tests:
        tests.write(f"\n\ndef test_zz(scene):\n    __import__('pytest').exit('stop', {code})\n")
    write = ["--oodscen-baseline=known.json", "--oodscen-baseline-mode=write"]
    result = session("'rule-based'", *write, "--oodscen-require=safe>=0", "-k", "kerb")
    assert result.ret == (pytest.ExitCode.INTERRUPTED if code is None else code)
    result.stdout.fnmatch_lines(["*known.json: not all tests ran*", "not all tests ran, *graded*"])
    assert not (pytester.path / "known.json").exists()


@pytest.mark.parametrize("text", ["import stack", "", '{"name": "app", "version": "1"}'])
def test_what_is_no_baseline_is_never_overwritten(session, pytester, text):
    (pytester.path / "mine.txt").write_text(text)
    write = ["--oodscen-baseline=mine.txt", "--oodscen-baseline-mode=write"]
    result = session("Blind", *write)
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    assert "only a baseline is overwritten" in result.stderr.str()
    assert (pytester.path / "mine.txt").read_text() == text


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--oodscen-require="], "--oodscen-require is empty"),
        (["--oodscen-baseline", " "], "--oodscen-baseline is empty"),
        (["--oodscen-require=safe"], "is not a requirement"),
        (["--oodscen-require=notice>=0.5"], "no figure is called 'notice'"),
        (["--oodscen-baseline=none.json"], "does not exist"),
        (["--oodscen-baseline=test_stack.py"], "malformed baseline"),
        (["--oodscen-baseline", "x" * 300], "cannot be the name of a file"),
        (["--oodscen-baseline-mode=update"], "needs --oodscen-baseline"),
        (["--oodscen-baseline", "../none.json"], "write --oodscen-baseline=../none.json"),
        (["-o", "oodscen_per_path=few"], "is not a number of scenes"),
        (["--oodscen-per-path=0"], "is not a number of scenes"),
    ],
)
def test_a_wrong_option_is_one_line(session, options, words):
    result = session("Blind", *options)
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    assert words in result.stderr.str()
    assert "Traceback" not in result.stderr.str()


def test_without_a_study_nothing_is_added(session, pytester):
    assert session("Blind", "--fixtures", named=False).stdout.str().count("oodscen_scene") == 0
    for lost in (
        "--oodscen-require=safe>=1",
        "--oodscen-baseline-mode=write",
        "--oodscen-per-path=3",
        "--oodscen-simulator=flat",
        "--oodscen-pictures=shown",
        "--oodscen-baseline=known.json",
    ):
        result = session("Blind", lost, named=False)
        assert f"{lost.partition('=')[0]} needs a study" in result.stderr.str()
    (pytester.path / "empty").mkdir()
    assert "holds no study" in session("Blind", "--oodscen=empty", named=False).stderr.str()


def test_a_setting_names_the_study_and_processes_share_the_scenes(session, study, pytester):
    pytester.makeini(
        "[pytest]\naddopts = -p oodscen.pytest_plugin._hooks -p xdist.plugin\n"
        f"oodscen = {study.folder}\noodscen_baseline = known.json\n"
    )
    write = ["--oodscen-baseline-mode=write", "-k", "test_safe"]
    session("Blind", *write, named=False)
    alone = (pytester.path / "known.json").read_bytes()
    result = session("Blind", *write, "-n", "1", named=False)
    assert result.ret == 0
    assert (pytester.path / "known.json").read_bytes() == alone
    result.stdout.fnmatch_lines([f"Stack, scenes: * of {len(study.scenes)} safe, *"])


def test_a_path_in_the_environment_is_refused_as_on_the_command_line(session, monkeypatch):
    monkeypatch.setenv("PYTEST_ADDOPTS", "--oodscen ../far")
    result = session("Blind", named=False)
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    assert "write --oodscen=../far: " in result.stderr.str()


def test_a_setting_starts_at_the_configuration_file_wherever_the_root_is(session, quick, pytester):
    shutil.copytree(quick, pytester.path / "here")
    (pytester.path / "elsewhere").mkdir()
    pytester.makeini("[pytest]\naddopts = -p oodscen.pytest_plugin._hooks\noodscen = here\n")
    options = ("-c", "tox.ini", "--rootdir=elsewhere", "--collect-only", "-k", "test_safe")
    result = session("Blind", *options, named=False)
    assert result.ret == pytest.ExitCode.OK
    result.stdout.fnmatch_lines([f"oodscen: {pytester.path / 'here'}"])


def test_the_working_folder_may_be_the_study(session, quick, pytester):
    shutil.copytree(quick, pytester.path, dirs_exist_ok=True)
    options = ("--oodscen", ".", "--collect-only", "-k", "test_safe", "test_stack.py")
    assert session("Blind", *options, named=False).ret == pytest.ExitCode.OK


def test_a_session_that_stops_at_a_failure_grades_and_writes_nothing(session, pytester):
    with (pytester.path / "test_stack.py").open("a") as tests:
        tests.write("\n\ndef test_a():\n    assert 1 == 2\n\n\ndef test_b():\n    pass\n")
    write = ("--oodscen-baseline=known.json", "--oodscen-baseline-mode=write")
    options = (*write, "--oodscen-require=safe>=0", "-k", "kerb or test_a or test_b", "-x")
    result = session("'rule-based'", *options)
    assert result.ret == pytest.ExitCode.TESTS_FAILED
    result.stdout.fnmatch_lines(["*known.json: not all tests ran*", "not all tests ran, *graded*"])
    assert not (pytester.path / "known.json").exists()


def test_pictures_lie_beside_the_junit_file_where_pytest_puts_it(session, pytester, monkeypatch):
    monkeypatch.setenv("REPORTS", "made")
    session("Blind", "--junitxml=$REPORTS/junit.xml", "-k", "test_safe and box-001")
    assert (pytester.path / "made" / "junit.xml").exists()
    assert len(list((pytester.path / "made" / "oodscen").iterdir())) == 2


def test_a_process_that_dies_leaves_no_grade_and_no_baseline(session, study, pytester):
    pytester.makeini(
        "[pytest]\naddopts = -p oodscen.pytest_plugin._hooks -p xdist.plugin\n"
        f"oodscen = {study.folder}\noodscen_baseline = known.json\n"
    )
    tests = """
import os, stack

def test_safe(scene, drive):
    if scene.id == "box-002":
        os._exit(3)
    assert drive(stack.Stack, name="Stack").is_safe
"""
    pytester.makepyfile(test_stack=tests)
    options = ["--oodscen-baseline-mode=write", "--oodscen-require=safe>=0", "-n", "1"]
    result = session("Blind", *options, named=False)
    assert result.ret == pytest.ExitCode.TESTS_FAILED
    assert not (pytester.path / "known.json").exists()
    result.stdout.fnmatch_lines(["not all tests ran, so that no stack is graded*"])


def test_pictures_are_never_written_into_a_study(session, study):
    result = session("Startled", f"--oodscen-pictures={study.folder / 'frames'}")
    assert result.ret != 0
    result.stdout.fnmatch_lines(["*frames*"])
    assert not (study.folder / "frames").exists()


def test_the_example_of_the_docs_runs(study, pytester, monkeypatch):
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    shutil.copytree(ROOT / "examples" / "driving_ci", pytester.path, dirs_exist_ok=True)
    shutil.copytree(study.folder, pytester.path / "study")
    code = re.search(r"```py\n.*?\n\n\n(.*?)```", (ROOT / "docs" / "ci.md").read_text(), re.DOTALL)
    assert (pytester.path / "tests" / "test_stack.py").read_text().endswith(code[1])
    pytester.syspathinsert()
    plugin = (
        "-p",
        "oodscen.pytest_plugin._hooks",
        "-W",
        "ignore::pytest.PytestAssertRewriteWarning",
    )
    write = pytester.runpytest_inprocess(*plugin, "--oodscen-baseline-mode=write")
    assert write.ret == 0
    again = pytester.runpytest_inprocess(*plugin)
    assert again.ret == 0
    again.stdout.fnmatch_lines(["*baseline.json: 0 regressions, 0 new failures*"])
