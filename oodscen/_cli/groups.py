"""A group of commands with what all of them have in common."""

from collections import Counter
from collections.abc import Sequence
from contextlib import suppress

import click

from oodscen._io.standard_output import for_results
from oodscen.errors import UsageError


class CommandGroup(click.Group):
    """A group whose commands keep standard output for results, and refuse a second value for an option of one.

    click takes the last value and drops the others without a word. Switches may be repeated.
    """

    def add_command(self, cmd: click.Command, name: str | None = None) -> None:
        """Add a command, which then keeps standard output for its results."""
        if cmd.callback is not None and not isinstance(cmd, click.Group):
            cmd.callback = for_results()(cmd.callback)
        super().add_command(cmd, name)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command, and check what it was given.

        Raises:
            UsageError: If an option is given more than once.
        """
        name, command, rest = super().resolve_command(ctx, args)
        if command is not None and not ctx.resilient_parsing:
            of_command = click.Context(
                command, parent=ctx, info_name=name, **command.context_settings
            )
            _refuse_repeated(of_command, rest)
        return name, command, rest


def _refuse_repeated(context: click.Context, args: Sequence[str]) -> None:
    parameters: list[click.Parameter] = []
    # The command itself tells what it cannot parse.
    with suppress(click.UsageError):
        _, _, parameters = context.command.make_parser(context).parse_args(list(args))
    counts = Counter(
        option.opts[-1]
        for option in parameters
        if isinstance(option, click.Option)
        and not (option.multiple or option.is_flag or option.count)
    )
    repeated = [name for name, count in counts.items() if count > 1]
    if repeated:
        are = "is" if len(repeated) == 1 else "are"
        raise UsageError(f"{' and '.join(repeated)} {are} given more than once; give one value")
