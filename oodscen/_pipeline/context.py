"""The context that the stages of one run share: its folder, components and stored items."""

import time
from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

from oodscen._entry_points import is_asked
from oodscen._pipeline.models import Models
from oodscen._pipeline.options import RunOptions
from oodscen._registry import make_catalogue, make_encoder, make_simulator
from oodscen._words.redaction import redact
from oodscen.baselines import load_baseline
from oodscen.baselines._baseline import Baseline
from oodscen.data._base import Data
from oodscen.encoders._cached import CachedEncoder
from oodscen.errors import StudyError, UsageError
from oodscen.study._config import StudyConfig
from oodscen.study._study import Study

Item = TypeVar("Item")


class Context:
    """One run of a study, as its stages see it.

    Args:
        out: The study's folder.
        config: What to run.
        options: How to run it.
    """

    def __init__(
        self, out: str | Path, config: StudyConfig, options: RunOptions | None = None
    ) -> None:
        # A component may change the working folder.
        self.study = Study(Path(out).absolute())
        self.store = self.study.store
        self.config = config
        self.options = options or RunOptions()
        self.progress = self.options.progress
        self.models = Models(config, self.store, self.options)
        self.cancel = self.models.limits.close
        """Called when waiting for answers is interrupted, so that pending calls end soon."""
        self.seconds: dict[str, float] = {}
        """Wall-clock seconds of this run, by stage."""

    def prepare(self) -> None:
        """Create the simulator, the encoder and the models.

        Raises:
            UsageError: For an unknown component, a missing extra, or an unusable file of ordinary texts.
        """
        self.simulator = make_simulator(self.config.simulator)
        vlms = [name for name in self.config.vlms if is_asked(name)]
        if vlms and self.simulator.catalogue().camera == "top":
            raise UsageError(
                f"the simulator {self.config.simulator!r} draws views from above only, and models are asked about "
                f"the view of a driver: leave out --vlm {vlms[0]}, or choose another simulator"
            )
        self.compared = {name: make_catalogue(name) for name in self.config.compared}
        self.encoder = CachedEncoder(make_encoder(self.config.encoder))
        self.llm = self.models.author(self.config.llm)
        self.red_llm = self.models.author(self.config.red_llm or self.config.llm)
        self.threads = self.models.threads(self.config.llm)
        for name in self.config.models:
            self.models.get(name)
        self.models.check_names()
        rarity_llm = self.config.rarity_llm
        self.rarity_llm = None if rarity_llm is None else self.models.get(rarity_llm)
        if not self.store.holds("metrics.json"):
            _ = self.baseline  # A wrong file is found before a model is asked.

    @cached_property
    def baseline(self) -> Baseline | None:
        """Texts of ordinary driving, or `None` for the shipped ones."""
        return load_baseline(self.config.baseline) if self.config.baseline else None

    def each(
        self,
        stage: str,
        file: str,
        items: Mapping[str, Item],
        work: Callable[[Mapping[str, Item]], Iterable[Data | Mapping[str, Any]]],
        *,
        made_from: Callable[[str], str] | None = None,
        is_whole: Callable[[Mapping[str, Any]], bool] = lambda line: True,
        others: Sequence[Mapping[str, Any]] = (),
    ) -> list[dict[str, Any]]:
        """Append a line for every item without a valid one, then sort the file in the items' order.

        A line is valid if its inputs have not changed since it was written and everything that belongs to it
        exists. If the work is interrupted, failed items that were to be redone keep their old line.

        Args:
            stage: Stage shown in the progress.
            file: File with one line per item, each with its `id`.
            items: Items by id, in the order of the file.
            work: Yields the lines of the given items, in any order.
            made_from: Returns the digest of the inputs of an id's line; lines keep it as `made_from`.
            is_whole: Returns whether everything that belongs to a line exists.
            others: Lines of the file that are about none of the items, and stay before theirs.

        Returns:
            The lines of all items, in their order.
        """
        before = self.fitting(file, items, made_from, is_whole)
        done = {name: line for name, line in before.items() if not self.is_again(line)}
        if len(done) < len(items):
            self.store.write_lines(file, [*others, *done.values()])
        try:
            self.progress(stage, len(done), len(items))
            for result in work({name: item for name, item in items.items() if name not in done}):
                row = result.model_dump(mode="json") if isinstance(result, Data) else dict(result)
                if made_from is not None:
                    row["made_from"] = made_from(row["id"])
                self.store.append(file, row)
                done[row["id"]] = row
                self.progress(stage, len(done), len(items))
        except BaseException:
            if not before.keys() <= done.keys():
                by_id = before | done
                with suppress(StudyError):
                    lines = [by_id[name] for name in items if name in by_id]
                    self.store.write_lines(file, [*others, *lines])
            raise
        rows = [done[name] for name in items]
        self.store.write_lines(file, [*others, *rows])
        return rows

    def fitting(
        self,
        file: str,
        items: Container[str],
        made_from: Callable[[str], str] | None,
        is_whole: Callable[[Mapping[str, Any]], bool] = lambda line: True,
    ) -> dict[str, dict[str, Any]]:
        """Return the lines that are still valid, by id, including those of failed items."""
        return {
            line["id"]: line
            for line in self.store.lines(file)
            if line["id"] in items
            and (made_from is None or line.get("made_from") == made_from(line["id"]))
            and is_whole(line)
        }

    def is_again(self, line: Mapping[str, Any]) -> bool:
        """Return whether the item of a line must be redone."""
        return line.get("status") == "failed" and (
            self.options.retry or line.get("retryable") is True
        )

    @contextmanager
    def timed(self, stage: str) -> Iterator[None]:
        """Record how long a stage takes, and attribute its model calls to it."""
        began = time.perf_counter()
        self.models.stage = stage
        yield
        self.seconds[stage] = round(time.perf_counter() - began, 3)


def failed(name: str, error: Exception, **more: Any) -> dict[str, Any]:
    """Return the line of a failed item."""
    is_retryable = {"retryable": True} if getattr(error, "retryable", False) else {}
    return {"id": name, **more, "status": "failed", "error": redact(str(error)), **is_retryable}
