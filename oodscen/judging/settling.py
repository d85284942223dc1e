"""Which of several options a text settles on, of all that it names."""

import re
from collections.abc import Sequence

from oodscen.judging.meaning import CORRECTIONS, FINAL, Meant
from oodscen.judging.patterns import compiled
from oodscen.judging.wording import Mention


def settled(plain: str, meant: Sequence[Meant], least: int = -1) -> str | None:
    """Return the one option that the strongest words are about, after the last correction.

    Args:
        plain: A normalised text.
        meant: What it names, and how.
        least: The level of words that settle something.
    """
    meant = [one for one in meant if one.level > -2]
    if (last_line := _last_line(plain, meant)) is not None:
        return last_line
    corrected = _after_the_last_correction(plain, meant)
    if not corrected and (first := _first_sentence(plain, meant)):
        return first
    meant = corrected or meant
    top = max((one.level for one in meant), default=-2)
    if top < least:
        return None
    strongest = [one for one in meant if one.level == top]
    if top == 3 and len(_options(strongest)) > 1:
        strongest = _given_last(plain, strongest)
    options = _options(strongest)
    return options.pop() if len(options) == 1 else None


def _options(meant: Sequence[Meant]) -> set[str]:
    return {one.mention.option for one in meant}


def _after_the_last_correction(plain: str, meant: Sequence[Meant]) -> list[Meant]:
    """Return what follows the last "wait" or "no" after which anything is named."""
    for correction in reversed(list(CORRECTIONS.finditer(plain))):
        if later := [one for one in meant if one.mention.start >= correction.end()]:
            return later
    return []


def _given_last(plain: str, given: Sequence[Meant]) -> list[Meant]:
    """Return what follows the last "the answer is" of a text that says so repeatedly."""
    marks = [m.start() for m in FINAL.finditer(plain)]
    last = max((mark for mark in marks if mark < given[-1].mention.start), default=0)
    return [one for one in given if one.mention.start > last]


# ------------------------------------------------------------------ an answer, then its reasons


def _first_sentence(plain: str, meant: Sequence[Meant]) -> str | None:
    """Return the option that a text begins with, where all after it only gives reasons for it."""
    if len(meant) < 2 or re.search(r"\w", plain[: meant[0].mention.start]):
        return None
    first, *others = meant
    if not _SENTENCE_ENDS.match(plain, first.mention.end):
        return None
    rivals = [one for one in others if one.mention.option != first.mention.option]
    if any(one.level >= 1 or _is_a_sentence(plain, one.mention) for one in rivals):
        return None
    return first.mention.option


_SENTENCE_ENDS = compiled(r"[)\]]? *(?:[.!](?=\s)|\n|\u2014|,? *\(?(?:because|since|as)\b)")


def _is_a_sentence(plain: str, mention: Mention) -> bool:
    """Whether a mention makes up its sentence, or all but a word of it."""
    before = re.split(r"[.;!?\n]", plain[: mention.start])[-1]
    after = re.split(r"[.;!?\n]", plain[mention.end :])[0]
    return len(re.findall(r"\w+", before + " " + after)) <= 1


# ------------------------------------------------------------------ reasons, then an answer


def _last_line(plain: str, meant: Sequence[Meant]) -> str | None:
    """Return the option that fills the last line, where no other fills a line."""
    named: dict[int, set[str]] = {}
    for one in meant:
        named.setdefault(_line_start(plain, one.mention), set()).add(one.mention.option)
    alone = [
        one
        for one in meant
        if len(named[_line_start(plain, one.mention)]) == 1 and _fills_its_line(plain, one.mention)
    ]
    if len(_options(alone)) != 1 or plain[alone[-1].mention.end :].strip(" .!)"):
        return None
    return alone[-1].mention.option


def _line_start(plain: str, mention: Mention) -> int:
    return plain.rfind("\n", 0, mention.start) + 1


def _fills_its_line(plain: str, mention: Mention) -> bool:
    start, end = _line_start(plain, mention), plain.find("\n", mention.end)
    rest = plain[start : mention.start] + plain[mention.end : end if end >= 0 else len(plain)]
    return not re.search(r"[^\W\d]", rest)
