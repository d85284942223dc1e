"""The members of an answer's object: which were requested, which give reasons, and the words in them."""

import re
from collections.abc import Mapping
from typing import Any, NamedTuple

from oodscen.judging._parsing.confidence import is_aside, is_confidence, probability
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
    sure: dict[str, Any] = {}
    reasons: list[str] = []
    asides: list[str] = []
    for name, member in value.items():
        plain = spelt(name)
        is_sure = CONFIDENCE.fullmatch(plain)
        if is_sure and not is_confidence(member):
            raise UnusableError(f"{name[:40]!r} is no confidence")
        if is_sure and is_aside(member):
            asides.append(member)
        if requested.fullmatch(plain) or WRAPPERS.fullmatch(plain):
            (sure if is_sure else rest)[name] = member
        elif REASON.fullmatch(plain):
            reasons += _texts(name, member)
        elif not is_sure:
            raise UnusableError(f"nobody asked for {name[:40]!r}")
    if len(rest) == 1:
        ((name, inner),) = rest.items()
        if isinstance(inner, dict) and WRAPPERS.fullmatch(spelt(name)):
            held = unwrap(inner, requested)
            inside = _with_confidences(held.requested, sure)
            return Held(inside, "\n".join([*reasons, held.reasons]), (*asides, *held.asides))
    for name in rest:
        if not requested.fullmatch(spelt(name)):
            raise UnusableError(f"nobody asked for {name[:40]!r}")
    return Held({**rest, **sure}, "\n".join(reasons), tuple(asides))


def _with_confidences(inside: dict[str, Any], sure: dict[str, Any]) -> dict[str, Any]:
    """Return the members in a wrapper with the confidences beside it; those that state none add nothing."""
    stating = {name: one for name, one in sure.items() if probability(one) is not None}
    stated = {probability(one) for one in (*stating.values(), *members(inside, CONFIDENCE))}
    if len(stated - {None}) > 1:
        raise UnusableError(TWO_ANSWERS)
    return {**inside, **stating}


def is_deeper(value: object, levels: int) -> bool:
    """Return whether lists and objects stand in each other on more than some levels."""
    is_nested = isinstance(value, (dict, list))
    return is_nested and (
        levels == 0 or any(is_deeper(held, levels - 1) for held in held_values(value))
    )


def _texts(name: str, value: Any) -> list[str]:
    """Return the texts of a member that gives reasons: a text, or a list of nothing else; `None` has none."""
    texts = value if isinstance(value, list) else [] if value is None else [value]
    if not all(isinstance(text, str) for text in texts):
        raise UnusableError(f"{name[:40]!r} is no text")
    return texts


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
