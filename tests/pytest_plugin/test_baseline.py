import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.errors import DataError, StudyError, UsageError
from oodscen.pytest_plugin._baseline import KnownOutcomes, KnownTest, update

known = st.builds(
    KnownTest, outcome=st.sampled_from(("passed", "failed")), scene=st.sampled_from("ab")
)
baselines = st.dictionaries(st.text(max_size=8), known, max_size=4).map(
    lambda tests: KnownOutcomes(tests=tests)
)
WORDS = {
    ("passed", "passed"): "same",
    ("passed", "failed"): "regression",
    ("failed", "failed"): "known",
    ("failed", "passed"): "improved",
}


@settings(max_examples=20)
@given(baselines)
def test_a_baseline_is_read_as_it_was_written(baseline) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "deep" / "baseline.json"
        baseline.write(path)
        assert KnownOutcomes.at(path) == baseline
        assert len(path.read_text().splitlines()) == len(baseline.tests) + 2 + (not baseline.tests)


@given(known, known)
def test_only_a_failure_that_passed_in_the_same_scene_is_a_regression(before, now) -> None:
    baseline = KnownOutcomes(tests={"t": before})
    expected = WORDS[before.outcome, now.outcome] if before.scene == now.scene else "new"
    assert baseline.change("t", now.outcome, now.scene) == expected
    assert baseline.change("other", now.outcome, now.scene) == "new"


@settings(max_examples=20)
@given(st.lists(st.dictionaries(st.text(max_size=8), known, max_size=4), max_size=3))
def test_an_update_replaces_the_tests_that_ran(sessions) -> None:
    expected = {}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "deep" / "baseline.json"
        for tests in sessions:
            update(path, tests)
            expected |= tests
            assert KnownOutcomes.at(path).tests == expected


def test_sessions_that_update_at_once_lose_nothing(tmp_path) -> None:
    path = tmp_path / "baseline.json"
    names = [f"test_{number}" for number in range(24)]
    with ThreadPoolExecutor(6) as sessions:
        done = [
            sessions.submit(update, path, {name: KnownTest(outcome="passed", scene="a")})
            for name in names
        ]
    assert [one.exception() for one in done] == [None] * len(names)
    assert set(KnownOutcomes.at(path).tests) == set(names)
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize(
    "text", ["", "[]", "{", "{}", '{"tests": {"a": {}}}', '{"schema_version": 2}']
)
def test_a_broken_baseline_is_named(text, tmp_path) -> None:
    path = tmp_path / "baseline.json"
    with pytest.raises(UsageError, match=r"does not exist yet; .*baseline-mode write") as missing:
        KnownOutcomes.at(path)
    assert not isinstance(missing.value, DataError)
    path.write_text(text)
    with pytest.raises(DataError) as caught:
        KnownOutcomes.at(path)
    assert (caught.value.noun, caught.value.source) == ("baseline", str(path))


def test_a_baseline_that_cannot_be_written_is_an_error(tmp_path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(StudyError):
        KnownOutcomes(tests={}).write(tmp_path / "file" / "baseline.json")
