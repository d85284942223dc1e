"""The whole paper as one resumable run, stage after stage."""

import time
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

from oodscen._abilities import Rehearses, packages_of
from oodscen._io.study_files import ASSETS, MOTIONS
from oodscen._members import reason
from oodscen._pipeline.context import Context
from oodscen._pipeline.options import RunOptions
from oodscen._pipeline.steps.aspects import judged, unjudged
from oodscen._pipeline.steps.compare import compare_catalogues
from oodscen._pipeline.steps.judge import evaluate, outcomes
from oodscen._pipeline.steps.measure import measure, unanswered
from oodscen._pipeline.steps.scenes import augment, refuse_late_outputs, simulate
from oodscen._pipeline.steps.texts import (
    describe,
    describe_sets,
    has_twins,
    refuse_added,
    text_files,
    without_twin,
)
from oodscen._pipeline.steps.trees import check_given, grow, prune, redteam
from oodscen._version import __version__
from oodscen._words.redaction import redact
from oodscen.data._base import canonical_json
from oodscen.data._pairing import kind_of
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.data._verdict import Verdict
from oodscen.errors import OodscenError, RunStopped, StudyError, StudyMismatch
from oodscen.llm._accounting import accounts
from oodscen.report._render import write_report
from oodscen.study._config import CHANGEABLE, Status, StudyConfig
from oodscen.study._record import authors, joined_versions, record
from oodscen.study._rounds import failed_at_end
from oodscen.study._shared_settings import refuse_changed_settings
from oodscen.study._stale_verdicts import OPINIONS
from oodscen.study._study import Study
from oodscen.tree._scenario_tree import ScenarioTree


class Texts(NamedTuple):
    """The results of the stages before staging."""

    initial: ScenarioTree
    diverse: ScenarioTree
    simulatable: ScenarioTree
    scenarios: list[Scenario]
    """Texts of the simulatable tree."""
    sets: dict[int, list[Scenario]]
    """Text sets of the diverse tree, by size."""


_LASTING = ("authors", "counts", "failures", "usage", "seconds")
"""Parts of `study.json` that an unfinished run leaves unchanged."""


class Pipeline:
    """Runs a study to its end, resuming from the state of its folder.

    Args:
        out: The study's folder.
        config: What to run.
        options: How to run it; no part of the study's identity.

    Raises:
        StudyMismatch: When the folder holds a study of another configuration.
        FolderTaken: When the folder holds no study, but files that a study would write.
        StudyError: When the folder cannot be written.
    """

    def __init__(
        self, out: str | Path, config: StudyConfig, options: RunOptions | None = None
    ) -> None:
        self.context = Context(out, config, options)
        self.study = self.context.study
        self.store = self.context.store
        self.config = config

    def run(self) -> Study:
        """Run every stage; failed items are recorded and do not stop the run.

        Raises:
            InUse: When another process writes the folder.
            RunStopped: When a cap is reached or an endpoint is given up; running again continues.
            KeyboardInterrupt: When the run is interrupted; running again continues as well.
        """
        with self.store.writing():
            return self._run()

    def _run(self) -> Study:
        limits = self.context.models.limits
        limits.reopen()
        began = time.perf_counter()
        self.prepare()
        try:
            self._save("running")
            counts = self._stages()
            self._finish(counts, time.perf_counter() - began)
        except RunStopped as stop:
            self._save_stopped(str(stop))
            write_report(self.study)
            raise
        except Exception as error:
            with suppress(OodscenError):  # The first error is the cause.
                self._save_stopped(str(error) if isinstance(error, OodscenError) else reason(error))
            raise
        except KeyboardInterrupt:
            limits.close()
            with suppress(StudyError):  # A full disk must not hide the signal.
                self._save_stopped("it was interrupted; the same command continues it")
            raise
        finally:
            self.context.models.close()
        return self.study

    def prepare(self) -> None:
        """Check the folder, then create the simulator, the encoder and the models."""
        self._check()
        self.context.prepare()

    def write_texts(self) -> Texts:
        """Run the stages up to the texts."""
        run = self.context
        with run.timed("grow"):
            initial = grow(run)
        with run.timed("redteam"):
            diverse = redteam(run, initial)
        with run.timed("prune"):
            simulatable = prune(run, diverse)
        with run.timed("compare"):
            compare_catalogues(run, diverse)
        with run.timed("describe"):
            scenarios, sets = describe(run, simulatable), describe_sets(run, diverse)
        return Texts(initial, diverse, simulatable, scenarios, sets)

    def stage(self, scenarios: list[Scenario]) -> list[Scene]:
        """Run the stage that turns texts into scenes."""
        with self.context.timed("augment"):
            return augment(self.context, scenarios)

    def _stages(self) -> dict[str, Any]:
        run = self.context
        texts = self.write_texts()
        with run.timed("metrics"):
            scenarios = measure(run, texts.scenarios, texts.sets)
        self.stage(scenarios)
        with run.timed("simulate"):
            scenes, episodes = simulate(run)
        with run.timed("evaluate"):
            verdicts = evaluate(run, episodes, scenarios, scenes)
        outside = len(texts.scenarios) - len(scenarios)
        leaves = texts.simulatable.leaves
        finished = [episode for episode in episodes if episode.status == "ok"]
        return {
            "nodes": {
                "initial": len(texts.initial),
                "diverse": len(texts.diverse),
                "simulatable": len(texts.simulatable),
            },
            "paths": len(leaves),
            "attested": sum(leaf.attested == "paper" for leaf in leaves),
            "texts": {str(size): len(scenarios) for size, scenarios in texts.sets.items()},
            "scenarios": len(scenarios),
            **({"outside_band": outside} if outside else {}),
            "scenes": len(scenes),
            "episodes": sum(not episode.is_ordinary for episode in finished),
            "twins": sum(episode.is_twin for episode in finished),
            "demands": sum(kind_of(episode.id) == "demand" for episode in finished),
            "restaged": sum(bool(episode.restaged) for episode in episodes),
            "hazards_visible": sum(episode.hazard_visible is True for episode in episodes),
            "below_floor": sum(episode.is_below_floor for episode in episodes),
            "verdicts": len(verdicts),
            "outcomes": outcomes(verdicts),
            **judged(verdicts, self.context.store.lines(OPINIONS)),
        }

    def _usage(self) -> list[dict[str, Any]]:
        return [item.model_dump(mode="json") for item in accounts(self.store.lines("calls.jsonl"))]

    def _check(self) -> None:
        """Check that the folder belongs to this run and that its files are intact."""
        check_given(self.context)
        if self.store.has("study.json"):
            differences = self.study.config.differences(self.config)
            for name in CHANGEABLE:
                differences.pop(name, None)
            made_with = self.study.info.get("versions", {}).get("oodscen")
            if made_with != __version__:
                differences["oodscen"] = (made_with, __version__)
            if self.study.info.get("status") in ("running", "stopped"):
                # What is still to be written would be by another author than it says.
                began_by, now = self.study.info.get("authors", {}), authors(self.config)
                differences |= {
                    role: (began_by[role], author)
                    for role, author in now.items()
                    if began_by.get(role, author) != author
                }
            if differences:
                raise StudyMismatch(str(self.study.folder), differences)
            verdicts = map(Verdict.parse, self.store.lines("verdicts.jsonl"))
            refuse_changed_settings(self.study.config, self.config, verdicts)
        self.study.check()
        refuse_added(self.store, self.config.per_path)
        refuse_late_outputs(self.store, self.context.options.outputs)

    def _save(self, status: Status, **more: Any) -> None:
        """Write `study.json`; earlier counts stay until new ones replace them."""
        earlier = self.study.info if self.store.has("study.json") else {}
        more = {name: earlier[name] for name in _LASTING if name in earlier} | more
        simulator = self.context.simulator
        more["camera"] = simulator.catalogue().camera
        more["rehearses"] = isinstance(simulator, Rehearses)
        content = record(
            self.config,
            status,
            tree=self.context.options.tree,
            packages=packages_of(simulator),
            **more,
        )
        content["versions"] = joined_versions(earlier.get("versions", {}), content["versions"])
        self.store.write("study.json", canonical_json(content) + "\n")

    def _save_stopped(self, reason: str) -> None:
        self._save("stopped", stopped=redact(reason), usage=self._usage())

    def _finish(self, counts: Mapping[str, Any], seconds: float) -> None:
        failures = self._failures()
        status: Status = "incomplete" if any(failures.values()) else "success"
        self._save(
            status,
            counts=dict(counts),
            failures=failures,
            usage=self._usage(),
            seconds=self._times({**self.context.seconds, "total": seconds}),
        )
        write_report(self.study)

    def _failures(self) -> dict[str, int]:
        """Return the number of failed items of every table, and of what was asked for beside their lines."""
        counts = {
            table: len(self.study.failures(table))
            for table in ("pruned", "scenarios", "scenes", "episodes", "verdicts")
        }
        counts["redteam"] = len(failed_at_end(self.study.rounds))
        others = {"texts": text_files(self.config)[1:], "assets": [ASSETS], "motions": [MOTIONS]}
        for table, files in others.items():
            if any(map(self.store.holds, files)):
                lines = [line for file in files for line in self.store.lines(file)]
                counts[table] = sum(line.get("status") == "failed" for line in lines)
        if has_twins(self.config):
            counts["ordinary"] = len(without_twin(self.store, self.config))
        if self.context.rarity_llm is not None:
            counts["rarity"] = unanswered(self.study)
        if self.config.judge:
            counts["opinions"] = unjudged(self.study.verdicts)
        return counts

    def _times(self, run_s: Mapping[str, float]) -> dict[str, float]:
        """Return the seconds of all runs that this study has taken, by stage."""
        earlier_s = self.study.info.get("seconds", {})
        return {
            stage: round(earlier_s.get(stage, 0.0) + run_s.get(stage, 0.0), 3)
            for stage in {**earlier_s, **run_s}
        }
