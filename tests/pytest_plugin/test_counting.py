"""A requirement counts the drives that its bars miss, in the scenes or twins that they are about."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._drive_result import DriveResult
from oodscen.judging._drive_requirements import DRIVE_FIGURES, drive_requirements
from oodscen.judging._leaderboard.requirements import parse_requirement
from oodscen.pytest_plugin._counting import is_counted


def drive(is_twin: bool, **fields) -> DriveResult:
    scene = "a-001~twin" if is_twin else "a-001"
    return DriveResult(
        id=f"{scene}@d", scene_id=scene, driver="d", is_twin=is_twin, progress=1.0
    ).model_copy(update=fields)


@pytest.mark.parametrize(
    ("figure", "good", "bad"),
    [
        ("safe", drive(False, passed=True), drive(False)),
        ("safe-twin", drive(True, passed=True), drive(True)),
        ("safe-both", drive(True, passed=True), drive(True, passed=True, progress=0.1)),
        ("needless", drive(True), drive(True, brakes_needlessly=True)),
        ("critical", drive(False, min_ttc_s=2.0), drive(False, min_ttc_s=0.5)),
    ],
)
def test_a_miss_is_counted_under_its_own_figure(figure, good, bad) -> None:
    sign = "<=" if figure in ("needless", "critical") else ">="
    bars = parse_requirement(f"{figure}{sign}0.5", DRIVE_FIGURES)
    assert not is_counted([good], bars)
    assert is_counted([good, bad], bars)
    assert not is_counted([bad], ())


def test_a_drive_in_which_the_stack_failed_is_no_miss() -> None:
    bars = parse_requirement("safe>=0.5,safe-both>=0.5", DRIVE_FIGURES)
    missed, failed = drive(False), drive(False, status="failed")
    assert is_counted([missed], bars)
    assert not is_counted([failed], bars)
    assert not is_counted([missed, failed], bars)
    assert not is_counted([drive(False, status="inconclusive")], bars)


@given(
    st.sampled_from(["safe", "safe-twin", "needless", "critical"]),
    st.booleans(),
    st.booleans(),
    st.sampled_from([None, 0.5, 2.0]),
    st.booleans(),
)
def test_what_is_counted_changes_the_figure(figure, is_twin, passed, ttc, needless) -> None:
    one = drive(
        is_twin,
        passed=passed,
        min_ttc_s=ttc,
        collisions=() if passed else ("a",),
        brakes_needlessly=needless if is_twin else None,
    )
    sign = "<=" if figure in ("needless", "critical") else ">="
    bars = parse_requirement(f"{figure}{sign}0.5", DRIVE_FIGURES)
    (grade,) = drive_requirements([one], [], bars)
    value = grade.bars[0].share
    missed = value is not None and value == (1.0 if sign == "<=" else 0.0)
    assert is_counted([one], bars) == missed
