"""Read what a model said that it sees in a frame."""

import re

from oodscen.judging.reading import LONGEST, Reading, is_refusal, member, objects, tail, too_long


def read_description(text: str) -> Reading[str]:
    """Read a description of a frame: any prose will do, a refusal or nothing will not."""
    if len(text) > LONGEST:
        return too_long(text)
    for value in objects(text):
        found = joined(member(value, _KEYS) or value)
        if _says_something(found):
            return Reading(found, "answered", "JSON")
    said = tail(text).strip()
    begun = _BROKEN_OFF.match(said)
    said = said[begun.end() :] if begun else said
    if is_refusal(said) and len(said) < LONGEST_REFUSAL:
        return Reading(None, "refused", "a refusal")
    if not _says_something(said) or said.startswith("{"):
        return Reading(None, "unparsed", "no description")
    return Reading(said, "answered", "prose")


def joined(value: object, depth: int = 3) -> str:
    """Return the words in a value, whatever they are arranged in."""
    if isinstance(value, str):
        return value.strip()
    inner = list(value.values()) if isinstance(value, dict) else value
    if not isinstance(inner, (list, tuple)) or not depth:
        return ""
    return "; ".join(filter(None, (joined(one, depth - 1) for one in inner)))


def _says_something(said: str) -> bool:
    return sum(char.isalpha() for char in said) >= LEAST_LETTERS


LEAST_LETTERS = 4
"""A description has at least so many letters."""

LONGEST_REFUSAL = 600
"""Whoever writes more than so many characters about a frame has seen it."""

_KEYS = ("description", "answer", "text", "summary", "caption")

_BROKEN_OFF = re.compile(r"""\{\s*["']?description["']?\s*:\s*["']?""", re.IGNORECASE)
"""How an object begins that breaks off in its description."""
