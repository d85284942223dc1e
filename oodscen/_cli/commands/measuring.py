"""Commands that measure texts."""

from pathlib import Path
from typing import Any

import click

from oodscen._cli.commands.completion import ComponentName
from oodscen._cli.numbers import FINITE
from oodscen._cli.options import json_option, refuse_idle, refuse_idle_server, seed_option
from oodscen._cli.output import say
from oodscen._cli.paths import READABLE
from oodscen._registry import DEFAULT_ENCODER
from oodscen.errors import UsageError


@click.command()
@click.argument("texts", type=READABLE)
@click.option(
    "--baseline", type=READABLE, help="Texts of ordinary driving.  [default: the shipped corpus]"
)
@click.option(
    "--encoder",
    type=ComponentName("encoder"),
    default=DEFAULT_ENCODER,
    show_default=True,
    help="Text encoder.",
)
@click.option(
    "--band",
    nargs=2,
    type=FINITE,
    metavar="LO HI",
    help="Count only texts whose OOD-ness lies between these values.",
)
@click.option(
    "--table", is_flag=True, help="Print the paper's table, with all definitions side by side."
)
@click.option(
    "--llm",
    type=ComponentName("llm"),
    help="Model that estimates rarity.  [default: the shipped offline head]",
)
@click.option("--api-base", help="Address of an OpenAI-compatible server.")
@click.option(
    "--anchors",
    metavar="FILE",
    help="Calibrate rarity on the rates in a TOML file, or on the `published` ones.",
)
@seed_option
@json_option
def score(
    texts: Path,
    baseline: Path | None,
    encoder: str,
    band: tuple[float, float] | None,
    table: bool,
    llm: str | None,
    api_base: str | None,
    anchors: str | None,
    seed: int,
    as_json: bool,
) -> None:
    """Measure rarity, OOD-ness and diversity of the texts in the file TEXTS (JSONL with `text`, or lines)."""
    from oodscen import Metrics, make_encoder, make_llm
    from oodscen.baselines._reading import read_records
    from oodscen.llm._call_log import Call

    report: Any
    calls: list[Call] = []
    if table and band is not None:
        raise UsageError("--table measures all texts; do not combine it with --band")
    if table and (llm is not None or anchors is not None):
        raise UsageError("--table has no rarity; do not combine it with --llm or --anchors")
    if llm is None:
        refuse_idle("without --llm", "api_base")
    else:
        refuse_idle_server(llm)
    metrics = Metrics(make_encoder(encoder), baseline, seed=seed)
    if table:
        report = metrics.paper_table([record.text for record in read_records(texts)])
    else:
        model = make_llm(llm, seed=seed, api_base=api_base, log=calls.append) if llm else None
        report = metrics.score_file(texts, band=band, llm=model, anchors=anchors)
    say(report.model_dump_json(indent=2) if as_json else str(report))
    if calls and not as_json:
        say(f"calls                  {len(calls)} of {report.rarity.by}")
