"""The command line: each command is a thin call of one public function.

Exit codes: 0 when all went well, 1 when something in the run failed, 2 when the request itself
cannot be met (unknown name, malformed file, folder of another study), 3 when a cap was reached or an
endpoint given up and the same command continues.
"""

import json
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click
from tqdm import tqdm

from oodscen import paper
from oodscen._data import Data
from oodscen._version import __version__
from oodscen.cli_options import (
    READABLE,
    extras_options,
    json_option,
    llm_options,
    out_option,
    seed_option,
    simulator_option,
    traffic_from,
    traffic_options,
)
from oodscen.cli_output import bars, estimated, read_lines, summary, write, write_lines
from oodscen.errors import OodscenError, RunStopped, UsageError
from oodscen.llms.redaction import redact
from oodscen.registry import DEFAULT_ENCODER

if TYPE_CHECKING:
    pass

# Threads that wait for work by spinning make a busy machine many times slower; read when torch is loaded.
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")

Row = TypeVar("Row", bound=Data)


class _Group(click.Group):
    """Turns errors of the library into one friendly line and an exit code."""

    def invoke(self, ctx: click.Context) -> Any:
        try:
            return super().invoke(ctx)
        except OodscenError as error:
            if ctx.params.get("debug"):
                raise
            click.echo(f"oodscen: {redact(str(error))}", err=True)
            ctx.exit(
                2 if isinstance(error, UsageError) else 3 if isinstance(error, RunStopped) else 1
            )


@click.group(cls=_Group, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="oodscen")
@click.option("--debug", is_flag=True, help="Show tracebacks.")
def main(debug: bool) -> None:
    """Out-of-distribution driving scenarios: tree, texts, scenes, episodes, judged models."""


# --------------------------------------------------------------------------- the whole paper


@main.command()
@click.argument("out", type=click.Path(file_okay=False, path_type=Path))
@llm_options
@click.option("--red-llm", help="Model that imagines scenarios; the same as --llm if left out.")
@click.option("--fallback", help="Model that is asked where the others give no answer.")
@click.option("--vlm", "vlms", multiple=True, help="Vision-language model to judge; repeatable.")
@traffic_options
@simulator_option
@click.option("--encoder", default=DEFAULT_ENCODER, show_default=True, help="Name, or module:attr.")
@click.option(
    "--baseline", type=READABLE, help="Ordinary-driving texts: lines, JSONL, CSV or JSON."
)
@click.option(
    "--nodes", type=int, help=f"Size of the initial tree.  [default: {paper.NODES['initial']}]"
)
@click.option(
    "--iterations", type=int, help=f"Rounds of red teaming.  [default: {paper.ITERATIONS}]"
)
@click.option(
    "--open-loop", is_flag=True, help="Do not show the red-LLM what is covered (the paper's way)."
)
@click.option(
    "--per-path", type=int, help=f"Texts per simulatable path.  [default: {paper.PER_PATH}]"
)
@click.option("--max-paths", type=int, help="Simulate at most this many paths.")
@click.option(
    "--band",
    nargs=2,
    type=float,
    metavar="LO HI",
    help="Stage only texts whose OOD-ness lies in this band.",
)
@click.option(
    "--workers",
    type=click.IntRange(min=1),
    help="Processes that simulate.  [default: number of CPUs]",
)
@extras_options
@seed_option
@click.option("--quick", is_flag=True, help="A complete small run in seconds.")
@click.option(
    "--retry-failed", is_flag=True, help="Do items again whose answers were never valid, too."
)
@click.option(
    "--dry-run",
    is_flag=True,
    help="Only say how many calls and tokens the run needs, at what cost.",
)
@json_option
def run(
    out: Path,
    quick: bool,
    workers: int | None,
    open_loop: bool,
    as_json: bool,
    traces: bool,
    annotations: bool,
    video: Any,
    retry_failed: bool,
    dry_run: bool,
    **choices: Any,
) -> None:
    """Run the whole paper into the folder OUT, or continue a run that stopped."""
    from oodscen.llms.accounting import Ledger
    from oodscen.study import Extras, StudyConfig, estimate, run_study

    traffic = traffic_from(choices)
    given = {name: value for name, value in choices.items() if value not in (None, ())}
    if "baseline" in given:
        given["baseline"] = str(given["baseline"])
    given["closed_loop"] = not open_loop
    if quick:
        given = {**StudyConfig.quick().model_dump(), **given}
    config = StudyConfig.parse(given)
    if dry_run:
        rows = estimate(out, config, prices=traffic.prices)
        click.echo(json.dumps([r.model_dump() for r in rows]) if as_json else estimated(rows))
        return
    ledger = Ledger()
    with bars(ledger) as progress:
        study = run_study(
            out,
            config,
            workers=workers or os.cpu_count() or 1,
            progress=progress,
            extras=Extras(traces, annotations, video),
            traffic=traffic,
            ledger=ledger,
            retry=retry_failed,
        )
    info = study.info
    if as_json:
        click.echo(json.dumps(info, indent=2))
    else:
        click.echo(summary(info))
        click.echo(f"report: {(study.folder / 'report.html').resolve()}")
    if info["status"] != "success":
        sys.exit(1)


# --------------------------------------------------------------------------- the stages alone


@main.command()
@llm_options
@seed_option
@click.option(
    "--nodes", default=paper.NODES["initial"], show_default=True, type=click.IntRange(min=12)
)
@out_option
def grow(llm: str, api_base: str | None, seed: int, nodes: int, out: Path | None) -> None:
    """Grow an initial tree."""
    from oodscen import TreeGrower, make_llm

    tree = TreeGrower(make_llm(llm, seed=seed, api_base=api_base), nodes=nodes).run()
    write(out, tree.to_json())


@main.command()
@click.argument("tree", type=READABLE)
@llm_options
@seed_option
@click.option(
    "--iterations", default=paper.ITERATIONS, show_default=True, type=click.IntRange(min=0)
)
@click.option("--open-loop", is_flag=True, help="The paper's way.")
@out_option
def redteam(
    tree: Path,
    llm: str,
    api_base: str | None,
    seed: int,
    iterations: int,
    open_loop: bool,
    out: Path | None,
) -> None:
    """Red-team the tree in the file TREE."""
    from oodscen import RedTeamer, ScenarioTree, make_llm

    grown = ScenarioTree.load(tree)
    teamer = RedTeamer(
        make_llm(llm, seed=seed, api_base=api_base),
        iterations=iterations,
        closed_loop=not open_loop,
    )
    for item in tqdm(teamer.rounds(grown), total=iterations, desc="redteam", disable=None):
        grown = grown.apply(*item.edits)
    write(out, grown.to_json())


@main.command()
@click.argument("tree", type=READABLE)
@llm_options
@seed_option
@simulator_option
@out_option
def prune(
    tree: Path, llm: str, api_base: str | None, seed: int, simulator: str, out: Path | None
) -> None:
    """Prune the tree in the file TREE to what a simulator can show."""
    from oodscen import Pruner, ScenarioTree, make_llm, make_simulator

    catalogue = make_simulator(simulator).catalogue()
    model = make_llm(llm, seed=seed, api_base=api_base)
    write(out, Pruner(model, catalogue).run(ScenarioTree.load(tree)).to_json())


@main.command()
@click.argument("tree", type=READABLE)
@llm_options
@seed_option
@click.option("--per-path", default=paper.PER_PATH, show_default=True, type=click.IntRange(min=1))
@click.option("--encoder", help="Encoder that finds near duplicates; none if left out.")
@out_option
def describe(
    tree: Path,
    llm: str,
    api_base: str | None,
    seed: int,
    per_path: int,
    encoder: str | None,
    out: Path | None,
) -> None:
    """Describe every path of the tree in the file TREE: one scenario per line."""
    from oodscen import Describer, ScenarioTree, make_encoder, make_llm

    model = make_llm(llm, seed=seed, api_base=api_base)
    describer = Describer(model, make_encoder(encoder) if encoder else None, per_path=per_path)
    write_lines(out, describer.run(ScenarioTree.load(tree)))


@main.command()
@click.argument("scenarios", type=READABLE)
@llm_options
@seed_option
@simulator_option
@out_option
def augment(
    scenarios: Path, llm: str, api_base: str | None, seed: int, simulator: str, out: Path | None
) -> None:
    """Stage every scenario of the file SCENARIOS: one scene per line."""
    from oodscen import Augmenter, Scenario, make_llm, make_simulator

    augmenter = Augmenter(
        make_llm(llm, seed=seed, api_base=api_base), make_simulator(simulator).catalogue()
    )
    items = tqdm(read_lines(Scenario, scenarios), desc="augment", disable=None)
    write_lines(out, (augmenter.run(scenario) for scenario in items))


@main.command()
@click.argument("scenes", type=READABLE)
@click.argument("out", type=click.Path(file_okay=False, path_type=Path))
@simulator_option
@seed_option
@extras_options
@click.option("--workers", default=1, show_default=True, type=click.IntRange(min=1))
def simulate(
    scenes: Path,
    out: Path,
    simulator: str,
    seed: int,
    traces: bool,
    annotations: bool,
    video: Any,
    workers: int,
) -> None:
    """Run every scene of the file SCENES; episodes and frames go into the folder OUT."""
    from oodscen import Scene
    from oodscen.study import Store
    from oodscen.study.sweep import Extras, Job, sweep

    items = read_lines(Scene, scenes)
    store = Store(out)
    store.prepare()
    episodes = {}
    job = Job(simulator, seed, Extras(traces, annotations, video))
    results = sweep(job, items, workers=workers)
    for result in tqdm(results, total=len(items), desc="simulate", disable=None):
        result.save(store)
        episodes[result.episode.id] = result.episode
    store.write_lines("episodes.jsonl", (episodes[scene.id] for scene in items))
    failed = [episode for episode in episodes.values() if episode.status == "failed"]
    for episode in failed:
        click.echo(f"{episode.id}: {episode.error}", err=True)
    sys.exit(bool(failed))


@main.command()
@click.argument("out", type=click.Path(exists=True, file_okay=False, path_type=Path))
@click.option(
    "--vlm", "vlms", multiple=True, required=True, help="Vision-language model; repeatable."
)
@traffic_options
def evaluate(out: Path, vlms: tuple[str, ...], **choices: Any) -> None:
    """Judge further vision-language models on the study in the folder OUT."""
    from oodscen.study import Study, run_study

    config = Study.open(out).config
    names = tuple(dict.fromkeys((*config.vlms, *vlms)))
    config = config.model_copy(update={"vlms": names})
    with bars() as progress:
        study = run_study(out, config, progress=progress, traffic=traffic_from(choices))
    click.echo(f"report: {(study.folder / 'report.html').resolve()}")


# --------------------------------------------------------------------------- measuring, showing


@main.command()
@click.argument("texts", type=READABLE)
@click.option(
    "--baseline", type=READABLE, help="Ordinary-driving texts; the shipped corpus if left out."
)
@click.option("--encoder", default=DEFAULT_ENCODER, show_default=True)
@click.option(
    "--band",
    nargs=2,
    type=float,
    metavar="LO HI",
    help="Count only texts inside this OOD-ness band.",
)
@seed_option
@json_option
def score(
    texts: Path,
    baseline: Path | None,
    encoder: str,
    band: tuple[float, float] | None,
    seed: int,
    as_json: bool,
) -> None:
    """Measure OOD-ness and diversity of the texts in the file TEXTS (JSONL with `text`, or lines)."""
    from oodscen import make_encoder
    from oodscen.metrics import score_file

    report = score_file(
        texts, baseline=baseline, encoder=make_encoder(encoder), band=band, seed=seed
    )
    click.echo(report.model_dump_json(indent=2) if as_json else str(report))


@main.command()
@click.argument("out", type=click.Path(exists=True, file_okay=False, path_type=Path))
def report(out: Path) -> None:
    """Write the report of the study in the folder OUT anew."""
    from oodscen.report import write_report
    from oodscen.study import Study

    click.echo(str(write_report(Study.open(out)).resolve()))


@main.command()
@json_option
def plugins(as_json: bool) -> None:
    """List the models, encoders and simulators that are installed."""
    from oodscen.registry import survey

    rows = survey()
    if as_json:
        click.echo(json.dumps(rows, indent=2))
        return
    for row in rows:
        click.echo(f"{row['kind']:10} {row['name']:22} {row['source']:55} {row['state']}")


@main.command()
@click.argument("what", required=False)
@click.argument("name", required=False)
@click.option("--api-base", help="With llm NAME: address of an OpenAI-compatible server.")
@click.option("--quick", is_flag=True, help="With a simulator: only the parts that take seconds.")
@json_option
def doctor(
    what: str | None, name: str | None, api_base: str | None, quick: bool, as_json: bool
) -> None:
    """Check that everything the default run needs is here; or judge one component.

    `doctor llm NAME` asks a language model two small questions, one with a picture. `doctor SIMULATOR` judges an
    adapter by what oodscen.testing.check_simulator looks at.
    """
    from oodscen.doctor import examine, examine_llm, examine_simulator

    if what == "llm":
        if name is None:
            raise click.UsageError("name a model: oodscen doctor llm NAME")
        findings = examine_llm(name, api_base=api_base)
    elif what is None:
        findings = examine()
    else:
        with bars() as progress:
            findings = examine_simulator(what, is_quick=quick, progress=progress)
    if as_json:
        click.echo(json.dumps([finding._asdict() for finding in findings], indent=2))
    else:
        for finding in findings:
            click.echo(
                f"{'ok     ' if finding.is_ok else 'problem'} {finding.what}: {finding.detail}"
            )
    sys.exit(not all(finding.is_ok for finding in findings))


if __name__ == "__main__":
    main()
