"""Commands that run one stage each."""

import sys
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from tqdm import tqdm

from oodscen import _paper as paper
from oodscen._cli.numbers import FINITE
from oodscen._cli.options import (
    extras_options,
    llm_options,
    out_option,
    picture_options,
    red_options,
    seed_option,
    simulator_option,
    style_option,
)
from oodscen._cli.output import read_lines, rounds_in_words, say, write, write_lines
from oodscen._cli.paths import READABLE, PathName
from oodscen._registry import DEFAULT_ENCODER
from oodscen.data._base import canonical_json
from oodscen.errors import DataError, FolderTaken, Issue, LLMError, OodscenError, UsageError
from oodscen.protocols import Camera

if TYPE_CHECKING:
    from oodscen.data._scenario import Scenario
    from oodscen.data._scene import Scene

_SIMULATED = ("study.json", "episodes.jsonl", "frames", "traces", "videos")
"""Files and folders whose presence makes `simulate` refuse a folder."""


@click.command()
@llm_options
@seed_option
@click.option(
    "--nodes", default=paper.NODES["initial"], show_default=True, type=click.IntRange(12, 2_000)
)
@out_option
def grow(llm: str, api_base: str | None, seed: int, nodes: int, out: Path | None) -> None:
    """Grow an initial tree."""
    from oodscen import TreeGrower, make_llm

    tree = TreeGrower(make_llm(llm, seed=seed, api_base=api_base), nodes=nodes).run()
    write(out, tree.to_json())


@click.command()
@click.argument("tree", type=READABLE)
@llm_options
@click.option("--red-llm", help="Model that imagines scenarios; the same as --llm if left out.")
@seed_option
@click.option(
    "--iterations",
    type=click.IntRange(0, 100_000),
    help=f"Rounds, at most.  [default: {paper.ITERATIONS}; with --budget as many as it allows]",
)
@click.option("--budget", type=click.IntRange(min=0), help="Model calls, at most.")
@click.option(
    "--encoder",
    default=DEFAULT_ENCODER,
    show_default=True,
    help="Encoder that finds near duplicates, as in a study; `none` refuses literal repetitions alone.",
)
@red_options
@click.option("--log", type=PathName(dir_okay=False, path_type=Path), help="File of the rounds.")
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
    """Red-team the tree in the file TREE."""
    from oodscen import RedTeamer, ScenarioTree, make_encoder, make_llm
    from oodscen.encoders import CachedEncoder
    from oodscen.stages._redteam.saturation import saturation

    grown = ScenarioTree.load(tree)
    most = paper.ITERATIONS if budget is None else budget
    is_blind = open_loop or encoder.casefold() == "none"
    teamer = RedTeamer(
        make_llm(llm, seed=seed, api_base=api_base),
        make_llm(red_llm, seed=seed, api_base=api_base) if red_llm else None,
        iterations=most if iterations is None else iterations,
        closed_loop=not open_loop,
        encoder=None if is_blind else CachedEncoder(make_encoder(encoder)),
        budget=budget,
        **{
            name.removeprefix("red_"): value for name, value in choices.items() if value is not None
        },
    )
    played = []
    total = None if teamer.limits.budget else teamer.limits.rounds
    for item in tqdm(teamer.rounds(grown), total=total, desc="redteam", disable=None):
        grown = grown.apply(*item.edits)
        played.append(item)
    if log is not None:
        write_lines(log, played)
    found = saturation(played)
    if out is not None or not as_json:
        write(out, grown.to_json())
    if as_json:
        said = {**found.model_dump(mode="json"), "stopped_by": teamer.stopped_by(played)}
        say(canonical_json(said))
    else:
        words = rounds_in_words(found, teamer.stopped_by(played), closed=not open_loop)
        say(words, err=True)


@click.command()
@click.argument("tree", type=READABLE)
@llm_options
@seed_option
@click.option("--per-path", default=paper.PER_PATH, show_default=True, type=click.IntRange(1, 999))
@click.option("--encoder", help="Encoder that finds near duplicates; none if left out.")
@style_option
@click.option(
    "--candidates",
    default=1,
    show_default=True,
    type=click.IntRange(1, 100),
    help="Texts written for each that is kept; the most diverse are kept.",
)
@click.option(
    "--band",
    nargs=2,
    type=FINITE,
    metavar="LO HI",
    help="Keep only texts whose OOD-ness lies in this band.",
)
@click.option("--baseline", type=READABLE, help="Ordinary-driving texts for the band.")
@click.option("--twins", is_flag=True, help="Write every text's ordinary twin as well.")
@out_option
def describe(
    tree: Path,
    llm: str,
    api_base: str | None,
    seed: int,
    per_path: int,
    encoder: str | None,
    style: Any,
    candidates: int,
    band: tuple[float, float] | None,
    baseline: Path | None,
    twins: bool,
    out: Path | None,
) -> None:
    """Describe every path of the tree in the file TREE: one scenario per line.

    A path with too few texts inside --band, or for which the model gives no answer, is reported on standard
    error; all other paths are written, and the exit code is 1.
    """
    from oodscen import Describer, ScenarioTree, make_encoder, make_llm
    from oodscen.baselines import load_baseline
    from oodscen.metrics import Metrics

    model = make_llm(llm, seed=seed, api_base=api_base)
    measure = make_encoder(encoder) if encoder else None
    is_chosen = candidates > 1 or band is not None
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
    for leaf, path in tqdm(paths.items(), desc="describe", disable=None):
        try:
            scenarios += describer.path(leaf, path, per_path)
        except (LLMError, UsageError) as error:
            failures.append(error)
            say(f"{leaf}: {error}", err=True)
    if failures and not scenarios:
        raise failures[-1]
    again = {scenario.id: scenario for scenario in describer.reworded(scenarios)}
    write_lines(out, [again.get(scenario.id, scenario) for scenario in scenarios])
    say(f"{len(scenarios)} texts, {len(failures)} of {len(paths)} paths failed", err=True)
    sys.exit(bool(failures))


@click.command()
@click.argument("scenarios", type=READABLE)
@llm_options
@seed_option
@simulator_option
@click.option(
    "--claims/--no-claims",
    default=True,
    show_default=True,
    help="Compare every scene with what its text says.",
)
@out_option
def augment(
    scenarios: Path,
    llm: str,
    api_base: str | None,
    seed: int,
    simulator: str,
    claims: bool,
    out: Path | None,
) -> None:
    """Stage every scenario of the file SCENARIOS: one scene per line.

    A text that cannot be staged is reported on standard error; all other texts are written as scenes, and the
    exit code is 1.
    """
    from oodscen import Augmenter, make_llm, make_simulator
    from oodscen.data._scenario import Scenario
    from oodscen.driving._sight.nameable import AdvisingCheck

    model = make_llm(llm, seed=seed, api_base=api_base)
    augmenter = Augmenter(
        model, make_simulator(simulator).catalogue(), check=AdvisingCheck(), claims=claims
    )
    items = read_lines(Scenario, scenarios)
    scenes: list[Scene] = []
    for scenario in tqdm(items, desc="augment", disable=None):
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
@click.option("--workers", default=1, show_default=True, type=click.IntRange(1, 256))
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
    workers: int,
) -> None:
    """Run every scene of the file SCENES; episodes and frames go into the folder OUT.

    A scene that cannot be run gives a failed episode, and the exit code is 1. A folder that already holds a
    study or simulation results is refused.
    """
    from oodscen import Scene, make_simulator
    from oodscen._pipeline.sweep import Extras, Job, sweep
    from oodscen.study import Study

    items = read_lines(Scene, scenes)
    counts = Counter(scene.id for scene in items)
    issues = [Issue("id", f"{one!r} occurs more than once") for one in counts if counts[one] > 1]
    if issues:
        raise DataError("scenes", issues, source=str(scenes))
    make_simulator(simulator).close()
    study, episodes = Study(out), {}
    camera = Camera(width or Camera.width, height or Camera.height)
    job = Job(simulator, seed, Extras(traces, annotations, video), camera=camera)
    with study.store.writing():
        if taken := [name for name in study.own() if name in _SIMULATED]:
            raise FolderTaken(str(out), taken)
        results = sweep(job, items, workers=workers)
        for result in tqdm(results, total=len(items), desc="simulate", disable=None):
            result.save(study.store)
            episodes[result.episode.id] = result.episode
        study.store.write_lines("episodes.jsonl", (episodes[scene.id] for scene in items))
    failed = [episode for episode in episodes.values() if episode.status == "failed"]
    for episode in failed:
        say(f"{episode.id}: {episode.error}", err=True)
    say(
        f"{len(items) - len(failed)} of {len(items)} scenes ran: {out / 'episodes.jsonl'}", err=True
    )
    sys.exit(bool(failed))
