"""Options of `oodscen run` that are read from a TOML file."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

from oodscen._cli.help import option_key
from oodscen._cli.paths import READABLE
from oodscen._io.files import read_utf8
from oodscen._io.toml import parse_toml
from oodscen._numbers import said
from oodscen._words.text import one_line
from oodscen.errors import DataError, Issue, close_matches

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
        *("tree", "nodes", "iterations", "red-budget", "open-loop", "red-patience", "red-coverage"),
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


def _configured(context: click.Context, option: click.Parameter, file: Path | None) -> None:
    """Take the values of a file as defaults of the other options."""
    if file is not None:
        values = read_configuration(file, context)
        context.default_map = {**(context.default_map or {}), **values}


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
    text = read_utf8(file, _NOUN)
    try:
        content = parse_toml(text)
    except ValueError as error:
        issue = Issue("", f"is not TOML: {one_line(str(error))[:200]}")
        raise DataError(_NOUN, [issue], source=str(file)) from None
    options = options_of(context.command)
    values: dict[str, Any] = {}
    issues = []
    for key, value in content.items():
        option = options.get(key.replace("_", "-"))
        if option is None:
            issues.append(Issue(key[:100], _unknown(key, options)))
            continue
        if option.name in values:
            issues.append(Issue(key, "is there already in another spelling"))
            continue
        try:
            values[str(option.name)] = _default(option, value, context)
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


def _unknown(key: str, options: Mapping[str, click.Option]) -> str:
    matches = close_matches(key.replace("_", "-"), options)
    hint = f"; did you mean {' or '.join(matches)}?" if matches else ""
    return f"is not an option of this command{hint}"


def _default(option: click.Option, value: Any, context: click.Context) -> Any:
    """Return a value of a file as a default of its option.

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
        words: Any = [_word(option, item) for item in values]
    else:
        words = _word(option, value)
    option.type_cast_value(context, words)
    return words


def _word(option: click.Option, value: Any) -> str:
    """Return a single value as a word of the command line."""
    kinds: tuple[type, ...] = (str,)
    noun = "a text"
    if isinstance(option.type, click.types.IntParamType):
        kinds, noun = (int,), "a whole number"
    elif isinstance(option.type, click.types.FloatParamType):
        kinds, noun = (int, float), "a number"
    if isinstance(value, bool) or not isinstance(value, kinds):
        raise ValueError(f"{said(value)} is not {noun}")
    return str(value)
