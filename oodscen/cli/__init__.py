"""The command line: each command is a thin call of one public function.

`EXIT_CODES` is what every command ends with. Modules in the current folder can be named, as in
`--driver my_stack:Driver`.
"""

import os
import shlex
import sys
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import click

from oodscen._text import one_line, plain, whole
from oodscen._version import __version__
from oodscen.cli import (
    claims,
    components,
    driving,
    judging,
    measuring,
    pruning,
    stages,
    study,
    tree,
)
from oodscen.cli.output import say, shortened
from oodscen.errors import OodscenError, RunStopped, UsageError
from oodscen.llms.redaction import redact

# Threads that wait for work by spinning make a busy machine many times slower; read when torch is loaded.
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")


_ORDER = "oodscen.order"
"""Key of the words behind the program's name in a context."""


class _Group(click.Group):
    """Turns errors of the library into one friendly line and an exit code."""

    def main(self, args: Sequence[str] | None = None, *given: Any, **options: Any) -> Any:
        try:
            return super().main(args, *given, **options)
        except OSError as error:
            if "--debug" in (sys.argv if args is None else args):
                raise
            with suppress(OSError):
                say(f"oodscen: {shortened(str(error))}", err=True)
            _silence()
            sys.exit(1)

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        for word in args:
            if "\0" in word or whole(word) != word:
                raise click.UsageError(f"{one_line(plain(word))[:100]!r} is no text in UTF-8.")
        ctx.meta[_ORDER] = list(args)
        return super().parse_args(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:
        order = ctx.meta.get(_ORDER, [])
        try:
            return super().invoke(ctx)
        except click.ClickException as error:
            vars(error)["message"] = shortened(error.message)  # click declares it final.
            raise
        except KeyboardInterrupt:
            again = ""
            if ctx.invoked_subcommand in ("run", "evaluate"):
                command = redact(shlex.join(["oodscen", *_without(order, "--drop")]))
                again = f"; what is done is written, and this command continues: {command}"
            say(f"oodscen: interrupted{again}", err=True)
            ctx.exit(130)
        except OodscenError as error:
            if ctx.params.get("debug"):
                raise
            say(f"oodscen: {shortened(redact(str(error)))}", err=True)
            ctx.exit(
                2 if isinstance(error, UsageError) else 3 if isinstance(error, RunStopped) else 1
            )


def _silence() -> None:
    """Drop what an output that is full or gone did not take, or it is tried again, and fails, at exit."""
    for stream in filter(None, (sys.stdout, sys.stderr)):
        try:
            stream.flush()
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _without(order: list[str], option: str) -> list[str]:
    """Leave out an option that is done once and for all, with its value."""
    kept: list[str] = []
    words = iter(order)
    for word in words:
        if word == option:
            next(words, None)
        elif not word.startswith(f"{option}="):
            kept.append(word)
    return kept


EXIT_CODES = {
    0: "all went well",
    1: "some items failed, or a check says no; what succeeded is written",
    2: "the request cannot be met: unknown name, malformed or empty file, folder of another study",
    3: "stopped by a cap or a server that is down; the same command continues",
    130: "interrupted (Ctrl-C); the same command continues",
}

_EPILOG = "\b\nExit codes:\n" + "\n".join(f"  {code}  {said}" for code, said in EXIT_CODES.items())


@click.group(cls=_Group, context_settings={"help_option_names": ["-h", "--help"]}, epilog=_EPILOG)
@click.version_option(__version__, prog_name="oodscen")
@click.option("--debug", is_flag=True, help="Show tracebacks.")
@click.pass_context
def main(context: click.Context, debug: bool) -> None:
    """Out-of-distribution driving scenarios: tree, texts, scenes, episodes, judged models."""
    here = os.getcwd()
    if here not in sys.path:
        sys.path.append(here)
        context.call_on_close(lambda: sys.path.remove(here))


for _command in (
    study.run,
    stages.grow,
    stages.redteam,
    pruning.prune,
    stages.describe,
    stages.augment,
    claims.faithful,
    stages.simulate,
    study.evaluate,
    driving.drive,
    measuring.score,
    judging.power,
    study.report,
    tree.tree,
    components.plugins,
    components.doctor,
):
    main.add_command(_command)
