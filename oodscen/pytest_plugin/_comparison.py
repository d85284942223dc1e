"""The tests of a session beside those of its baseline."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from oodscen._io.files import check_name
from oodscen.errors import OodscenError, UsageError
from oodscen.pytest_plugin._baseline import Change, KnownOutcomes, KnownTest, Outcome, update


class BaselineComparison:
    """The outcomes of a session's tests, compared with a baseline's or written as one.

    Args:
        file: The file of the baseline; without one, no test is known and nothing is written.
        mode: `compare`, `write` or `update`.

    Raises:
        UsageError: If there is a mode without a file, or the file is no baseline.
    """

    def __init__(self, file: Path | None, mode: str) -> None:
        self._file, self._mode = file, mode
        self._known = self._read()
        self._changes: dict[str, Change] = {}
        self._tests: dict[str, KnownTest] = {}
        """The outcomes of this session's tests, by their ids in the baseline."""

    def _read(self) -> KnownOutcomes:
        """Return the known outcomes; none yet if they are to be written."""
        if self._file is None:
            if self._mode != "compare":
                raise UsageError(f"--oodscen-baseline-mode {self._mode} needs --oodscen-baseline")
            return KnownOutcomes(tests={})
        check_name(self._file)
        if self._mode != "compare" and not self._file.exists():
            return KnownOutcomes(tests={})
        if self._mode != "write":
            return KnownOutcomes.at(self._file)
        try:
            KnownOutcomes.at(self._file)
        except OodscenError as error:
            raise UsageError(f"{error}\nonly a baseline is overwritten") from None
        return KnownOutcomes(tests={})

    @property
    def has_file(self) -> bool:
        """True if the session names a baseline."""
        return self._file is not None

    def test_id(self, item: pytest.Item) -> str:
        """Return the id of a test in the baseline: its path is relative to the file of the baseline.

        Pytest's own ids are relative to a root folder that depends on the command line.
        """
        if self._file is None:
            return item.nodeid
        path = Path(os.path.relpath(item.path, self._file.parent)).as_posix()
        test = f"{path}::{item.nodeid.partition('::')[2]}"
        # Names of files need not be UTF-8, the baseline must.
        return test.encode("utf-8", "backslashreplace").decode()

    def change(self, test: str, outcome: Outcome, scene: str) -> Change:
        """Return how a test differs from the baseline; `scene` is the digest of its scene."""
        return self._known.change(test, outcome, scene)

    def forgives(self, change: Change) -> str | None:
        """Return why a failure with this change does not fail the session; `None` if it does."""
        if self._mode != "compare":
            return "goes into the baseline"
        return "failed in the baseline" if change == "known" else None

    def add(self, test: str, known: Mapping[str, Any], change: Change) -> None:
        """Add the outcome of a test, as its report carries it."""
        self._tests[test] = KnownTest.parse(known)
        self._changes[test] = change

    def save(self) -> None:
        """Write the outcomes, if they are to become the baseline or a part of it.

        Raises:
            OodscenError: If the file cannot be written.
        """
        if self._file is None or not self._tests:
            return
        if self._mode == "update":
            update(self._file, self._tests)
        elif self._mode == "write":
            KnownOutcomes(tests=self._tests).write(self._file)

    def lines(self, *, is_whole: bool) -> list[str]:
        """Return how the outcomes differ from the baseline, or where they were written."""
        if self._file is None or not self._tests:
            return []
        from oodscen.pytest_plugin._summary import change_lines, written_line

        if not is_whole:
            return [f"{self._file}: not all tests ran, so that nothing is written or compared"]
        if self._mode != "compare":
            return [written_line(self._file, self._tests)]
        return change_lines(self._file, self._tests, self._changes)
