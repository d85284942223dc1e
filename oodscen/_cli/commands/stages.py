"""Commands that run one stage each."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from oodscen import _paper as paper
from oodscen._cli.commands.completion import ComponentName
from oodscen._cli.numbers import FINITE
from oodscen._cli.options import (
    extras_options,
    llm_options,
    out_option,
    picture_options,
    rear_view_option,
    red_options,
    refuse_idle,
    refuse_idle_in_open_loop,
    refuse_idle_server,
    rollout_options,
    seed_option,
    simulator_option,
    style_option,
    things_encoder,
    things_option,
)
from oodscen._cli.output import if_stopped, read_lines, say, write, write_lines
from oodscen._cli.paths import READABLE, FileCommand, OutputName, PathName
from oodscen._cli.progress import bars, tracked
from oodscen._cli.summaries import rounds_in_words
from oodscen._io.study_files import refuse_inside
from oodscen._members import close
from oodscen._registry import DEFAULT_ENCODER
from oodscen.data._base import canonical_json
from oodscen.data._reactions import REACTIONS_S
from oodscen.errors import LLMError, OodscenError, UsageError
from oodscen.protocols import Camera

if TYPE_CHECKING:
    from oodscen.data._scenario import Scenario
    from oodscen.data._scene import Scene
    from oodscen.stages._redteam.rounds import Round


@click.command(cls=FileCommand)
@llm_options
@seed_option
@click.option(
    "--nodes",
    default=paper.NODES["initial"],
    show_default=True,
    type=click.IntRange(12, 2_000),
    help="Size of the tree.",
)
@out_option
def grow(llm: str, api_base: str | None, seed: int, nodes: int, out: Path | None) -> None:
    """Grow the initial scenario tree."""
    from oodscen import TreeGrower, make_llm
    from oodscen.llm._accounting import Ledger

    refuse_idle_server(llm)
    ledger = Ledger()
    model = make_llm(llm, seed=seed, api_base=api_base, log=ledger.add)
    grower = TreeGrower(model, nodes=nodes)
    with bars(ledger) as progress:
        tree = grower.run(progress=progress)
    write(out, tree.to_json())


@click.command(cls=FileCommand)
@click.argument("tree", type=READABLE)
@llm_options
@click.option("--red-llm", help="Model that imagines scenarios.  [default: --llm]")
@seed_option
@click.option(
    "--iterations",
    type=click.IntRange(0, 100_000),
    help=f"Maximum number of rounds.  [default: {paper.ITERATIONS}; with --budget, as many as it allows]",
)
@click.option("--budget", type=click.IntRange(min=0), help="Maximum number of model calls.")
@click.option(
    "--encoder",
    type=ComponentName("encoder"),
    default=DEFAULT_ENCODER,
    show_default=True,
    help="Text encoder that detects near duplicates; `none` detects literal repetitions only.",
)
@red_options
@click.option("--log", type=OutputName(), help="File for the log of all rounds.")
@click.option(
    "--json", "as_json", is_flag=True, help="Print the saturation as JSON instead of the tree."
)
@out_option
def redteam(
    tree: Path,
    llm: str,
    red_llm: str | None,
    api_base: str | None,
    seed: int,
    iterations: int | None,
    budget: int | None,
    encoder: str,
    open_loop: bool,
    log: Path | None,
    as_json: bool,
    out: Path | None,
    **choices: Any,
) -> None:
    """Extend the tree in the file TREE by red teaming.

    Rounds that failed are reported on standard error; the exit code is then 1.
    """
    from oodscen import RedTeamer, ScenarioTree, make_llm
    from oodscen.llm._accounting import Ledger
    from oodscen.stages._redteam.saturation import saturation

    refuse_idle_server(llm, red_llm)
    if open_loop:
        refuse_idle("with --open-loop", "encoder")
        refuse_idle_in_open_loop()
    grown = ScenarioTree.load(tree)
    if iterations is None:
        iterations = paper.ITERATIONS if budget is None else budget
    ledger = Ledger()
    settings: dict[str, Any] = {"seed": seed, "api_base": api_base, "log": ledger.add}
    teamer = RedTeamer(
        make_llm(llm, **settings),
        make_llm(red_llm, **settings) if red_llm else None,
        iterations=iterations,
        closed_loop=not open_loop,
        encoder=None if open_loop else things_encoder(encoder),
        budget=budget,
        **{
            name.removeprefix("red_"): value for name, value in choices.items() if value is not None
        },
    )
    rounds: list[Round] = []

    def save() -> None:
        try:
            if log is not None:
                write_lines(log, rounds)
        finally:
            if out is not None or not as_json:
                write(out, grown.to_json())

    with if_stopped(rounds, save):
        for red_round in tracked(teamer.rounds(grown), "redteam", iterations, ledger):
            grown = grown.apply(*red_round.edits)
            rounds.append(red_round)
            if red_round.status == "failed":
                say(f"round {red_round.round}: {red_round.error}", err=True)
    estimates = saturation(rounds)
    stopped_by = teamer.stopped_by(rounds)
    save()
    if as_json:
        say(canonical_json({**estimates.model_dump(mode="json"), "stopped_by": stopped_by}))
    else:
        say(rounds_in_words(estimates, stopped_by, closed=not open_loop), err=True)
    sys.exit(any(red_round.status == "failed" for red_round in rounds))


@click.command(cls=FileCommand)
@click.argument("tree", type=READABLE)
@llm_options
@seed_option
@click.option(
    "--per-path",
    default=paper.PER_PATH,
    show_default=True,
    type=click.IntRange(1, 999),
    help="Texts per path.",
)
@click.option(
    "--encoder",
    type=ComponentName("encoder"),
    default="none",
    show_default=True,
    help="Text encoder that detects near duplicates.",
)
@style_option
@click.option(
    "--candidates",
    default=1,
    show_default=True,
    type=click.IntRange(1, 100),
    help="Texts written per text kept; the most diverse are kept.",
)
@click.option(
    "--band",
    nargs=2,
    type=FINITE,
    metavar="LO HI",
    help="Keep only texts whose OOD-ness lies between these values.",
)
@click.option(
    "--baseline",
    type=READABLE,
    help="Texts of ordinary driving, for the band.  [default: the shipped corpus]",
)
@click.option("--twins", is_flag=True, help="Also write the ordinary twin of every text.")
@out_option
def describe(
    tree: Path,
    llm: str,
    api_base: str | None,
    seed: int,
    per_path: int,
    encoder: str,
    style: Any,
    candidates: int,
    band: tuple[float, float] | None,
    baseline: Path | None,
    twins: bool,
    out: Path | None,
) -> None:
    """Write texts for every path of the tree in the file TREE, one scenario per line.

    Paths with too few texts inside --band, or without an answer from the model, are reported on standard error
    and skipped, and texts without the twin that --twins asks for are counted there; the exit code is then 1.
    """
    from oodscen import Describer, ScenarioTree, make_llm
    from oodscen.baselines import load_baseline
    from oodscen.llm._accounting import Ledger
    from oodscen.metrics._metrics import Metrics

    is_chosen = candidates > 1 or band is not None
    if not is_chosen:
        refuse_idle("without --band or --candidates", "baseline")
    refuse_idle_server(llm)
    ledger = Ledger()
    model = make_llm(llm, seed=seed, api_base=api_base, log=ledger.add)
    measure = things_encoder(encoder)
    ordinary = load_baseline(baseline) if baseline else None
    describer = Describer(
        model,
        measure,
        per_path=per_path,
        style=style or "natural",
        candidates=candidates,
        band=band,
        metrics=Metrics(measure, ordinary, seed=seed) if is_chosen else None,
        twins=twins,
    )
    paths = ScenarioTree.load(tree).paths
    scenarios: list[Scenario] = []
    failures: list[OodscenError] = []
    with if_stopped(scenarios, lambda: write_lines(out, scenarios)):
        for leaf, path in tracked(paths.items(), "describe", len(paths), ledger):
            try:
                scenarios += describer.path(leaf, path, per_path)
            except (LLMError, UsageError) as error:
                failures.append(error)
                say(f"{leaf}: {error}", err=True)
    if failures and not scenarios:
        raise failures[-1]
    reworded: dict[str, Scenario] = {}
    try:
        reworded = {scenario.id: scenario for scenario in describer.reworded(scenarios)}
    except LLMError as error:
        say(f"texts that repeat others stay: {error}", err=True)
    scenarios = [reworded.get(scenario.id, scenario) for scenario in scenarios]
    write_lines(out, scenarios)
    say(f"{len(scenarios)} texts, {len(failures)} of {len(paths)} paths failed", err=True)
    without_twin = sum(scenario.ordinary is None for scenario in scenarios) if twins else 0
    if without_twin:
        say(f"{without_twin} of them without a twin: no answer could be read", err=True)
    sys.exit(bool(failures or without_twin))


@click.command(cls=FileCommand)
@click.argument("scenarios", type=READABLE)
@llm_options
@seed_option
@simulator_option
@click.option(
    "--claims/--no-claims",
    default=True,
    show_default=True,
    help="Check every scene against the claims of its text.",
)
@things_option
@out_option
def augment(
    scenarios: Path,
    llm: str,
    api_base: str | None,
    seed: int,
    simulator: str,
    claims: bool,
    encoder: str,
    out: Path | None,
) -> None:
    """Turn every scenario of the file SCENARIOS into a scene, one per line.

    Texts that cannot be staged are reported on standard error and skipped; the exit code is then 1.
    """
    from oodscen import Augmenter, make_llm, make_simulator
    from oodscen.data._scenario import Scenario
    from oodscen.driving._sight.staging_advice import AdvisingCheck
    from oodscen.llm._accounting import Ledger

    if not claims:
        refuse_idle("with --no-claims", "encoder")
    refuse_idle_server(llm)
    ledger = Ledger()
    model = make_llm(llm, seed=seed, api_base=api_base, log=ledger.add)
    augmenter = Augmenter(
        model,
        make_simulator(simulator).catalogue(),
        check=AdvisingCheck(),
        claims=claims,
        encoder=things_encoder(encoder),
    )
    items = read_lines(Scenario, scenarios)
    scenes: list[Scene] = []
    with if_stopped(scenes, lambda: write_lines(out, scenes)):
        for scenario in tracked(items, "augment", len(items), ledger):
            try:
                scenes.append(augmenter.run(scenario))
            except LLMError as error:
                say(f"{scenario.id}: {error}", err=True)
    write_lines(out, scenes)
    say(f"{len(scenes)} of {len(items)} texts staged", err=True)
    sys.exit(len(scenes) < len(items))


@click.command()
@click.argument("scenes", type=READABLE)
@click.argument("out", type=PathName(file_okay=False, path_type=Path))
@simulator_option
@seed_option
@extras_options
@picture_options
@rear_view_option
@rollout_options
@click.option(
    "--workers",
    default=1,
    show_default=True,
    type=click.IntRange(1, 256),
    help="Simulation processes.",
)
def simulate(
    scenes: Path,
    out: Path,
    simulator: str,
    seed: int,
    traces: bool,
    annotations: bool,
    video: Any,
    width: int | None,
    height: int | None,
    rear_view: bool | None,
    reaction: tuple[float, ...],
    horizon: float | None,
    workers: int,
) -> None:
    """Simulate every scene of the file SCENES into the folder OUT.

    Writes episodes.jsonl and the frames; with --rear-view also rear.jpg beside them, and episodes.rear.jsonl. A
    scene that cannot be run becomes a failed episode, and the exit code is 1. The same command continues what was
    stopped, and runs failed scenes again; a folder with a study or other results is refused.
    """
    from oodscen import Scene, make_simulator
    from oodscen._pipeline.jobs import Job, Outputs
    from oodscen._pipeline.simulation import EPISODES, Simulation
    from oodscen.study._store import Store

    refuse_inside(out)
    items = read_lines(Scene, scenes)
    close(make_simulator(simulator))
    job = Job(
        simulator,
        seed,
        Outputs(traces, annotations, video),
        camera=Camera(width or Camera.width, height or Camera.height),
        reaction=reaction or REACTIONS_S,
        horizon=horizon,
    )
    store = Store(out)
    with store.writing():
        simulation = Simulation(store, job, items, workers=workers)
        episodes = [*tracked(simulation.run(), "simulate", len(items))]
        behind = [*tracked(simulation.run_behind(), "rear", len(items))] if rear_view else []
    failed = {
        episode.id: episode.error for episode in (*behind, *episodes) if episode.status == "failed"
    }
    for episode_id, error in failed.items():
        say(f"{episode_id}: {error}", err=True)
    unsure = sum(episode.status == "ok" and not episode.is_deterministic for episode in episodes)
    if unsure:
        say(f"{unsure} of the scenes do not repeat: none of their actions counts as safe", err=True)
    say(f"{len(items) - len(failed)} of {len(items)} scenes ran: {out / EPISODES}", err=True)
    sys.exit(bool(failed))
