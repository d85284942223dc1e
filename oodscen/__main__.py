"""Entry point of the command `oodscen` and of `python -m oodscen`."""

import sys


def main() -> None:
    """Run the command line; Ctrl-C while its modules are imported ends it in one line, as it does later."""
    try:
        from oodscen._cli import main as command
    except KeyboardInterrupt:
        print("oodscen: interrupted", file=sys.stderr)
        sys.exit(130)
    command(prog_name="oodscen")


if __name__ == "__main__":
    main()
