"""Reading a typed answer out of the text of a language model."""

import re
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Generic, NamedTuple, TypeVar

from pydantic import BaseModel, ValidationError

from oodscen._words.prose import is_disowned, is_taken_back, without_thoughts
from oodscen.data._issues import issues_of
from oodscen.errors import Issue
from oodscen.llm._json_objects import JsonObject, find_objects, held_values, is_cut_off

Answer = TypeVar("Answer", bound=BaseModel)

MAX_ANSWER = 200_000
"""Longest answer that is read, in characters."""

CUT_OFF = Issue("", "the answer is cut off before its end; answer more briefly")
EMPTY = Issue("", "the answer is empty")
UNSPOKEN = Issue("", "there is no answer after its reasoning")
ONLY = {
    "a tool call": Issue(
        "", "the answer is empty: it is only a tool call; call none, and write text"
    ),
    "reasoning": Issue("", "the answer is empty: it is only reasoning; write text after it"),
}
"""Faults of an empty answer, by what stood in its place."""


class _Reading(NamedTuple, Generic[Answer]):
    """One object of a text, read as an answer."""

    source: JsonObject
    answer: Answer | None
    """None if the object has another shape, or lacks its end and some of its members."""
    issues: list[Issue]
    """Faults of its shape, or reasons why it may say something else than what was read."""
    after: str
    """The text behind it."""


def read_answer(
    raw: str,
    kind: type[Answer],
    checks: Sequence[Callable[[Answer], Sequence[Issue]]] = (),
) -> tuple[Answer | None, list[Issue]]:
    """Find the answer in a model's text.

    Objects in reasoning that has ended (`<think> ... </think>`) are drafts. Among the others, one must be an answer,
    and none may be a different one, since nothing tells which of two is meant.

    Returns:
        The answer and no issues, or `None` and the faults of the object that came closest.
    """
    if len(raw) > MAX_ANSWER:
        return None, [Issue("", f"the answer has {len(raw):,} characters; {MAX_ANSWER:,} at most")]
    text = without_thoughts(raw)
    if not text.strip():
        return None, [UNSPOKEN if raw.strip() else EMPTY]
    readings = [_read(candidates, kind, text) for candidates in find_objects(text)]
    answers = [reading for reading in readings if reading.answer is not None]
    others = [reading for reading in readings if reading.answer is None]
    if not answers:
        return None, _nearest_faults(others, text)
    first = answers[0]
    issues = [issue for answer in answers for issue in answer.issues]
    if not issues:
        issues = [
            *_rivals(answers),
            *_corrections(first, others, kind),
            *_second_thoughts(answers[-1]),
        ]
    if not issues and first.answer is not None:
        issues = [issue for check in checks for issue in check(first.answer)]
    return (None, issues) if issues else (first.answer, [])


def _read(candidates: tuple[JsonObject, ...], kind: type[Answer], text: str) -> _Reading[Answer]:
    """Read an object, or else the one that it wraps."""
    outer = candidates[0]
    after = text[outer.start + outer.width :] if outer.width else ""
    outer_issues: list[Issue] = []
    for candidate in candidates:
        try:
            answer = kind.model_validate(candidate.value)
        except ValidationError as error:
            outer_issues = outer_issues or issues_of(error)
            continue
        if candidate.is_complete or kind.model_fields.keys() <= candidate.value.keys():
            issues = [*_doubts(candidate, answer), *_denial(outer, text)]
            return _Reading(candidate, answer, issues, after)
    return _Reading(outer, None, outer_issues, after)


def _nearest_faults(others: Sequence[_Reading[Answer]], text: str) -> list[Issue]:
    """Return the faults of a text without an answer: those of its longest object, if it is whole."""
    if is_cut_off(text):
        return [CUT_OFF]
    if others:
        return max(others, key=lambda reading: reading.source.width).issues
    return [Issue("", "no JSON object was found in the answer")]


def _rivals(answers: Sequence[_Reading[Answer]]) -> list[Issue]:
    """Return the fault that answers differ."""
    different: list[Answer | None] = []
    for reading in answers:
        if reading.answer not in different:
            different.append(reading.answer)
    if len(different) == 1:
        return []
    return [Issue("", f"it holds {len(different)} different answers; give one")]


def _corrections(
    answer: _Reading[Answer], others: Sequence[_Reading[Answer]], kind: type[Answer]
) -> list[Issue]:
    """Return the fault that another object, such as a correction, gives a member of the answer another value."""
    value = answer.source.value
    inner = list(_inner_objects(value))
    for other in (reading.source.value for reading in others):
        is_member_changed = any(
            name in kind.model_fields and member != value.get(name)
            for name, member in other.items()
        )
        if is_member_changed or _contradicts(other, inner):
            return [Issue("", "a second object beside the answer says otherwise; give one")]
    return []


def _inner_objects(value: object) -> Iterator[dict[str, Any]]:
    """Yield the objects that an object or a list holds, at any depth."""
    for inner in held_values(value):
        if isinstance(inner, dict):
            yield inner
        yield from _inner_objects(inner)


def _contradicts(other: dict[str, Any], objects: Sequence[dict[str, Any]]) -> bool:
    """Return whether an object shares members with some others, and agrees with none of those."""
    alike = [item for item in objects if item.keys() & other.keys()]
    return bool(alike) and not any(
        all(item[name] == other[name] for name in item.keys() & other.keys()) for item in alike
    )


def _second_thoughts(answer: _Reading[Answer]) -> list[Issue]:
    """Return the fault that the words behind an answer take it back or correct it."""
    if not is_taken_back(answer.after):
        return []
    return [Issue("", "the words after the object correct it; give the corrected object alone")]


def _denial(source: JsonObject, text: str) -> list[Issue]:
    """Return the fault that the words beside an object say that it is not the answer."""
    if not source.width:
        return []
    before, after = text[: source.start], text[source.start + source.width :]
    if not is_disowned(before, after):
        return []
    return [Issue("", "the words beside the object say that it is not the answer; give one")]


def _doubts(source: JsonObject, answer: BaseModel) -> list[Issue]:
    """Return the reasons why an object of the right shape may say something else than what was read."""
    issues = [Issue(name[:80], "is given twice with different values") for name in source.repeated]
    if source.is_altered:
        issues.append(Issue("", "it is not valid JSON; quote every text, and write plain numbers"))
    return [*issues, *_differences(source.value, answer)]


def _differences(written: object, read: object, path: str = "") -> Iterator[Issue]:
    """Yield a fault per truth value read as a number, and per member passed over since its name is spelt `Label`."""
    if isinstance(written, bool):
        if isinstance(read, int | float) and not isinstance(read, bool):
            yield Issue(path, "must be a number, not true or false")
    elif isinstance(written, dict) and isinstance(read, dict | BaseModel):
        members = read if isinstance(read, dict) else vars(read)
        left_out = members.keys() - getattr(read, "model_fields_set", members.keys())
        for name, member in written.items():
            inner_path = f"{path}.{name[:80]}".strip(".")
            plain = "_".join(re.findall("[a-z0-9]+", name.casefold()))
            if name in members:
                yield from _differences(member, members[name], inner_path)
            elif plain in left_out:
                yield Issue(inner_path, f"is not known: write {plain!r}")
    elif isinstance(written, list) and isinstance(read, list | tuple):
        for index, (inner, inner_read) in enumerate(zip(written, read, strict=False)):
            yield from _differences(inner, inner_read, f"{path}[{index}]")
