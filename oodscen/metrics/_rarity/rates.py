"""Published rates of events in traffic: the shipped ones, those of a file, or a caller's own."""

from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from oodscen._arguments import instances_of
from oodscen._display import cut
from oodscen._io.files import bundled, read_utf8
from oodscen._io.toml import parse_toml
from oodscen._words.text import folded_words
from oodscen.data._base import Data
from oodscen.errors import DataError, Issue

Kind = Literal["own", "occurring", "met"]
"""An event that happens to the ego, one that happens somewhere in the traffic, or one that the ego comes upon."""
_NOUN = "file of rates"
LEAST_KM, MOST_KM = 0.001, 1e15
"""Range of published rates, km; all that was ever driven on roads is less than 1e15 km."""


class PublishedRate(Data):
    """One published or own rate of an event."""

    noun: ClassVar[str] = "rate"
    _refuses_conversion: ClassVar = True

    number: int = 0
    event: str
    kind: Kind = "met"
    grade: Literal["A", "B", "C", "M"] = "A"
    """A from a primary source, B from a secondary one, C with an assumed denominator, M from memory."""
    km: tuple[float, float, float]
    """Kilometres between two events: least, best, most."""
    source: str
    texts: tuple[str, ...] = Field(min_length=1)
    """Wordings of the event."""

    @model_validator(mode="after")
    def _is_usable(self) -> "PublishedRate":
        if not LEAST_KM <= self.km[0] <= self.km[1] <= self.km[2] <= MOST_KM:
            raise ValueError(
                f"km: three numbers in order, least, best, most, from {LEAST_KM} to {MOST_KM:.0e}"
            )
        if not all(text.strip() for text in (self.event, self.source, *self.texts)):
            raise ValueError("event, source, texts: none may be blank")
        return self

    @property
    def log10_km(self) -> float:
        """The decimal logarithm of the best figure."""
        return float(np.log10(self.km[1]))


def published_rates() -> tuple[PublishedRate, ...]:
    """Return the shipped rates."""
    return _rates(bundled("anchors.toml", "oodscen.metrics._rarity"), "anchors.toml")


def load_rates(path: str | Path) -> tuple[PublishedRate, ...]:
    """Read rates from a TOML file with one `[[rate]]` each: `event`, `km`, `source`, `texts`, and `kind` if not met.

    Raises:
        DataError: If the file cannot be read or holds no valid rates.
    """
    return _rates(read_utf8(path, _NOUN), str(path))


def resolve_rates(
    anchors: Sequence[PublishedRate] | str | Path | None,
) -> tuple[PublishedRate, ...] | None:
    """Return the rates that a caller names: `published` for the shipped ones, a file, or the rates themselves.

    Raises:
        DataError: If there is none, or the file holds no valid rates.
        UsageError: If they are no rates.
    """
    if anchors is None:
        return None
    if isinstance(anchors, str | Path):
        return published_rates() if anchors == "published" else load_rates(anchors)
    instances_of("anchors", anchors, PublishedRate)
    rates = tuple(anchors)
    if faults := _contradictions(rates) if rates else [Issue("", "there is none")]:
        raise DataError("rates", faults)
    return rates


@contextmanager
def anchored(
    anchors: Sequence[PublishedRate] | str | Path | None,
) -> Iterator[tuple[PublishedRate, ...] | None]:
    """Give the rates that a caller names, and name their file where they turn out to be of no use.

    Raises:
        DataError: As `resolve_rates` does, and for rates that cannot be calibrated on.
        UsageError: If they are no rates.
    """
    rates = resolve_rates(anchors)
    try:
        yield rates
    except DataError as error:
        if error.noun != "rates" or not isinstance(anchors, str | Path):
            raise
        raise DataError("rates", error.issues, source=str(anchors)) from None


def _rates(content: str, source: str) -> tuple[PublishedRate, ...]:
    try:
        table = parse_toml(content)
    except ValueError as error:
        raise DataError(_NOUN, [Issue("", f"is not TOML: {error}")], source=source) from None
    rows = table.pop("rate", None)
    if not isinstance(rows, list) or not rows:
        raise DataError(_NOUN, [Issue("rate", "holds no [[rate]]")], source=source)
    if table:
        unknown = [Issue(name, "is no member of a file of rates") for name in table]
        raise DataError(_NOUN, unknown, source=source)
    rates = tuple(
        PublishedRate.parse(row, source=f"{source}, rate {number}")
        for number, row in enumerate(rows, 1)
    )
    counts = Counter(rate.number for rate in rates if rate.number)
    if repeated := [str(number) for number, count in counts.items() if count > 1]:
        issue = Issue("number", f"stands for more than one rate: {', '.join(repeated)}")
        raise DataError(_NOUN, [issue], source=source)
    if faults := _contradictions(rates):
        raise DataError(_NOUN, faults, source=source)
    return rates


def _contradictions(rates: Sequence[PublishedRate]) -> list[Issue]:
    """Return the rates whose figures exclude those of rates before them of the same kind and wording."""
    ranges: dict[tuple[Kind, str], tuple[float, float]] = {}
    faults = []
    for index, rate in enumerate(rates):
        for text in rate.texts:
            key = rate.kind, folded_words(text)
            least_km, most_km = ranges.get(key, (LEAST_KM, MOST_KM))
            least_km, most_km = max(least_km, rate.km[0]), min(most_km, rate.km[2])
            if least_km <= most_km:
                ranges[key] = least_km, most_km
                continue
            fault = (
                f"excludes the figures of the rates before it that have the text {cut(text)!r}, too"
            )
            faults.append(Issue(f"rate[{index}].km", fault))
    return faults
