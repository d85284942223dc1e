"""Interruptions leave no reports of what they cut off."""

import signal
import sys

import pytest

from oodscen._interrupts import raise_until_handled, unreported


class HalfMade:
    """Its finaliser needs what an interrupted constructor did not set."""

    def __del__(self) -> None:
        raise AttributeError("no handle")


def test_only_finalisers_after_an_interruption_fail_in_silence(monkeypatch) -> None:
    reports: list[object] = []
    monkeypatch.setattr(sys, "unraisablehook", lambda report: reports.append(report.exc_type))
    former = signal.getsignal(signal.SIGALRM)
    try:
        with unreported(KeyboardInterrupt):
            HalfMade()
            with pytest.raises(KeyboardInterrupt):
                raise_until_handled(KeyboardInterrupt)
            HalfMade()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, former)
    assert reports == [AttributeError]
