"""Interruptions leave no reports of what they cut off."""

import signal
import sys
from collections.abc import Iterator

import pytest

from oodscen._parallel.interrupts import raise_until_handled, unreported


class HalfMade:
    """Its finaliser needs what an interrupted constructor did not set."""

    def __del__(self) -> None:
        raise AttributeError("no handle")


@pytest.fixture
def reports(monkeypatch) -> Iterator[list[object]]:
    """Return the errors that Python has dropped; the alarm is off afterwards."""
    kept: list[object] = []
    monkeypatch.setattr(sys, "unraisablehook", lambda report: kept.append(report.exc_type))
    former = signal.getsignal(signal.SIGALRM)
    yield kept
    signal.setitimer(signal.ITIMER_REAL, 0.0)
    signal.signal(signal.SIGALRM, former)


def construct() -> None:
    """Be interrupted while something is half made."""
    half_made = HalfMade()
    raise_until_handled(KeyboardInterrupt)
    del half_made


def test_only_finalisers_after_an_interruption_fail_in_silence(reports) -> None:
    with unreported(KeyboardInterrupt):
        HalfMade()
        with pytest.raises(KeyboardInterrupt):
            raise_until_handled(KeyboardInterrupt)
        HalfMade()
    assert reports == [AttributeError]


def test_what_an_interruption_left_half_made_goes_with_it(reports) -> None:
    try:
        with unreported(KeyboardInterrupt):
            construct()
    except KeyboardInterrupt:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
    assert reports == []
