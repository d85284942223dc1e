"""The `progress` argument of long calls: a bar, a callable, or silence."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

from oodscen.errors import UsageError

Progress = Callable[[str, int, int], None]
"""Called after every finished item of a long task with the stage, the items done and their total."""

Item = TypeVar("Item")


def silent(stage: str, done: int, total: int) -> None:
    """Show nothing."""


@contextmanager
def reporting(progress: Progress | bool | None, note: object = "") -> Iterator[Progress]:
    """Return the callable that a `progress` argument stands for, and close its bars at the end.

    Args:
        progress: True for one bar per stage, which is a widget in a notebook; a callable; `None` or false for
            silence.
        note: Shown after a bar as text, as it is at the time.

    Raises:
        UsageError: If it is anything else.
    """
    if progress is None or progress is False:
        yield silent
        return
    if progress is not True:
        if not callable(progress):
            raise UsageError(f"progress must be True or a function, not {progress!r:.80}")
        yield progress
        return
    from tqdm.auto import tqdm

    bars: dict[str, tqdm[Any]] = {}

    def show(stage: str, done: int, total: int) -> None:
        bar = bars.get(stage)
        # A stage may come again, with other items. What was done before does not count into its speed.
        if bar is None or (bar.disable and done < total):
            bar = bars[stage] = tqdm(total=total, initial=done, desc=f"{stage:13}")
        bar.total = total
        if text := str(note):
            bar.set_postfix_str(text, refresh=False)
        bar.update(done - bar.n)
        if done >= total:
            bar.close()

    try:
        yield show
    finally:
        for bar in bars.values():
            bar.close()


def counted(
    items: Iterable[Item], stage: str, total: int, report_progress: Progress
) -> Iterator[Item]:
    """Yield items, and report each as done when the next one is asked for."""
    report_progress(stage, 0, total)
    for done, item in enumerate(items, start=1):
        yield item
        report_progress(stage, done, total)
