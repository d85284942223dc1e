"""The stages that make scenes and episodes: augment, simulate."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

from oodscen._io.study_files import REAR
from oodscen._parallel.threads import as_finished
from oodscen._pipeline.context import Context, failed
from oodscen._pipeline.jobs import Job, Outputs
from oodscen._pipeline.steps.staged import SCENES, STAGED, Line, StagedScenes
from oodscen._pipeline.sweep import sweep
from oodscen.data._base import digest
from oodscen.data._claim import Claim
from oodscen.data._episode import Episode, moments
from oodscen.data._pairing import demand_id, scene_of, twin_id
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.driving._sight.staging_advice import AdvisingCheck
from oodscen.errors import LLMError, UsageError
from oodscen.stages._augment import Augmenter
from oodscen.study._made import NOTHING, made_for
from oodscen.study._staging import Staging, text_digest
from oodscen.study._store import Store

CLAIMS = "claims.jsonl"
"""File of the claims of every text."""
RESTAGED = "restaged.jsonl"
"""File of the scenes in which all or none of the actions are safe: how each was re-staged, the scene that was
run, and failed attempts.
"""


def augment(run: Context, scenarios: Sequence[Scenario]) -> list[Scene]:
    """Extract the claims of every text and stage a scene that satisfies them.

    Returns:
        The scenes as they were staged.

    Raises:
        DataError: When a line of `scenes.jsonl` is malformed or belongs to no text, or two belong to one text.
    """
    catalogue, context = run.simulator.catalogue(), run.config.context
    augmenter = partial(Augmenter, run.llm, catalogue, context=context, encoder=run.encoder)
    plain = augmenter(check=AdvisingCheck(run.simulator))
    made = made_for(run.study)
    with_made = {
        path: augmenter(check=AdvisingCheck(), made=props, motions=motions)
        for path, (props, motions) in made.items()
    }
    by_id = {scenario.id: scenario for scenario in scenarios}
    earlier = StagedScenes(run.store)
    written = earlier.written(by_id)
    claims_by_text = _claims(run, plain, scenarios)

    def made_from(name: str) -> str:
        scenario, claims = by_id[name], claims_by_text[name]
        return text_digest(
            scenario,
            None if isinstance(claims, LLMError) else claims,
            made.get(scenario.path, NOTHING).digests(),
        )

    def work(scenario: Scenario) -> Staging | Line:
        claims = claims_by_text[scenario.id]
        try:
            if isinstance(claims, LLMError):
                raise claims
            scene = with_made.get(scenario.path, plain).run(scenario, claims)
        except LLMError as error:
            return failed(scenario.id, error, scenario_id=scenario.id)
        if run.config.horizon is not None:
            scene = scene.model_copy(update={"horizon_s": run.config.horizon})
        return Staging(id=scenario.id, scene=scene)

    # Remove the scenes of changed texts first; later they would look as if changed by hand.
    valid = run.fitting(STAGED, by_id, made_from)
    remaining = {
        name: scene for name, scene in written.items() if name in valid or earlier.is_by_hand(scene)
    }
    if len(remaining) < len(written):
        run.store.write_lines(SCENES, remaining.values())
    _ask_each(run, "augment", STAGED, scenarios, work, made_from)
    staged = StagedScenes(run.store)
    staged.write_scenes(staged.ran | remaining)
    return [staging.scene for staging in staged.by_id.values()]


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
    staged = StagedScenes(run.store)
    episodes = _simulate(run, staged)
    if staged.take_edited():
        staged.save()
        episodes = _simulate(run, staged)
    staged.save()
    restagings = [staged.by_id[name].restaging() for name in sorted(staged.by_id)]
    run.store.write_lines(RESTAGED, filter(None, restagings))
    staged.write_scenes(staged.ran)
    return list(staged.ran.values()), episodes


def _simulate(run: Context, staged: StagedScenes) -> list[Episode]:
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
    made_from = {name: scene.digest() for name, scene in staged.ran.items()}

    def work(todo: Mapping[str, str]) -> Iterator[Episode]:
        scenes = [staged.by_id[name].scene for name in dict.fromkeys(todo.values())]
        for result in sweep(
            job, scenes, workers=run.options.workers, executor=run.options.executor
        ):
            drive_id = result.episode.id
            if drive_id in staged.by_id:
                tried = tuple(attempt._asdict() for attempt in result.tried)
                staging = staged.by_id[drive_id].after(
                    result.episode.restaged, result.restaged, tried
                )
                made_from[drive_id] = staging.ran.digest()
                staged.put(staging)
            elif result.demand is not None:
                staged.put(staged.by_id[scene_of(drive_id)].demanding(result.demand))
            result.save(run.store)
            yield result.episode

    ids_of = (str, twin_id, demand_id) if run.config.demands else (str, twin_id)
    rows = run.each(
        "simulate",
        "episodes.jsonl",
        {id_of(name): name for name in staged.by_id for id_of in ids_of},
        work,
        made_from=lambda item: made_from[scene_of(item)],
        is_whole=lambda line: (
            staged.by_id[scene_of(line["id"])].how is not None and has_files(run.store, line)
        ),
    )
    return [Episode.parse(row) for row in rows]


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
        is_whole=lambda line: has_files(run.store, line),
    )
    return [Episode.parse(row) for row in rows]


def simulate_behind(run: Context, episodes: Sequence[Episode]) -> dict[str, Episode]:
    """Take the picture from the rear window at every decision; return the runs by id of the drive.

    Args:
        run: The run's context.
        episodes: The episodes of scenes, twins and demands that are to be judged.
    """
    lines = [line for line in run.store.lines(SCENES) if line.get("status") != "failed"]
    drives = {scene.id: scene for scene in map(Scene.parse, lines)}
    for episode in episodes:
        if episode.is_twin and episode.decision_s is not None:
            scene = drives[scene_of(episode.scene_id)]
            drives[episode.scene_id] = scene.twin(episode.decision_s)
    items = {
        episode.scene_id: drives[episode.scene_id] for episode in episodes if episode.status == "ok"
    }
    config = run.config
    job = Job(config.simulator, config.seed, camera=config.camera, is_rear=True)
    return {episode.scene_id: episode for episode in _sweep(run, job, items, REAR)}


def refuse_late_outputs(store: Store, outputs: Outputs) -> None:
    """Refuse outputs that the runs of a study were not asked for: what has been run is not run again.

    Raises:
        UsageError: If an episode lacks one of them; the message names them.
    """
    folders = {
        noun: folder
        for noun, folder, is_wanted in (
            ("traces", "traces/", outputs.traces),
            ("annotations", "frames/", outputs.annotations),
            ("videos", "videos/", outputs.video is not None),
        )
        if is_wanted
    }
    if not folders:
        return
    ran = [line for line in store.lines("episodes.jsonl") if line.get("status") == "ok"]
    missing = [
        noun
        for noun, folder in folders.items()
        if not all(any(file.startswith(folder) for file in line["files"]) for line in ran)
    ]
    if missing:
        raise UsageError(
            f"{store.folder} has episodes that were run without {' and '.join(missing)}, and they are not run again: "
            "run the same command in another folder, or remove their lines from episodes.jsonl first"
        )


def has_files(store: Store, line: Mapping[str, Any]) -> bool:
    """Return whether the files of an episode are there, as they were written."""
    sha256 = line.get("file_sha256", {})
    return all(
        store.holds(file) and (file not in sha256 or store.digest(file) == sha256[file])
        for file in (*line["frames"].values(), *line["files"])
    )
