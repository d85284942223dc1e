"""Help texts whose commands and options are grouped by purpose."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import click

Sections = Mapping[str, Sequence[str]]

COMMANDS: Sections = {
    "Make a study": ("init", "run"),
    "Judge models and driving stacks on it": ("evaluate", "drive", "quiz"),
    "Look at it": ("show", "report", "tree", "audit", "power", "props"),
    "Run one stage": ("grow", "redteam", "prune", "describe", "augment", "simulate"),
    "Check and measure texts and scenes": ("check-claims", "score"),
    "Exchange scenes with other tools": ("export", "publish", "serve", "import", "verdict", "vary"),
    "Set up": ("doctor", "plugins", "new", "completion"),
}


def sections_of(sections: Sections, names: Iterable[str], rest: str) -> dict[str, tuple[str, ...]]:
    """Return the sections that have a name, each with its names.

    Args:
        sections: Titles with the names that belong to them.
        names: The names to list.
        rest: Title for those in no section.
    """
    present = list(names)
    filled = {
        title: tuple(name for name in section if name in present)
        for title, section in sections.items()
    }
    listed = {name for section in sections.values() for name in section}
    filled[rest] = tuple(name for name in present if name not in listed)
    return {title: section for title, section in filled.items() if section}


class SectionedCommand(click.Command):
    """A command whose help lists the options in sections.

    Args:
        sections: Titles with the names of options, without dashes.
    """

    def __init__(self, *args: Any, sections: Sections, **options: Any) -> None:
        super().__init__(*args, **options)
        self.sections = sections

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the options of each section."""
        options = {
            option_key(param): record
            for param in self.get_params(ctx)
            if isinstance(param, click.Option)
            and (record := param.get_help_record(ctx)) is not None
        }
        for title, names in sections_of(self.sections, options, "Further options").items():
            with formatter.section(title):
                formatter.write_dl([options[name] for name in names])


def option_key(option: click.Parameter) -> str:
    """Return the name of an option without dashes, e.g. `per-path`."""
    return max(option.opts, key=len).lstrip("-")
