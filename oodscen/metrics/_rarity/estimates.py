"""Rarity of texts as data, and the offline estimate of it."""

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final, Literal, get_args

import numpy as np
from pydantic import Field, computed_field, model_validator

from oodscen._display import cut
from oodscen.data._base import Data
from oodscen.encoders._check import encode
from oodscen.encoders._similarity import Vectors, unit
from oodscen.errors import DataError, Issue
from oodscen.metrics._rarity.anchors import PublishedRate, RateCalibration, calibrate
from oodscen.metrics._rarity.head import Estimates, Head, estimated, load_head
from oodscen.metrics._rarity.plausibility import is_impossible, names_event, parts
from oodscen.metrics._rarity.subject import is_number, names_road, repeats_word
from oodscen.protocols import Encoder

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
_FEWEST_KNOWN = 0.4
"""Minimum share of a text's words that the head knows."""
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
        found = [one for one in (self.low, self.best, self.high) if one is not None]
        if len(found) not in (0, 3) or found != sorted(found):
            raise ValueError("low, best and high are all given, in order, or all missing")
        return self

    def calibrated(self, calibration: RateCalibration) -> "TextRarity":
        """Return the rarity after calibration."""
        if self.low is None or self.best is None or self.high is None:
            return self
        low, best, high = (calibration.apply(one) for one in (self.low, self.best, self.high))
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
    unknown: int = Field(ge=0)
    """Number of texts without a figure."""
    calibration: RateCalibration | None = None
    """The calibration that was applied to all figures, if any."""
    unanswered_rates: int = Field(default=0, ge=0)
    """Number of published rates left out of the calibration, since the model gave no estimate of them."""
    input_tokens: int = 0
    output_tokens: int = 0
    cost_usd: float | None = 0.0
    """`None` if the price of the model is not known."""

    def __str__(self) -> str:
        n = len(self.per_text)
        if self.median is None:
            line = f"rarity                 is unknown for all of {n} texts, by {self.by}"
        else:
            found = [rarity.best for rarity in self.per_text if rarity.best is not None]
            ends = np.quantile(found, [0.1, 0.9])
            line = (
                f"rarity                 once in 10^{self.median:.1f} km (median; 80 % of texts "
                f"10^{ends[0]:.1f} to 10^{ends[1]:.1f}), by {self.by}"
            )
            line += f"; unknown for {self.unknown} of {n}" if self.unknown else ""
        unanswered = sum("not answered" in rarity.flags for rarity in self.per_text)
        line += f"; not answered for {unanswered}" if unanswered else ""
        if self.unanswered_rates and self.calibration is None:
            line += (
                f"; not calibrated, as none of {self.unanswered_rates} published rates was answered"
            )
        elif self.unanswered_rates:
            line += f"; not answered for {self.unanswered_rates} published rates"
        if not self.input_tokens + self.output_tokens:
            return line
        cost = "price not known" if self.cost_usd is None else _money(self.cost_usd)
        return f"{line}; {self.input_tokens + self.output_tokens:,} tokens, {cost}"


def _money(usd: float) -> str:
    return f"{usd:.2f} USD" if usd == 0.0 or usd >= 0.01 else f"{usd:.2g} USD"


def gather_rarity(
    per_text: Sequence[TextRarity],
    by: str,
    anchors: Sequence[PublishedRate] | None,
    own: Sequence[float],
) -> Rarity:
    """Return the rarity of a set, calibrated if there are anchors.

    Args:
        per_text: The rarity of each text.
        by: The name of what estimated it.
        anchors: The published rates.
        own: The estimate of each anchor, in their order.
    """
    calibration = None if anchors is None else calibrate(anchors, own)
    if calibration is not None:
        per_text = [rarity.calibrated(calibration) for rarity in per_text]
    found = [rarity.best for rarity in per_text if rarity.best is not None]
    return Rarity(
        by=by,
        per_text=tuple(per_text),
        median=float(np.median(found)) if found else None,
        unknown=len(per_text) - len(found),
        calibration=calibration,
    )


def estimate_rarity(
    space: "BaselineSpace", texts: Sequence[str], anchors: Sequence[PublishedRate] | None = None
) -> Rarity:
    """Return the offline estimate for texts; see `oodscen.metrics._rarity.head`."""
    name = space.encoder.name
    head, estimates, vectors = estimated(name, texts, space.vectors)
    off_topic = set(space.guard.flags(vectors).flagged) if vectors is not None else set()
    per_text = []
    for place, text in enumerate(texts):
        flags = _flags(text, head, estimates, place)
        is_refused = place in off_topic and estimates.best[place] < _RARE
        if is_refused and not {"language", "no driving"} & set(flags):
            flags.append("no driving")
        values = (estimates.low[place], estimates.best[place], estimates.high[place])
        low, best, high = (
            (None,) * 3 if UNTOLD & set(flags) else (round(float(value), 2) for value in values)
        )
        ordered = tuple(flag for flag in FLAGS if flag in flags)
        per_text.append(TextRarity(low=low, best=best, high=high, flags=ordered))
    own = [] if anchors is None else anchor_estimates(space, anchors)
    return gather_rarity(per_text, name if head.uses_vectors else "words", anchors, own)


def estimated_km(encoder: Encoder | None, text: str) -> float | None:
    """Return the kilometres between two meetings with a text's kind by the offline head, two digits.

    Without an encoder the head uses stems alone. No baseline is asked whether the text is about driving.

    Returns:
        `None` if a flag in `UNTOLD` applies by the text's own words.
    """
    name = "" if encoder is None else encoder.name
    head, estimates, _ = estimated(
        name, [text], lambda said: unit(encode(encoder, said)) if encoder else _NO_VECTORS
    )
    if UNTOLD & set(_flags(text, head, estimates, 0)):
        return None
    return float(f"{10.0 ** estimates.best[0]:.1e}")


def anchor_estimates(space: "BaselineSpace", anchors: Sequence[PublishedRate]) -> list[float]:
    """Return the head's estimate of each anchor, the mean over its wordings.

    Raises:
        DataError: If a wording tells of no driving, of something impossible, or is not in English.
    """
    wordings = [text for rate in anchors for text in rate.texts]
    head, estimates, _ = estimated(space.encoder.name, wordings, space.vectors)
    faults = [
        Issue("texts", f"{cut(text)!r} cannot be estimated: {flags[0]}")
        for place, text in enumerate(wordings)
        if (
            flags := sorted(_UNUSABLE & set(_flags(text, head, estimates, place, needs_road=False)))
        )
    ]
    if faults:
        raise DataError("rates", faults)
    best = iter(estimates.best)
    return [float(np.mean([next(best) for _ in rate.texts])) for rate in anchors]


def _flags(
    text: str, head: Head, found: Estimates, place: int, *, needs_road: bool = True
) -> list[Flag]:
    """Return the faults of a text that its words, and a head's estimate of it, show."""
    flags: list[Flag] = []
    letters = len(_LETTER.findall(text))
    is_mostly_signs = letters < 0.5 * len(re.sub(r"\s", "", text))
    if is_mostly_signs or is_number(text) or repeats_word(text):
        flags.append("no driving")
    elif found.known[place] < _FEWEST_KNOWN or len(_ASCII_LETTER.findall(text)) < 0.8 * letters:
        flags.append("language")
    elif needs_road and not names_road(text):
        flags.append("no driving")
    if is_impossible(text):
        flags.append("impossible")
    if len(text) > _LONG:
        flags.append("long")
    said = parts(text)
    if len(said) > 1:
        best = load_head("words").estimate(said).best
        if sum(names_event(one) or x >= _RARE for one, x in zip(said, best, strict=True)) > 1:
            flags.append("several events")
    if found.near[place] < head.nearest:
        flags.append("far")
    return flags
