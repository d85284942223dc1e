"""The paper's metrics over sets of texts."""

import math
from collections.abc import Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from oodscen._arguments import checked
from oodscen._display import Brief
from oodscen._members import conforming
from oodscen._numbers import finite_number, said, seed_number, whole_number
from oodscen._progress import Progress, reporting
from oodscen._seeding import stream
from oodscen.baselines._baseline import Baseline
from oodscen.baselines._duplicates import NearDuplicates, similar_meaning, similar_wording
from oodscen.baselines._embedded import (
    SUFFIXES,
    EmbeddedBaseline,
    open_embeddings,
    write_embeddings,
)
from oodscen.baselines._loading import load_baseline
from oodscen.baselines._ordinary import ordinary_driving
from oodscen.baselines._texts import check_texts, is_ordered
from oodscen.data._scenario import Scenario
from oodscen.encoders._all_minilm import all_minilm
from oodscen.errors import DataError, Issue, UsageError
from oodscen.metrics._comparison import Comparison, SetDistance, compare, distance
from oodscen.metrics._detection.guard import THRESHOLD, OffTopicFlags
from oodscen.metrics._diversity import Diversity, diversity
from oodscen.metrics._groups import group_name, paths_of
from oodscen.metrics._oodness import Definition, Measure, Oodness, oodness
from oodscen.metrics._rarity.asking import DRAWS, ask_rarity
from oodscen.metrics._rarity.estimates import Rarity, estimate_rarity
from oodscen.metrics._rarity.exposure import Exposure, check_choices, exposure
from oodscen.metrics._rarity.rates import PublishedRate, anchored
from oodscen.metrics._report import BaselineBatch, MetricsReport, baseline_batch, report
from oodscen.metrics._scored_file import score_file
from oodscen.metrics._selection import Band, BandMeasure, Method, Selection, band, select
from oodscen.metrics._table import SIZES, Table, paper_table
from oodscen.metrics._variety import Variety, variety
from oodscen.metrics._vectors.space import BaselineSpace
from oodscen.protocols import LLM, Encoder

# Quoted where `checked` would refuse what `check_texts` and `group_name` say more about.
Texts = Sequence[str | Scenario]
Groups = Sequence[str | int | Sequence[str]]


class Metrics(Brief):
    """Computes OOD-ness and diversity of texts with one encoder and against one baseline.

    `oodscen.metrics._oodness` and `oodscen.metrics._diversity` explain the formulas and their pitfalls. Each text is encoded
    once. The baseline is encoded on first use; its vectors are kept in the user's cache folder if the encoder's
    name determines its values (`cacheable`).

    Args:
        encoder: By default all-MiniLM-L6-v2, as in the paper.
        baseline: Texts of ordinary driving, by default the bundled ones; or the path of a file of such texts,
            as for `load_baseline`, or of their embeddings by this encoder (`.npy`, `.arrow`, `.feather`), of
            any number: see `write_embeddings`.
        seed: Seed of every random draw: bootstrap, batches, subsamples.
        device: Device that searches for the nearest baseline texts: `cpu`; a torch device such as `cuda`;
            or `auto`, CUDA if available. Values agree to 1e-6, not to the last bit.
    """

    _repr_fields = ("encoder", "baseline", "seed")

    @checked
    def __init__(
        self,
        encoder: Encoder | None = None,
        baseline: Baseline | EmbeddedBaseline | Sequence[str] | str | Path | None = None,
        *,
        seed: int = 0,
        device: str = "cpu",
    ) -> None:
        self.encoder: Encoder = all_minilm() if encoder is None else conforming("encoder", encoder)
        self.baseline = _as_baseline(baseline, self.encoder)
        self.seed = seed_number(seed)
        self._space = BaselineSpace(self.encoder, self.baseline, self.seed, device)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle what it was made of; vectors are computed again, and embeddings on disk read from there."""
        baseline: Baseline | EmbeddedBaseline | Path = self.baseline
        if isinstance(baseline, EmbeddedBaseline):
            baseline = baseline.path.absolute()
        construct = partial(type(self), seed=self.seed, device=self._space.device)
        return construct, (self.encoder, baseline)

    @checked
    def oodness(self, texts: "Texts", definition: Measure = "tabulated") -> Oodness:
        """Return the distance of texts from the baseline: `-max_i cos(e_b,i, e_o,j)` and its mean.

        Args:
            texts: At least one string or scenario. Scenarios of one path are resampled together.
            definition: `tabulated`; `printed` for equation 1 to the letter; or a detector of
                `oodscen.metrics._detection.detectors`, on a scale of its own.

        Raises:
            DataError: If there is no text, or one is blank or not a text.
            EncoderError: If the encoder fails.
        """
        return oodness(self._space, check_texts(texts), paths_of(texts), definition)

    @checked
    def rarity(
        self,
        texts: "Texts",
        llm: LLM | None = None,
        *,
        groups: "Groups | None" = None,
        anchors: Sequence[PublishedRate] | str | Path | None = None,
        draws: int = DRAWS,
    ) -> Rarity:
        """Return the expected kilometres between two meetings with each kind of situation, with intervals.

        Args:
            texts: At least one string or scenario.
            llm: The model to ask; by default the shipped offline head estimates.
            groups: The path (or other group) of each text, for the interval of the median, as in `report`.
            anchors: Rates to calibrate the figures on: a file for `load_rates`, or `published` for the
                shipped ones. By default figures are those of the head or model.
            draws: Independent draws of a model, whose median counts.

        Raises:
            DataError: If there is no text, one is blank, the anchors are not valid rates, or there are more or
                fewer groups than texts.
            UsageError: If `groups` is no sequence of labels, or `draws` is not a whole number from 1 to 100.
            EncoderError: If the encoder fails.
            LLMError: If the model can answer no question; texts that it gives no figure for are flagged instead.
        """
        plain = check_texts(texts)
        clusters = _clusters(texts, groups)
        draws = whole_number("draws", draws, 1, 100)
        with anchored(anchors) as rates:
            if llm is None:
                return estimate_rarity(self._space, plain, clusters, rates)
            return ask_rarity(
                conforming("llm", llm),
                plain,
                anchors=rates,
                clusters=clusters,
                seed=self.seed,
                draws=draws,
            )

    def exposure(
        self,
        texts: Texts,
        chosen: Sequence[bool],
        llm: LLM | None = None,
        *,
        anchors: Sequence[PublishedRate] | str | Path | None = None,
    ) -> Exposure | None:
        """Return the share of all meetings with the texts' kinds that the chosen ones make up.

        Args:
            texts: Texts or labels of kinds, each kind once.
            chosen: One truth value per text.
            llm: As for `rarity`.
            anchors: As for `rarity`.

        Returns:
            `None` if no rarity can be estimated, or none of a chosen text.

        Raises:
            UsageError: If there is not one choice per text, or one is neither true nor false.
            DataError: As for `rarity`, which also lists the other errors.
        """
        plain = check_texts(texts)
        check_choices(chosen, len(plain))  # Before a model is asked.
        return exposure(self.rarity(plain, llm, anchors=anchors).per_text, chosen)

    def diversity(self, texts: Texts) -> Diversity:
        """Return how much texts differ from one another, by both definitions.

        Raises:
            DataError: If there is no text, or one is blank or not a text.
            EncoderError: If the encoder fails.
        """
        vectors = self._space.vectors(check_texts(texts))
        return diversity(vectors, self.encoder.name, paths_of(texts), seed=self.seed)

    @checked
    def report(
        self,
        texts: "Texts",
        groups: "Groups | None" = None,
        *,
        definition: Measure = "tabulated",
        checks: bool = True,
        progress: Progress | bool | None = None,
    ) -> MetricsReport:
        """Return all figures of a set of texts.

        They come with checks against the known pitfalls: the percentile of the texts among held-out
        baseline texts, their separation from ordinary sentences, and, for all-MiniLM-L6-v2, the
        texts that are not about driving.

        Args:
            texts: At least one string or scenario.
            groups: One label or path of labels per text, by default the path of a scenario. Texts of a group
                resemble one another, so they are resampled together; each group also gets its own mean.
            definition: A definition of OOD-ness, or a detector.
            checks: Whether to make the checks; without them only the texts and the baseline are encoded.
            progress: True for a progress bar, or a callable; it counts the figures. The first use of a baseline
                takes longest, as it is encoded.

        Raises:
            DataError: If there is no text, one is blank, or `groups` has another length.
            UsageError: If `groups` is no sequence of labels or paths.
            EncoderError: If the encoder fails.
        """
        plain = check_texts(texts)
        clusters = _clusters(texts, groups)
        with reporting(progress) as report_progress:
            return report(
                self._space, plain, clusters, definition, checks=checks, progress=report_progress
            )

    @checked
    def off_topic(self, texts: "Texts", threshold: float = THRESHOLD) -> OffTopicFlags:
        """Return the texts that are not about driving a car; see `oodscen.metrics._detection.guard`.

        Args:
            texts: At least one.
            threshold: A lower threshold flags fewer texts.

        Raises:
            DataError: If there is no text, or one is blank or not a text.
        """
        finite_number("threshold", threshold)
        return self._space.guard.flags(self._space.vectors(check_texts(texts)), threshold)

    @checked
    def held_out_scores(self, definition: Measure = "tabulated") -> tuple[float, ...]:
        """Return the OOD-ness of baseline texts held out in groups of similar texts, for calibration.

        Raises:
            UsageError: If the baseline has a single text, or is known by its embeddings alone.
        """
        return tuple(self._space.held_out(definition)[0].tolist())

    @checked
    def control_scores(self, definition: Measure = "tabulated") -> tuple[float, ...]:
        """Return the OOD-ness of the bundled ordinary control sentences (*frozen*)."""
        return tuple(self._space.control_scores(definition).tolist())

    def vectors(self, texts: Texts) -> NDArray[np.float32]:
        """Return the embeddings of texts: [n, d], rows of unit length or zero.

        Raises:
            DataError: If there is no text, or one is blank or not a text.
        """
        return self._space.vectors(check_texts(texts))

    @property
    def baseline_vectors(self) -> NDArray[np.float32]:
        """The embeddings of the baseline's texts: [N, d].

        Raises:
            UsageError: If they are on disk.
        """
        return self._space.whole

    @checked
    def select(
        self,
        texts: "Texts",
        n: int,
        *,
        low: float = -math.inf,
        high: float = math.inf,
        method: Method = "max-min",
        definition: BandMeasure = "tabulated",
    ) -> Selection:
        """Return n texts inside a band: those that differ most, or those that are met most or least often.

        Args:
            texts: Candidates; 100,000 take seconds once they are encoded.
            n: Number of texts to choose.
            low: Lower bound of OOD-ness or rarity.
            high: Upper bound of OOD-ness or rarity.
            method: `max-min` or `determinantal` for variety, `commonest` for the greatest exposure, `rarest` against
                exposure; see `oodscen.metrics._selection`.
            definition: As for `band`.

        Raises:
            UsageError: If fewer than n texts lie inside the band.
        """
        n = whole_number("n", n, 1)
        inside = self.band(texts, low, high, definition=definition)
        return select(self._space, inside, n, method)

    def variety(self, texts: Texts) -> Variety:
        """Return further measures of variety; see `oodscen.metrics._variety`."""
        return variety(self._space, check_texts(texts))

    @checked
    def distance(
        self, a: "Texts", b: "Texts | None" = None, *, size: int | None = None, repeats: int = 10
    ) -> SetDistance:
        """Return the distance between two sets as a whole, at equal size.

        Args:
            a: At least two texts.
            b: The reference, at least two texts; by default the baseline. The width of the kernel of `mmd` is
                that of its distances, so that `mmd` is not the same with the sets exchanged.
            size: Texts drawn from each set, without replacement; by default the size of the smaller set.
                A set that is drawn whole gives the same figure in every repeat.
            repeats: Number of draws.

        Raises:
            UsageError: If a set has fewer than `size` texts, or `size` is below 2.
        """
        first = self._space.vectors(check_texts(a, "set a"))
        second = self._space.whole if b is None else self._space.vectors(check_texts(b, "set b"))
        return distance(self._space, first, second, size=size, repeats=repeats)

    @checked
    def band(
        self,
        texts: "Texts",
        low: float,
        high: float,
        *,
        definition: BandMeasure = "tabulated",
    ) -> Band:
        """Return the texts whose OOD-ness or rarity lies in [low, high] (Remark 1 of the paper).

        Args:
            texts: At least one.
            low: Lower bound; `-math.inf` for none.
            high: Upper bound; `math.inf` for none.
            definition: Definition of OOD-ness; or `rarity`, with bounds as decimal logarithms of kilometres:
                4 to 7.5 keeps what is rare but real. A text without a rarity is outside.

        Raises:
            UsageError: If the bounds are not numbers in order.
            DataError: If there is no text, or one is blank or not a text.
        """
        return band(self._space, check_texts(texts), low, high, definition)

    @checked
    def baseline_batch(
        self, size: int = 100, repeats: int = 10, *, definition: Definition = "tabulated"
    ) -> BaselineBatch:
        """Return the OOD-ness of ordinary text: random batches of the baseline against the rest of it.

        Source: the paper's section on diverse scenario generation (100 texts, 10 repeats).

        Raises:
            UsageError: If the baseline is not larger than a batch.
        """
        size = whole_number("size", size, 1)
        repeats = whole_number("repeats", repeats, 1)
        if size >= len(self.baseline):
            raise UsageError(
                f"{repeats} batches of {size} cannot be drawn from {len(self.baseline)} baseline texts"
            )
        return baseline_batch(self._space, size, repeats, definition)

    @checked
    def baseline_diversity(self, sample: int | None = None) -> Diversity:
        """Return the diversity of the baseline, by both definitions.

        Args:
            sample: Number of its texts to draw; all by default. `nearest` is only comparable with a set of the
                same size.

        Raises:
            UsageError: If the baseline has fewer texts.
        """
        vectors = self._space.whole
        if sample is not None:
            sample = whole_number("sample", sample, 1)
            if sample > len(vectors):
                raise UsageError(
                    f"{sample} texts cannot be drawn from {len(vectors)} baseline texts"
                )
            chosen = stream(self.seed, "baseline-diversity", sample).permutation(len(vectors))
            vectors = vectors[np.sort(chosen[:sample])]
        return diversity(vectors, self.encoder.name, seed=self.seed)

    @checked
    def near_duplicates(
        self, texts: "Texts", threshold: float = 0.9, *, by_meaning: bool = False
    ) -> NearDuplicates:
        """Return the texts that resemble an earlier one.

        Args:
            texts: At least one; time grows with the square of their number.
            threshold: Smallest similarity that counts, in (0, 1].
            by_meaning: Compare embeddings by cosine, instead of sets of three-letter sequences by their
                Jaccard index.

        Raises:
            DataError: If there is no text, or one is blank or not a text.
            UsageError: If the threshold is not in (0, 1].
        """
        plain = check_texts(texts)
        if by_meaning:
            return similar_meaning(self._space.vectors(plain), threshold)
        return similar_wording(plain, threshold)

    @checked
    def write_embeddings(self, path: str | Path, texts: Iterable[str]) -> int:
        """Write the embeddings of texts to a `.npy` file, to serve as a baseline of any size.

        Args:
            path: The file; replaced only after all texts are written.
            texts: Any number of texts; they are read once and not kept.

        Returns:
            The number of texts.

        Raises:
            UsageError: If the file is not to be a `.npy` file.
            DataError: If there is no text, or a value is not a usable text.
            EncoderError: If the encoder fails.
            OodscenError: If a file cannot be written.
        """
        return write_embeddings(path, self.encoder, texts)

    @checked
    def paper_table(
        self, texts: "Texts", *, sizes: Sequence[int] = SIZES, repeats: int = 10
    ) -> Table:
        """Return the paper's table: batches of the baseline, and random draws of the texts by size.

        Args:
            texts: The scenarios; all of them make the last row.
            sizes: Sizes of the draws; sizes above the number of texts are left out.
            repeats: Draws per size, as in the paper; figures are their means.

        Raises:
            DataError: If there is no text, or one is blank or not a text.
            UsageError: If the baseline has a single text, or is known by its embeddings alone; or if a size or
                `repeats` is not a whole number from 1 on.
            EncoderError: If the encoder fails.
        """
        return paper_table(self, texts, sizes=sizes, repeats=repeats)

    @checked
    def score_file(
        self,
        path: str | Path,
        *,
        band: tuple[float, float] | None = None,
        definition: Definition = "tabulated",
        llm: LLM | None = None,
        anchors: str | Path | None = None,
    ) -> MetricsReport:
        """Return rarity, OOD-ness and diversity of the texts in a file.

        Args:
            path: Plain lines, JSON lines with `text` (and `path` or `leaf`, if known), a JSON list, or
                CSV with a column `text`.
            band: Bounds of OOD-ness; only the texts inside are reported.
            definition: Definition of OOD-ness.
            llm: The model that estimates rarity; by default the shipped offline head.
            anchors: Rates that calibrate rarity; see `Metrics.rarity`.

        Raises:
            DataError: If a file cannot be read, a line has no text, or only some have a group.
            UsageError: If no text lies inside the band.
            EncoderError: If the encoder fails.
        """
        with anchored(anchors) as rates:
            return score_file(self, path, band=band, definition=definition, llm=llm, anchors=rates)

    @checked
    def compare(
        self,
        a: "Texts",
        b: "Texts",
        *,
        size: int | None = None,
        repeats: int = 100,
        paired: bool = False,
        definition: Measure = "tabulated",
    ) -> Comparison:
        """Return a comparison of two sets at equal size: each repeat draws `size` texts from each.

        The p-value is for OOD-ness over all texts: by sign flips for pairs, else by permutation. Whole paths are
        permuted where all texts of a set are scenarios with a path; a pair has the path of either text, `a` first.
        Diversity has no test, because its terms share texts.

        Args:
            a: At least two texts.
            b: At least two texts.
            size: Texts drawn from each set, without replacement; by default the size of the smaller set.
                A set that is drawn whole gives the same figure in every repeat.
            repeats: Number of draws.
            paired: Whether the i-th texts of both belong together (a scenario and its ordinary twin). If so, the
                test is of their differences, and the same indices are drawn from both.
            definition: Definition of OOD-ness.

        Raises:
            DataError: If a set is empty, or a text is blank or not a text.
            UsageError: If a set has fewer than `size` texts, `size` is below 2, or pairs do not match.
        """
        sets = (check_texts(a, "set a"), check_texts(b, "set b"))
        return compare(
            self._space,
            sets,
            (paths_of(a), paths_of(b)),
            size=size,
            repeats=repeats,
            paired=paired,
            definition=definition,
        )


def _as_baseline(
    baseline: Baseline | EmbeddedBaseline | Sequence[str] | str | Path | None, encoder: Encoder
) -> Baseline | EmbeddedBaseline:
    if baseline is None:
        return ordinary_driving()
    if isinstance(baseline, Baseline | EmbeddedBaseline):
        return baseline
    if isinstance(baseline, str | Path):
        is_embedded = Path(baseline).suffix in SUFFIXES
        return open_embeddings(baseline, encoder) if is_embedded else load_baseline(baseline)
    return Baseline(texts=check_texts(baseline, Baseline.noun))


def _clusters(texts: Texts, groups: Groups | None) -> tuple[str, ...] | None:
    """Return the group of each text: the given one, or its path; `None` unless all have one.

    Raises:
        DataError: If there are more or fewer groups than texts.
        UsageError: If the groups are no sequence of labels or paths.
    """
    if groups is not None and not is_ordered(groups):
        raise UsageError(f"groups must be a sequence of labels, not {said(groups, 80)}")
    clusters = paths_of(texts) if groups is None else tuple(map(group_name, groups))
    if clusters is not None and len(clusters) != len(texts):
        issue = Issue("", f"has {len(clusters)} labels for {len(texts)} texts")
        raise DataError("groups", [issue])
    return clusters
