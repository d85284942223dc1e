"""The stages that make scenes and episodes: augment, simulate."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from oodscen.augment import Augmenter
from oodscen.concurrency import as_finished
from oodscen.episode import Episode
from oodscen.errors import LLMError
from oodscen.scenario import Scenario
from oodscen.scene import Scene
from oodscen.study.context import Context, failed
from oodscen.study.sweep import Job, sweep


def augment(run: Context, scenarios: Sequence[Scenario]) -> list[Scene]:
    """Stage every scenario."""
    augmenter = Augmenter(run.llm, run.simulator.catalogue())

    def work(scenario: Scenario) -> dict[str, Any]:
        try:
            return augmenter.run(scenario).model_dump(mode="json")
        except LLMError as error:
            return failed(scenario.id, error, scenario_id=scenario.id)

    items = {scenario.id: scenario for scenario in scenarios}
    rows = run.each(
        "augment",
        "scenes.jsonl",
        items,
        lambda todo: (row for _, row in as_finished(work, todo.values(), threads=run.threads)),
    )
    return [Scene.parse(row) for row in rows if row.get("status") != "failed"]


def simulate(run: Context, scenes: Sequence[Scene]) -> list[Episode]:
    """Run every scene in worker processes; only this process writes."""
    job = Job(run.config.simulator, run.config.seed, run.extras)

    def work(todo: Mapping[str, Scene]) -> Iterator[Episode]:
        for result in sweep(job, list(todo.values()), workers=run.workers, executor=run.executor):
            result.save(run.store)
            yield result.episode

    items = {scene.id: scene for scene in scenes}
    rows = run.each("simulate", "episodes.jsonl", items, work)
    return [Episode.parse(row) for row in rows]
