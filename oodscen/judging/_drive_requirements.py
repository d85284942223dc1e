"""Requirements on driving stacks, in the grammar and with the test of those on models."""

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np

from oodscen.data._drive_result import DriveResult
from oodscen.data._pairing import scene_of, twin_id
from oodscen.data._scenario import Scenario
from oodscen.judging._drive_board import (
    HARDLY_DRIVES,
    drives_and_passes,
    is_critical,
    path_of,
    paths_of,
)
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


class _Figure(NamedTuple):
    """A figure to which each drive adds a value of its own; `safe-both` is none, as it needs two drives."""

    is_of_twins: bool
    value_of: Callable[[DriveResult], bool | None]
    miss: bool
    """The value that counts against a stack."""


_FIGURES = {
    "safe": _Figure(False, lambda drive: drive.passed, miss=False),
    "safe-twin": _Figure(True, lambda drive: drive.passed, miss=False),
    "needless": _Figure(True, lambda drive: drive.brakes_needlessly, miss=True),
    "critical": _Figure(False, is_critical, miss=True),
}


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
    for name, driven in sorted(grouped.items()):
        clusters = [path_of(drive, paths) for drive in driven]
        tests = [
            RequirementTest(clusters, *_columns(bar.figure, driven), bar, seed) for bar in bars
        ]
        scenes = sum(not drive.is_twin for drive in driven)
        results.append(grade_of(name, tests, level, scenes / len(set(clusters))))
    return results


def counts_a_miss(
    drives: Sequence[DriveResult],
    bars: Sequence[Bar],
    *,
    among: Iterable[DriveResult] | None = None,
) -> bool:
    """Return whether a bar counts one of a test's drives as a miss; none does if the stack failed in one of them.

    Args:
        drives: The test's drives.
        bars: Bars on `DRIVE_FIGURES`.
        among: All drives, without which every drive is taken to have the counterpart that `safe-both` needs.
    """
    if any(drive.status == "failed" for drive in drives):
        return False
    others = None if among is None else {(one.driver, one.scene_id) for one in among}
    return any(
        _is_miss(drive, bar.figure)
        for drive in drives
        for bar in bars
        if drive.status == "ok"
        and (others is None or bar.figure != "safe-both" or _counterpart(drive) in others)
    )


def _counterpart(drive: DriveResult) -> tuple[str, str]:
    """Return the driver, and the scene of a twin or the twin of a scene."""
    scene = drive.scene_id
    return drive.driver, scene_of(scene) if drive.is_twin else twin_id(scene)


def _is_miss(drive: DriveResult, name: str) -> bool:
    if name == "safe-both":
        return not drive.passed or (drive.is_twin and drive.progress < HARDLY_DRIVES)
    figure = _FIGURES[name]
    return drive.is_twin == figure.is_of_twins and figure.value_of(drive) == figure.miss


def _columns(figure: str, drives: Sequence[DriveResult]) -> tuple[Floats, Mask]:
    """Return the [n] values of a figure, NaN if there is none, and the [n] drives that lack theirs."""
    if figure == "safe-both":
        return _paired_columns(drives)
    is_of_twins, value_of, _ = _FIGURES[figure]
    values = np.full(len(drives), np.nan)
    missing = np.zeros(len(drives), np.bool_)
    for row, drive in enumerate(drives):
        if drive.is_twin != is_of_twins:
            continue
        if drive.status != "ok":
            missing[row] = True
        elif (value := value_of(drive)) is not None:
            values[row] = value
    return values, missing


def _paired_columns(drives: Sequence[DriveResult]) -> tuple[Floats, Mask]:
    """Return the columns of `safe-both`, whose rows are the scenes of which the twin was driven, too."""
    values = np.full(len(drives), np.nan)
    missing = np.zeros(len(drives), np.bool_)
    passes = drives_and_passes(drives)
    with_twin = {scene_of(drive.scene_id) for drive in drives if drive.is_twin}
    for row, drive in enumerate(drives):
        if not drive.is_twin and drive.scene_id in with_twin:
            missing[row] = drive.scene_id not in passes
            values[row] = passes.get(drive.scene_id, np.nan)
    return values, missing
