"""The stages that make scenes and episodes: augment, simulate."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from oodscen.augment import Augmenter
from oodscen.claims.claim import Claim
from oodscen.concurrency import as_finished
from oodscen.episode import Episode
from oodscen.errors import LLMError
from oodscen.scenario import Scenario
from oodscen.scene import Scene
from oodscen.study.context import Context, failed
from oodscen.study.sweep import Job, SweepResult, sweep
from oodscen.twins import twin_id

RESTAGED = "restaged.jsonl"
"""One line per scene that told no actions apart: its id, how it was staged anew with the scene that was run (`how`
is empty where nothing helped), and what was tried in vain and why."""


def augment(run: Context, scenarios: Sequence[Scenario]) -> list[Scene]:
    """Read what every text says, and stage it so that the scene holds to that."""
    augmenter = Augmenter(run.llm, run.simulator.catalogue(), context=run.config.context)
    told = _claims(run, augmenter, scenarios)

    def work(scenario: Scenario) -> dict[str, Any]:
        claims = told[scenario.id]
        if isinstance(claims, LLMError):
            return failed(scenario.id, claims, scenario_id=scenario.id)
        try:
            return augmenter.run(scenario, claims).model_dump(mode="json")
        except LLMError as error:
            return failed(scenario.id, error, scenario_id=scenario.id)

    rows = _asked(run, "augment", "scenes.jsonl", scenarios, work)
    return [Scene.parse(row) for row in rows if row.get("status") != "failed"]


def _claims(
    run: Context, augmenter: Augmenter, scenarios: Sequence[Scenario]
) -> dict[str, tuple[Claim, ...] | LLMError]:
    """Return what every text says, by its id; where nobody could read it, the error.

    A scene that lacks its claims can be made at another time exactly when they can be read then.
    """

    def work(scenario: Scenario) -> dict[str, Any]:
        try:
            claims = augmenter.read(scenario)
        except LLMError as error:
            return failed(scenario.id, error)
        return {"id": scenario.id, "claims": [claim.model_dump(mode="json") for claim in claims]}

    rows = _asked(run, "claims", "claims.jsonl", scenarios, work)
    return {
        row["id"]: LLMError(
            f"what the text says could not be read: {row['error']}",
            retryable=row.get("retryable", False),
        )
        if row.get("status") == "failed"
        else tuple(Claim.parse(claim) for claim in row["claims"])
        for row in rows
    }


def _asked(
    run: Context,
    stage: str,
    file: str,
    scenarios: Sequence[Scenario],
    work: Callable[[Scenario], dict[str, Any]],
) -> list[dict[str, Any]]:
    """Ask a model about every scenario, as many at once as it may be asked; return the lines."""
    return run.each(
        stage,
        file,
        {scenario.id: scenario for scenario in scenarios},
        lambda todo: (
            row
            for _, row in as_finished(work, todo.values(), threads=run.threads, cancel=run.cancel)
        ),
    )


def simulate(run: Context, scenes: Sequence[Scene]) -> list[Episode]:
    """Run every scene and its ordinary twin in worker processes; only this process writes.

    Scenes in which all or none of the actions are safe say nothing about a choice: they are
    re-staged where that helps. `restaged.jsonl` says which and how, and what was tried in vain;
    `scenes.jsonl` then holds what was run.
    """
    job = Job(run.config.simulator, run.config.seed, run.extras, twins=True, restages=True)
    scenes = _as_run(run, scenes)
    by_id = {scene.id: scene for scene in scenes}
    items: dict[str, Scene] = {}
    for scene in scenes:
        items[scene.id] = items[twin_id(scene.id)] = scene
    done = {line["id"]: line for line in run.store.lines("episodes.jsonl")}

    def work(todo: Mapping[str, Scene]) -> Iterator[Episode]:
        wanted = [by_id[name] for name in todo if name in by_id]
        for name, scene in todo.items():
            if name not in by_id and scene.id not in todo:
                wanted.append(scene.twin(done[scene.id].get("decision_s") or 0.0))
        for result in sweep(job, wanted, workers=run.workers, executor=run.executor):
            if result.episode.id not in todo:
                continue
            result.save(run.store)
            if result.restaged or result.tried:
                run.store.append(RESTAGED, _restaged_line(result))
            yield result.episode

    rows = run.each("simulate", "episodes.jsonl", items, work)
    _as_run(run, scenes)
    return [Episode.parse(row) for row in rows]


def simulate_whole(run: Context, scenes: Sequence[Scene]) -> list[Episode]:
    """Run every scene as the paper did: frames of the whole trace, collisions only, no twins."""
    job = Job(run.config.simulator, run.config.seed, protocol="paper")

    def work(todo: Mapping[str, Scene]) -> Iterator[Episode]:
        for result in sweep(job, list(todo.values()), workers=run.workers, executor=run.executor):
            result.save(run.store)
            yield result.episode

    items = {scene.id: scene for scene in _as_run(run, scenes)}
    rows = run.each("simulate", "episodes.paper.jsonl", items, work)
    return [Episode.parse(row) for row in rows]


def _restaged_line(result: SweepResult) -> dict[str, Any]:
    line: dict[str, Any] = {
        "id": result.episode.id,
        "how": result.episode.restaged,
        "tried": [attempt._asdict() for attempt in result.tried],
    }
    if result.restaged:
        line["scene"] = result.restaged.model_dump(mode="json")
    return line


def _as_run(run: Context, scenes: Sequence[Scene]) -> list[Scene]:
    """Put re-staged scenes in the place of the given ones, here and in `scenes.jsonl`."""
    lines = {line["id"]: line for line in run.store.lines(RESTAGED)}
    lines = {name: lines[name] for name in sorted(lines)}
    if not lines:
        return list(scenes)
    run.store.write_lines(RESTAGED, lines.values())
    changed = {name: line["scene"] for name, line in lines.items() if "scene" in line}
    if not changed:
        return list(scenes)
    rows = list(run.store.lines("scenes.jsonl"))
    rows = [changed.get(row["id"], row) for row in rows]
    run.store.write_lines("scenes.jsonl", rows)
    return [Scene.parse(changed[scene.id]) if scene.id in changed else scene for scene in scenes]
