"""The metrics of the paper over sets of texts."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from oodscen.baselines.baseline import Baseline
from oodscen.baselines.ordinary import ordinary_driving
from oodscen.baselines.texts import check_texts
from oodscen.encoders.cached import CachedEncoder, cache_folder
from oodscen.encoders.check import encode
from oodscen.encoders.minilm import MiniLM
from oodscen.errors import DataError, Issue, UsageError
from oodscen.metrics.diversity import Diversity, diversity, mean_nearest, mean_pairwise
from oodscen.metrics.oodness import Definition, Neighbour, Oodness, scores
from oodscen.metrics.report import (
    Band,
    BaselineBatch,
    Comparison,
    Contrast,
    GroupScore,
    Report,
)
from oodscen.metrics.similarity import Vectors, nearest, smallest, unit
from oodscen.metrics.statistics import bootstrap_mean
from oodscen.protocols import Encoder
from oodscen.scenario import Scenario
from oodscen.seeding import stream

Texts = Sequence[str | Scenario]


class Metrics:
    """OOD-ness and diversity of texts, by one encoder and against one baseline.

    The formulas, and what fools them, are in `oodscen.metrics.oodness` and `.diversity`. Texts are
    encoded once each; the baseline is encoded when it is first needed, and its vectors are kept in
    the user's cache folder for encoders whose name decides their values (`cacheable`).

    Args:
        encoder: By default all-MiniLM-L6-v2, as in the paper.
        baseline: Texts of ordinary driving; by default those that are shipped.
        seed: Of every random draw: bootstrap, batches, subsamples.
    """

    def __init__(
        self,
        encoder: Encoder | None = None,
        baseline: Baseline | Sequence[str] | None = None,
        *,
        seed: int = 0,
    ) -> None:
        self.encoder: Encoder = encoder if encoder is not None else MiniLM()
        self.baseline = _as_baseline(baseline)
        self.seed = seed
        is_cached = isinstance(self.encoder, CachedEncoder)
        self._memory = self.encoder if is_cached else CachedEncoder(self.encoder)
        self._baseline_vectors: Vectors | None = None

    def oodness(self, texts: Texts, definition: Definition = "tabulated") -> Oodness:
        """Return how far texts lie from the baseline: `-max_i cos(e_b,i, e_o,j)` and its mean.

        Args:
            texts: At least one; strings or scenarios. Scenarios of one path are resampled together.
            definition: `tabulated`, or `printed` for equation 1 to the letter.

        Raises:
            DataError: When there is no text, or one is blank or not a text.
            EncoderError: When the encoder fails.
        """
        return self._oodness(check_texts(texts), _paths(texts), definition)

    def diversity(self, texts: Texts) -> Diversity:
        """Return how much texts differ from one another, by both definitions.

        Raises:
            DataError: When there is no text, or one is blank or not a text.
            EncoderError: When the encoder fails.
        """
        vectors = self._vectors(check_texts(texts))
        return diversity(vectors, self.encoder.name, _paths(texts), seed=self.seed)

    def report(
        self,
        texts: Texts,
        groups: Sequence[str] | None = None,
        *,
        definition: Definition = "tabulated",
    ) -> Report:
        """Return all figures of a set of texts.

        Args:
            texts: At least one; strings or scenarios.
            groups: One label per text, by default the path of a scenario. Texts of a group are
                resampled together, since they resemble one another, and get a mean of their own.
            definition: Of OOD-ness.

        Raises:
            DataError: When there is no text, one is blank, or `groups` has another length.
            EncoderError: When the encoder fails.
        """
        plain = check_texts(texts)
        clusters = tuple(groups) if groups is not None else _paths(texts)
        if clusters is not None and len(clusters) != len(plain):
            fault = f"has {len(clusters)} labels for {len(plain)} texts"
            raise DataError("groups", [Issue("", fault)])
        oodness = self._oodness(plain, clusters, definition)
        return Report(
            oodness=oodness,
            diversity=diversity(self._vectors(plain), self.encoder.name, clusters, seed=self.seed),
            n=len(plain),
            N=len(self.baseline),
            encoder=self.encoder.name,
            baseline=self.baseline.name,
            baseline_digest=self.baseline.digest(),
            seed=self.seed,
            groups=_by_group(clusters, oodness.per_text),
        )

    def band(
        self,
        texts: Texts,
        low: float,
        high: float,
        *,
        definition: Definition = "tabulated",
    ) -> Band:
        """Keep the texts whose OOD-ness lies in [low, high] (Remark 1 of the paper).

        Args:
            texts: At least one.
            low: Lower bound; `-math.inf` for none.
            high: Upper bound; `math.inf` for none.
            definition: Of OOD-ness.

        Raises:
            UsageError: When the bounds are not numbers in order.
            DataError: When there is no text, or one is blank or not a text.
        """
        if not low <= high:
            raise UsageError(f"the band's lower bound {low} is not below its upper bound {high}")
        plain = check_texts(texts)
        values = self._scores(plain, definition)
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
        """Return what ordinary text scores: random batches of the baseline against its rest.

        Source: the paper's section on diverse scenario generation (100 texts, 10 repeats).

        Raises:
            UsageError: When the baseline is not larger than a batch.
        """
        if not 0 < size < len(self.baseline) or repeats < 1:
            raise UsageError(
                f"{repeats} batches of {size} cannot be drawn from {len(self.baseline)} baseline texts"
            )
        vectors = self._reference()
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
            sample: How many of its texts to draw; all by default. Draw as many as the set has that
                it is compared with, or `nearest` means nothing.

        Raises:
            UsageError: When the baseline has fewer texts.
        """
        vectors = self._reference()
        if sample is not None:
            if not 0 < sample <= len(vectors):
                raise UsageError(
                    f"{sample} texts cannot be drawn from {len(vectors)} baseline texts"
                )
            chosen = stream(self.seed, "baseline-diversity", sample).permutation(len(vectors))
            vectors = vectors[np.sort(chosen[:sample])]
        return diversity(vectors, self.encoder.name, seed=self.seed)

    def compare(
        self, a: Texts, b: Texts, *, size: int | None = None, repeats: int = 100
    ) -> Comparison:
        """Compare two sets at equal size: each repeat draws `size` texts from either.

        Args:
            a: At least two texts.
            b: At least two texts.
            size: Texts drawn from each set, without replacement; by default all of the smaller.
            repeats: How often.

        Raises:
            DataError: When a set is empty, or a text is blank or not a text.
            UsageError: When a set has fewer than `size` texts, or `size` is below 2.
        """
        sets = (check_texts(a, "set a"), check_texts(b, "set b"))
        smaller = min(map(len, sets))
        drawn = smaller if size is None else size
        if not 2 <= drawn <= smaller or repeats < 1:
            raise UsageError(
                f"sets of {len(sets[0])} and {len(sets[1])} texts cannot be compared by {repeats} "
                f"draws of {drawn}: at least 2 texts and at most all of the smaller set"
            )
        figures = [
            self._subsamples(name, texts, drawn, repeats)
            for name, texts in zip("ab", sets, strict=True)
        ]
        contrasts = [_contrast(*pair) for pair in zip(*figures, strict=True)]
        return Comparison(
            size=drawn,
            repeats=repeats,
            n_a=len(sets[0]),
            n_b=len(sets[1]),
            oodness=contrasts[0],
            nearest=contrasts[1],
            pairwise=contrasts[2],
            encoder=self.encoder.name,
            baseline=self.baseline.name,
            seed=self.seed,
        )

    def _subsamples(
        self, name: str, texts: tuple[str, ...], size: int, repeats: int
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        vectors = self._vectors(texts)
        values = np.array(self._scores(texts, "tabulated"))
        draws = stream(self.seed, "compare", name)
        found = []
        for _ in range(repeats):
            chosen = draws.permutation(len(texts))[:size]
            part = vectors[chosen]
            found.append((values[chosen].mean(), -mean_nearest(part), -mean_pairwise(part)))
        oodness, nearest, pairwise = np.array(found).T
        return oodness, nearest, pairwise

    def _oodness(
        self, texts: tuple[str, ...], clusters: tuple[str, ...] | None, definition: Definition
    ) -> Oodness:
        vectors, reference = self._vectors(texts), self._reference()
        found = nearest(vectors, reference)
        values = smallest(vectors, reference) if definition == "printed" else 0.0 - found.cosine
        neighbours = tuple(
            Neighbour(index=index, text=self.baseline.texts[index], cosine=cosine)
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
        )

    def _scores(self, texts: tuple[str, ...], definition: Definition) -> list[float]:
        values: list[float] = scores(self._vectors(texts), self._reference(), definition).tolist()
        return values

    def _vectors(self, texts: tuple[str, ...]) -> Vectors:
        return unit(encode(self._memory, texts))

    def _reference(self) -> Vectors:
        if self._baseline_vectors is None:
            encoder: Encoder = self.encoder
            if getattr(encoder, "cacheable", False):
                encoder = CachedEncoder(encoder, self._cache())
            self._baseline_vectors = unit(encode(encoder, self.baseline.texts))
        return self._baseline_vectors

    def _cache(self) -> Path:
        return cache_folder() / "baselines" / self.baseline.digest()[:16]


def _as_baseline(baseline: Baseline | Sequence[str] | None) -> Baseline:
    if baseline is None:
        return ordinary_driving()
    if isinstance(baseline, Baseline):
        return baseline
    return Baseline(texts=check_texts(baseline, Baseline.noun))


def _paths(texts: Texts) -> tuple[str, ...] | None:
    """Return the paths that cluster a set, if all of it are scenarios that have one."""
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
