"""The command line: each command is a thin call of one public function.

`EXIT_CODES` lists the exit codes of every command. Commands can name modules of the current folder, as in
`--driver my_stack:Driver`.
"""

import os
import shlex
import signal
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any

import click

from oodscen._cli.commands import (
    claims,
    completion,
    components,
    driving,
    evaluation,
    export,
    init,
    interchange,
    judging,
    measuring,
    props,
    pruning,
    publishing,
    serving,
    show,
    stages,
    study,
    tree,
)
from oodscen._cli.groups import CommandGroup
from oodscen._cli.help import COMMANDS, sections_of
from oodscen._cli.output import drop_output, say, shortened
from oodscen._parallel.interrupts import in_this_process, raise_until_handled, unreported
from oodscen._parallel.processes import ending_children
from oodscen._version import __version__
from oodscen._words.redaction import redact
from oodscen._words.text import printable, text_fault
from oodscen.errors import OodscenError, RunStopped, UsageError
from oodscen.llm._remote.offline import enforce

# Idle threads that spin slow a busy machine down many times. torch reads this setting when it is
# loaded.
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")


_ONE_S = 0.1
"""Seconds within which further signals are the same: `timeout` and service managers signal a process and its group."""
_ORDER = "oodscen.order"
"""The key in a click context for the arguments after the program's name."""


class _MainGroup(CommandGroup):
    """Turns the library's errors into one friendly line and an exit code."""

    def main(self, args: Sequence[str] | None = None, *rest: Any, **options: Any) -> Any:
        try:
            return super().main(args, *rest, **options)
        except OSError as error:
            if "--debug" in (sys.argv if args is None else args):
                raise
            with suppress(OSError):
                file = f" {error.filename}" if error.filename else ""
                message = redact(f"cannot write the output{file}: {error.strerror or error}")
                say(f"oodscen: {message}", err=True)
            drop_output()
            sys.exit(1)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands under what they are for."""
        for title, names in sections_of(COMMANDS, self.commands, "Further commands").items():
            with formatter.section(title):
                limit = formatter.width - 6 - max(map(len, names))
                rows = [(name, self.commands[name].get_short_help_str(limit)) for name in names]
                formatter.write_dl(rows)

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        for word in args:
            if fault := text_fault(word):
                raise click.UsageError(f"{fault}.")
        ctx.meta[_ORDER] = list(args)
        try:
            return super().parse_args(ctx, args)
        except click.ClickException as error:
            _clean(error)
            raise

    def invoke(self, ctx: click.Context) -> Any:
        order = ctx.meta.get(_ORDER, [])
        try:
            if sys.stdout is None:
                raise UsageError("standard output is closed; send it to a file or to /dev/null")
            with ending_children(), _interruptible():
                return super().invoke(ctx)
        except click.ClickException as error:
            _clean(error)
            raise
        except KeyboardInterrupt as interrupt:
            continuation = ""
            if ctx.invoked_subcommand in ("run", "evaluate") and "--dry-run" not in order:
                command = redact(shlex.join(["oodscen", *_without(order, "--drop")]))
                continuation = f"; finished work is saved, and this command continues: {command}"
            with suppress(OSError):  # the terminal has hung up
                say(f"oodscen: interrupted{continuation}", err=True)
            ctx.exit(128 + getattr(interrupt, "signal", signal.SIGINT))
        except MemoryError:
            if ctx.params.get("debug"):
                raise
            say("oodscen: there is not enough memory; --debug shows where", err=True)
            ctx.exit(1)
        except OodscenError as error:
            if ctx.params.get("debug"):
                raise
            say(f"oodscen: {shortened(redact(str(error)))}", err=True)
            ctx.exit(_exit_code(error))


def _exit_code(error: OodscenError) -> int:
    if isinstance(error, UsageError):
        return 2
    return 3 if isinstance(error, RunStopped) else 1


def _clean(error: click.ClickException) -> None:
    """Make click's own message, which quotes what was typed, safe to print, and cut very long lines."""
    vars(error)["message"] = shortened(printable(redact(error.message)))  # click declares it final.


class _Interrupt(KeyboardInterrupt):
    """A signal that asks the command to end."""

    def __init__(self, number: int) -> None:
        self.signal = number
        super().__init__()


@contextmanager
def _interruptible() -> Iterator[None]:
    """Let SIGTERM and SIGHUP interrupt as Ctrl-C does; a second signal ends the process at once.

    A signal that the process was started to ignore, as under `nohup`, stays ignored. A foreign error after an
    interruption counts as the interruption: a compiler whose callback was cut off fails a moment later.
    """
    handlers: dict[int, Any] = {}
    received: list[int] = []

    def interrupt(number: int, frame: FrameType | None) -> None:
        for handled in handlers:
            signal.signal(handled, signal.SIG_IGN)
        time.sleep(_ONE_S)
        for handled in handlers:
            signal.signal(handled, signal.SIG_DFL)
        handlers[signal.SIGALRM] = signal.getsignal(signal.SIGALRM)
        received.append(number)
        raise_until_handled(lambda: _Interrupt(number))

    handler = in_this_process(interrupt, handlers)
    try:
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
                if signal.getsignal(number) is not signal.SIG_IGN:
                    handlers[number] = signal.getsignal(number)
                    signal.signal(number, handler)
        with unreported(_Interrupt):
            yield
    except (OodscenError, click.ClickException, click.exceptions.Exit):
        raise
    except Exception as error:
        if received:
            raise _Interrupt(received[0]) from error
        raise
    finally:
        if signal.SIGALRM in handlers:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
        for handled, former in handlers.items():
            signal.signal(handled, former)


def _without(order: list[str], option: str) -> list[str]:
    """Return the arguments without an option, and its value, that must not be repeated."""
    remaining: list[str] = []
    words = iter(order)
    for word in words:
        if word == option:
            next(words, None)
        elif not word.startswith(f"{option}="):
            remaining.append(word)
    return remaining


EXIT_CODES = {
    0: "success",
    1: "some items failed, a check failed, or a file cannot be written; what succeeded is written",
    2: "invalid request: unknown name, unreadable or malformed file, folder of another study",
    3: "stopped by a cap or a server that is down; what succeeded is written",
    4: "a model fails the requirement (--require)",
    5: "no model fails the requirement, but there are too few scenes to tell of one",
    129: "interrupted by SIGHUP (terminal closed); what succeeded is written",
    130: "interrupted by Ctrl-C (SIGINT); what succeeded is written",
    143: "interrupted by SIGTERM; what succeeded is written",
}

_EPILOG = "\b\nExit codes:\n" + "\n".join(
    f"  {code}  {meaning}" for code, meaning in EXIT_CODES.items()
)


@click.group(
    cls=_MainGroup, context_settings={"help_option_names": ["-h", "--help"]}, epilog=_EPILOG
)
@click.version_option(__version__, prog_name="oodscen")
@click.option("--debug", is_flag=True, help="Show tracebacks.")
@click.pass_context
def main(context: click.Context, debug: bool) -> None:
    """Test automated driving on out-of-distribution scenarios written by language models."""
    enforce()
    try:
        folder = os.getcwd()
    except OSError:
        raise UsageError("the current folder no longer exists; change to one that does") from None
    if folder not in sys.path:
        sys.path.append(folder)
        context.call_on_close(lambda: sys.path.remove(folder))


for _command in (
    study.run,
    init.init,
    show.show,
    stages.grow,
    stages.redteam,
    pruning.prune,
    props.props,
    stages.describe,
    stages.augment,
    claims.check_claims,
    stages.simulate,
    evaluation.evaluate,
    driving.drive,
    serving.serve,
    export.export,
    interchange.import_,
    interchange.verdict,
    interchange.vary,
    measuring.score,
    judging.audit,
    judging.power,
    study.report,
    study.quiz,
    publishing.publish,
    tree.tree,
    components.plugins,
    components.doctor,
    completion.completion,
    components.new,
):
    main.add_command(_command)

if sys.flags.optimize > 1:
    for _command in (main, *main.commands.values()):
        _command.epilog = (
            "python -OO drops the descriptions of the commands; those of the options stay."
        )
