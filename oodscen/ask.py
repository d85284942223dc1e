"""Ask a language model one typed question and get a typed answer."""

import json
import re
from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeVar, cast

import json_repair
from pydantic import BaseModel, ValidationError

from oodscen._data import issues_of
from oodscen.errors import AnswerError, Issue
from oodscen.messages import Message
from oodscen.prompts.base import Prompt
from oodscen.protocols import LLM, Request

Answer = TypeVar("Answer", bound=BaseModel)

ATTEMPTS = 3
"""How often a question is put before its answer counts as invalid, the first time included."""

SHOWN_ISSUES = 12
"""How many faults are fed back at once."""

MAX_ANSWER = 200_000
"""Longest answer that is read, in characters."""

QUOTED = 8_000
"""How much of an invalid answer is put before the model again, in characters."""

Check = Callable[[Answer], Sequence[Issue]]


def ask(
    llm: LLM,
    prompt: Prompt[Answer],
    sample: int = 0,
    *,
    check: Check[Answer] | None = None,
    attempts: int = ATTEMPTS,
) -> Answer:
    """Put a question; parse and validate the answer; feed faults back until it is valid.

    Args:
        llm: Who is asked.
        prompt: The typed question.
        sample: Which of several independent draws this is.
        check: Further requirements, beyond those of the prompt itself.
        attempts: Largest number of calls, at least 1.

    Raises:
        AnswerError: When the last answer is still invalid; it keeps the raw text and the faults.
        LLMError: When the model cannot be reached.
    """
    checks: list[Check[Answer]] = [prompt.check, *([check] if check else [])]
    kind = cast(type[Answer], prompt.answer)
    question = messages = prompt.messages()
    schema = prompt.answer_schema()
    issues: list[Issue] = []
    raw = ""
    for attempt in range(1, max(attempts, 1) + 1):
        raw = llm.complete(Request(prompt, messages, schema, sample, attempt)).text
        answer, issues = read_answer(raw, kind, checks)
        if answer is not None:
            return answer
        messages = (*question, *_repair(raw, issues))
    raise AnswerError(llm.name, prompt.purpose, issues, raw, max(attempts, 1))


def read_answer(
    raw: str, kind: type[Answer], checks: Sequence[Check[Answer]] = ()
) -> tuple[Answer | None, list[Issue]]:
    """Find the answer in a model's words.

    Among the JSON objects in the text the last one that is valid counts, since models that think
    aloud answer at the end.

    Returns:
        The answer and no issues; or `None` and the faults of the object that came nearest.
    """
    if len(raw) > MAX_ANSWER:
        return None, [Issue("", f"the answer has {len(raw):,} characters; {MAX_ANSWER:,} at most")]
    misshapen: list[tuple[int, list[Issue]]] = []
    refused: list[Issue] = []
    for value, width in find_objects(raw):
        try:
            answer = kind.model_validate(value)
        except ValidationError as error:
            misshapen.append((width, issues_of(error)))
            continue
        issues = [issue for check in checks for issue in check(answer)]
        if not issues:
            return answer, []
        refused = refused or issues
    if refused:
        return None, refused
    if _scan(raw)[1] is not None:
        return None, [Issue("", "the answer is cut off before its end; answer more briefly")]
    if misshapen:
        return None, max(misshapen, key=lambda found: found[0])[1]
    return None, [Issue("", "no JSON object was found in the answer")]


def find_objects(text: str) -> Iterator[tuple[dict[str, Any], int]]:
    """Yield the JSON objects in a text with their widths in characters, likeliest answer first.

    They may stand in a fence, in prose, after a chain of thought, inside one wrapping key or a JSON
    string, and may have small faults: trailing commas, single quotes, comments, a missing end (but never a
    text or number that is cut short).
    """
    tail = text.rpartition("</think>")[2]
    for part in dict.fromkeys((tail, text)):
        closed, broken_off = _scan(part)
        for value, width in reversed(closed):
            yield value, width
            if len(value) == 1 and isinstance(inner := next(iter(value.values())), dict):
                yield inner, 0
        quoted = _strict(part)
        if isinstance(quoted, str):
            yield from ((value, 0) for value, _ in reversed(_scan(quoted)[0]))
        if broken_off is not None and (ended := _end(part[broken_off:])) is not None:
            yield ended, len(part) - broken_off


_DECODER = json.JSONDecoder(strict=False)

_STARTS = 40
"""How many things that begin like an object and are none are tried before the rest is given up."""

_MENDABLE = 20_000
"""Longest object with faults that is mended, in characters: the mending takes quadratic time."""

_OBJECT = re.compile(r"""\{\s*(?:["'}]|[A-Za-z_]\w*\s*:|//|/\*)""")
"""How an object begins, with some licence; braces in prose and formulas do not look like it."""


def _scan(text: str) -> tuple[list[tuple[dict[str, Any], int]], int | None]:
    """Find the objects that have an end, none inside another, and where the first one without begins."""
    found: list[tuple[dict[str, Any], int]] = []
    broken_off: int | None = None
    position = failed = 0
    while failed < _STARTS and (start := _OBJECT.search(text, position)):
        position = start.start()
        value, end = _strict_at(text, position)
        if not isinstance(value, dict):
            end = _matching_brace(text, position)
            value = _mended(text[position:end]) if end else None
            broken_off = position if broken_off is None and not end else broken_off
        if isinstance(value, dict):
            found.append((value, end - position))
            position = end
        else:
            position += 1
            failed += 1
    return found, broken_off


def _end(text: str) -> dict[str, Any] | None:
    """Return the object that a text breaks off in, if all that is there of it is whole."""
    text = re.sub(r"\s*(?:```)?\s*$", "", text)
    whole = text.endswith(("]", '"', "true", "false", "null", ",")) and not _ends_in_string(text)
    return _mended(text) if whole or text.endswith("}") else None


def _strict(text: str) -> Any:
    try:
        return _DECODER.decode(text)
    except (ValueError, RecursionError):
        return None


def _strict_at(text: str, position: int) -> tuple[Any, int]:
    try:
        return _DECODER.raw_decode(text, position)
    except (ValueError, RecursionError):
        return None, 0


_TRAILING_COMMA = re.compile(r'("(?:[^"\\]|\\.)*")|,(?=\s*[}\]])', re.DOTALL)


def _mended(text: str) -> dict[str, Any] | None:
    if len(text) > _MENDABLE:
        return None
    plain = _TRAILING_COMMA.sub(lambda match: match[1] or "", text)
    if isinstance(value := _strict(plain), dict):
        return value
    try:
        value = json_repair.loads(text, skip_json_loads=True)
    # Written for broken input, and itself broken by some of it.
    except Exception:
        return None
    return value if isinstance(value, dict) and value else None


_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|[{}"]', re.DOTALL)


def _matching_brace(text: str, position: int) -> int:
    """Return the position after the brace that closes the one at `position`; 0 if none does."""
    depth = 0
    for token in _TOKEN.finditer(text, position):
        mark = token.group()
        depth += (mark == "{") - (mark == "}")
        if mark == '"':
            return 0
        if depth == 0:
            return token.end()
    return 0


def _ends_in_string(text: str) -> bool:
    return any(token.group() == '"' for token in _TOKEN.finditer(text))


def _repair(raw: str, issues: Sequence[Issue]) -> tuple[Message, Message]:
    faults = "\n".join(f"- {issue}" for issue in issues[:SHOWN_ISSUES])
    rest = len(issues) - SHOWN_ISSUES
    more = f"\n- and {rest} more" if rest > 0 else ""
    said = raw if len(raw) <= QUOTED else f"{raw[:QUOTED]} ..."
    return (
        Message(role="assistant", text=said.strip() or "(nothing)"),
        Message(
            role="user",
            text=f"That answer cannot be used:\n{faults}{more}\n\nMend these faults and answer "
            "again with the complete JSON object and nothing else.",
        ),
    )
