"""Progress of long work on standard error: bars in a terminal, lines in a log."""

import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from oodscen._cli.output import say
from oodscen._progress import Progress, counted, reporting

Item = TypeVar("Item")

_INTERVAL_S = 30.0
"""Time between the lines of a stage that goes on, s."""


@contextmanager
def bars(note: object = "") -> Iterator[Progress]:
    """Show progress on standard error: a bar per stage in a terminal, elsewhere a line at its end and every half minute.

    Args:
        note: Shown after a bar as text.
    """
    if sys.stderr is not None and sys.stderr.isatty():
        with reporting(True, note) as progress:
            yield progress
        return
    lines = _StageLines()
    try:
        yield lines
    finally:
        lines.end()


class _StageLines:
    """Prints lines for a log: the items and seconds of each stage that ends, and at intervals those done so far."""

    def __init__(self) -> None:
        self._began = time.monotonic()
        """Time at which the current stage began, which is the end of the one before."""
        self._printed_at = self._began
        self._counts: dict[str, tuple[int, int]] = {}
        """Items done and in all, by stage."""
        self._reported: set[tuple[str, int]] = set()
        """Stages that have their line, each with its items done."""

    def __call__(self, stage: str, done: int, total: int) -> None:
        """Note the items done; print the line when they are all."""
        self._counts[stage] = done, total
        if done >= total:
            self._print(stage)
        elif time.monotonic() - self._printed_at >= _INTERVAL_S:
            self._printed_at = time.monotonic()
            say(f"{stage}: {done} of {total} so far", err=True)

    def end(self) -> None:
        """Print the lines of the stages that ended early."""
        for stage in list(self._counts):
            self._print(stage)

    def _print(self, stage: str) -> None:
        done, total = self._counts.pop(stage)
        if not done or (stage, done) in self._reported:
            return
        self._reported.add((stage, done))
        before, self._began = self._began, time.monotonic()
        self._printed_at = self._began
        count = f"{done}" if done >= total else f"{done} of {total}"
        say(f"{stage}: {count} in {self._began - before:.1f} s", err=True)


def tracked(items: Iterable[Item], stage: str, total: int, note: object = "") -> Iterator[Item]:
    """Yield items, counted by `bars`; the stage stands before the bar, the note after it."""
    with bars(note) as progress:
        yield from counted(items, stage, total, progress)
