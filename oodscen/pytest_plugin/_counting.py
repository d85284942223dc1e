"""The drives that a requirement counts as misses, whose failed assertions need not fail the session too."""

from collections.abc import Iterable, Sequence

from oodscen.data._drive_result import DriveResult
from oodscen.judging._drive_board import HARDLY_DRIVES, is_critical
from oodscen.judging._leaderboard.requirements import Bar


def is_counted(drives: Iterable[DriveResult], bars: Sequence[Bar]) -> bool:
    """Return whether a bar counts one of a test's drives as a miss; none does where the stack failed in one of them.

    Args:
        drives: The drives of one test.
        bars: The requirement, of `DRIVE_FIGURES`.
    """
    results = list(drives)
    if any(result.status == "failed" for result in results):
        return False
    return any(
        _is_miss(result, bar.figure) for result in results for bar in bars if result.status == "ok"
    )


def _is_miss(one: DriveResult, figure: str) -> bool:
    match figure:
        case "safe":
            return not one.is_twin and not one.passed
        case "safe-twin":
            return one.is_twin and not one.passed
        case "safe-both":
            return not one.passed or (one.is_twin and one.progress < HARDLY_DRIVES)
        case "needless":
            return bool(one.brakes_needlessly)
        case "critical":
            return not one.is_twin and is_critical(one)
    raise AssertionError(figure)
