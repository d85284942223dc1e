"""Findings of the conformance check, and their report."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

from oodscen._members import is_interruption

_NAMED = 6
"""Maximum number of subjects that a line names."""
_NOUNS = frozenset({"actor", "asset", "behaviour", "camera", "map", "scene", "trigger"})
"""First words of subjects that can be counted; their plural ends in s."""


class NotApplicable(Exception):
    """Raised by a part that has nothing to try, with the reason."""


class Finding(NamedTuple):
    """One broken promise."""

    subject: str
    """The thing that breaks it: `behaviour fall of cone`, `asset car brake`; may be empty."""
    message: str


class PartResult(NamedTuple):
    """The result of one part of the check."""

    part: str
    findings: tuple[Finding, ...]
    """Broken promises; empty if the part holds or does not apply."""
    inapplicable: str = ""
    """Why there was nothing to try; empty if the part was tried."""
    note: str = ""
    """The things that the part left out, in words; empty if none."""

    @property
    def holds(self) -> bool:
        """Return whether nothing was found."""
        return not self.findings

    def lines(self) -> list[str]:
        """Return the findings in words, those alike on one line."""
        groups: dict[str, list[Finding]] = {}
        for finding in self.findings:
            groups.setdefault(re.sub(r"\d+(\.\d+)?", "#", finding.message), []).append(finding)
        return [_line(self.part, group) for group in groups.values()]


def _line(part: str, group: list[Finding]) -> str:
    """Return findings whose words differ at most in numbers as one line, with the number and the names of their subjects."""
    subjects = list(dict.fromkeys(finding.subject for finding in group if finding.subject))
    message = group[0].message
    if not subjects:
        return f"{part}: {message}"
    if len(subjects) == 1:
        return f"{part}: {subjects[0]}: {message}"
    if any(finding.message != message for finding in group):
        message += " (the first)"
    nouns = {subject.partition(" ")[0] for subject in subjects}
    names = [subject.partition(" ")[2] for subject in subjects]
    if len(nouns) == 1 and nouns <= _NOUNS and all(names):
        counted = f"{len(names)} {nouns.pop()}s"
    else:
        names, counted = subjects, f"{len(subjects)} times"
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return f"{part}: {counted} ({', '.join(names[:_NAMED])}{more}): {message}"


class Findings:
    """Collects findings, so that one run reports all of them."""

    def __init__(self) -> None:
        self.recorded: list[Finding] = []
        self.notes: list[str] = []
        """The things that were left out, in words."""
        self.unstaged: list[str] = []
        """The runs that were left out because the catalogue has no room to stage them."""

    @property
    def note(self) -> str:
        """All that was left out, in words; empty if nothing was."""
        runs = [f"no room to stage {', '.join(self.unstaged)}"] if self.unstaged else []
        return "; ".join([*self.notes, *runs])

    def add(self, subject: str, message: str) -> None:
        """Record a finding."""
        self.recorded.append(Finding(subject, message))

    def expect(self, holds: object, subject: str, message: str) -> None:
        """Record a finding if the condition does not hold."""
        if not holds:
            self.add(subject, message)

    @contextmanager
    def trying(self, subject: str) -> Iterator[None]:
        """Record an exception as a finding instead of stopping."""
        try:
            yield
        except NotApplicable:
            raise
        except BaseException as error:
            if is_interruption(error):
                raise
            name, message = type(error).__name__, " ".join(str(error).split())
            self.add(subject, f"{name}: {message}" if message else name)
