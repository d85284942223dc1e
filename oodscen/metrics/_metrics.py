"""The paper's metrics over sets of texts."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from oodscen._conformance import conforming
from oodscen._numbers import finite_number, whole_number
from oodscen._seeding import MAX_SEED, stream
from oodscen.baselines._baseline import Baseline
from oodscen.baselines._embedded import EmbeddedBaseline
from oodscen.baselines._ordinary import ordinary_driving
from oodscen.baselines._texts import check_texts
from oodscen.data._scenario import Scenario
from oodscen.encoders import all_minilm
from oodscen.errors import DataError, Issue, UsageError
from oodscen.metrics._detection.calibration import Calibration, calibrate
from oodscen.metrics._detection.guard import THRESHOLD, OffTopicFlags, is_calibrated
from oodscen.metrics._detection.separation import auroc_interval, permutation_test, sign_flip_test
from oodscen.metrics._diversity import Diversity, diversity, mean_nearest, mean_pairwise
from oodscen.metrics._lexical import compression_ratio, distinct_n
from oodscen.metrics._oodness import Definition, Measure, Neighbour, Oodness, scores
from oodscen.metrics._report import (
    Band,
    BaselineBatch,
    Comparison,
    Contrast,
    ControlCheck,
    GroupScore,
    Report,
    Selection,
    SetDistance,
    Variety,
)
from oodscen.metrics._selection import Method, most_diverse
from oodscen.metrics._vectors.distances import frechet, mmd, remote_clique, vendi
from oodscen.metrics._vectors.space import Space
from oodscen.protocols import Encoder
from oodscen.statistics._resampling import bootstrap_mean, members

Texts = Sequence[str | Scenario]


class Metrics:
    """Computes OOD-ness and diversity of texts with one encoder and against one baseline.

    `oodscen.metrics._oodness` and `.diversity` explain the formulas and their pitfalls. Each text is encoded
    once. The baseline is encoded on first use; its vectors are kept in the user's cache folder if the encoder's
    name determines its values (`cacheable`).

    Args:
        encoder: By default all-MiniLM-L6-v2, as in the paper.
        baseline: Texts of ordinary driving, by default the bundled ones; or embeddings on disk of any
            number, from `open_embeddings`.
        seed: Seed of every random draw: bootstrap, batches, subsamples.
        device: Device that searches for the nearest baseline texts: `cpu`; a torch device such as `cuda`;
            or `auto`, CUDA if available. Values agree to 1e-6, not to the last bit.
    """

    def __init__(
        self,
        encoder: Encoder | None = None,
        baseline: Baseline | EmbeddedBaseline | Sequence[str] | None = None,
        *,
        seed: int = 0,
        device: str = "cpu",
    ) -> None:
        self.encoder: Encoder = all_minilm() if encoder is None else conforming("encoder", encoder)
        self.baseline = _as_baseline(baseline)
        self.seed = whole_number("seed", seed, 0, MAX_SEED)
        self._space = Space(self.encoder, self.baseline, seed, device)

    def oodness(self, texts: Texts, definition: Measure = "tabulated") -> Oodness:
        """Return the distance of texts from the baseline: `-max_i cos(e_b,i, e_o,j)` and its mean.

        Args:
            texts: At least one string or scenario. Scenarios of one path are resampled together.
            definition: `tabulated`; `printed` for equation 1 to the letter; or a detector of
                `oodscen.metrics._detection.detectors`, on a scale of its own.

        Raises:
            DataError: If there is no text, or one is blank or not a text.
            EncoderError: If the encoder fails.
        """
        return self._oodness(check_texts(texts), _paths(texts), definition)

    def diversity(self, texts: Texts) -> Diversity:
        """Return how much texts differ from one another, by both definitions.

        Raises:
            DataError: If there is no text, or one is blank or not a text.
            EncoderError: If the encoder fails.
        """
        vectors = self._space.vectors(check_texts(texts))
        return diversity(vectors, self.encoder.name, _paths(texts), seed=self.seed)

    def report(
        self,
        texts: Texts,
        groups: Sequence[str] | None = None,
        *,
        definition: Measure = "tabulated",
        checks: bool = True,
    ) -> Report:
        """Return all figures of a set of texts.

        They come with checks against the known pitfalls: the percentile of the texts among held-out baseline
        texts,
        their separation from ordinary sentences, and, for all-MiniLM-L6-v2, the texts that are not about driving.

        Args:
            texts: At least one string or scenario.
            groups: One label per text, by default the path of a scenario. Texts of a group resemble one
                another, so they are resampled together; each group also gets its own mean.
            definition: A definition of OOD-ness, or a detector.
            checks: Whether to make the checks; without them only the texts and the baseline are encoded.

        Raises:
            DataError: If there is no text, one is blank, or `groups` has another length.
            EncoderError: If the encoder fails.
        """
        plain = check_texts(texts)
        clusters = tuple(groups) if groups is not None else _paths(texts)
        if clusters is not None and len(clusters) != len(plain):
            fault = f"has {len(clusters)} labels for {len(plain)} texts"
            raise DataError("groups", [Issue("", fault)])
        oodness = self._oodness(plain, clusters, definition)
        return Report(
            oodness=oodness,
            diversity=diversity(
                self._space.vectors(plain), self.encoder.name, clusters, seed=self.seed
            ),
            n=len(plain),
            N=len(self.baseline),
            encoder=self.encoder.name,
            baseline=self.baseline.name,
            baseline_digest=self.baseline.digest(),
            seed=self.seed,
            groups=_by_group(clusters, oodness.per_text),
            calibration=self._calibration(oodness) if checks else None,
            control=self._control(oodness, clusters, definition) if checks else None,
            off_topic=self._flags_if_calibrated(plain) if checks else None,
        )

    def off_topic(self, texts: Texts, threshold: float = THRESHOLD) -> OffTopicFlags:
        """Return the texts that are not about driving a car; see `oodscen.metrics._detection.guard`.

        Args:
            texts: At least one.
            threshold: A lower threshold flags fewer texts.

        Raises:
            DataError: If there is no text, or one is blank or not a text.
        """
        finite_number("threshold", threshold)
        return self._space.guard.flags(self._space.vectors(check_texts(texts)), threshold)

    def held_out_scores(self, definition: Measure = "tabulated") -> tuple[float, ...]:
        """Return the OOD-ness of baseline texts held out in groups of similar texts, for calibration."""
        return tuple(self._space.held_out_by(definition)[0].tolist())

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

    def select(
        self,
        texts: Texts,
        n: int,
        *,
        low: float = -math.inf,
        high: float = math.inf,
        method: Method = "max-min",
        definition: Measure = "tabulated",
    ) -> Selection:
        """Return the n texts that differ most from one another, among those inside a band of OOD-ness.

        Args:
            texts: Candidates; 100,000 take seconds once they are encoded.
            n: Number of texts to choose.
            low: Lower bound of OOD-ness.
            high: Upper bound of OOD-ness.
            method: `max-min` or `determinantal`; see `oodscen.metrics._selection`.
            definition: Definition of OOD-ness.

        Raises:
            UsageError: If fewer than n texts lie inside the band.
        """
        whole_number("n", n, 1)
        band = self.band(texts, low, high, definition=definition)
        if not n <= len(band.indices):
            raise UsageError(
                f"{n} texts cannot be chosen: {len(band.indices)} of {len(band.scores)} lie inside the band; "
                "widen it, or choose fewer"
            )
        chosen = most_diverse(self._space.vectors(band.texts), n, method)
        return Selection(
            texts=tuple(band.texts[place] for place in chosen),
            indices=tuple(band.indices[place] for place in chosen),
            method=method,
            low=band.low,
            high=band.high,
            inside=len(band.indices),
            candidates=len(band.scores),
        )

    def variety(self, texts: Texts) -> Variety:
        """Return further measures of variety; see `oodscen.metrics._vectors.distances` and `.lexical`."""
        plain = check_texts(texts)
        vectors = self._space.vectors(plain)
        return Variety(
            n=len(plain),
            vendi=vendi(vectors),
            remote_clique=remote_clique(vectors) if len(plain) > 1 else None,
            compression_ratio=compression_ratio(plain),
            distinct_1=distinct_n(plain, 1),
            distinct_2=distinct_n(plain, 2),
            encoder=self.encoder.name,
        )

    def distance(
        self, a: Texts, b: Texts | None = None, *, size: int | None = None, repeats: int = 10
    ) -> SetDistance:
        """Return the distance between two sets as a whole, at equal size.

        Args:
            a: At least two texts.
            b: At least two texts; by default the baseline.
            size: Texts drawn from each set, without replacement; by default the size of the smaller set.
            repeats: Number of draws.

        Raises:
            UsageError: If a set has fewer than `size` texts, or `size` is below 2.
        """
        first = self._space.vectors(check_texts(a, "set a"))
        second = self._space.whole if b is None else self._space.vectors(check_texts(b, "set b"))
        drawn = self._size(len(first), len(second), size, repeats)
        draws = stream(self.seed, "distance")
        found = []
        for _ in range(repeats):
            one, other = (rows[draws.permutation(len(rows))[:drawn]] for rows in (first, second))
            found.append((mmd(one, other), frechet(one, other)))
        squared, moments = np.array(found).T
        return SetDistance(
            mmd=float(squared.mean()),
            mmd_spread=float(squared.std()),
            frechet=float(moments.mean()),
            frechet_spread=float(moments.std()),
            size=drawn,
            repeats=repeats,
            n_a=len(first),
            n_b=len(second),
            encoder=self.encoder.name,
            seed=self.seed,
        )

    def band(
        self,
        texts: Texts,
        low: float,
        high: float,
        *,
        definition: Measure = "tabulated",
    ) -> Band:
        """Return the texts whose OOD-ness lies in [low, high] (Remark 1 of the paper).

        Args:
            texts: At least one.
            low: Lower bound; `-math.inf` for none.
            high: Upper bound; `math.inf` for none.
            definition: Definition of OOD-ness.

        Raises:
            UsageError: If the bounds are not numbers in order.
            DataError: If there is no text, or one is blank or not a text.
        """
        for name, bound in (("low", low), ("high", high)):
            if bound not in (-math.inf, math.inf):
                finite_number(name, bound)
        if not low <= high:
            raise UsageError(f"the band's lower bound {low} is not below its upper bound {high}")
        plain = check_texts(texts)
        values: list[float] = self._space.scores(plain, definition).tolist()
        inside = tuple(i for i, value in enumerate(values) if low <= value <= high)
        return Band(
            low=low if math.isfinite(low) else None,
            high=high if math.isfinite(high) else None,
            texts=tuple(plain[i] for i in inside),
            indices=inside,
            scores=tuple(values),
            below=sum(value < low for value in values),
            above=sum(value > high for value in values),
        )

    def baseline_batch(
        self, size: int = 100, repeats: int = 10, *, definition: Definition = "tabulated"
    ) -> BaselineBatch:
        """Return the OOD-ness of ordinary text: random batches of the baseline against the rest of it.

        Source: the paper's section on diverse scenario generation (100 texts, 10 repeats).

        Raises:
            UsageError: If the baseline is not larger than a batch.
        """
        whole_number("size", size, 1)
        whole_number("repeats", repeats, 1)
        if not size < len(self.baseline):
            raise UsageError(
                f"{repeats} batches of {size} cannot be drawn from {len(self.baseline)} baseline texts"
            )
        vectors = self._space.whole
        draws = stream(self.seed, "baseline-batch", size)
        found = []
        for _ in range(repeats):
            order = draws.permutation(len(vectors))
            batch, rest = vectors[order[:size]], vectors[order[size:]]
            found.append(float(scores(batch, rest, definition).mean()))
        return BaselineBatch(
            mean=float(np.mean(found)),
            spread=float(np.std(found, ddof=1)) if repeats > 1 else 0.0,
            per_repeat=tuple(found),
            size=size,
            repeats=repeats,
            N=len(vectors),
            definition=definition,
            encoder=self.encoder.name,
            baseline=self.baseline.name,
            seed=self.seed,
        )

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
            if not whole_number("sample", sample, 1) <= len(vectors):
                raise UsageError(
                    f"{sample} texts cannot be drawn from {len(vectors)} baseline texts"
                )
            chosen = stream(self.seed, "baseline-diversity", sample).permutation(len(vectors))
            vectors = vectors[np.sort(chosen[:sample])]
        return diversity(vectors, self.encoder.name, seed=self.seed)

    def compare(
        self,
        a: Texts,
        b: Texts,
        *,
        size: int | None = None,
        repeats: int = 100,
        paired: bool = False,
        definition: Measure = "tabulated",
    ) -> Comparison:
        """Return a comparison of two sets at equal size: each repeat draws `size` texts from either.

        The p-value is for OOD-ness over all texts: by sign flips for pairs, else by permutation. Whole paths are
        permuted if all texts are scenarios with a path. Diversity has no test, because its terms share texts.

        Args:
            a: At least two texts.
            b: At least two texts.
            size: Texts drawn from each set, without replacement; by default the size of the smaller set.
            repeats: Number of draws.
            paired: Whether the i-th texts of both belong together (a scenario and its ordinary twin). If so, the
                test is of their differences, and the same indices are drawn from both.
            definition: Definition of OOD-ness.

        Raises:
            DataError: If a set is empty, or a text is blank or not a text.
            UsageError: If a set has fewer than `size` texts, `size` is below 2, or pairs do not match.
        """
        sets = (check_texts(a, "set a"), check_texts(b, "set b"))
        drawn = self._size(len(sets[0]), len(sets[1]), size, repeats)
        if paired and len(sets[0]) != len(sets[1]):
            raise UsageError(f"{len(sets[0])} and {len(sets[1])} texts are not matched pairs")
        values = [self._space.scores(texts, definition) for texts in sets]
        names = ("pairs", "pairs") if paired else ("a", "b")
        figures = [
            self._subsamples(name, texts, own, drawn, repeats)
            for name, texts, own in zip(names, sets, values, strict=True)
        ]
        if paired:
            p_value = sign_flip_test(_per_path(values[0] - values[1], _paths(a)), seed=self.seed)
        else:
            p_value = permutation_test(values[0], values[1], (_paths(a), _paths(b)), seed=self.seed)
        contrasts = [_contrast(*pair) for pair in zip(*figures, strict=True)]
        return Comparison(
            size=drawn,
            repeats=repeats,
            n_a=len(sets[0]),
            n_b=len(sets[1]),
            is_paired=paired,
            oodness=contrasts[0].model_copy(update={"p_value": p_value}),
            nearest=contrasts[1],
            pairwise=contrasts[2],
            encoder=self.encoder.name,
            baseline=self.baseline.name,
            seed=self.seed,
            N=len(self.baseline),
            definition=definition,
        )

    def _size(self, n: int, m: int, size: int | None, repeats: int) -> int:
        drawn = min(n, m) if size is None else whole_number("size", size, 2)
        whole_number("repeats", repeats, 1)
        if not 2 <= drawn <= min(n, m):
            raise UsageError(
                f"sets of {n} and {m} texts cannot be compared by {repeats} draws of {drawn}: at least "
                "2 texts and at most all of the smaller set"
            )
        return drawn

    def _subsamples(
        self,
        name: str,
        texts: tuple[str, ...],
        values: NDArray[np.float64],
        size: int,
        repeats: int,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        vectors = self._space.vectors(texts)
        draws = stream(self.seed, "compare", name)
        found = []
        for _ in range(repeats):
            chosen = draws.permutation(len(texts))[:size]
            part = vectors[chosen]
            found.append((values[chosen].mean(), -mean_nearest(part), -mean_pairwise(part)))
        oodness, nearest, pairwise = np.array(found).T
        return oodness, nearest, pairwise

    def _oodness(
        self, texts: tuple[str, ...], clusters: tuple[str, ...] | None, definition: Measure
    ) -> Oodness:
        found = self._space.nearest(self._space.vectors(texts))
        tabulated = definition == "tabulated"
        values = 0.0 - found.cosine if tabulated else self._space.scores(texts, definition)
        neighbours = tuple(
            Neighbour(index=index, text=self._space.neighbour_text(index), cosine=cosine)
            for index, cosine in zip(found.index.tolist(), found.cosine.tolist(), strict=True)
        )
        return Oodness(
            mean=float(values.mean()),
            per_text=tuple(values.tolist()),
            nearest=neighbours,
            interval=bootstrap_mean(values, clusters, seed=self.seed),
            n=len(texts),
            N=len(self.baseline),
            definition=definition,
            encoder=self.encoder.name,
            seed=self.seed,
        )

    def _calibration(self, oodness: Oodness) -> Calibration | None:
        """Return where a set lies among held-out texts, if the baseline has texts to hold out."""
        if not isinstance(self.baseline, Baseline) or len(self.baseline) < 2:
            return None
        return calibrate(oodness.per_text, *self._space.held_out_by(oodness.definition))

    def _control(
        self, oodness: Oodness, clusters: tuple[str, ...] | None, definition: Measure
    ) -> ControlCheck:
        ordinary, own = self._space.control_scores(definition), np.array(oodness.per_text)
        return ControlCheck(
            mean=float(ordinary.mean()),
            n=len(ordinary),
            auroc=auroc_interval(ordinary, own, clusters, seed=self.seed),
        )

    def _flags_if_calibrated(self, texts: tuple[str, ...]) -> OffTopicFlags | None:
        return self.off_topic(texts) if is_calibrated(self.encoder.name) else None


def _as_baseline(
    baseline: Baseline | EmbeddedBaseline | Sequence[str] | None,
) -> Baseline | EmbeddedBaseline:
    if baseline is None:
        return ordinary_driving()
    if isinstance(baseline, Baseline | EmbeddedBaseline):
        return baseline
    return Baseline(texts=check_texts(baseline, Baseline.noun))


def _paths(texts: Texts) -> tuple[str, ...] | None:
    """Return the path of each text, for clustering; `None` unless all are scenarios with a path."""
    paths = [" / ".join(item.path) for item in texts if isinstance(item, Scenario) and item.path]
    return tuple(paths) if len(paths) == len(texts) else None


def _by_group(clusters: tuple[str, ...] | None, values: tuple[float, ...]) -> dict[str, GroupScore]:
    members: dict[str, list[float]] = {}
    for label, value in zip(clusters or (), values if clusters else (), strict=True):
        members.setdefault(label, []).append(value)
    return {
        label: GroupScore(n=len(found), oodness=math.fsum(found) / len(found))
        for label, found in members.items()
    }


def _contrast(a: np.ndarray, b: np.ndarray) -> Contrast:
    low, high = np.quantile(a - b, [0.025, 0.975])
    return Contrast(
        a=float(a.mean()),
        b=float(b.mean()),
        difference=float((a - b).mean()),
        low=float(low),
        high=float(high),
    )


def _per_path(
    differences: NDArray[np.float64], paths: tuple[str, ...] | None
) -> NDArray[np.float64]:
    """Return one mean difference per path; without paths, the differences as they are."""
    member = members(len(differences), paths)
    return np.bincount(member, weights=differences) / np.bincount(member)
