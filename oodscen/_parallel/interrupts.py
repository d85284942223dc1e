"""Interruptions that reach the code they interrupt.

Python drops an exception that is raised within a finaliser or a callback, such as a compiler's, and reports it on
standard error. An interruption is therefore raised again as long as nothing handles it.
"""

import os
import signal
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from types import FrameType
from typing import Any, NoReturn

AGAIN_S = 0.5
"""Time after which a dropped interruption is raised again, s."""


def in_this_process(
    handler: Callable[[int, FrameType | None], None], before: Mapping[int, Any]
) -> Callable[[int, FrameType | None], None]:
    """Return a signal handler that is in force in this process alone.

    A fork, such as a worker of a component's pool, inherits it, and takes the handlers of before at its first signal.
    """
    owner = os.getpid()

    def handle(number: int, frame: FrameType | None) -> None:
        if os.getpid() == owner:
            handler(number, frame)
            return
        for one, former in before.items():
            signal.signal(one, former)
        signal.raise_signal(number)

    return handle


def raise_until_handled(interruption: Callable[[], KeyboardInterrupt]) -> NoReturn:
    """Raise an interruption from a signal handler, and again until something handles it.

    The timer and SIGALRM are the caller's to restore.
    """

    def raise_again(number: int, frame: FrameType | None) -> None:
        if sys.exc_info()[1] is None:
            raise interruption()

    signal.signal(signal.SIGALRM, raise_again)
    signal.setitimer(signal.ITIMER_REAL, AGAIN_S, AGAIN_S)
    raise interruption()


@contextmanager
def unreported(kind: type[KeyboardInterrupt]) -> Iterator[None]:
    """Drop interruptions of a kind without a report where Python drops them.

    So are errors after an interruption: what it left half made may fail in its finaliser.
    """

    def report(dropped: "sys.UnraisableHookArgs") -> None:
        is_interrupted = signal.getitimer(signal.ITIMER_REAL)[1] == AGAIN_S
        if not (is_interrupted or isinstance(dropped.exc_value, kind)):
            report_others(dropped)

    report_others, sys.unraisablehook = sys.unraisablehook, report
    try:
        yield
    except kind as interruption:
        # What is half made goes now, not after the report is back.
        traceback.clear_frames(interruption.__traceback__)
        raise
    finally:
        sys.unraisablehook = report_others
