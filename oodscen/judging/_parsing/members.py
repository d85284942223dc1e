"""The members of an answer's object: which were requested, which give reasons, and the words in them."""

import re
from collections.abc import Mapping
from typing import Any, NamedTuple

from oodscen.judging._parsing.confidence import is_aside, is_confidence
from oodscen.judging._parsing.unusable import TWO_ANSWERS, UnusableError
from oodscen.llm._json_objects import held_values

WRAPPERS = re.compile(
    r"(?=.)(?:final|json|data|arguments)?(?:answer|response|result|output|assessment)?"
)
"""Matches the members that may wrap the requested ones."""
REASON = re.compile(
    r"(?:stepbystep|chainof)?(?:reason(?:s|ing)?|rationale|thoughts?|thinking|analysis|explanation"
    r"|justification|descriptions?|observations?|why)"
)
"""Matches the members that give reasons, in which other options may be weighed."""
CONFIDENCE = re.compile(r"confidence|certainty|probability")


class Held(NamedTuple):
    """The members of an object, or of it and the one that it wraps."""

    requested: dict[str, Any]
    reasons: str
    asides: tuple[str, ...]
    """Words in the place of a confidence that state none."""


def unwrap(value: Mapping[str, Any], requested: re.Pattern[str]) -> Held:
    """Return the requested members of an object, or of the one that it wraps, and what stands beside them.

    Raises:
        UnusableError: If it has other members, or one of them twice.
    """
    if getattr(value, "repeated", ()):
        raise UnusableError(TWO_ANSWERS)
    rest: dict[str, Any] = {}
    reasons: list[str] = []
    asides: list[str] = []
    for name, member in value.items():
        is_sure = CONFIDENCE.fullmatch(spelt(name))
        if is_sure and not is_confidence(member):
            raise UnusableError(f"{name[:40]!r} is no confidence")
        if is_sure and is_aside(member):
            asides.append(member)
        if requested.fullmatch(spelt(name)) or WRAPPERS.fullmatch(spelt(name)):
            rest[name] = member
        elif _is_reason(name, member):
            reasons += _texts(member)
        elif REASON.fullmatch(spelt(name)):
            raise UnusableError(f"{name[:40]!r} is no text")
        elif not is_sure:
            raise UnusableError(f"nobody asked for {name[:40]!r}")
    sure = {name: member for name, member in rest.items() if CONFIDENCE.fullmatch(spelt(name))}
    wrappers = rest.keys() - sure.keys()
    inner = rest[next(iter(wrappers))] if len(wrappers) == 1 else None
    if isinstance(inner, dict) and all(WRAPPERS.fullmatch(spelt(name)) for name in wrappers):
        held = unwrap(inner, requested)
        if any(held.requested.get(name, member) != member for name, member in sure.items()):
            raise UnusableError(TWO_ANSWERS)
        inside = {**sure, **held.requested}
        return Held(inside, "\n".join([*reasons, held.reasons]), (*asides, *held.asides))
    for name in rest:
        if not requested.fullmatch(spelt(name)):
            raise UnusableError(f"nobody asked for {name[:40]!r}")
    return Held(rest, "\n".join(reasons), tuple(asides))


def is_deeper(value: object, levels: int) -> bool:
    """Return whether lists and objects stand in each other on more than some levels."""
    is_nested = isinstance(value, (dict, list))
    return is_nested and (
        levels == 0 or any(is_deeper(held, levels - 1) for held in held_values(value))
    )


def _is_reason(name: str, value: Any) -> bool:
    return bool(REASON.fullmatch(spelt(name))) and (value in (None, "", []) or bool(_texts(value)))


def _texts(value: Any) -> list[str]:
    """Return a text, or the texts of a list of nothing else, as a list; else an empty one."""
    texts = value if isinstance(value, list) else [value]
    return list(texts) if all(isinstance(text, str) for text in texts) else []


def spelt(name: str) -> str:
    """Return the name of a member in a canonical spelling; one with other marks than spaces and hyphens is kept."""
    is_plain = re.fullmatch(r"\s*\w[\w\s-]*", name)
    return re.sub(r"[\s_-]+", "", name).casefold() if is_plain else name


def members(value: Mapping[str, Any], names: re.Pattern[str]) -> list[Any]:
    """Return the values of the members whose names match."""
    return [member for name, member in value.items() if names.fullmatch(spelt(name))]


def is_placeholder(value: object) -> bool:
    """Return whether a value is a placeholder from the question's example, such as `"..."`."""
    return isinstance(value, str) and bool(re.fullmatch(r"\s*(?:\.\.\.|\u2026|<[^<>]*>)\s*", value))


def words_in(value: object, depth: int = 3) -> str:
    """Return the words in a value, whatever its structure."""
    if isinstance(value, str):
        return value.strip()
    parts = list(value.values()) if isinstance(value, dict) else value
    if not isinstance(parts, (list, tuple)) or not depth:
        return ""
    return "; ".join(filter(None, (words_in(part, depth - 1) for part in parts)))
