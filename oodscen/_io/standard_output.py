"""Standard output while a command runs: for its results alone.

What models, encoders, simulators and driving stacks write there goes to standard error, whether they are written in
Python or in C, or start processes.
"""

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout, suppress
from pathlib import Path
from typing import TextIO

_NAMES = frozenset({"/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"})

_results: TextIO | None = None
"""The stream of the results; `None` unless a command runs."""


def results() -> TextIO:
    """Return the stream of a command's results; outside of a command, that of everything."""
    return _results or sys.stdout


def place(out: Path) -> Path:
    """Return the file to open for an output: a name of standard output stands for that of the results."""
    if _results is None or str(out) not in _NAMES:
        return out
    try:
        return Path(f"/dev/fd/{_results.fileno()}")
    except OSError:  # A stream in memory.
        return out


@contextmanager
def for_results() -> Iterator[None]:
    """Keep standard output for the results of the command that runs."""
    global _results
    if _results is not None:
        yield
        return
    with _moved(sys.stdout) as _results, redirect_stdout(sys.stderr):
        try:
            yield
        finally:
            _results = None


@contextmanager
def _moved(stream: TextIO) -> Iterator[TextIO]:
    """Let the descriptor of a stream lead to standard error, and yield a stream that leads where it led.

    A stream in memory, or one without standard error beside it, is yielded itself.
    """
    try:
        number, error = stream.fileno(), sys.stderr.fileno()
    except (AttributeError, OSError, ValueError):
        yield stream
        return
    stream.flush()
    kept = os.dup(number)
    moved = os.fdopen(kept, "w", encoding=stream.encoding, errors=stream.errors)
    os.dup2(error, number)
    try:
        yield moved
    finally:
        _flush(stream)
        os.dup2(kept, number)
        moved.close()


def _flush(stream: TextIO) -> None:
    """Write out what Python and C hold back for standard output."""
    with suppress(OSError, ValueError):
        stream.flush()
    ctypes.CDLL(None).fflush(None)
