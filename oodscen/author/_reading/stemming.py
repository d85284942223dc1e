"""Stems of the content words of a text."""

import re

from oodscen._words.text import stem, without_possessives

_STOP = frozenset(
    """a an the and or but of in on at to from into onto over under with without by for as is are was
    were be been being has have had it its this that these those which who whose there here then
    than so such no not nor only just while when where if up down out off about around between
    through along across some any each every all both one two more most very too also can could
    may might will would must do does did he she they them their his her i my we our you your
    ego egos s""".split()
)


def stems(text: str) -> list[str]:
    """Return the stems of all content words, in order."""
    words = re.findall(r"[a-z]+", without_possessives(text.casefold()))
    return [stem(word) for word in words if word not in _STOP]
