"""Find JSON objects in the words of a language model."""

import json
import re
from collections.abc import Iterator
from typing import Any, NamedTuple

import json_repair

from oodscen._text import whole


class Members(dict[str, Any]):
    """An object in which members occur twice with different values; the later ones are its items."""

    repeated: frozenset[str] = frozenset()
    """Their names."""


class Found(NamedTuple):
    """One JSON object in a text."""

    value: dict[str, Any]
    width: int
    """Characters of text that it was read from; 0 for what another object or a string holds."""
    is_complete: bool = True
    """False where the closing brace is missing, so that members may be missing too."""
    start: int = 0
    """Where it begins, for those that `scan` returns."""
    is_mended: bool = False
    """Whether it had faults, so that the mending may have dropped words."""


def find_objects(text: str) -> Iterator[Found]:
    """Yield the JSON objects in a text, the likeliest answer first: from the last to the first.

    They may stand in a fence, in prose, after a chain of thought, inside one wrapping key or a JSON
    string, and may have small faults: trailing commas, single quotes, bare keys, comments, line breaks in
    strings. The closing brace may be missing, but nothing is yielded that is cut short in a text, a
    number, a list or an inner object. Halves of surrogate pairs are replaced.
    """
    text = cleaned(text)
    tail = text.rpartition("</think>")[2]
    for part in dict.fromkeys((tail, text)):
        closed, broken_off = scan(part)
        for found in reversed(closed):
            yield found
            if len(found.value) == 1 and isinstance(
                inner := next(iter(found.value.values())), dict
            ):
                yield Found(inner, 0)
        quoted = _strict(part)
        if isinstance(quoted, str):
            yield from (Found(value, 0) for value, *_ in reversed(scan(quoted)[0]))
        if broken_off is not None and (value := _ended(part[broken_off:])) is not None:
            yield Found(value, len(part) - broken_off, is_complete=False)


def is_cut_off(text: str) -> bool:
    """Whether an object begins in a text and does not end."""
    return scan(text)[1] is not None


def cleaned(text: str) -> str:
    """Replace halves of surrogate pairs, escaped or not."""
    return _ESCAPE.sub(lambda found: "\\ufffd" if found[1] else found[0], whole(text))


_ESCAPE = re.compile(
    r"\\(?:u[dD][89abAB][0-9a-fA-F]{2}\\u[dD][c-fC-F][0-9a-fA-F]{2}|u([dD][89a-fA-F][0-9a-fA-F]{2})|.)",
    re.DOTALL,
)
"""An escape in a JSON string; its group is half of a surrogate pair that stands alone."""


def _members(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    value = dict(pairs)
    if len(value) == len(pairs):
        return value
    repeated = frozenset(name for name, one in pairs if value[name] != one)
    if not repeated:
        return value
    members = Members(value)
    members.repeated = repeated
    return members


_DECODER = json.JSONDecoder(strict=False, object_pairs_hook=_members)

_STARTS = 20
"""How many things that begin like an object and are none are tried before the rest is given up."""

_MENDED = 100
"""How many objects with faults are mended before the rest is given up."""

_MENDABLE = 20_000
"""Longest object with faults that is mended, in characters: the mending takes quadratic time."""

_OBJECT = re.compile(r"""\{\s*(?:["'}]|[A-Za-z_]\w*\s*:|//|/\*)""")
"""How an object begins, with some licence; braces in prose and formulas do not look like it."""

_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|[{}\[\]"]', re.DOTALL)
"""Strings, brackets, and a quotation mark that opens a string without an end."""

_TRAILING_COMMA = re.compile(r'("(?:[^"\\]|\\.)*")|,(?=\s*[}\]])', re.DOTALL)


def scan(text: str) -> tuple[list[Found], int | None]:
    """Return the objects that have an end, none inside another, and where the first without begins."""
    found: list[Found] = []
    broken_off: int | None = None
    position = failed = mended = 0
    while failed < _STARTS and mended < _MENDED and (start := _OBJECT.search(text, position)):
        position = start.start()
        value, end = _strict_at(text, position)
        is_mended = not isinstance(value, dict)
        if is_mended:
            end = _matching_brace(text, position)
            value = _mended(text[position:end]) if end else None
            broken_off = position if broken_off is None and not end else broken_off
        if isinstance(value, dict):
            found.append(Found(value, end - position, True, position, is_mended))
            mended += is_mended
            position = end
        else:
            position += 1
            failed += 1
    return found, broken_off


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


def _ended(text: str) -> dict[str, Any] | None:
    """Return the object that a text breaks off in, if only its closing brace is missing."""
    text = re.sub(r"\s*(?:```)?\s*$", "", text)
    if text.endswith("}") and re.match(r"\{\s*'", text):
        # Quotation marks inside single-quoted strings make the brackets uncountable.
        return _mended(text)
    marks = [token.group() for token in _TOKEN.finditer(text)]
    is_missing_a_brace = (
        text.endswith(('"', "]", "}"))
        and '"' not in marks
        and marks.count("{") == marks.count("}") + 1
        and marks.count("[") == marks.count("]")
    )
    return _mended(text + "}") if is_missing_a_brace else None


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
