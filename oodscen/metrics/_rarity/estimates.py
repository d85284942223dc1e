"""Rarity of texts as data, and the offline estimate of it."""

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final, Literal, get_args

import numpy as np
from pydantic import Field, computed_field, model_validator

from oodscen._display import cut
from oodscen.data._base import Data
from oodscen.encoders._check import unit_embeddings
from oodscen.encoders._similarity import Vectors
from oodscen.errors import DataError, Issue
from oodscen.metrics._rarity.head import Estimates, Head, estimate, load_head
from oodscen.metrics._rarity.plausibility import is_impossible, names_event, parts
from oodscen.metrics._rarity.rate_calibration import RateCalibration, calibrate
from oodscen.metrics._rarity.rates import PublishedRate
from oodscen.metrics._rarity.subject import is_number, names_road, repeats_word
from oodscen.protocols import Encoder
from oodscen.statistics._intervals import Interval
from oodscen.statistics._resampling import bootstrap_median

if TYPE_CHECKING:
    from oodscen.metrics._vectors.space import BaselineSpace

POPULATION: Final = "passenger cars in Europe and North America"
Flag = Literal[
    "no driving", "language", "far", "impossible", "several events", "long", "not answered"
]
FLAGS: tuple[Flag, ...] = get_args(Flag)
UNTOLD: Final = frozenset[Flag]({"no driving", "language", "far", "impossible", "not answered"})
"""Flags of texts that get no figure."""

_UNUSABLE: Final = frozenset[Flag]({"no driving", "language", "impossible"})
"""Flags of wordings that no rate can be compared with."""
_NO_VECTORS: Vectors = np.empty((0, 0), np.float32)
_LONG = 1_000
"""Characters from which a text is flagged as long."""
_LEAST_KNOWN_SHARE = 0.4
"""Minimum share of a text's words that the head knows."""
_LEAST_ASCII_SHARE = 0.8
"""Minimum share of a text's letters that are plain Latin ones."""
_RARE = 4.5
"""Estimate, log10 km, from which a text counts as an event even if the baseline or its words do not show one."""
_ASCII_LETTER, _LETTER = re.compile(r"[A-Za-z]"), re.compile(r"[^\W\d_]")


class TextRarity(Data):
    """Rarity of one text, as decimal logarithms of kilometres between two meetings with its kind."""

    low: float | None = None
    """Lower end of the 90 % interval; `None` without a figure."""
    best: float | None = None
    high: float | None = None
    flags: tuple[Flag, ...] = ()
    """Faults of the text, among them the reasons for a missing figure."""
    draws: tuple[float, ...] = ()
    """Answers of a model, one per draw; empty for the offline estimate."""

    @computed_field  # type: ignore[prop-decorator]  # mypy does not support decorators on properties
    @property
    def log10_km(self) -> float | None:
        """The same as `best`."""
        return self.best

    @model_validator(mode="before")
    @classmethod
    def _without_copy(cls, value: Any) -> Any:
        if not isinstance(value, dict) or "log10_km" not in value:
            return value
        fields = dict(value)
        if fields.pop("log10_km") != fields.get("best"):
            raise ValueError("log10_km must equal best")
        return fields

    @model_validator(mode="after")
    def _is_ordered(self) -> "TextRarity":
        figures = [figure for figure in (self.low, self.best, self.high) if figure is not None]
        if len(figures) not in (0, 3) or figures != sorted(figures):
            raise ValueError("low, best and high are all given, in order, or all missing")
        return self

    def calibrated(self, calibration: RateCalibration) -> "TextRarity":
        """Return the rarity after calibration."""
        if self.low is None or self.best is None or self.high is None:
            return self
        low, best, high = map(calibration.apply, (self.low, self.best, self.high))
        return self.model_copy(update={"low": low, "best": best, "high": high})


class Rarity(Data):
    """Rarity of a set of texts: expected kilometres between two meetings with each kind, as logarithms."""

    unit: Literal["log10 km"] = "log10 km"
    population: str = POPULATION
    by: str
    """The encoder of the offline head, `words` if the head uses stems alone, or the model that was asked."""
    per_text: tuple[TextRarity, ...]
    median: float | None
    """Median of the texts that have a figure."""
    interval: Interval | None = None
    """95 % interval of the median, for other texts like these; `None` with fewer than five texts or groups."""
    unknown: int = Field(ge=0)
    """Number of texts without a figure."""
    calibration: RateCalibration | None = None
    """The calibration that was applied to all figures, if any."""
    unanswered_rates: int = Field(default=0, ge=0)
    """Number of rates left out of the calibration, since the model gave no figure for one of their wordings."""
    input_tokens: int = 0
    output_tokens: int = 0
    cost_usd: float | None = 0.0
    """`None` if it is not known."""

    def __str__(self) -> str:
        parts = [f"rarity                 {self._median_line()}"]
        if self.median is not None and self.unknown:
            parts.append(f"unknown for {self.unknown} of {len(self.per_text)}")
        if unanswered := sum("not answered" in rarity.flags for rarity in self.per_text):
            parts.append(f"not answered for {unanswered}")
        if self.unanswered_rates and self.calibration is None:
            parts.append(
                f"not calibrated, as none of {self.unanswered_rates} rates has a figure for each wording"
            )
        elif self.unanswered_rates:
            parts.append(
                f"{self.unanswered_rates} rates left out, without a figure for each wording"
            )
        if tokens := self.input_tokens + self.output_tokens:
            cost = "cost not known" if self.cost_usd is None else _money(self.cost_usd)
            parts.append(f"{tokens:,} tokens, {cost}")
        return "; ".join(parts)

    def _median_line(self) -> str:
        if self.median is None:
            return f"is unknown for all of {len(self.per_text)} texts, by {self.by}"
        figures = [rarity.best for rarity in self.per_text if rarity.best is not None]
        low, high = np.quantile(figures, [0.1, 0.9])
        found = self.interval
        interval = f" [10^{found.low:.1f}, 10^{found.high:.1f}]" if found else ""
        return (
            f"once in 10^{self.median:.1f} km{interval} (median; 80 % of texts "
            f"10^{low:.1f} to 10^{high:.1f}), by {self.by}"
        )


def _money(usd: float) -> str:
    return f"{usd:.2f} USD" if usd == 0.0 or usd >= 0.01 else f"{usd:.2g} USD"


def gather_rarity(
    per_text: Sequence[TextRarity],
    by: str,
    anchors: Sequence[PublishedRate] | None,
    anchor_estimates: Sequence[float],
    clusters: Sequence[str] | None,
    *,
    seed: int,
) -> Rarity:
    """Return the rarity of a set, calibrated if there are anchors.

    Args:
        per_text: The rarity of each text.
        by: The name of what estimated it.
        anchors: The published rates.
        anchor_estimates: The estimate of each anchor, in their order.
        clusters: The group of each text, if the texts have groups.
        seed: Seed of the bootstrap.
    """
    calibration = None if anchors is None else calibrate(anchors, anchor_estimates)
    if calibration is not None:
        per_text = [rarity.calibrated(calibration) for rarity in per_text]
    known = [index for index, rarity in enumerate(per_text) if rarity.best is not None]
    figures = np.array([per_text[index].best for index in known], np.float64)
    groups = None if clusters is None else [clusters[index] for index in known]
    return Rarity(
        by=by,
        per_text=tuple(per_text),
        median=float(np.median(figures)) if known else None,
        interval=bootstrap_median(figures, groups, seed=seed),
        unknown=len(per_text) - len(known),
        calibration=calibration,
    )


def estimate_rarity(
    space: "BaselineSpace",
    texts: Sequence[str],
    clusters: Sequence[str] | None = None,
    anchors: Sequence[PublishedRate] | None = None,
) -> Rarity:
    """Return the offline estimate for a set of texts; see `oodscen.metrics._rarity.head`."""
    by, per_text = estimate_texts(space, texts)
    by_anchor = [] if anchors is None else estimate_anchors(space, anchors)
    return gather_rarity(per_text, by, anchors, by_anchor, clusters, seed=space.seed)


def estimate_texts(space: "BaselineSpace", texts: Sequence[str]) -> tuple[str, list[TextRarity]]:
    """Return the name of what estimates, and the estimate of each text."""
    name = space.encoder.name
    head, estimates, vectors = estimate(name, texts, space.vectors)
    off_topic = set(space.guard.flags(vectors).flagged) if vectors is not None else set()
    per_text = [
        _text_rarity(text, head, estimates, index, is_off_topic=index in off_topic)
        for index, text in enumerate(texts)
    ]
    return name if head.uses_vectors else "words", per_text


def _text_rarity(
    text: str, head: Head, estimates: Estimates, index: int, *, is_off_topic: bool
) -> TextRarity:
    """Return the rarity of the text of an index; the guard is not believed where the head sees a rare event."""
    flags = set(_flags(text, head, estimates, index))
    if is_off_topic and estimates.best[index] < _RARE and "language" not in flags:
        flags.add("no driving")
    ordered = tuple(flag for flag in FLAGS if flag in flags)
    if UNTOLD & flags:
        return TextRarity(flags=ordered)
    low, best, high = (
        round(float(figures[index]), 2)
        for figures in (estimates.low, estimates.best, estimates.high)
    )
    return TextRarity(low=low, best=best, high=high, flags=ordered)


def estimated_km(encoder: Encoder | None, text: str) -> float | None:
    """Return the kilometres between two meetings with a text's kind by the offline head, two digits.

    Without an encoder the head uses stems alone. No baseline is asked whether the text is about driving.

    Returns:
        `None` if a flag in `UNTOLD` applies by the text's own words.
    """
    name = "" if encoder is None else encoder.name
    head, estimates, _ = estimate(
        name, [text], lambda texts: unit_embeddings(encoder, texts) if encoder else _NO_VECTORS
    )
    if UNTOLD & set(_flags(text, head, estimates, 0)):
        return None
    return float(f"{10.0 ** estimates.best[0]:.1e}")


def estimate_anchors(space: "BaselineSpace", anchors: Sequence[PublishedRate]) -> list[float]:
    """Return the head's estimate of each anchor, the mean over its wordings.

    Raises:
        DataError: If a wording tells of no driving, of something impossible, or is not in English.
    """
    wordings = [text for rate in anchors for text in rate.texts]
    head, estimates, _ = estimate(space.encoder.name, wordings, space.vectors)
    faults = []
    for index, text in enumerate(wordings):
        flags = _flags(text, head, estimates, index, needs_road=False)
        if unusable := sorted(_UNUSABLE & set(flags)):
            faults.append(Issue("texts", f"{cut(text)!r} cannot be estimated: {unusable[0]}"))
    if faults:
        raise DataError("rates", faults)
    best = iter(estimates.best)
    return [float(np.mean([next(best) for _ in rate.texts])) for rate in anchors]


def _flags(
    text: str, head: Head, estimates: Estimates, index: int, *, needs_road: bool = True
) -> list[Flag]:
    """Return the faults of a text that its words, and a head's estimate at its index, show."""
    flags: list[Flag] = []
    letters = len(_LETTER.findall(text))
    is_mostly_signs = letters < 0.5 * len(re.sub(r"\s", "", text))
    if is_mostly_signs or is_number(text) or repeats_word(text):
        flags.append("no driving")
    elif (
        estimates.known_share[index] < _LEAST_KNOWN_SHARE
        or len(_ASCII_LETTER.findall(text)) < _LEAST_ASCII_SHARE * letters
    ):
        flags.append("language")
    elif needs_road and not names_road(text):
        flags.append("no driving")
    if is_impossible(text):
        flags.append("impossible")
    if len(text) > _LONG:
        flags.append("long")
    if _count_events(parts(text)) > 1:
        flags.append("several events")
    if estimates.nearness[index] < head.least_nearness:
        flags.append("far")
    return flags


def _count_events(text_parts: list[str]) -> int:
    """Return the number of parts of a text that name an event or describe a rare one; a single part is one event."""
    if len(text_parts) < 2:
        return len(text_parts)
    best = load_head("words").estimate(text_parts).best
    return sum(
        names_event(part) or log10_km >= _RARE
        for part, log10_km in zip(text_parts, best, strict=True)
    )
