"""Implied motion of things that no verb sets in motion.

A thing that lies, blocks the way or was put there is stationary.
"""

import re
from collections.abc import Collection, Sequence

from oodscen.author._reading import phrases
from oodscen.author._reading.clauses import Noun, Subject, last_end

_STATIONARY = "stationary"


def usual_motion(
    text: str, subject: Subject, nouns: Sequence[Noun], claimed: Collection[str]
) -> str | None:
    """Return the motion that a thing's name, or its effect on the road, implies; `None` if the text leaves it open.

    `claimed` has the claims that exist about the thing, as kind and value, such as `place in_lane`. If one of them is
    a motion, nothing is added.
    """
    thing, mention = subject.mention.thing, subject.mention
    if any(claim.startswith("motion ") for claim in claimed):
        return None
    if mention.word in phrases.BY_NATURE:
        return phrases.BY_NATURE[mention.word]
    if subject.is_faint:
        return None
    if phrases.context("still_by_name").search(mention.word):
        return _STATIONARY
    if thing.group not in ("object", "signal", "vehicle") or thing.name in phrases.things("light"):
        return None
    begin = last_end(phrases.context("sentence"), text[: mention.start])
    end = phrases.context("sentence").search(text, mention.end)
    sentence = text[begin : end.start() if end else len(text)]
    if phrases.context("stirs").search(phrases.context("moved_past").sub(" ", sentence)):
        return None
    lead, after = text[begin : mention.start], text[mention.end : begin + len(sentence)]
    if phrases.context("blocked").search(lead):
        return _STATIONARY
    if thing.group == "vehicle":
        is_put = phrases.context("put").search(lead) and not re.search(
            r"\bleft (?!its )", lead, re.IGNORECASE
        )
        bars = phrases.context("bars").search(after)
        return _STATIONARY if is_put or (bars and _governs(subject, bars, nouns)) else None
    if phrases.context("borne").search(lead):
        return None
    is_in_lane = "place in_lane" in claimed
    lies = (
        is_in_lane
        or phrases.context("blocks").search(sentence)
        or phrases.context("put").search(lead)
    )
    return _STATIONARY if lies else None


def _governs(subject: Subject, found: re.Match[str], nouns: Sequence[Noun]) -> bool:
    """Return whether no other thing is named between a vehicle and the verb that says it blocks."""
    low = subject.mention.end
    high = low + found.start()
    return not any(n.start >= low and n.end <= high and not n.is_oblique for n in nouns)
