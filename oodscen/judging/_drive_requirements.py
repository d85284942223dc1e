"""Requirements on driving stacks, in the grammar and with the test of those on models."""

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from oodscen.data._drive_result import DriveResult
from oodscen.data._pairing import scene_of
from oodscen.data._scenario import Scenario
from oodscen.judging._drive_board import drives_and_passes, is_critical, path_of, paths_of
from oodscen.judging._items import Floats, Mask, last_by
from oodscen.judging._leaderboard.requirements import (
    ALPHA,
    Bar,
    RequirementResult,
    RequirementTest,
    grade_of,
)

DRIVE_FIGURES = {
    "safe": "scenes driven without a collision, on the road",
    "safe-twin": "ordinary twins driven without a collision, on the road",
    "safe-both": "safe in the scene and in its twin, with at least half the way in the twin",
    "needless": "twins in which it brakes hard although keeping the speed is safe",
    "critical": "scenes with a collision, or a time to collision below 1.5 s",
}
"""Figures of a driving stack on which a bar can be put."""


def drive_requirements(
    drives: Iterable[DriveResult],
    scenarios: Iterable[Scenario],
    bars: Sequence[Bar],
    *,
    seed: int = 0,
) -> list[RequirementResult]:
    """Return the grade of every driver, in order of their names, by at least one bar of `DRIVE_FIGURES`.

    A drive that failed or is inconclusive counts as a missing answer: as wrong for "meets", as right for "fails". The
    last result of a driver in a scene replaces earlier ones.
    """
    paths = paths_of(scenarios)
    grouped: dict[str, list[DriveResult]] = {}
    for drive in last_by(drives, lambda drive: (drive.driver, drive.scene_id)):
        grouped.setdefault(drive.driver, []).append(drive)
    level = ALPHA / max(len(grouped), 1)
    results = []
    for name, drive_results in sorted(grouped.items()):
        clusters = [path_of(result, paths) for result in drive_results]
        tests = [
            RequirementTest(clusters, *_columns(bar.figure, drive_results), bar, seed)
            for bar in bars
        ]
        scenes = sum(not result.is_twin for result in drive_results)
        results.append(grade_of(name, tests, level, scenes / len(set(clusters))))
    return results


def _columns(figure: str, drives: Sequence[DriveResult]) -> tuple[Floats, Mask]:
    """Return the [n] values of a figure, NaN if there is none, and the [n] drives that lack theirs."""
    values = np.full(len(drives), np.nan)
    missing = np.zeros(len(drives), np.bool_)
    both = drives_and_passes(drives)
    driven = {scene_of(drive.scene_id) for drive in drives if drive.is_twin}
    simple: dict[str, tuple[bool, Callable[[DriveResult], bool | None]]] = {
        "safe": (False, lambda result: result.passed),
        "safe-twin": (True, lambda result: result.passed),
        "needless": (True, lambda result: result.brakes_needlessly),
        "critical": (False, is_critical),
    }
    for row, drive_result in enumerate(drives):
        if figure == "safe-both":
            if not drive_result.is_twin and drive_result.scene_id in driven:
                missing[row] = drive_result.scene_id not in both
                values[row] = both.get(drive_result.scene_id, np.nan)
            continue
        is_twin, value = simple[figure]
        if drive_result.is_twin == is_twin:
            missing[row] = drive_result.status != "ok"
            found = None if missing[row] else value(drive_result)
            values[row] = np.nan if found is None else found
    return values, missing
