"""Which of several options a text settles on, of all that it names."""

import re
from collections.abc import Sequence

from oodscen.judging.wording import CORRECTIONS, FINAL, Meant, Mention


def settled(plain: str, meant: Sequence[Meant], least: int = -1) -> str | None:
    """Return the one option that the strongest words are about, after the last correction."""
    meant = [one for one in meant if one.level > -2]
    alone = [one for one in meant if _is_alone_on_its_line(plain, one.mention, meant)]
    if len({one.mention.option for one in alone}) == 1 and not plain[alone[-1].mention.end :].strip(
        " .!)"
    ):
        return alone[-1].mention.option
    corrections = [m.end() for m in CORRECTIONS.finditer(plain)]
    for place in reversed(corrections):
        later = [one for one in meant if one.mention.start >= place]
        if later:
            meant = later
            break
    else:
        if first := _leading(plain, meant):
            return first
    top = max((one.level for one in meant), default=-2)
    if top < least:
        return None
    strongest = [one for one in meant if one.level == top]
    options = {one.mention.option for one in strongest}
    if len(options) == 1:
        return options.pop()
    if top == 3:
        marks = [m.start() for m in FINAL.finditer(plain)]
        last = max((mark for mark in marks if mark < strongest[-1].mention.start), default=0)
        options = {one.mention.option for one in strongest if one.mention.start > last}
        return options.pop() if len(options) == 1 else None
    return None


def _leading(plain: str, meant: Sequence[Meant]) -> str | None:
    """Return the option that is a text's first sentence, where the rest only gives reasons for it."""
    if len(meant) < 2 or re.search(r"\w", plain[: meant[0].mention.start]):
        return None
    first, *others = meant
    if not _GIVEN_FIRST.match(plain, first.mention.end):
        return None
    for one in others:
        if one.mention.option != first.mention.option and (
            one.level >= 1 or _is_a_sentence(plain, one.mention)
        ):
            return None
    return first.mention.option


_GIVEN_FIRST = re.compile(r"[)\]]?\s*(?:[.!](?=\s)|\n|\u2014|,?\s*\(?(?:because|since|as)\b)")


def _is_a_sentence(plain: str, mention: Mention) -> bool:
    """Whether a mention makes up its sentence, or all but a word of it."""
    before = re.split(r"[.;!?\n]", plain[: mention.start])[-1]
    after = re.split(r"[.;!?\n]", plain[mention.end :])[0]
    return len(re.findall(r"\w+", before + " " + after)) <= 1


def _is_alone_on_its_line(plain: str, mention: Mention, meant: Sequence[Meant]) -> bool:
    """Whether a mention fills its line, as answers after the reasons do."""
    start = plain.rfind("\n", 0, mention.start) + 1
    end = plain.find("\n", mention.end)
    end = end if end >= 0 else len(plain)
    options = {one.mention.option for one in meant if start <= one.mention.start < end}
    rest = plain[start : mention.start] + plain[mention.end : end]
    return len(options) == 1 and not re.search(r"[^\W\d]", rest)
