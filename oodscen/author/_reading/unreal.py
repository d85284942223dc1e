"""Weather, hours, roads and traffic that a text only mentions: denied, at another time, quoted, compared, or in a name."""

import re
from collections.abc import Iterable

from oodscen.author._reading import phrases
from oodscen.claims._cancelled import (
    describes_noun,
    is_over,
    is_weather_cancelled,
    names_thing,
    precedes_subject,
)
from oodscen.claims._things import Mention
from oodscen.data._claim import Kind

_NEAR = 80
"""Number of characters before a setting whose words may take it back."""
_QUOTATION = re.compile(
    r""""[^"]{1,80}"|\u201c[^\u201d]{1,80}\u201d|\u00ab[^\u00bb]{1,80}\u00bb"""
    r"""|(?<![\w'])['\u2018](?:[^']|(?<=\w)'(?=\w)){1,80}'(?!\w)"""
)
"""Words in quotation marks, as few as a sign has room for."""
_DENIAL = re.compile(r"\b(?:no|not|never|neither|nor)\b", re.IGNORECASE)
_LATER_WORD = re.compile(r"(?<=\s)[A-Za-z]{3,}")
"""A word after the first one that title case would capitalise."""
_INSIDE_A_SENTENCE = re.compile(r"\b(?!I\b)[a-z][\w'-]* (?:[A-Z][\w'-]* )*$")

_NAME = re.compile(r"\w+y|dawn|dusk", re.IGNORECASE)
"""A word for weather or an hour that is a name of people and animals, too."""
_STARTS = re.compile(r"(?:^|[.;:!?\"\u201d] )[\"'\u201c\u2018]?$")
"""The start of a sentence."""


def is_unreal(kind: Kind, match: re.Match[str], mentioned: Iterable[Mention]) -> bool:
    """Return whether a setting is denied, at another time, part of a name, or a figure of speech.

    Args:
        kind: The kind of claim.
        match: Its words in the text.
        mentioned: The things that the text names.
    """
    text, (start, end) = match.string, match.span()
    before, after = text[max(0, start - _NEAR) : start], text[end:]
    if phrases.context("denied_too").search(before) or _is_listed(before, after):
        return True
    if kind == "ego":
        return _DENIAL.search(match.group(0)) is not None
    if kind != "traffic" and phrases.context("denied").search(before):
        return True
    if _is_said(kind, before, after) or phrases.context("supposed").search(before):
        return True
    if kind not in ("weather", "time", "road"):
        return False
    if _is_quoted(match) or _is_in_a_name(kind, match, mentioned):
        return True
    return kind != "road" and (
        _is_at_another_time(kind, match, before, after)
        or _is_proper_name(match, before)
        or _is_first_name(match, before, mentioned)
        or _is_figurative(match.group(0), before, after)
    )


def _is_listed(before: str, after: str) -> bool:
    """Return whether words stand in the middle of a list that is denied."""
    return bool(
        phrases.context("listed").search(before) and phrases.context("or_more").match(after)
    )


def _is_quoted(match: re.Match[str]) -> bool:
    """Return whether quotation marks around a part of the text enclose some words."""
    return any(
        quotation.start() < match.start() and match.end() < quotation.end()
        for quotation in _QUOTATION.finditer(match.string)
        if quotation.group(0) != match.string
    )


def _is_in_a_name(kind: Kind, match: re.Match[str], mentioned: Iterable[Mention]) -> bool:
    """Return whether words only describe the noun that follows: `night bus`."""
    if describes_noun(match) or (kind != "road" and names_thing(match)):
        return True
    if precedes_subject(match):
        return False
    text, end = match.string, match.end()
    noun = next((mention for mention in mentioned if mention.start > end), None)
    if noun is None or noun.is_plural:
        return False
    if kind == "road" and noun.thing.group not in ("vehicle", "person", "animal"):
        return False
    return phrases.context("noun_before").match(text[end : noun.start]) is not None


def _is_said(kind: Kind, before: str, after: str) -> bool:
    """Return whether the words are those of a sign or a speaker, or a name that is given."""
    if phrases.context("named").search(before) or phrases.context("is_said").match(after):
        return True
    said = phrases.context("says").search(before)
    is_place = (
        kind not in ("weather", "time")
        and said
        and phrases.context("at_place").search(said.group(0))
    )
    return bool(said) and not is_place


def _is_at_another_time(kind: Kind, match: re.Match[str], before: str, after: str) -> bool:
    """Return whether weather or an hour is over, or yet to come."""
    if phrases.context("another_time").search(before) or phrases.context("not_now").match(after):
        return True
    if _was_once(before, after) or is_over(match):
        return True
    return kind == "weather" and bool(
        is_weather_cancelled(match)
        or phrases.context("past").search(before)
        or phrases.context("to_come").search(before)
    )


def _was_once(before: str, after: str) -> bool:
    """Return whether weather or an hour was there and something else is there now."""
    was = phrases.context("was").search(before) and phrases.context("but_now").match(after)
    return bool(was or phrases.context("was_but_now").match(after))


def _is_proper_name(match: re.Match[str], before: str) -> bool:
    """Return whether a word has a capital inside a sentence, in a text that is not in title case."""
    if not (match.group(0)[0].isupper() and _INSIDE_A_SENTENCE.search(before)):
        return False
    words: list[str] = _LATER_WORD.findall(match.string)
    return 2 * sum(word[0].isupper() for word in words) <= len(words)


def _is_first_name(match: re.Match[str], before: str, mentioned: Iterable[Mention]) -> bool:
    """Return whether a word at the start of a sentence is the name of a person or an animal that acts."""
    words, after = match.group(0), match.string[match.end() :]
    if not words[0].isupper() or not _NAME.fullmatch(words) or not _STARTS.search(before):
        return False
    if phrases.context("acts").match(after):
        return True
    apposed = next((mention for mention in mentioned if mention.start > match.end()), None)
    if apposed is None or apposed.thing.group not in ("person", "animal"):
        return False
    between, rest = match.string[match.end() : apposed.start], match.string[apposed.end :]
    is_apposed = phrases.context("apposed").match(between) and rest.startswith(", ")
    return bool(is_apposed and phrases.context("acts").match(rest[1:]))


def _is_figurative(words: str, before: str, after: str) -> bool:
    """Return whether weather or an hour is a comparison or a figure of speech."""
    is_outpouring = phrases.context("outpouring").search(words)
    return bool(
        (is_outpouring and phrases.context("of_something").match(after))
        or phrases.context("likened").search(before)
        or phrases.context("of_the_mind").search(before)
        or phrases.context("figure").match(after)
    )
