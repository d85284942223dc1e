"""The describer, which writes distinct texts, and their twins, for the paths of a tree (paper, section III-B)."""

from collections.abc import Iterable, Mapping, Sequence, Set
from contextlib import suppress
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from oodscen._arguments import checked
from oodscen._display import Brief
from oodscen._numbers import whole_number
from oodscen._parallel.threads import as_finished
from oodscen._progress import Progress, counted, reporting
from oodscen._words.text import folded_words, one_line
from oodscen.data._catalogue import Catalogue
from oodscen.data._scenario import Scenario
from oodscen.encoders._check import unit_embeddings
from oodscen.errors import AnswerError, LLMError, UsageError
from oodscen.llm._ask import ask
from oodscen.llm._reading import read_answer
from oodscen.metrics._detection.guard import is_calibrated
from oodscen.prompts._digest import CatalogueDigest
from oodscen.prompts._scenario.describe_ordinary import DescribeOrdinary
from oodscen.prompts._scenario.describe_path import STYLES, DescribePath, Descriptions
from oodscen.protocols import LLM, Encoder
from oodscen.stages._options import DescribeOptions, with_changes
from oodscen.tree._scenario_tree import ScenarioTree

if TYPE_CHECKING:
    from oodscen.metrics._metrics import Metrics


def text_id(leaf: str, number: int) -> str:
    """Return the id of a path's text by its number, from 1 on."""
    return f"{leaf}-{number:03d}"


class Describer(Brief):
    """Asks the tree-LLM for texts along each path; near duplicates and off-topic texts are redrawn.

    A model that gives fewer texts than it is asked for has run dry: the kind bears no more. It is not asked
    again, and near duplicates and off-topic texts are left out, though never all texts of a path.

    Args:
        llm: The tree-LLM.
        encoder: Measures the similarity of two texts of a path; without one only identical texts are duplicates.
        metrics: Measures OOD-ness, selects texts and flags off-topic ones; required for `candidates` above 1
            and for a `band`.
        catalogue: The simulator that will show the texts, so that they ask for nothing else.
        made: Things and motions made to order, in words, by the path of the leaf that they were made for.
        options: All other options; the defaults if left out.
        **changes: Single options, e.g. `per_path=3`, instead of those in `options`.

    Raises:
        UsageError: For an unknown option, a value that is not allowed, or a selection without metrics.
    """

    Options: ClassVar[type[DescribeOptions]] = DescribeOptions
    """The options as one frozen value."""
    styles: ClassVar[tuple[str, ...]] = STYLES
    """Names of the styles that `style` accepts."""
    _repr_fields = ("llm", "encoder", "options")

    @checked
    def __init__(
        self,
        llm: LLM,
        encoder: Encoder | None = None,
        *,
        metrics: "Metrics | None" = None,
        catalogue: Catalogue | None = None,
        made: Mapping[tuple[str, ...], Sequence[str]] | None = None,
        options: DescribeOptions | None = None,
        **changes: Any,
    ) -> None:
        self.options = with_changes(DescribeOptions, options, changes)
        if metrics is None and self.options.is_selective:
            raise UsageError("texts are chosen by metrics; pass `metrics=Metrics(encoder)`")
        self.llm = llm
        self.encoder = encoder
        self.metrics = metrics
        self.catalogue = CatalogueDigest.of(catalogue) if catalogue else None
        self.made = {path: tuple(words) for path, words in (made or {}).items()}

    @checked
    def run(self, tree: ScenarioTree, *, progress: Progress | bool | None = None) -> list[Scenario]:
        """Return up to `per_path` scenarios for every leaf, in tree order, with different texts if the model has them.

        Args:
            tree: The simulatable tree.
            progress: True for a progress bar, or a callable; it counts the paths.

        Raises:
            LLMError: When the model fails on a path.
            UsageError: When too few candidates lie inside the band.
        """
        paths = tree.paths
        written = as_finished(
            lambda leaf: self.path(leaf, paths[leaf], self.options.per_path),
            paths,
            threads=self.options.threads,
        )
        with reporting(progress) as report_progress:
            by_leaf = dict(counted(written, "describe", len(paths), report_progress))
        scenarios = [scenario for leaf in paths for scenario in by_leaf[leaf]]
        reworded = {scenario.id: scenario for scenario in self.reworded(scenarios)}
        return [reworded.get(scenario.id, scenario) for scenario in scenarios]

    @checked
    def path(self, leaf: str, path: Sequence[str], count: int) -> list[Scenario]:
        """Return scenarios `<leaf>-001`, `<leaf>-002` ... for one path: `count`, or as many as its kind bears.

        Raises:
            LLMError: When the model fails.
            UsageError: When too few candidates lie inside the band.
        """
        path, count = tuple(path), whole_number("count", count, 1)
        texts, is_dry = self._draw(path, count * self.options.candidates, avoid=())
        for _ in range(self.options.redraws):
            unfit = self._near_duplicates(texts) | self._off_topic(texts)
            if not unfit:
                break
            fit = [text for index, text in enumerate(texts) if index not in unfit]
            if is_dry:
                texts = fit or texts[:1]
                break
            fresh, is_dry = self._draw(path, len(unfit), avoid=texts)
            texts = fit + fresh or texts[:1]
        count = min(count, len(texts))
        if self.metrics is not None and self.options.is_selective:
            low, high = self.options.band or (-np.inf, np.inf)
            selected = self.metrics.select(texts, count, low=low, high=high)
            texts = [texts[index] for index in sorted(selected.indices)]
        return [
            self._scenario(text_id(leaf, number), text, leaf, path)
            for number, text in enumerate(texts, start=1)
        ]

    @checked
    def reworded(self, scenarios: Iterable[Scenario]) -> list[Scenario]:
        """Return new versions of scenarios that repeat an earlier text, ignoring case and punctuation.

        A repetition stays if the model gives no other text.

        Raises:
            LLMError: When the model fails.
        """
        scenarios = list(scenarios)
        taken = {folded_words(scenario.text) for scenario in scenarios}
        earlier: set[str] = set()
        reworded = []
        for scenario in scenarios:
            words = folded_words(scenario.text)
            if words in earlier:
                same_leaf = [other.text for other in scenarios if other.leaf == scenario.leaf]
                fresh: list[str] = []
                with suppress(AnswerError):
                    fresh, _ = self._draw(scenario.path, 1, avoid=same_leaf, taken=taken)
                if not fresh:
                    continue
                reworded.append(self._scenario(scenario.id, fresh[0], scenario.leaf, scenario.path))
                words = folded_words(fresh[0])
                taken.add(words)
            earlier.add(words)
        return reworded

    @checked
    def ordinary(self, scenario: Scenario) -> str:
        """Return the ordinary twin of a text: same place, phrasing and length, without the event.

        Raises:
            LLMError: When the model fails.
        """
        prompt = DescribeOrdinary(text=scenario.text, path=scenario.path)
        return one_line(ask(self.llm, prompt, sample=self.options.sample).text)

    def _scenario(self, name: str, text: str, leaf: str, path: tuple[str, ...]) -> Scenario:
        scenario = Scenario(id=name, text=text, leaf=leaf, path=path, style=self.options.style)
        return self.twinned(scenario) if self.options.twins else scenario

    @checked
    def twinned(self, scenario: Scenario) -> Scenario:
        """Return a scenario with its ordinary twin, or as it is if the model has none: it counts without.

        Raises:
            LLMError: When the model fails, and may answer later.
        """
        try:
            return scenario.model_copy(update={"ordinary": self.ordinary(scenario)})
        except LLMError as error:
            if error.retryable:
                raise
            return scenario

    def _draw(
        self, path: tuple[str, ...], count: int, avoid: Sequence[str], taken: Set[str] = frozenset()
    ) -> tuple[list[str], bool]:
        """Ask for texts until enough are not `taken`; later questions avoid the ones that are.

        Returns:
            The texts, and true if the model gave fewer than it was asked for.
        """
        texts: list[str] = []
        refused: list[str] = []
        while len(texts) < count:
            wanted = min(self.options.batch, count - len(texts))
            prompt = DescribePath(
                path=path,
                count=wanted,
                avoid=(*avoid, *texts, *refused),
                style=self.options.style,
                catalogue=self.catalogue,
                made=self.made.get(path, ()),
            )
            answer = self._texts(prompt)
            for text in answer:
                is_taken = folded_words(text) in taken
                (refused if is_taken else texts).append(one_line(text))
            if len(answer) < wanted:
                return texts, True
        return texts, False

    def _texts(self, prompt: DescribePath) -> list[str]:
        """Return the texts that the model gives; those at fault in its last attempt are left out, if others are not.

        Raises:
            LLMError: When the model fails.
        """
        try:
            return ask(self.llm, prompt, sample=self.options.sample).texts
        except AnswerError as error:
            # An answer at fault elsewhere may be cut off within a text.
            are_texts_at_fault = all(issue.path.startswith("texts") for issue in error.issues)
            answer, _ = read_answer(error.raw, Descriptions)
            texts = prompt.usable(answer) if answer and are_texts_at_fault else None
            if texts is None:
                raise
            return texts

    def _off_topic(self, texts: list[str]) -> set[int]:
        """Return the positions of texts that are not about driving, if the encoder can tell."""
        if self.metrics is None or not is_calibrated(self.metrics.encoder.name):
            return set()
        return set(self.metrics.off_topic(texts).flagged)

    def _near_duplicates(self, texts: list[str]) -> set[int]:
        """Return the positions of texts that are too similar to an earlier one."""
        if self.encoder is None or len(texts) < 2:
            return set()
        unit = unit_embeddings(self.encoder, texts)
        cosines = np.tril(unit @ unit.T, k=-1)
        return {int(row) for row in np.nonzero((cosines > self.options.nearest).any(axis=1))[0]}
