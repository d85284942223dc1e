"""Commands that list and check installed components."""

import json
import sys
from concurrent.futures import BrokenExecutor
from typing import TYPE_CHECKING

import click

from oodscen._cli.groups import CommandGroup
from oodscen._cli.options import json_option, refuse_idle
from oodscen._cli.output import say
from oodscen._cli.progress import bars

if TYPE_CHECKING:
    from oodscen._doctor import CheckResult


@click.command()
@json_option
def plugins(as_json: bool) -> None:
    """List the installed models, encoders and simulators."""
    from oodscen._entry_points import survey

    rows = survey()
    if as_json:
        say(json.dumps(rows, indent=2))
        return
    for row in rows:
        say(f"{row['kind']:10} {row['name']:22} {row['source']:55} {row['state']}")


@click.group(cls=CommandGroup)
def new() -> None:
    """Write the beginnings of a package of your own."""


@new.command()
@click.argument("name")
@click.option("--into", default=".", help="Folder in which the package's folder is made.")
def adapter(name: str, into: str) -> None:
    """Write a package with a simulator adapter that passes `doctor --quick`, and its tests.

    NAME is the simulator's name; the package is oodscen_NAME. Replace its dynamics and pictures by those of
    the simulator that you connect.
    """
    from oodscen.testing._new.writing import write_adapter

    for path in write_adapter(name, into):
        say(f"wrote {path}")


@click.command()
@click.argument("what", required=False)
@click.argument("name", required=False)
@click.option("--api-base", help="Address of an OpenAI-compatible server, for llm NAME.")
@click.option("--quick", is_flag=True, help="Run only the quicker checks of a simulator.")
@click.option("--states-only", is_flag=True, help="Allow pixels that differ from run to run.")
@json_option
def doctor(
    what: str | None,
    name: str | None,
    api_base: str | None,
    quick: bool,
    states_only: bool,
    as_json: bool,
) -> None:
    """Check the installation, or one component.

    `doctor llm NAME` asks a language model two small questions, one with a picture. `doctor knowledge [FILE]`
    inspects the knowledge base of the built-in author, or a file of your own. `doctor SIMULATOR` checks an
    adapter with oodscen.testing.check_simulator.
    """
    from oodscen._doctor import CheckResult, examine, examine_knowledge, examine_llm
    from oodscen._members import message
    from oodscen._parallel.processes import run_apart

    if name is not None and what not in ("llm", "knowledge"):
        raise click.UsageError(f"unexpected argument {name!r}; usage: oodscen doctor SIMULATOR")
    if api_base is not None and what != "llm":
        raise click.UsageError("--api-base needs a model: oodscen doctor llm NAME")
    if what in (None, "llm", "knowledge"):
        refuse_idle("without a simulator: oodscen doctor SIMULATOR", "quick", "states_only")
    if what == "llm":
        if name is None:
            raise click.UsageError("name a model: oodscen doctor llm NAME")
        findings = examine_llm(name, api_base=api_base)
    elif what == "knowledge":
        findings = examine_knowledge(name)
    elif what is None:
        findings = examine()
    else:
        try:
            findings = run_apart(_examined, what, quick, states_only)
        except (BrokenExecutor, OSError) as error:
            findings = [CheckResult(f"simulator {what}", False, message(error))]
    if as_json:
        say(json.dumps([finding._asdict() for finding in findings], indent=2))
    else:
        for finding in findings:
            say(f"{'ok     ' if finding.is_ok else 'problem'} {finding.what}: {finding.detail}")
    sys.exit(not all(finding.is_ok for finding in findings))


def _examined(name: str, is_quick: bool, states_only: bool) -> "list[CheckResult]":
    """Check a simulator with a progress bar."""
    from oodscen._doctor import examine_simulator

    with bars() as progress:
        return examine_simulator(
            name, is_quick=is_quick, states_only=states_only, progress=progress
        )
