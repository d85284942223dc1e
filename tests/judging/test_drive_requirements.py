import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._drive_result import DriveResult
from oodscen.data._pairing import twin_id
from oodscen.errors import UsageError
from oodscen.judging._drive_requirements import (
    DRIVE_FIGURES,
    counts_a_miss,
    drive_requirements,
)
from oodscen.judging._leaderboard.figures import FAULTS
from oodscen.judging._leaderboard.requirements import parse_requirement


def drives(outcomes, *, paths=20, name="stack", **fields):
    """Return one drive per scene, and one of its twin that passes."""
    rows = []
    for number, outcome in enumerate(outcomes):
        scene = f"path{number % paths}-{number:03}"
        known = {"status": "failed"} if outcome is None else {"passed": outcome, **fields}
        rows.append(
            DriveResult(id=f"{scene}@{name}", scene_id=scene, driver=name, progress=1.0, **known)
        )
        twin = rows[-1].model_copy(
            update={
                "id": f"{twin_id(scene)}@{name}",
                "scene_id": twin_id(scene),
                "is_twin": True,
                "passed": True,
                "status": "ok",
                "brakes_needlessly": False,
            }
        )
        rows.append(twin)
    return rows


def grade(rows, text):
    (found,) = drive_requirements(rows, (), parse_requirement(text, DRIVE_FIGURES))
    return found


def test_figures_are_shares_of_what_was_driven() -> None:
    rows = drives([True] * 15 + [False] * 5)
    for figure, share in {
        "safe": 0.75,
        "safe-twin": 1.0,
        "safe-both": 0.75,
        "needless": 0.0,
        "critical": 0.0,
    }.items():
        sign = "<=" if figure in FAULTS else ">="
        (bar,) = grade(rows, f"{figure}{sign}0.5").bars
        assert (bar.share, bar.items, bar.missing) == (share, 20, 0), figure


def test_many_safe_paths_meet_and_many_unsafe_ones_fail() -> None:
    assert grade(drives([True] * 100, paths=100), "safe>=0.9,needless<=5%").grade == "meets"
    assert grade(drives([False] * 100, paths=100), "safe>=0.9").grade == "fails"
    assert grade(drives([True] * 3, paths=3), "safe>=0.9").grade == "cannot tell yet"


@given(st.lists(st.sampled_from((True, False, None)), min_size=1, max_size=12))
def test_a_drive_that_failed_counts_against_either_word(outcomes) -> None:
    found = grade(drives(outcomes), "safe>=0.6").bars[0]
    worst = grade(drives([bool(outcome) for outcome in outcomes]), "safe>=0.6").bars[0]
    best = grade(drives([outcome is not False for outcome in outcomes]), "safe>=0.6").bars[0]
    assert found.missing == outcomes.count(None)
    assert found.p_meets == worst.p_meets
    assert found.p_fails == best.p_fails


def test_only_the_last_of_repeated_drives_counts() -> None:
    rows = drives([True] * 15 + [False] * 5)
    assert grade([*drives([False] * 20), *rows], "safe>=0.9") == grade(rows, "safe>=0.9")


def test_models_and_stacks_have_their_own_figures() -> None:
    with pytest.raises(UsageError, match="notice"):
        parse_requirement("notice>=0.5", DRIVE_FIGURES)
    with pytest.raises(UsageError, match="critical"):
        parse_requirement("critical<=0.5")


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
    assert not counts_a_miss([good], bars)
    assert counts_a_miss([good, bad], bars)
    assert not counts_a_miss([bad], ())


@pytest.mark.parametrize("is_twin", [False, True])
def test_safe_both_counts_no_drive_without_its_counterpart(is_twin) -> None:
    missed, other = drive(is_twin), drive(not is_twin, passed=True)
    bars = parse_requirement("safe-both>=0.5", DRIVE_FIGURES)
    assert counts_a_miss([missed], bars)
    assert counts_a_miss([missed], bars, among=[missed, other])
    elsewhere = other.model_copy(update={"driver": "another"})
    assert not counts_a_miss([missed], bars, among=[missed, elsewhere])
    found = grade([missed], "safe-both>=0.5").bars[0]
    assert found.items == 0


def test_a_drive_in_which_the_stack_failed_is_no_miss() -> None:
    bars = parse_requirement("safe>=0.5,safe-both>=0.5", DRIVE_FIGURES)
    missed, failed = drive(False), drive(False, status="failed")
    assert counts_a_miss([missed], bars)
    assert not counts_a_miss([failed], bars)
    assert not counts_a_miss([missed, failed], bars)
    assert not counts_a_miss([drive(False, status="inconclusive")], bars)


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
    assert counts_a_miss([one], bars) == missed
