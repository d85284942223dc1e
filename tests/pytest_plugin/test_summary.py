"""Lines at the end of a session: counts that add up, and lists that end."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._drive_result import DriveResult
from oodscen.errors import UsageError
from oodscen.pytest_plugin._baseline import KnownTest
from oodscen.pytest_plugin._properties import with_properties
from oodscen.pytest_plugin._session import _scenes_per_path
from oodscen.pytest_plugin._summary import change_lines, stack_lines, written_line

FILE = Path("known.json")


def drive(driver: str, **fields) -> DriveResult:
    result = DriveResult(id="a@d", scene_id="a", driver=driver, passed=True, progress=1.0)
    return result.model_copy(update=fields)


def test_every_stack_has_a_line_and_its_twins_another():
    drives = [
        drive("b"),
        drive("a", passed=False, collisions=("box",)),
        drive("a", is_twin=True, brakes_needlessly=True),
    ]
    assert stack_lines(drives) == [
        "a, scenes: 0 of 1 safe, 1 collisions, 0 off the road, 0 failed",
        "a, twins: 1 of 1 safe, 0 collisions, 0 off the road, 0 failed, 1 braked needlessly",
        "b, scenes: 1 of 1 safe, 0 collisions, 0 off the road, 0 failed",
    ]
    assert stack_lines([]) == []


@given(
    st.dictionaries(
        st.text(min_size=1),
        st.tuples(
            st.sampled_from(["same", "regression", "known", "improved", "new"]),
            st.sampled_from(["passed", "failed"]),
        ),
        max_size=60,
    )
)
def test_every_change_is_counted_and_twenty_regressions_are_listed(rows):
    tests = {name: KnownTest(outcome=outcome, scene="x") for name, (_, outcome) in rows.items()}
    changes = {name: change for name, (change, _) in rows.items()}
    counts = {
        change: sum(other == change for other in changes.values())
        for change in ("regression", "known", "improved")
    }
    new_failures = sum(row == ("new", "failed") for row in rows.values())
    first, *others = change_lines(FILE, tests, changes)
    assert first == (
        f"known.json: {counts['regression']} regressions, {new_failures} new failures, "
        f"{counts['known']} known failures, {counts['improved']} improved"
    )
    listed = [line for line in others if line.startswith("  regression: ")]
    assert len(listed) == min(20, counts["regression"])
    more = counts["regression"] - 20
    assert (f"  and {more} more" in others) == (more > 0)
    assert ("update" in "".join(others[-1:])) >= (counts["improved"] > 0)
    failed = sum(outcome == "failed" for _, outcome in rows.values())
    assert written_line(FILE, tests) == (
        f"known.json: {len(tests)} outcomes written, {failed} of them failures"
    )


def test_properties_replace_those_of_their_names_and_none_is_left_out():
    before = [("oodscen.drive.safe", "true"), ("other", 1)]
    added = [("oodscen.drive.safe", "false"), ("oodscen.drive.min_ttc_s", None), ("share", 0.5)]
    assert with_properties(before, added) == [
        ("other", 1),
        ("oodscen.drive.safe", "false"),
        ("share", "0.5"),
    ]


def test_a_number_of_scenes_per_path_is_from_one_to_a_million():
    assert [_scenes_per_path(text) for text in (None, "1", "007", "999999")] == [None, 1, 7, 999999]
    for text in ("", "0", "-1", "1.5", "1000000", "9" * 5_000, "two"):
        with pytest.raises(UsageError, match="is not a number of scenes"):
            _scenes_per_path(text)
