"""The drives that a requirement counts as misses, whose failed assertions need not fail the session too."""

from collections.abc import Iterable, Sequence

from oodscen.data._drive_result import DriveResult
from oodscen.judging._drive_board import HARDLY_DRIVES, is_critical
from oodscen.judging._leaderboard.requirements import Bar


def is_counted(drives: Iterable[DriveResult], bars: Sequence[Bar]) -> bool:
    """Return whether a bar counts one of a test's drives as a miss; none does if the stack failed in one of them.

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


def _is_miss(result: DriveResult, figure: str) -> bool:
    match figure:
        case "safe":
            return not result.is_twin and not result.passed
        case "safe-twin":
            return result.is_twin and not result.passed
        case "safe-both":
            return not result.passed or (result.is_twin and result.progress < HARDLY_DRIVES)
        case "needless":
            return bool(result.brakes_needlessly)
        case "critical":
            return not result.is_twin and is_critical(result)
    raise AssertionError(figure)
