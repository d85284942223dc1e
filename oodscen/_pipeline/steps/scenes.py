"""The stages that make scenes and episodes: augment, simulate."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any

from oodscen._concurrency import as_finished
from oodscen._pipeline.context import Context, failed
from oodscen._pipeline.steps.made import ids_of, made_for
from oodscen._pipeline.sweep import Job, sweep
from oodscen.data._base import digest
from oodscen.data._claim import Claim
from oodscen.data._episode import Episode, moments
from oodscen.data._pairing import demand_id, scene_of, twin_id
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.driving._sight.staging_advice import AdvisingCheck
from oodscen.errors import DataError, Issue, LLMError
from oodscen.stages._augment import Augmenter
from oodscen.study._staging import Staging

SCENES = "scenes.jsonl"
"""File with one line per scenario, the scene that was run, followed by its ordinary demand."""
CLAIMS = "claims.jsonl"
"""File of the claims of every text."""
STAGED = "staged.jsonl"
"""File with one `Staging` per scenario."""
RESTAGED = "restaged.jsonl"
"""File of the scenes in which all or none of the actions are safe: how each was re-staged, the scene that was
run, and failed attempts.
"""

REAR = "episodes.rear.jsonl"
"""File of the runs in which the views to the rear were taken."""

Line = dict[str, Any]


def augment(run: Context, scenarios: Sequence[Scenario]) -> list[Scene]:
    """Extract the claims of every text and stage a scene that satisfies them.

    Returns:
        The scenes as they were staged.

    Raises:
        DataError: When a line of `scenes.jsonl` is malformed or belongs to no text, or two belong to one text.
    """
    augmenter = Augmenter(
        run.llm,
        run.simulator.catalogue(),
        check=AdvisingCheck(run.simulator),
        context=run.config.context,
        encoder=run.encoder,
    )
    staging = made_for(run)
    with_made = {
        names: Augmenter(
            run.llm,
            run.simulator.catalogue(),
            check=AdvisingCheck(),
            context=run.config.context,
            encoder=run.encoder,
            made=props,
            motions=motions,
        )
        for names, (props, motions) in {ids_of(one): one for one in staging.values()}.items()
    }
    by_id = {scenario.id: scenario for scenario in scenarios}
    before = _staged_scenes(_lines(run))
    written = _written_scenes(run, by_id, before)
    claims_by_text = _claims(run, augmenter, scenarios)

    def made_from(name: str) -> str:
        scenario, claims = by_id[name], claims_by_text[name]
        if isinstance(claims, LLMError):
            return digest([scenario.text, scenario.path, None])
        said = [claim.model_dump(mode="json") for claim in claims]
        return digest([scenario.text, scenario.path, said])

    def work(scenario: Scenario) -> Staging | Line:
        claims = claims_by_text[scenario.id]
        if isinstance(claims, LLMError):
            return failed(scenario.id, claims, scenario_id=scenario.id)
        try:
            needed = ids_of(staging[scenario.path]) if scenario.path in staging else ()
            scene = with_made.get(needed, augmenter).run(scenario, claims)
            if run.config.horizon is not None:
                scene = scene.model_copy(update={"horizon_s": run.config.horizon})
            return Staging(id=scenario.id, scene=scene)
        except LLMError as error:
            return failed(scenario.id, error, scenario_id=scenario.id)

    # Remove the scenes of changed texts first; later they would look as if changed by hand.
    fits = run.fitting(STAGED, by_id, made_from)
    kept = {
        name: scene
        for name, scene in written.items()
        if name in fits or _is_by_hand(scene, before.get(name))
    }
    if len(kept) < len(written):
        run.store.write_lines(SCENES, kept.values())
    _ask_each(run, "augment", STAGED, scenarios, work, made_from)
    lines = _lines(run)
    staged = _staged_scenes(lines)
    _write_scenes(run, lines, {name: one.ran for name, one in staged.items()} | kept, staged)
    return [one.scene for one in staged.values()]


def _lines(run: Context) -> dict[str, Line]:
    """Return the lines of `staged.jsonl` by id; the last line of an id wins."""
    return {line["id"]: line for line in run.store.lines(STAGED)}


def _staged_scenes(lines: Mapping[str, Line]) -> dict[str, Staging]:
    """Return the scenes that could be staged, by id."""
    return {
        name: Staging.parse(line, source=f"{STAGED}, {name}")
        for name, line in lines.items()
        if line.get("status") != "failed"
    }


def _written_scenes(
    run: Context, texts: Collection[str], staged: Mapping[str, Staging]
) -> dict[str, Scene]:
    """Return the scenes of `scenes.jsonl`, which may have been edited by hand, by id."""
    found: dict[str, Scene] = {}
    for number, line in enumerate(run.store.lines(SCENES), start=1):
        if line.get("status") == "failed":
            continue
        source = f"{run.store.path(SCENES)}, line {number}"
        scene = Scene.parse(line, source=source)
        if scene.is_ordinary:
            continue
        if scene.id not in texts and _is_by_hand(scene, staged.get(scene.id)):
            fault = (
                f"there is no text {scene.id!r} in this study; remove the line, and run the scene by itself with "
                "`oodscen simulate`"
            )
            raise DataError(Scene.noun, [Issue("", fault)], source=source)
        found[scene.id] = scene
    return found


def _is_by_hand(scene: Scene, staging: Staging | None) -> bool:
    """Return whether a scene of `scenes.jsonl` differs from the staged scene and from the one that was run."""
    return staging is None or scene not in (staging.scene, staging.run)


def _write_scenes(
    run: Context,
    lines: Mapping[str, Line],
    scenes: Mapping[str, Scene],
    staged: Mapping[str, Staging],
) -> None:
    """Write `scenes.jsonl`: every scene with its demand, and a failure line for each that was not staged."""
    failures = {
        name: {key: value for key, value in line.items() if key != "made_from"}
        for name, line in lines.items()
    }
    rows: list[Scene | Line] = []
    for name, failure in failures.items():
        rows.append(scenes.get(name, failure))
        demand = staged[name].demand if name in scenes and name in staged else None
        rows += [demand] if demand is not None else []
    run.store.write_lines(SCENES, rows)


def _claims(
    run: Context, augmenter: Augmenter, scenarios: Sequence[Scenario]
) -> dict[str, tuple[Claim, ...] | LLMError]:
    """Return the claims of every text by id, or the error if they could not be extracted.

    A scene without claims is retryable exactly if its claims are.
    """
    texts = {scenario.id: scenario.text for scenario in scenarios}

    def work(scenario: Scenario) -> Line:
        try:
            claims = augmenter.read(scenario)
        except LLMError as error:
            return failed(scenario.id, error)
        return {"id": scenario.id, "claims": [claim.model_dump(mode="json") for claim in claims]}

    rows = _ask_each(run, "claims", CLAIMS, scenarios, work, lambda name: digest(texts[name]))
    errors = {
        row["id"]: LLMError(
            f"what the text says could not be read: {row['error']}",
            retryable=row.get("retryable", False),
        )
        for row in rows
        if row.get("status") == "failed"
    }
    return {**_claims_of(rows), **errors}


def _claims_of(rows: Iterable[Line]) -> dict[str, tuple[Claim, ...]]:
    """Return the claims in lines of `claims.jsonl` by scenario; texts that could not be read have none."""
    return {
        row["id"]: tuple(Claim.parse(claim) for claim in row["claims"])
        for row in rows
        if row.get("status") != "failed"
    }


def _ask_each(
    run: Context,
    stage: str,
    file: str,
    scenarios: Sequence[Scenario],
    work: Callable[[Scenario], Staging | Line],
    made_from: Callable[[str], str],
) -> list[Line]:
    """Ask a model about every scenario, several at once if allowed, and return the lines."""
    return run.each(
        stage,
        file,
        {scenario.id: scenario for scenario in scenarios},
        lambda todo: (
            row
            for _, row in as_finished(work, todo.values(), threads=run.threads, cancel=run.cancel)
        ),
        made_from=made_from,
    )


def simulate(run: Context) -> tuple[list[Scene], list[Episode]]:
    """Run every scene, its ordinary twin and its ordinary demand in worker processes; only this process writes.

    A scene whose hazard cannot be named at the decision is decided later, if a safe action is left then. Scenes
    in which all or none of the actions are safe do not test a decision, so they are re-staged if that helps.
    `restaged.jsonl` lists these scenes with their changes and the failed attempts; `scenes.jsonl` then holds the
    scenes that were run. A scene edited there by hand replaces the staged one, and is run.

    Returns:
        The scenes as they were run, and the episodes of scenes, twins and demands.
    """
    lines = _lines(run)
    staged = _staged_scenes(lines)
    episodes = _simulate(run, staged)
    by_hand = {
        name: Staging(id=name, made_from=lines[name]["made_from"], scene=scene)
        for name, scene in _written_scenes(run, lines, staged).items()
        if _is_by_hand(scene, staged.get(name))
    }
    if by_hand:
        staged |= by_hand
        staged = {name: staged[name] for name in lines if name in staged}
        run.store.write_lines(STAGED, [staged.get(name, line) for name, line in lines.items()])
        episodes = _simulate(run, staged)
    run.store.write_lines(STAGED, [staged.get(name, line) for name, line in lines.items()])
    restagings = [staged[name].restaging() for name in sorted(staged)]
    run.store.write_lines(RESTAGED, filter(None, restagings))
    ran = {name: one.ran for name, one in staged.items()}
    _write_scenes(run, lines, ran, staged)
    return list(ran.values()), episodes


def _simulate(run: Context, staged: dict[str, Staging]) -> list[Episode]:
    """Run the scenes that lack an episode, each with its ordinary drives; update `staged` with the outcomes."""
    job = Job(
        run.config.simulator,
        run.config.seed,
        run.options.outputs,
        twins=True,
        demands=run.config.demands,
        restages=True,
        camera=run.config.camera,
        moments=moments(run.config.frames),
        claims=_claims_of(run.store.lines(CLAIMS)),
        reaction=run.config.reaction,
    )
    made_from = {name: one.ran.digest() for name, one in staged.items()}

    def work(todo: Mapping[str, str]) -> Iterator[Episode]:
        wanted = [staged[name].scene for name in dict.fromkeys(todo.values())]
        for result in sweep(
            job, wanted, workers=run.options.workers, executor=run.options.executor
        ):
            name = result.episode.id
            if name in staged:
                tried = tuple(attempt._asdict() for attempt in result.tried)
                staged[name] = staged[name].after(result.episode.restaged, result.restaged, tried)
                made_from[name] = staged[name].ran.digest()
                run.store.append(STAGED, staged[name])
            elif result.demand is not None:
                owner = scene_of(name)
                staged[owner] = staged[owner].demanding(result.demand)
                run.store.append(STAGED, staged[owner])
            result.save(run.store)
            yield result.episode

    def items(name: str) -> tuple[str, ...]:
        demands = (demand_id(name),) if run.config.demands else ()
        return (name, twin_id(name), *demands)

    def is_whole(line: Mapping[str, Any]) -> bool:
        return staged[scene_of(line["id"])].how is not None and _has_files(run, line)

    found = run.each(
        "simulate",
        "episodes.jsonl",
        {item: name for name in staged for item in items(name)},
        work,
        made_from=lambda item: made_from[scene_of(item)],
        is_whole=is_whole,
    )
    return [Episode.parse(row) for row in found]


def simulate_whole(run: Context, scenes: Sequence[Scene]) -> list[Episode]:
    """Run every scene as the paper did: frames of the whole trace, collisions only, no twins.

    Args:
        run: The run's context.
        scenes: The scenes that were run for the episodes.
    """
    camera = run.config.camera
    job = Job(run.config.simulator, run.config.seed, protocol="paper", camera=camera)
    return _sweep(run, job, {scene.id: scene for scene in scenes}, "episodes.paper.jsonl")


def _sweep(run: Context, job: Job, items: Mapping[str, Scene], file: str) -> list[Episode]:
    """Run the scenes that lack an episode in a file, and return the episodes of all."""

    def work(todo: Mapping[str, Scene]) -> Iterator[Episode]:
        for result in sweep(
            job, list(todo.values()), workers=run.options.workers, executor=run.options.executor
        ):
            result.save(run.store)
            yield result.episode

    rows = run.each(
        "simulate",
        file,
        items,
        work,
        made_from=lambda name: items[name].digest(),
        is_whole=lambda line: _has_files(run, line),
    )
    return [Episode.parse(row) for row in rows]


def simulate_behind(run: Context, episodes: Sequence[Episode]) -> dict[str, str]:
    """Take the picture from the rear window at every decision; return the files by id of the drive.

    Args:
        run: The run's context.
        episodes: The episodes of scenes, twins and demands that are to be judged.
    """
    ran = [Scene.parse(line) for line in run.store.lines(SCENES) if line.get("status") != "failed"]
    drives = {scene.id: scene for scene in ran}
    for episode in episodes:
        if episode.is_twin and episode.decision_s is not None:
            name = scene_of(episode.scene_id)
            drives[episode.scene_id] = drives[name].twin(episode.decision_s)
    items = {one.scene_id: drives[one.scene_id] for one in episodes if one.status == "ok"}
    config = run.config
    job = Job(config.simulator, config.seed, camera=config.camera, is_rear=True)
    rows = _sweep(run, job, items, REAR)
    return {one.scene_id: one.frames["last"] for one in rows if one.frames}


def _has_files(run: Context, line: Mapping[str, Any]) -> bool:
    """Return whether the files of an episode are there, as they were written."""
    written = line.get("file_sha256", {})
    return all(
        run.store.holds(file) and (file not in written or run.store.digest(file) == written[file])
        for file in (*line["frames"].values(), *line["files"])
    )
