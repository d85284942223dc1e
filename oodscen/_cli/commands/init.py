"""The command that writes a TOML file with every option of `oodscen run`, with comments."""

import json
import re
import shlex
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

from oodscen._arguments import refuse_key
from oodscen._cli.configuration import RUN_SECTIONS, options_of
from oodscen._cli.help import option_key, sections_of
from oodscen._cli.output import say, write
from oodscen._cli.paths import FileCommand, OutputName
from oodscen._entry_points import DEFAULT_LLM
from oodscen._io.files import is_written_through
from oodscen._words.text import one_line, text_fault
from oodscen.errors import UsageError

_EXAMPLES: Mapping[str, Any] = {
    "red-llm": "gpt-4o",
    "fallback": "gpt-4o-mini",
    "rarity-llm": "gpt-4o",
    "recogniser": "gpt-4o",
    "api-base": "http://localhost:8000/v1",
    "vlm": ["gpt-4o"],
    "judge": "gpt-4o",
    "max-cost": 5.0,
    "max-requests": 1_000,
    "max-tokens": 1_000_000,
    "max-seconds": 3_600,
    "price": ["my-model=2.5,10"],
    "tree": "tree.json",
    "red-budget": 500,
    "red-patience": 20,
    "red-coverage": 0.9,
    "rarity": [1_000.0, 1_000_000.0],
    "baseline": "texts.txt",
    "band": [-0.9, 0.0],
    "set": [10, 100],
    "chain": False,
    "twins": True,
    "made": True,
    "max-paths": 10,
    "workers": 2,
    "horizon": 8.0,
    "context": 8_192,
    "video": "both",
    "catalogue": ["carla-0.9.16"],
}
"""Values that show the form of an option that has no default of its own."""


@click.command(cls=FileCommand)
@click.option("--llm", help="Model that writes the scenarios.")
@click.option("--vlm", "vlms", multiple=True, help="Vision-language model to judge; repeatable.")
@click.option(
    "--quick/--no-quick", default=None, help="A small study in seconds, or the whole one."
)
@click.option(
    "-o",
    "--out",
    type=OutputName(),
    default="run.toml",
    show_default=True,
    help="File to write.",
)
@click.option("--force", is_flag=True, help="Replace the file if there is one.")
def init(
    llm: str | None, vlms: tuple[str, ...], quick: bool | None, out: Path, force: bool
) -> None:
    """Write a commented configuration file for `oodscen run OUT --config FILE`.

    Asks for what the options leave open; in a pipe, takes the defaults.
    """
    from oodscen._cli.commands.study import run

    if out.exists() and not force and not is_written_through(out):
        raise UsageError(f"{out} exists; name another file with --out, or replace it with --force")
    if is_terminal():
        llm, vlms, quick = _ask(llm, vlms, quick)
    for model in (llm, *vlms):
        if model is not None:
            _check_model(model)
    chosen: dict[str, Any] = {"llm": llm or DEFAULT_LLM, "quick": bool(quick)}
    if vlms:
        chosen["vlm"] = list(vlms)
    write(out, commented(run, chosen))
    if not is_written_through(out):
        start = f"oodscen run OUT --config {shlex.quote(str(out))}"
        say(f"{out} is written; start with: {start}", err=True)


def _ask(
    llm: str | None, vlms: tuple[str, ...], quick: bool | None
) -> tuple[str, tuple[str, ...], bool]:
    """Return the choices, after asking for those that are open."""
    if llm is None:
        typed = click.prompt(
            "Model that writes the scenarios (builtin needs no key; or a name such as gpt-4o)",
            default=DEFAULT_LLM,
        )
        llm = typed.strip() or DEFAULT_LLM
    if not vlms:
        listed = click.prompt(
            "Vision-language models to judge, separated by commas (empty: none)",
            default="",
            show_default=False,
        )
        vlms = tuple(filter(None, map(str.strip, listed.split(","))))
    if quick is None:
        quick = click.confirm("A small study in seconds instead of the whole one?")
    return llm, vlms, quick


def _check_model(name: str) -> None:
    if (fault := text_fault(name)) or not name.strip() or one_line(name) != name:
        raise UsageError(f"the model {fault or f'has the unusable name {name[:100]!r}'}")
    refuse_key("the model", name)


def is_terminal() -> bool:
    """Return whether a person can be asked."""
    return sys.stdin is not None and sys.stdin.isatty()


def commented(command: click.Command, chosen: Mapping[str, Any]) -> str:
    """Return a TOML file with every option of a command: the chosen ones set, the others in comments."""
    options = options_of(command)
    lines = [
        "# Options of `oodscen run OUT --config FILE`. Those on the command line win over these.",
        "# A line that starts with `# name =` shows a default, or the form of a value; remove the `# ` to set it.",
    ]
    for title, names in sections_of(RUN_SECTIONS, options, "Further options").items():
        lines += ["", f"# ---- {title}"]
        for name in names:
            option = options[name]
            lines += ["", f"# {_words(option)}"]
            value = chosen.get(name, _shown(option))
            lines.append(f"{'' if name in chosen else '# '}{name} = {_literal(value)}")
    return "\n".join(lines)


def _words(option: click.Option) -> str:
    """Return the help of an option on one line, with its choices."""
    text = one_line(option.help or "")
    if isinstance(option.type, click.Choice):
        text += f" One of {', '.join(map(str, option.type.choices))}."
    return text


def _shown(option: click.Option) -> Any:
    """Return the default of an option, or a value that shows its form."""
    from oodscen.study._config import StudyConfig

    name = option_key(option)
    if name in _EXAMPLES:
        return _EXAMPLES[name]
    default = option.get_default(click.Context(click.Command("run")))
    if not isinstance(default, bool | int | float | str):  # Unset, in some form of click's.
        field = StudyConfig.model_fields.get(str(option.name))
        default = field.get_default(call_default_factory=True) if field else None
    if isinstance(default, tuple):
        default = list(default)
    return default


def _literal(value: Any) -> str:
    """Return a value as TOML, whose texts, numbers and lists are written as in JSON."""
    text = json.dumps(value, ensure_ascii=False)
    return re.sub("[\x7f]", lambda match: f"\\u{ord(match[0]):04x}", text)
