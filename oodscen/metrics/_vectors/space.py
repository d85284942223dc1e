"""The vectors that the metrics need, each computed once: texts, baseline, controls, anchors."""

from collections.abc import Sequence
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from oodscen._members import optional
from oodscen._seeding import stream
from oodscen.baselines._baseline import Baseline
from oodscen.baselines._controls import load_controls
from oodscen.baselines._embedded import EmbeddedBaseline
from oodscen.baselines._ordinary import ordinary_driving
from oodscen.encoders._cached import CachedEncoder, cache_folder
from oodscen.encoders._check import check_rows, unit_embeddings
from oodscen.encoders._similarity import Nearest, Rows, Vectors, nearest, smallest
from oodscen.errors import UsageError
from oodscen.metrics._detection.calibration import held_out_scores, separate_groups
from oodscen.metrics._detection.detectors import DetectorName, Detectors
from oodscen.metrics._detection.guard import Guard
from oodscen.metrics._oodness import Measure
from oodscen.metrics._vectors import accelerated
from oodscen.protocols import Encoder

_SHIPPED = "shipped"
"""Cache folder for the vectors of this library's own texts, including its baseline."""
_PARTS = 4
"""Parts of the baseline, each held out from a detector that is fitted to the others."""
_SCORED_PER_PART = 300
_MOST_GROUPED = 20_000
"""Texts up to which similar ones are held out together; above, the search for them takes too long."""


class BaselineSpace:
    """An encoder's space with a baseline in it, whose nearest vectors are searched for on a device.

    Vectors of the baseline and of this library's texts are kept in the user's cache folder if the encoder's name
    determines its values (`cacheable`).
    """

    def __init__(
        self, encoder: Encoder, baseline: Baseline | EmbeddedBaseline, seed: int, device: str
    ) -> None:
        if isinstance(baseline, EmbeddedBaseline) and baseline.encoder != encoder.name:
            raise UsageError(
                f"the baseline {baseline.name} holds embeddings of {baseline.encoder}, and the encoder is "
                f"{encoder.name}: pass the encoder that made it"
            )
        self.encoder = encoder
        self.baseline = baseline
        self.seed = seed
        self.device = accelerated.chosen_device(device)
        self._memory = encoder if isinstance(encoder, CachedEncoder) else CachedEncoder(encoder)
        self._held_out: dict[str, tuple[NDArray[np.float64], int]] = {}
        self._stores: dict[str, CachedEncoder] = {}
        self._is_checked = False

    def vectors(self, texts: Sequence[str]) -> Vectors:
        """Return the vectors of texts to score; they are kept in memory.

        Raises:
            EncoderError: If the encoder fails, breaks its contract or mixes up the rows of the first texts.
        """
        vectors = unit_embeddings(self._memory, texts)
        if len(texts) > 1 and not self._is_checked:
            check_rows(self.encoder, texts, vectors)
            self._is_checked = True
        return vectors

    @cached_property
    def reference(self) -> Rows:
        """The baseline's vectors."""
        if isinstance(self.baseline, EmbeddedBaseline):
            return self.baseline
        return self._beside_baseline(self.baseline.texts)

    @property
    def whole(self) -> Vectors:
        """The baseline's vectors, in memory.

        Raises:
            UsageError: If they are on disk.
        """
        if isinstance(self.baseline, EmbeddedBaseline):
            raise UsageError(
                f"this needs the texts of the baseline, and {self.baseline.name} holds embeddings alone: "
                "pass a Baseline"
            )
        vectors = self.reference
        assert isinstance(vectors, np.ndarray)
        return vectors

    def nearest(self, vectors: Vectors) -> Nearest:
        """Return the nearest baseline vector of each row."""
        if self.device == "cpu":
            return nearest(vectors, self.reference)
        return accelerated.nearest(vectors, self.reference, self.device)

    def scores(self, texts: Sequence[str], measure: Measure) -> NDArray[np.float64]:
        """Return the OOD-ness of each text by a definition or a detector."""
        return self._scored(texts, self.vectors(texts), measure)

    @cached_property
    def detectors(self) -> Detectors:
        """The detectors fitted to the baseline."""
        return Detectors(self.baseline.texts, self.whole, self._beside_baseline)

    @cached_property
    def guard(self) -> Guard:
        """The off-topic guard."""
        return Guard(self._stored, self.encoder.name)

    def held_out(self, measure: Measure) -> tuple[NDArray[np.float64], int]:
        """Return scores of held-out baseline texts by any definition or detector, and the number of groups.

        For all but `tabulated`, the groups of similar texts are split into 4 parts; a detector fitted to three of
        them scores up to 300 texts of the fourth. The baseline is smaller then, so texts appear slightly more OOD.

        Raises:
            UsageError: If the baseline has a single text, or its vectors are on disk.
        """
        if len(self.whole) < 2:
            raise UsageError("no text can be held out of a baseline of one text")
        if measure not in self._held_out:
            self._held_out[measure] = (
                held_out_scores(self.whole, self.seed)
                if measure == "tabulated"
                else self._in_parts(measure)
            )
        return self._held_out[measure]

    def _in_parts(
        self, measure: DetectorName | Literal["printed"]
    ) -> tuple[NDArray[np.float64], int]:
        """Return the scores of texts of each part by a measure against the other parts, and the number of groups."""
        vectors, texts = self.whole, np.array(self.baseline.texts, object)
        is_grouped = len(vectors) <= _MOST_GROUPED
        group = separate_groups(vectors) if is_grouped else np.arange(len(vectors))
        count = int(group.max()) + 1
        draws = stream(self.seed, "calibration", "parts")
        part = draws.permutation(count)[group] % min(_PARTS, count)
        scores = []
        for number in range(int(part.max()) + 1):
            members = np.flatnonzero(part == number)
            scored = np.sort(members[draws.permutation(len(members))[:_SCORED_PER_PART]])
            rest = np.ascontiguousarray(vectors[part != number])
            if measure == "printed":
                scores.append(smallest(vectors[scored], rest))
                continue
            detectors = Detectors(tuple(texts[part != number]), rest, self._beside_baseline)
            scores.append(detectors.score(measure, tuple(texts[scored]), vectors[scored]))
        return np.concatenate(scores), count

    def control_scores(self, measure: Measure) -> NDArray[np.float64]:
        """Return the OOD-ness of the ordinary controls reserved for reporting."""
        texts = [control.text for control in load_controls("frozen")[::2]]
        return self._scored(texts, self._stored(texts), measure)

    def _scored(
        self, texts: Sequence[str], vectors: Vectors, measure: Measure
    ) -> NDArray[np.float64]:
        if measure == "tabulated":
            return 0.0 - self.nearest(vectors).cosine
        if measure == "printed":
            return smallest(vectors, self.reference)
        return self.detectors.score(measure, texts, vectors)

    @cached_property
    def _folder(self) -> str:
        """The cache folder of the baseline's vectors."""
        digest = self.baseline.digest()
        is_shipped = digest == ordinary_driving().digest()
        return _SHIPPED if is_shipped else f"baselines/{digest[:16]}"

    def _beside_baseline(self, texts: Sequence[str]) -> Vectors:
        """Return the vectors of texts that the baseline needs, from its cache folder."""
        return self._stored(texts, self._folder)

    def _stored(self, texts: Sequence[str], folder: str = _SHIPPED) -> Vectors:
        """Return the vectors of texts, cached in a folder if the encoder's name determines its values."""
        encoder = self.encoder
        if optional(encoder, "cacheable", False) is True:
            encoder = self._stores.setdefault(
                folder, CachedEncoder(encoder, cache_folder() / folder)
            )
        return unit_embeddings(encoder, texts)
