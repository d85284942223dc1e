"""The lines about stacks and the baseline that a session prints at its end."""

from collections.abc import Iterable, Mapping
from pathlib import Path

from oodscen.data._drive_result import DriveResult
from oodscen.pytest_plugin._baseline import Change, KnownTest

_LISTED = 20
"""Maximum number of regressions that are listed by name."""


def stack_lines(drives: Iterable[DriveResult]) -> list[str]:
    """Return one line per stack, and one more per stack that drove twins."""
    by_stack: dict[tuple[str, bool], list[DriveResult]] = {}
    for drive in drives:
        by_stack.setdefault((drive.driver, drive.is_twin), []).append(drive)
    return [
        _stack_line(driver, results, is_twin=is_twin)
        for (driver, is_twin), results in sorted(by_stack.items())
    ]


def _stack_line(driver: str, results: list[DriveResult], *, is_twin: bool) -> str:
    passed = sum(result.passed for result in results)
    collided = sum(bool(result.collisions) for result in results)
    off_road = sum(result.off_road for result in results)
    failed = sum(result.status == "failed" for result in results)
    counts = (
        f"{passed} of {len(results)} safe, {collided} collisions, {off_road} off the road, "
        f"{failed} failed"
    )
    if not is_twin:
        return f"{driver}, scenes: {counts}"
    needless = sum(bool(result.brakes_needlessly) for result in results)
    return f"{driver}, twins: {counts}, {needless} braked needlessly"


def change_lines(
    file: Path, tests: Mapping[str, KnownTest], changes: Mapping[str, Change]
) -> list[str]:
    """Return how the outcomes of tests differ from the baseline in a file.

    Args:
        file: The file of the baseline.
        tests: The outcomes, by the ids of the tests.
        changes: The change of each.
    """
    by_change: dict[Change, list[str]] = {}
    for test, change in changes.items():
        by_change.setdefault(change, []).append(test)
    new_failures = sum(tests[test].outcome == "failed" for test in by_change.get("new", ()))
    regressions, improved = by_change.get("regression", []), by_change.get("improved", [])
    lines = [
        f"{file}: {len(regressions)} regressions, {new_failures} new failures, "
        f"{len(by_change.get('known', ()))} known failures, {len(improved)} improved"
    ]
    lines += [f"  regression: {test}" for test in regressions[:_LISTED]]
    if len(regressions) > _LISTED:
        lines.append(f"  and {len(regressions) - _LISTED} more")
    if improved:
        lines.append("  keep the improvements with --oodscen-baseline-mode update")
    return lines


def written_line(file: Path, tests: Mapping[str, KnownTest]) -> str:
    """Return how many outcomes were written to a file."""
    failed = sum(test.outcome == "failed" for test in tests.values())
    return f"{file}: {len(tests)} outcomes written, {failed} of them failures"
