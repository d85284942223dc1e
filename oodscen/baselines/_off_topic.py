"""Texts that are not about driving a car on a road, for calibrating the off-topic guard.

*Near misses* share words with driving (aircraft, trains, cycle races, motor sport, car finance, car
repair, packets and gels in lanes). *Off-topic* texts share nothing with it (recipes, law, small
talk, code, gibberish), or are in a language other than English, which the default encoder does not
read. All were written by hand and are split in halves like the controls. A third part, *blind*, was
written by an author who had seen neither these texts nor the guard.
"""

from functools import cache
from typing import Literal, TypeAlias

from pydantic import Field

from oodscen.baselines._bundled import Split, bundled_records
from oodscen.data._base import Data

Part: TypeAlias = Split | Literal["blind"]
"""Part of the off-topic texts."""


class OffTopic(Data):
    """One text that a measure of driving scenarios should refuse to score."""

    id: str
    kind: Literal["near-miss", "off-topic"]
    split: Part
    """`tune` for the half of its kind with the smaller SHA-256 of "oodscen off-topic <id>", else `frozen`; or
    `blind`.
    """
    topic: str
    """Subject of the text."""
    text: str = Field(min_length=1)


def off_topic_texts(part: Part) -> tuple[OffTopic, ...]:
    """Return one part of the bundled texts, near misses first: `tune` to set a threshold, the others to report."""
    return tuple(text for text in _bundled() if text.split == part)


@cache
def _bundled() -> tuple[OffTopic, ...]:
    return bundled_records(OffTopic, "off_topic.jsonl")
