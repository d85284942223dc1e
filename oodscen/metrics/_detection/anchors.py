"""Sentences that call something ordinary, or not ordinary, in general words.

They give directions in an encoder's space, from *ordinary* to *not ordinary*. Most pairs are one frame filled
with two words of opposite judgement. The `kinds` of `anchors.toml` describe weather, loads, structures, signals
and so on, as they should be and gone wrong. These are kinds of events, so a detector that uses them knows these
kinds beforehand. No sentence was taken from an OOD text. All were written by hand, for English encoders trained
on sentences, by an author who had read the *tune* half of the controls.
"""

import tomllib
from functools import cache
from typing import NamedTuple

from oodscen._io.files import bundled

Pairs = tuple[tuple[str, str], ...]
"""Pairs of an ordinary and a not ordinary text in the same frame."""


class Anchors(NamedTuple):
    """The four sorts of pairs."""

    judgements: Pairs
    conduct: Pairs
    """Sentences about the conduct of things on the road."""
    sentences: Pairs
    kinds: Pairs
    """Kinds of events, as they should be and gone wrong."""


@cache
def load_anchors() -> Anchors:
    """Return the bundled pairs."""
    table = tomllib.loads(bundled("anchors.toml", "oodscen.metrics._detection"))
    return Anchors(
        judgements=tuple(
            (_fill(frame, calm), _fill(frame, odd))
            for calm, odd in table["judgements"]
            for frame in table["frames"]
        ),
        conduct=tuple(
            (f"{thing} {calm}.", f"{thing} {odd}.")
            for thing in table["things"]
            for calm, odd in table["conduct"]
        ),
        sentences=tuple((calm, odd) for calm, odd in table["sentences"]),
        kinds=tuple((calm, odd) for calm, odd in table["kinds"]),
    )


def _fill(frame: str, word: str) -> str:
    """Return a frame as a sentence with a word in it; its first letter may belong to the word."""
    text = frame.format(word)
    return text[:1].upper() + text[1:]
