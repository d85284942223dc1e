"""A test fails if one of its subtests does, in the baseline and by a requirement."""

import json

import pytest

pytest.importorskip("_pytest.subtests", reason="subtests are part of pytest 9")
pytest_plugins = ["pytester"]

WRITE = ("--oodscen-baseline=known.json", "--oodscen-baseline-mode=write")
TESTS = """
import os

import stack


def test_parts(drive, subtests, record_property):
    record_property("own", "kept")
    for part in "ab":
        with subtests.test(part):
            assert drive(stack.Stack, name="Stack" + part).is_safe
    with subtests.test("other"):
        assert "OTHER" not in os.environ
    with subtests.test("last"):
        pass
"""


@pytest.fixture
def parts(session, pytester):
    """Return a function that runs a test of four subtests, two of which drive."""
    pytester.makepyfile(test_stack=TESTS)

    def run(stack, *options):
        return session(stack, *options, "-k", "box-001")

    return run


@pytest.fixture
def outcomes(pytester):
    """Return a function that reads the outcomes of the baseline."""

    def read():
        rows = json.loads((pytester.path / "known.json").read_text())["tests"]
        return [row["outcome"] for row in rows.values()]

    return read


def test_a_failed_subtest_is_a_failure_of_its_test_in_the_baseline(parts, outcomes):
    written = parts("Blind", *WRITE)
    assert written.ret == 0
    written.stdout.fnmatch_lines(["*1 outcomes written, 1 of them failures"])
    assert written.parseoutcomes()["xfailed"] == 1
    assert outcomes() == ["failed"]
    again = parts("Blind", WRITE[0])
    assert (again.ret, again.parseoutcomes()["xfailed"]) == (0, 1)
    again.stdout.fnmatch_lines(["*0 regressions, 0 new failures, 1 known failures*"])


def test_a_failed_subtest_is_a_regression_where_the_test_passed(parts, outcomes):
    parts("'rule-based'", *WRITE)
    assert outcomes() == ["passed"]
    worse = parts("Blind", WRITE[0])
    assert worse.ret == pytest.ExitCode.TESTS_FAILED
    worse.stdout.fnmatch_lines(["*1 regressions, *", "  regression: *test_parts*"])
    parts("Blind", WRITE[0], "--oodscen-baseline-mode=update")
    assert outcomes() == ["failed"]
    better = parts("'rule-based'", WRITE[0])
    better.stdout.fnmatch_lines(["*0 regressions, *1 improved"])
    assert better.ret == 0


@pytest.mark.parametrize("other", [False, True])
def test_a_requirement_counts_the_subtests_about_drives_only(parts, monkeypatch, other):
    if other:
        monkeypatch.setenv("OTHER", "1")
    result = parts("Blind", "--oodscen-require=safe>=0")
    said = result.stdout.str()
    assert result.ret == (pytest.ExitCode.TESTS_FAILED if other else 0)
    assert ("SUBFAILED[other]" in said, "SUBFAILED[a]" in said) == (other, False)
    assert result.parseoutcomes().get("xfailed", 0) == (not other)


def test_a_drive_before_the_subtests_is_counted_in_each(session, pytester):
    pytester.makepyfile(
        test_stack="""
import stack


def test_parts(drive, subtests):
    driven = drive(stack.Stack)
    for part in "ab":
        with subtests.test(part):
            assert driven.is_safe
"""
    )
    assert session("Blind", "--oodscen-require=safe>=0", "-k", "box-001").ret == 0


def test_properties_are_told_once(parts, pytester):
    parts("Blind", "--junitxml=junit.xml", "-o", "junit_family=xunit1")
    text = (pytester.path / "junit.xml").read_text()
    assert text.count('"oodscen.scene"') == text.count("<testcase") == 1
    assert text.count('"oodscen.drive.driver"') == 2
    assert text.count('name="own" value="kept"') == 1
