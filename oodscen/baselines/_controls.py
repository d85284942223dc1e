"""Controls: pairs of an ordinary and an OOD sentence that differ in the event alone.

A measure of OOD-ness is worth what it makes of these. Both sentences of a pair have the same style,
place and length, so that neither wording nor subject tells them apart, and both were written by hand,
before the hand-written part of the shipped baseline (`oodscen.baselines._handwritten`) and apart from
the texts that the built-in author writes.

The pairs are split in halves. *Tune* is there to choose by: which detector, which threshold, which
ordinary situations the baseline lacks. *Frozen* is there to report, once the choice is made.
"""

import json
from functools import cache
from importlib import resources
from typing import ClassVar, Literal

from pydantic import Field

from oodscen.data._base import Data

Split = Literal["tune", "frozen"]


class Control(Data):
    """One sentence of a pair."""

    noun: ClassVar[str] = "control"

    id: str
    """`<pair>-<kind>`."""
    pair: str
    """Id of the pair that it belongs to; both sentences of a pair are in the same split."""
    kind: Literal["ordinary", "ood"]
    split: Split
    """`tune` for the pairs with the smaller SHA-256 of "oodscen controls <pair>", else `frozen`."""
    topic: str
    """Kind of event that the OOD sentence of the pair tells."""
    text: str = Field(min_length=1)


def load_controls(split: Split) -> tuple[Control, ...]:
    """Return one half of the controls that are shipped.

    Args:
        split: `tune` to choose a detector or a baseline by, `frozen` to report.

    Returns:
        The sentences in pairs, the ordinary one first: `[::2]` and `[1::2]` are matched lists.
    """
    return tuple(control for control in _controls() if control.split == split)


@cache
def _controls() -> tuple[Control, ...]:
    file = resources.files("oodscen.baselines") / "controls.jsonl"
    lines = file.read_text(encoding="utf-8").splitlines()
    return tuple(Control.parse(json.loads(line), source=file.name) for line in lines)
