import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._drive_result import DriveResult
from oodscen.data._pairing import twin_id
from oodscen.errors import UsageError
from oodscen.judging._drive_requirements import DRIVE_FIGURES, drive_requirements
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
