"""Options of `oodscen run` in a TOML file: reading it, and writing one with comments."""

import json
import re
import shlex
import sys
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

from oodscen._arguments import refuse_key
from oodscen._cli.help import option_key, sections_of
from oodscen._cli.output import say, write
from oodscen._cli.paths import READABLE, FileCommand, OutputName
from oodscen._files import is_written_through, read_utf8
from oodscen._registry import DEFAULT_LLM
from oodscen._text import one_line, text_fault
from oodscen.errors import DataError, Issue, UsageError, close_matches

_NOUN = "configuration"
_HIDDEN = ("config", "help")
"""Options of `run` that a file cannot hold."""

RUN_SECTIONS: Mapping[str, tuple[str, ...]] = {
    "Models": ("llm", "red-llm", "fallback", "rarity-llm", "recogniser", "context", "api-base"),
    "Judging": ("vlm", "protocol", "chain", "rear-view", "without-pictures", "ordinary", "judge"),
    "Limits": (
        *("max-cost", "max-requests", "max-tokens", "max-seconds", "price"),
        *("concurrency", "timeout", "patience"),
    ),
    "Tree": (
        *("nodes", "iterations", "red-budget", "open-loop", "red-patience", "red-coverage"),
        *("in-flight", "nearest", "nearest-label", "rarity", "broadenings", "made"),
    ),
    "Texts": ("per-path", "set", "style", "candidates", "twins", "encoder", "baseline", "band"),
    "Simulation": (
        *("simulator", "catalogue", "max-paths", "reaction", "horizon", "width", "height"),
        *("frames", "demands", "traces", "annotations", "video"),
    ),
    "The run": (
        *("config", "quick", "seed", "workers", "retry-failed", "dry-run", "json", "help"),
    ),
}
"""Options of `run` by what they are about."""

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
    "red-budget": 500,
    "red-patience": 20,
    "red-coverage": 0.9,
    "rarity": [1_000.0, 1_000_000.0],
    "baseline": "texts.txt",
    "band": [0.3, 0.9],
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


def _configured(context: click.Context, option: click.Parameter, file: Path | None) -> None:
    """Take the values of a file as defaults of the other options."""
    if file is not None:
        found = read_configuration(file, context)
        context.default_map = {**(context.default_map or {}), **found}


config_option = click.option(
    "--config",
    type=READABLE,
    is_eager=True,
    expose_value=False,
    callback=_configured,
    help="TOML file with values for these options.",
)


def read_configuration(file: Path, context: click.Context) -> dict[str, Any]:
    """Return the values of a file, by the names of a command's parameters.

    Raises:
        DataError: With every unknown key, with close matches, and every value that its option refuses.
    """
    try:
        content = tomllib.loads(read_utf8(file, _NOUN))
    except (tomllib.TOMLDecodeError, RecursionError, ValueError) as error:
        if isinstance(error, DataError):
            raise
        issue = Issue("", f"is not TOML: {one_line(str(error))[:200]}")
        raise DataError(_NOUN, [issue], source=str(file)) from None
    known = options_of(context.command)
    values: dict[str, Any] = {}
    issues = []
    for key, value in content.items():
        option = known.get(key.replace("_", "-"))
        if option is None:
            issues.append(Issue(key[:100], _unknown(key, known)))
            continue
        if option.name in values:
            issues.append(Issue(key, "is there already in another spelling"))
            continue
        try:
            values[str(option.name)] = _taken(option, value, context)
        except (click.BadParameter, ValueError) as error:
            words = error.message if isinstance(error, click.BadParameter) else str(error)
            issues.append(Issue(key, one_line(words)[:200]))
    if issues:
        raise DataError(_NOUN, issues, source=str(file))
    return values


def options_of(command: click.Command) -> dict[str, click.Option]:
    """Return the options of a command that a file can hold, by their names without dashes."""
    options = [param for param in command.params if isinstance(param, click.Option)]
    return {key: option for option in options if (key := option_key(option)) not in _HIDDEN}


def _unknown(key: str, known: Mapping[str, click.Option]) -> str:
    matches = close_matches(key.replace("_", "-"), known)
    hint = f"; did you mean {' or '.join(matches)}?" if matches else ""
    return f"is not an option of this command{hint}"


def _taken(option: click.Option, value: Any, context: click.Context) -> Any:
    """Return a value as its option takes it.

    Raises:
        ValueError: If it is of another kind than the option's.
        click.BadParameter: If the option refuses it.
    """
    if option.is_flag:
        if not isinstance(value, bool):
            raise ValueError("must be true or false")
        return value
    if option.multiple or option.nargs > 1:
        values = value if isinstance(value, list) or option.nargs > 1 else [value]
        if not isinstance(values, list):
            raise ValueError(f"must be a list of {option.nargs} values")
        words: Any = [_word(option, one) for one in values]
    else:
        words = _word(option, value)
    option.type_cast_value(context, words)
    return words


def _word(option: click.Option, value: Any) -> str:
    """Return a single value as a word of the command line."""
    is_number = isinstance(option.type, click.types.IntParamType | click.types.FloatParamType)
    if isinstance(value, bool) or not isinstance(value, int | float if is_number else str):
        raise ValueError(f"must be a {'number' if is_number else 'text'}")
    return str(value)


# ------------------------------------------------------------------ writing


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
    from oodscen._cli.study import run

    if out.exists() and not force and not is_written_through(out):
        raise UsageError(f"{out} exists; name another file with --out, or replace it with --force")
    if is_terminal():
        if llm is None:
            llm = click.prompt(
                "Model that writes the scenarios (builtin needs no key; or a name such as gpt-4o)",
                default=DEFAULT_LLM,
            )
        if not vlms:
            named = click.prompt(
                "Vision-language models to judge, separated by commas (empty: none)",
                default="",
                show_default=False,
            )
            vlms = tuple(filter(None, map(str.strip, named.split(","))))
        if quick is None:
            quick = click.confirm("A small study in seconds instead of the whole one?")
    for named in (name for name in (llm, *vlms) if name is not None):
        if (fault := text_fault(named)) or not named.strip() or one_line(named) != named:
            raise UsageError(f"the model {fault or f'has the unusable name {named[:100]!r}'}")
        refuse_key("the model", named)
    chosen: dict[str, Any] = {"llm": llm or DEFAULT_LLM, "quick": bool(quick)}
    if vlms:
        chosen["vlm"] = list(vlms)
    write(out, commented(run, chosen))
    if not is_written_through(out):
        start = f"oodscen run OUT --config {shlex.quote(str(out))}"
        say(f"{out} is written; start with: {start}", err=True)


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
