"""Controls: pairs of an ordinary and an OOD sentence that differ in the event alone.

They are the test of an OOD-ness measure. Both sentences of a pair have the same style, place and
length, so that neither wording nor subject separates them. Both were written by hand, before the
hand-written part of the bundled baseline (`oodscen.baselines._handwritten`) and independently of the
texts that the built-in author writes.

The pairs are split in halves. *Tune* serves to choose a detector, a threshold, or ordinary situations
that the baseline lacks. *Frozen* serves to report results once the choice is made.
"""

from functools import cache
from typing import Literal, overload

from pydantic import Field

from oodscen._arguments import checked
from oodscen.baselines._bundled import Split, bundled_records
from oodscen.baselines._off_topic import OffTopic, Part, off_topic_texts
from oodscen.data._base import Data
from oodscen.errors import UsageError


class ControlText(Data):
    """One sentence of a pair."""

    id: str
    """`<pair>-<kind>`."""
    pair: str
    """Id of the pair; both sentences of a pair are in the same split."""
    kind: Literal["ordinary", "ood"]
    split: Split
    """`tune` for the pairs with the smaller SHA-256 of "oodscen controls <pair>", else `frozen`."""
    topic: str
    """Kind of event in the OOD sentence of the pair."""
    text: str = Field(min_length=1)


@overload
def load_controls(
    split: Split, *, off_topic: Literal[False] = False
) -> tuple[ControlText, ...]: ...


@overload
def load_controls(split: Part, *, off_topic: Literal[True]) -> tuple[OffTopic, ...]: ...


@checked
def load_controls(
    split: Part, *, off_topic: bool = False
) -> tuple[ControlText, ...] | tuple[OffTopic, ...]:
    """Return one part of the bundled controls.

    Args:
        split: `tune` to choose a detector, a baseline or a threshold, `frozen` to report results; of the
            off-topic texts also `blind`, by an author who had seen neither the others nor the guard.
        off_topic: Return the texts that are not about driving, near misses first.

    Raises:
        UsageError: If there is no such part.

    Returns:
        The sentences in pairs, the ordinary one first: `[::2]` and `[1::2]` are matched lists; or the
        off-topic texts.
    """
    if off_topic:
        return off_topic_texts(split)
    if split == "blind":
        raise UsageError("only the off-topic texts have a part `blind`")
    return tuple(control for control in _controls() if control.split == split)


@cache
def _controls() -> tuple[ControlText, ...]:
    return bundled_records(ControlText, "controls.jsonl")
