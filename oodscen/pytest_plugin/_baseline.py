"""The baseline: the outcomes of tests that are known, so that only regressions fail."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar, Literal

from oodscen._io.files import write_named, writing
from oodscen._io.lock import locked
from oodscen.data._base import Data
from oodscen.errors import StudyError, UsageError

_PATIENCE_S = 10.0
"""Seconds to wait for another session that updates the same file."""

Outcome = Literal["passed", "failed"]
Change = Literal["same", "regression", "known", "improved", "new"]
"""The change of an outcome: still passed, now failed, still failed, now passed, or no known outcome."""


class KnownTest(Data):
    """The known outcome of one test in one scene."""

    outcome: Outcome
    scene: str
    """SHA-256 digest of the scene; the outcome in a scene that has changed is not known."""


class KnownOutcomes(Data):
    """The known outcomes of the tests of a repository."""

    noun: ClassVar[str] = "baseline"

    schema_version: Literal[1] = 1
    tests: dict[str, KnownTest]
    """By the id of the test."""

    @classmethod
    def at(cls, path: Path) -> "KnownOutcomes":
        """Read a baseline.

        Raises:
            UsageError: If there is none.
            DataError: If it is malformed.
        """
        if not path.exists():
            raise UsageError(
                f"the baseline {path} does not exist yet; write it with --oodscen-baseline-mode write"
            )
        return cls.load(path)

    def change(self, test: str, outcome: Outcome, scene: str) -> Change:
        """Compare an outcome with the known one."""
        known_test = self.tests.get(test)
        if known_test is None or known_test.scene != scene:
            return "new"
        if known_test.outcome == outcome:
            return "known" if outcome == "failed" else "same"
        return "regression" if outcome == "failed" else "improved"

    def write(self, path: Path) -> None:
        """Write one line per test, in order of their ids.

        Raises:
            StudyError: If it cannot be written.
        """
        rows = [
            f"{json.dumps(name)}: {test.to_json()}" for name, test in sorted(self.tests.items())
        ]
        lines = ",\n".join(rows)
        content = f'{{"schema_version": {self.schema_version}, "tests": {{\n{lines}\n}}}}\n'
        with writing(path, StudyError):
            write_named(path, content.encode())


def update(path: Path, tests: Mapping[str, KnownTest]) -> None:
    """Replace or add outcomes in a file, which other sessions may update meanwhile.

    Raises:
        DataError: If the file is malformed.
        InUse: If another session does not let go of it.
        StudyError: If it cannot be written.
    """
    with writing(path, StudyError):
        path.parent.mkdir(parents=True, exist_ok=True)
    with locked(path, KnownOutcomes.noun, wait_s=_PATIENCE_S):
        known = KnownOutcomes.load(path).tests if path.exists() else {}
        KnownOutcomes(tests={**known, **tests}).write(path)
