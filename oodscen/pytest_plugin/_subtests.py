"""The subtests of a test: pytest reports each of them while the test runs, and the test itself last."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from oodscen.data._drive_result import DriveResult
    from oodscen.pytest_plugin._driving import Drive


@dataclass
class Subtests:
    """The subtests of one test that have been reported so far."""

    is_over: bool = False
    """True once the test has ended, so that the next report is its own."""
    forgiven: list[str | None] = field(default_factory=list)
    """Why each failed subtest does not fail the session; `None` where it does."""
    _driven: set[int] = field(default_factory=set)
    """Indices of the drives that subtests made, in the results of the test."""

    @property
    def all_forgiven(self) -> str | None:
        """The reason for which a test that passes but for its subtests is forgiven; `None` if it is not."""
        return self.forgiven[-1] if self.forgiven and all(self.forgiven) else None

    def own_drives(self, drive: "Drive", call: pytest.CallInfo[None]) -> "list[DriveResult]":
        """Return the drives that a subtest or test made, and those that no subtest made."""
        during_call = {index for index, began in enumerate(drive.began) if began >= call.start}
        results = [
            result
            for index, result in enumerate(drive.results)
            if index in during_call or index not in self._driven
        ]
        if not self.is_over:
            self._driven |= during_call
        return results
