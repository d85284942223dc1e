"""Forks of the process under test."""

import os
import signal


def ended_fork():
    """Return the exit code of a fork of this process that is told to end."""
    child = os.fork()
    if not child:
        try:
            signal.raise_signal(signal.SIGTERM)
        finally:
            os._exit(0)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
