"""The command that prints what a shell needs in order to complete commands, options and names."""

import click
from click.shell_completion import CompletionItem, get_completion_class

from oodscen._io.standard_output import results
from oodscen.errors import UsageError

SHELLS = ("bash", "zsh", "fish")


@click.command()
@click.argument("shell", type=click.Choice(SHELLS))
def completion(shell: str) -> None:
    """Print the completion script of a SHELL.

    Load it in every session: `eval "$(oodscen completion bash)"` in ~/.bashrc, the same with zsh in ~/.zshrc, or
    `oodscen completion fish > ~/.config/fish/completions/oodscen.fish`.
    """
    from oodscen._cli import main

    kind = get_completion_class(shell)
    if kind is None:
        raise UsageError(f"there is no completion for {shell}")
    script = kind(main, {}, "oodscen", "_OODSCEN_COMPLETE")
    click.echo(click.style(script.source(), reset=False), file=results(), nl=False)


class ComponentName(click.types.StringParamType):
    """The name of a component; installed ones are offered for completion.

    Args:
        kind: The kind of component, e.g. `simulator`.
    """

    def __init__(self, kind: str) -> None:
        self.kind = kind

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Return the installed names that start like this."""
        from oodscen._entry_points import names

        return [CompletionItem(name) for name in names(self.kind) if name.startswith(incomplete)]
