"""Help texts that are grouped by what one wants."""

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
    """Return the names of every section that has any, in the order of the sections.

    Args:
        sections: Titles with the names that belong to them.
        names: The names that there are.
        rest: Title for those in no section.
    """
    there = list(names)
    found = {
        title: tuple(one for one in listed if one in there) for title, listed in sections.items()
    }
    known = {one for listed in sections.values() for one in listed}
    found[rest] = tuple(one for one in there if one not in known)
    return {title: listed for title, listed in found.items() if listed}


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
            option_key(one): record
            for one in self.get_params(ctx)
            if isinstance(one, click.Option) and (record := one.get_help_record(ctx)) is not None
        }
        for title, names in sections_of(self.sections, options, "Further options").items():
            with formatter.section(title):
                formatter.write_dl([options[name] for name in names])


def option_key(option: click.Parameter) -> str:
    """Return the name of an option without dashes, e.g. `per-path`."""
    return max(option.opts, key=len).lstrip("-")
