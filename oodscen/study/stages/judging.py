"""The stage that judges models."""

from collections.abc import Iterator, Mapping, Sequence

from oodscen.concurrency import as_finished
from oodscen.episode import ACTIONS, Episode
from oodscen.evaluation import evaluate as judge_episode
from oodscen.messages import Image
from oodscen.protocols import LLM
from oodscen.scenario import Scenario
from oodscen.study.context import Context
from oodscen.verdict import Verdict


def evaluate(
    run: Context, episodes: Sequence[Episode], scenarios: Sequence[Scenario]
) -> list[Verdict]:
    """Judge the reference answerers and every named model."""
    references = [*(f"constant:{action}" for action in ACTIONS), "random"]
    paths = {scenario.id: scenario.path for scenario in scenarios}
    ready = [episode for episode in episodes if episode.status == "ok" and episode.frames]
    models: dict[str, tuple[LLM, int]] = {}
    for name in (*references, *run.config.vlms):
        model = run.models.get(name)
        is_reference = getattr(model, "kind", "model") == "reference"
        models[name] = (model, 1 if is_reference else run.models.traffic.concurrency)
    items = {
        f"{episode.scene_id}@{model.name}": (episode, name)
        for name, (model, _) in models.items()
        for episode in ready
    }

    def work(todo: Mapping[str, tuple[Episode, str]]) -> Iterator[Verdict]:
        images = {
            scene: {
                moment: Image.from_file(run.store.path(file), file)
                for moment, file in episode.frames.items()
            }
            for scene, episode in {e.scene_id: e for e, _ in todo.values()}.items()
        }

        def judge(item: tuple[Episode, str]) -> Verdict:
            episode, name = item
            scene = episode.scene_id
            return judge_episode(episode, images[scene], models[name][0], path=paths[scene])

        for name, (_, threads) in models.items():
            batch = [item for item in todo.values() if item[1] == name]
            for _, verdict in as_finished(judge, batch, threads=threads):
                yield verdict

    rows = run.each("evaluate", "verdicts.jsonl", items, work)
    return [Verdict.parse(row) for row in rows]
