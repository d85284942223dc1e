"""The command that publishes a study."""

from pathlib import Path

import click

from oodscen._cli.numbers import FiniteRange
from oodscen._cli.output import say
from oodscen._cli.paths import PathName
from oodscen.errors import UsageError


@click.command()
@click.argument("study", metavar="OUT", type=PathName(exists=True, file_okay=False, path_type=Path))
@click.option(
    "-o",
    "--out",
    type=PathName(file_okay=False, path_type=Path),
    required=True,
    help="Folder to write into: new, empty, or an earlier data set.",
)
@click.option(
    "--to",
    "forms",
    type=click.Choice(("vlmevalkit", "lmms-eval", "drivelm", "none")),
    multiple=True,
    help="Form for another tool beside the Parquet files; repeatable.  [default: all]",
)
@click.option(
    "--validation",
    type=FiniteRange(0.0, 0.9),
    default=0.2,
    show_default=True,
    help="Share of the kinds of situation in the validation split.",
)
@click.option(
    "--licence",
    default="cc-by-4.0",
    show_default=True,
    help="Licence of the data, as the Hugging Face Hub names it.",
)
def publish(
    study: Path, out: Path, forms: tuple[str, ...], validation: float, licence: str
) -> None:
    """Write the study in the folder OUT as a data set for the Hugging Face Hub.

    Its questions become Parquet files with the pictures, split by kind of situation, with a card, and the same for
    VLMEvalKit, lmms-eval and readers of DriveLM's JSON. Nothing is uploaded.
    """
    from oodscen.publish._publishing import FORMS
    from oodscen.publish._publishing import publish as published
    from oodscen.study._study import Study

    if "none" in forms and len(set(forms)) > 1:
        raise UsageError("--to none is for the Parquet files alone: name no other form beside it")
    wanted = [form for form in FORMS if not forms or form in forms]
    say(
        str(published(Study.open(study), out, forms=wanted, validation=validation, licence=licence))
    )
