"""Parses a model's description of a frame."""

import re
from collections.abc import Mapping
from typing import Any

from oodscen._words.prose import fold, is_refusal
from oodscen.judging._parsing.members import is_placeholder, members, words_in
from oodscen.judging._parsing.reading import ParsedAnswer, Question, read
from oodscen.judging._parsing.unusable import UnusableError

_DESCRIPTION = re.compile(r"(?:\w*description|answer|text|summary|caption)")
_ANY = re.compile(r".*")
"""Any member may describe the frame."""
_LONGEST_REFUSAL = 300
"""The longest prose that counts as a refusal, in characters; longer prose is a description."""
_FEWEST_LETTERS = 4


def read_description(text: str) -> ParsedAnswer[str]:
    """Return a description of a frame; any prose is accepted except a refusal or nothing."""
    return read(text, Question(_in_object, _in_prose, _ANY, has_labels=False))


def _in_object(value: Mapping[str, Any]) -> str | None:
    descriptions = [words_in(member) for member in members(value, _DESCRIPTION)]
    words = next(filter(None, descriptions), "") if descriptions else words_in(dict(value))
    return None if is_placeholder(words) else _usable(words)


def _in_prose(prose: str) -> str:
    if len(prose) <= _LONGEST_REFUSAL and is_refusal(prose):
        raise UnusableError("a refusal")
    return _usable(re.sub(r"\A\W*description\s*:\s*", "", prose, flags=re.IGNORECASE))


def _usable(words: str) -> str:
    """Return words that can describe a frame; refuse those with hardly a letter."""
    if sum(char.isalpha() for char in fold(words)) < _FEWEST_LETTERS:
        raise UnusableError("no description")
    return words
