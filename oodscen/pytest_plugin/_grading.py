"""The drives of a session and the requirement that their stacks are graded by."""

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import pytest

from oodscen._words.text import first_few

if TYPE_CHECKING:
    from oodscen.data._drive_result import DriveResult
    from oodscen.judging._leaderboard.requirements import Bar, RequirementResult
    from oodscen.study._study import Study


class StackGrades:
    """The drives of a session's stacks, and their grades.

    Args:
        requirement: The bars, as `--oodscen-require` takes them; without any, nothing is graded.

    Raises:
        UsageError: If the requirement is malformed.
    """

    def __init__(self, requirement: str | None) -> None:
        self._bars = _parse_bars(requirement)
        self._drives: dict[str, DriveResult] = {}
        self._forgiven: list[list[DriveResult]] = []
        """The drives of every failure that was left to a bar."""
        self._uncounted: list[str] = []
        """The scenes of those failures that no bar counts in the end."""
        self._grades: list[RequirementResult] = []

    @property
    def are_required(self) -> bool:
        """True if there is a requirement."""
        return bool(self._bars)

    def add(
        self, rows: Iterable[Mapping[str, Any]], forgiven: Iterable[Mapping[str, Any]] = ()
    ) -> None:
        """Add drives, as reports carry them; of several drives by one stack the worst counts.

        Args:
            rows: All drives of the report's test.
            forgiven: Those that its failure may be about, if `forgives` left it to a bar.
        """
        from oodscen.data._drive_result import DriveResult

        for result in map(DriveResult.parse, rows):
            before = self._drives.get(result.id)
            if before is None or before.passed:
                self._drives[result.id] = result
        if drives := [DriveResult.parse(row) for row in forgiven]:
            self._forgiven.append(drives)

    def forgives(self, call: pytest.CallInfo[None], drives: "Sequence[DriveResult]") -> str | None:
        """Return why a failure does not fail the session; `None` if it does.

        Args:
            call: What failed.
            drives: The drives that it may be about.
        """
        from oodscen.judging._drive_requirements import counts_a_miss

        if call.excinfo is None:
            return None
        is_assertion = call.excinfo.errisinstance((AssertionError, pytest.fail.Exception))
        if is_assertion and counts_a_miss(drives, self._bars):
            return "counted by --oodscen-require"
        return None

    def meets(self, study: "Study") -> bool:
        """Grade the stacks, and return whether there are any, all meet the requirement, and it counts every failure."""
        from oodscen.judging._drive_requirements import counts_a_miss, drive_requirements

        all_drives = self._drives.values()
        self._grades = drive_requirements(
            all_drives, study.scenarios, self._bars, seed=study.config.seed
        )
        self._uncounted = [
            drives[0].scene_id
            for drives in self._forgiven
            if not counts_a_miss(drives, self._bars, among=all_drives)
        ]
        return self._is_met

    @property
    def _is_met(self) -> bool:
        grades = {grade.grade for grade in self._grades}
        return grades == {"meets"} and not self._uncounted

    def lines(self) -> list[str]:
        """Return the stacks' figures, their grades, and whether the requirement is met."""
        from oodscen.pytest_plugin._summary import stack_lines

        lines = [*stack_lines(self._drives.values()), *map(str, self._grades)]
        if self._grades:
            bars = ",".join(map(str, self._bars))
            fault = "" if self._is_met else "not "
            end = "" if self._is_met else ", so the session fails"
            lines.append(f"requirement {fault}met{end}: {bars}")
        if self._uncounted:
            scenes = first_few(list(dict.fromkeys(self._uncounted)))
            lines.append(f"safe-both counts no failure without a drive of scene and twin: {scenes}")
        return lines

    def missing(self, *, is_whole: bool, is_cut_short: bool) -> list[str]:
        """Return why no stack is graded, if one should be."""
        if not self._bars or self._grades:
            return []
        if is_whole or not (self._drives or is_cut_short):
            return ["no stack drove a scene, so none can meet --oodscen-require"]
        return ["not all tests ran, so that no stack is graded by --oodscen-require"]


def _parse_bars(text: str | None) -> "tuple[Bar, ...]":
    if text is None:
        return ()
    from oodscen.judging._drive_requirements import DRIVE_FIGURES
    from oodscen.judging._leaderboard.requirements import parse_requirement

    return parse_requirement(text, DRIVE_FIGURES)
