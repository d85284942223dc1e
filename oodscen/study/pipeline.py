"""The whole paper as one resumable run: each stage reads what is there and adds what is missing."""

import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from oodscen import paper
from oodscen._data import Data, canonical_json
from oodscen._version import __version__
from oodscen.augment import Augmenter
from oodscen.baselines import load_baseline
from oodscen.concurrency import as_finished
from oodscen.describe import Describer, spread, spread_subset
from oodscen.encoders import CachedEncoder
from oodscen.episode import ACTIONS, Episode
from oodscen.errors import LLMError, RunStopped, StudyMismatch
from oodscen.evaluation import evaluate
from oodscen.grow import TreeGrower
from oodscen.llms.accounting import Ledger, accounts
from oodscen.llms.redaction import redact
from oodscen.llms.traffic import Traffic
from oodscen.messages import Image
from oodscen.metrics import Metrics
from oodscen.protocols import LLM
from oodscen.prune import Pruner, all_decisions, pruned
from oodscen.redteam import RedTeamer, Round
from oodscen.registry import make_encoder, make_simulator
from oodscen.scenario import Scenario
from oodscen.scene import Scene
from oodscen.study.config import Status, StudyConfig
from oodscen.study.models import Models
from oodscen.study.record import record
from oodscen.study.study import Study
from oodscen.study.sweep import Extras, Job, sweep
from oodscen.tree import ScenarioTree
from oodscen.verdict import Verdict

Item = TypeVar("Item")

Progress = Callable[[str, int, int], None]
"""Told about every finished item of long work: the stage, how many are done, of how many."""


class Pipeline:
    """Runs a study to its end, from wherever it stands.

    Args:
        out: The study's folder.
        config: What to run.
        workers: Processes that simulate, 0 for this one; not part of the study's identity.
        executor: Runs the simulation jobs instead of local processes, e.g. a cluster's.
        progress: Told about finished items.
        models: Objects that answer for model names of the configuration.
        extras: What else is kept of the episodes that this run simulates; not part of the study's
            identity.
        traffic: Caps, prices and concurrency of the models; not part of the study's identity.
        ledger: Keeps running totals of the calls.
        retry: Do failed items again; without it, only those that may succeed at another time.

    Raises:
        StudyMismatch: When the folder holds a study of another configuration.
        StudyError: When the folder cannot be written.
    """

    def __init__(
        self,
        out: str | Path,
        config: StudyConfig,
        *,
        workers: int = 0,
        executor: Executor | None = None,
        progress: Progress | None = None,
        models: Mapping[str, LLM] | None = None,
        extras: Extras | None = None,
        traffic: Traffic | None = None,
        ledger: Ledger | None = None,
        retry: bool = False,
    ) -> None:
        self.study = Study(out)
        self.store = self.study.store
        self.config = config
        self.workers = workers
        self.executor = executor
        self.progress = progress or (lambda stage, done, total: None)
        self.retry = retry
        self.models = Models(
            config,
            self.store,
            traffic or Traffic(),
            given=models,
            ledger=ledger,
            is_retry=retry,
        )
        self.extras = extras or Extras()
        self.seconds: dict[str, float] = {}

    def run(self) -> Study:
        """Run every stage; items that fail are recorded and the rest goes on.

        Raises:
            RunStopped: When a cap is reached or an endpoint given up; running again continues.
        """
        began = time.perf_counter()
        self.prepare()
        try:
            counts = self._stages()
        except RunStopped as stop:
            self._save("stopped", stopped=redact(str(stop)), usage=self._usage())
            raise
        self._finish(counts, time.perf_counter() - began)
        return self.study

    def prepare(self) -> None:
        """Make simulator, encoder and models, and claim the folder."""
        self.simulator = make_simulator(self.config.simulator)
        self.encoder = CachedEncoder(make_encoder(self.config.encoder))
        self.llm = self.models.author(self.config.llm)
        self.red_llm = self.models.author(self.config.red_llm or self.config.llm)
        self.threads = self.models.threads(self.config.llm)
        self._claim()

    def _stages(self) -> dict[str, Any]:
        scenarios, sets, initial, diverse = self.write_texts()
        simulatable = self.study.tree("simulatable")
        with self.timed("metrics"):
            scenarios = self.measure(scenarios, sets)
        with self.timed("augment"):
            scenes = self.augment(scenarios)
        with self.timed("simulate"):
            episodes = self.simulate(scenes)
        with self.timed("evaluate"):
            verdicts = self.evaluate(episodes, scenarios)
        return {
            "nodes": {
                "initial": len(initial),
                "diverse": len(diverse),
                "simulatable": len(simulatable),
            },
            "paths": len(simulatable.leaves),
            "attested": sum(leaf.attested == "paper" for leaf in simulatable.leaves),
            "texts": {str(size): len(chosen) for size, chosen in sets.items()},
            "scenarios": len(scenarios),
            "scenes": len(scenes),
            "episodes": sum(episode.status == "ok" for episode in episodes),
            "hazards_visible": sum(episode.hazard_visible is True for episode in episodes),
            "verdicts": len(verdicts),
        }

    # ---------------------------------------------------------------- the stages

    def write_texts(
        self,
    ) -> tuple[list[Scenario], dict[int, list[Scenario]], ScenarioTree, ScenarioTree]:
        """Run the stages up to the texts; return these, the text sets, and the trees before pruning."""
        with self.timed("grow"):
            initial = self.grow()
        with self.timed("redteam"):
            diverse = self.redteam(initial)
        with self.timed("prune"):
            simulatable = self.prune(diverse)
        with self.timed("describe"):
            return self.describe(simulatable), self.describe_sets(diverse), initial, diverse

    def grow(self) -> ScenarioTree:
        """Grow the initial tree."""
        if not self.store.has("tree.initial.json"):
            self.store.write(
                "tree.initial.json", _tree_text(TreeGrower(self.llm, nodes=self.config.nodes).run())
            )
        self.progress("grow", 1, 1)
        return self.study.tree("initial")

    def redteam(self, tree: ScenarioTree) -> ScenarioTree:
        """Grow the diverse tree, round by round."""
        total = self.config.iterations
        done = [Round.parse(line) for line in self.store.lines("redteam.jsonl")]
        if self.store.has("tree.diverse.json"):
            self.progress("redteam", len(done), total)
            return self.study.tree("diverse")
        # What follows a failed round builds on it, so only the last ones can be played again.
        while done and self._again(done[-1].model_dump()):
            done.pop()
        self.store.write_lines("redteam.jsonl", done)
        self.progress("redteam", len(done), total)
        teamer = RedTeamer(
            self.llm, self.red_llm, iterations=total, closed_loop=self.config.closed_loop
        )
        for item in teamer.rounds(tree, done):
            self.store.append("redteam.jsonl", item)
            done.append(item)
            self.progress("redteam", item.round, total)
        self.store.write_lines("redteam.jsonl", done)
        diverse = tree.apply(*(edit for item in done for edit in item.edits))
        self.store.write("tree.diverse.json", _tree_text(diverse))
        return diverse

    def prune(self, tree: ScenarioTree) -> ScenarioTree:
        """Prune to what the simulator's catalogue can show."""
        total = len(tree.leaves)
        leaves = {leaf.id for leaf in tree.leaves}
        judged = [item for item in self.study.decisions if item.id in leaves]
        judged = [item for item in judged if not self._again(item.model_dump())]
        if self.store.has("tree.simulatable.json") and len(judged) == total:
            self.progress("prune", total, total)
            return self.study.tree("simulatable")
        self.store.write_lines("pruned.jsonl", judged)
        pruner = Pruner(self.llm, self.simulator.catalogue(), threads=self.threads)
        for decision in pruner.decisions(tree, [item.id for item in judged]):
            self.store.append("pruned.jsonl", decision)
            judged.append(decision)
            self.progress("prune", len(judged), total)
        self.store.write_lines("pruned.jsonl", all_decisions(tree, judged))
        simulatable = pruned(tree, judged)
        self.store.write_lines("edits.jsonl", simulatable.edits)
        self.store.write("tree.simulatable.json", _tree_text(simulatable))
        return simulatable

    def describe(self, tree: ScenarioTree) -> list[Scenario]:
        """Write the texts along the paths of the simulatable tree."""
        paths = tree.paths
        if self.config.max_paths is not None:
            leaves = list(paths)
            count = min(self.config.max_paths, len(leaves))
            chosen = [leaves[index * len(leaves) // count] for index in range(count)]
            paths = {leaf: paths[leaf] for leaf in chosen}
        counts = dict.fromkeys(paths, self.config.per_path)
        return self._describe("describe", "scenarios.jsonl", paths, counts, sample=0)

    def describe_sets(self, tree: ScenarioTree) -> dict[int, list[Scenario]]:
        """Write the text sets of the diverse tree; smaller sets are spread over the largest."""
        if not self.config.sets or not tree.paths:
            return {}
        largest = max(self.config.sets)
        counts = spread(tree.paths, largest)
        paths = {leaf: path for leaf, path in tree.paths.items() if counts[leaf]}
        file = f"texts.diverse.{largest}.jsonl"
        texts = self._describe("describe sets", file, paths, counts, sample=1)
        sets = {size: spread_subset(texts, size) for size in sorted(self.config.sets)}
        for size, chosen in sets.items():
            if size != largest:
                self.store.write_lines(f"texts.diverse.{size}.jsonl", chosen)
        return sets

    def _describe(
        self,
        stage: str,
        file: str,
        paths: Mapping[str, tuple[str, ...]],
        counts: Mapping[str, int],
        *,
        sample: int,
    ) -> list[Scenario]:
        """Write texts path by path; a path counts as done when all its lines are there."""
        describer = Describer(self.llm, self.encoder, sample=sample)
        lines: dict[str, list[dict[str, Any]]] = {}
        for line in self.store.lines(file):
            if not self._again(line):
                lines.setdefault(line["leaf"], []).append(line)
        done = {leaf: rows for leaf, rows in lines.items() if _is_whole(rows, counts.get(leaf, 0))}

        def work(leaf: str) -> list[dict[str, Any]]:
            try:
                scenarios = describer.path(leaf, paths[leaf], counts[leaf])
            except LLMError as error:
                return [_failed(leaf, error, leaf=leaf, path=paths[leaf])]
            return [scenario.model_dump(mode="json") for scenario in scenarios]

        todo = [leaf for leaf in paths if leaf not in done]
        if todo:
            self.store.remove("metrics.json")
            self.store.write_lines(file, (row for rows in done.values() for row in rows))
        self.progress(stage, len(done), len(paths))
        for leaf, rows in as_finished(work, todo, threads=self.threads):
            for row in rows:
                self.store.append(file, row)
            done[leaf] = rows
            self.progress(stage, len(done), len(paths))
        ordered = [row for leaf in paths for row in done[leaf]]
        self.store.write_lines(file, ordered)
        return [Scenario.parse(row) for row in ordered if "error" not in row]

    def measure(
        self, scenarios: list[Scenario], sets: Mapping[int, list[Scenario]]
    ) -> list[Scenario]:
        """Compute the metrics; return the scenarios inside the OOD-ness band."""
        if not self.store.has("metrics.json"):
            self.progress("metrics", 0, 1)
            content = self._metrics(
                {**{str(k): v for k, v in sets.items()}, "simulatable": scenarios}
            )
            self.store.write("metrics.json", canonical_json(content) + "\n")
        self.progress("metrics", 1, 1)
        if self.config.band is None or not scenarios:
            return scenarios
        low, high = self.config.band
        values = self.study.metrics["sets"]["simulatable"]["oodness"]["per_text"]
        return [s for s, value in zip(scenarios, values, strict=True) if low <= value <= high]

    def _metrics(self, groups: Mapping[str, Sequence[Scenario]]) -> dict[str, Any]:
        baseline = load_baseline(self.config.baseline) if self.config.baseline else None
        metrics = Metrics(self.encoder, baseline, seed=self.config.seed)
        size = min(paper.BATCH, max(1, len(metrics.baseline) // 2))
        return {
            "encoder": metrics.encoder.name,
            "baseline": {
                "name": metrics.baseline.name,
                "N": len(metrics.baseline),
                "digest": metrics.baseline.digest(),
            },
            "sets": {
                name: metrics.report(
                    [scenario.text for scenario in chosen],
                    groups=[scenario.leaf for scenario in chosen],
                ).model_dump(mode="json")
                for name, chosen in groups.items()
                if chosen
            },
            "baseline_batch": metrics.baseline_batch(size).model_dump(mode="json"),
            "baseline_diversity": metrics.baseline_diversity().model_dump(mode="json"),
        }

    def augment(self, scenarios: Sequence[Scenario]) -> list[Scene]:
        """Stage every scenario."""
        augmenter = Augmenter(self.llm, self.simulator.catalogue())

        def work(scenario: Scenario) -> dict[str, Any]:
            try:
                return augmenter.run(scenario).model_dump(mode="json")
            except LLMError as error:
                return _failed(scenario.id, error, scenario_id=scenario.id)

        items = {scenario.id: scenario for scenario in scenarios}
        rows = self._each(
            "augment",
            "scenes.jsonl",
            items,
            lambda todo: (row for _, row in as_finished(work, todo.values(), threads=self.threads)),
        )
        return [Scene.parse(row) for row in rows if row.get("status") != "failed"]

    def simulate(self, scenes: Sequence[Scene]) -> list[Episode]:
        """Run every scene in worker processes; only this process writes."""
        job = Job(self.config.simulator, self.config.seed, self.extras)

        def work(todo: Mapping[str, Scene]) -> Iterator[Episode]:
            for result in sweep(
                job, list(todo.values()), workers=self.workers, executor=self.executor
            ):
                result.save(self.store)
                yield result.episode

        items = {scene.id: scene for scene in scenes}
        rows = self._each("simulate", "episodes.jsonl", items, work)
        return [Episode.parse(row) for row in rows]

    def evaluate(self, episodes: Sequence[Episode], scenarios: Sequence[Scenario]) -> list[Verdict]:
        """Judge the reference answerers and every named model."""
        references = [*(f"constant:{action}" for action in ACTIONS), "random"]
        paths = {scenario.id: scenario.path for scenario in scenarios}
        ready = [episode for episode in episodes if episode.status == "ok" and episode.frames]
        models: dict[str, tuple[LLM, int]] = {}
        for name in (*references, *self.config.vlms):
            model = self.models.get(name)
            is_reference = getattr(model, "kind", "model") == "reference"
            models[name] = (model, 1 if is_reference else self.models.traffic.concurrency)
        items = {
            f"{episode.scene_id}@{model.name}": (episode, name)
            for name, (model, _) in models.items()
            for episode in ready
        }

        def work(todo: Mapping[str, tuple[Episode, str]]) -> Iterator[Verdict]:
            images = {
                scene: {
                    moment: Image.from_file(self.store.path(file), file)
                    for moment, file in episode.frames.items()
                }
                for scene, episode in {e.scene_id: e for e, _ in todo.values()}.items()
            }

            def judge(item: tuple[Episode, str]) -> Verdict:
                episode, name = item
                scene = episode.scene_id
                return evaluate(episode, images[scene], models[name][0], path=paths[scene])

            for name, (_, threads) in models.items():
                batch = [item for item in todo.values() if item[1] == name]
                for _, verdict in as_finished(judge, batch, threads=threads):
                    yield verdict

        rows = self._each("evaluate", "verdicts.jsonl", items, work)
        return [Verdict.parse(row) for row in rows]

    # ---------------------------------------------------------------- what the stages share

    def _each(
        self,
        stage: str,
        file: str,
        items: Mapping[str, Item],
        work: Callable[[Mapping[str, Item]], Iterable[Data | Mapping[str, Any]]],
    ) -> list[dict[str, Any]]:
        """Append one line per item that has none yet; leave the file in the items' order."""
        lines = [line for line in self.store.lines(file) if not self._again(line)]
        done = {line["id"]: line for line in lines if line["id"] in items}
        if len(done) < len(items):
            self.store.write_lines(file, done.values())
        self.progress(stage, len(done), len(items))
        for result in work({name: item for name, item in items.items() if name not in done}):
            row = result.model_dump(mode="json") if isinstance(result, Data) else dict(result)
            self.store.append(file, row)
            done[row["id"]] = row
            self.progress(stage, len(done), len(items))
        rows = [done[name] for name in items]
        self.store.write_lines(file, rows)
        return rows

    def _again(self, line: Mapping[str, Any]) -> bool:
        """Whether a line is of an item that is done again."""
        return line.get("status") == "failed" and (self.retry or line.get("retryable") is True)

    def _usage(self) -> list[dict[str, Any]]:
        return [item.model_dump(mode="json") for item in accounts(self.store.lines("calls.jsonl"))]

    @contextmanager
    def timed(self, stage: str) -> Iterator[None]:
        """Note how long a stage takes, and that calls are made for it."""
        began = time.perf_counter()
        self.models.stage = stage
        yield
        self.seconds[stage] = round(time.perf_counter() - began, 3)

    def _claim(self) -> None:
        """Write `study.json` first, or check that the one there belongs to this run."""
        if self.store.has("study.json"):
            differences = self.study.config.differences(self.config)
            differences.pop("vlms", None)
            made_with = self.study.info.get("versions", {}).get("oodscen")
            if made_with != __version__:
                differences["oodscen"] = (made_with, __version__)
            if differences:
                raise StudyMismatch(str(self.study.folder), differences)
        else:
            self.store.prepare()
        self._save("running")

    def _save(self, status: Status, **more: Any) -> None:
        self.store.write("study.json", canonical_json(record(self.config, status, **more)) + "\n")

    def _finish(self, counts: Mapping[str, Any], seconds: float) -> None:
        from oodscen.report import write_report

        failures = {
            name: len(self.study.failures(name))
            for name in ("redteam", "pruned", "scenarios", "scenes", "episodes", "verdicts")
        }
        status: Status = "incomplete" if any(failures.values()) else "success"
        self._save(
            status,
            counts=dict(counts),
            failures=failures,
            usage=self._usage(),
            seconds={**self.seconds, "total": round(seconds, 3)},
        )
        write_report(self.study)


def _tree_text(tree: ScenarioTree) -> str:
    return tree.to_json() + "\n"


def _failed(name: str, error: Exception, **more: Any) -> dict[str, Any]:
    """Return the line of an item that failed."""
    is_retryable = {"retryable": True} if getattr(error, "retryable", False) else {}
    return {"id": name, **more, "status": "failed", "error": redact(str(error)), **is_retryable}


def _is_whole(rows: Sequence[Mapping[str, Any]], count: int) -> bool:
    """Whether the lines of a path are all there, or say that it failed."""
    return len(rows) == count or any(row.get("status") == "failed" for row in rows)
