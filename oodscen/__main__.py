"""Entry point of the command `oodscen` and of `python -m oodscen`."""

import os
import sys
import threading
import time

_GRACE_S = 5.0
"""Seconds that threads of plug-ins have to end after the command."""


def main() -> None:
    """Run the command line; Ctrl-C while its modules are imported ends it in one line, as it does later."""
    try:
        from oodscen._cli import main as command
    except KeyboardInterrupt:
        print("oodscen: interrupted", file=sys.stderr)
        sys.exit(130)
    try:
        command(prog_name="oodscen")
    except SystemExit as ending:
        code = ending.code if isinstance(ending.code, int) else int(ending.code is not None)
        threading.Thread(target=_end, args=(code,), daemon=True).start()
        raise


def _end(code: int) -> None:
    """End the process with the command's exit code, even if a plug-in left a thread for which Python would wait."""
    time.sleep(_GRACE_S)
    left = sum(not thread.daemon for thread in threading.enumerate()) - 1
    print(f"oodscen: threads of plug-ins still ran: {left}", file=sys.stderr, flush=True)
    os._exit(code)


if __name__ == "__main__":
    main()
