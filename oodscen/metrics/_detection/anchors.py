"""Sentences that call something ordinary, or not ordinary, in general words.

They give directions in an encoder's space, from *ordinary* to *not ordinary*. Most pairs are one frame filled
with two words of opposite judgement. The `kinds` of `anchors.toml` describe weather, loads, structures, signals
and so on, as they should be and gone wrong. These are kinds of events, so a detector that uses them knows these
kinds beforehand. No sentence was taken from an OOD text. All were written by hand, for English encoders trained
on sentences, by an author who had read the *tune* half of the controls.
"""

import tomllib
from functools import cache

from oodscen.baselines._texts import bundled

Pairs = tuple[tuple[str, str], ...]
"""Pairs of an ordinary and a not ordinary text in the same frame."""


@cache
def anchors() -> tuple[Pairs, Pairs, Pairs, Pairs]:
    """Return the four sorts of pairs: judgements, conduct of things on the road, sentences, kinds of events."""
    known = tomllib.loads(bundled("anchors.toml", "oodscen.metrics._detection"))
    judgements = tuple(
        (_filled(frame, calm), _filled(frame, odd))
        for calm, odd in known["judgements"]
        for frame in known["frames"]
    )
    conduct = tuple(
        (f"{thing} {calm}.", f"{thing} {odd}.")
        for thing in known["things"]
        for calm, odd in known["conduct"]
    )
    return judgements, conduct, _pairs(known["sentences"]), _pairs(known["kinds"])


def _pairs(rows: list[list[str]]) -> Pairs:
    return tuple((calm, odd) for calm, odd in rows)


def _filled(frame: str, word: str) -> str:
    text = frame.format(word)
    return text[:1].upper() + text[1:]
