"""A search for JSON objects in the text of a language model."""

import json
import re
from collections.abc import Iterator
from typing import Any, NamedTuple

import json_repair

from oodscen._text import whole


class Members(dict[str, Any]):
    """An object with repeated members of different values; it holds the later ones."""

    repeated: frozenset[str] = frozenset()
    """Names of the repeated members."""


class Found(NamedTuple):
    """One JSON object in a text."""

    value: dict[str, Any]
    width: int
    """Number of characters it was read from; 0 for objects nested in another object or a string."""
    is_complete: bool = True
    """False if the closing brace is missing, so that members may be missing too."""
    start: int = 0
    """Offset of its first character, set by `scan`."""
    is_mended: bool = False
    """True if it had faults, in which case the repair may have dropped words."""


def find_objects(text: str) -> Iterator[Found]:
    """Yield the JSON objects in a text, likeliest answer first: from the last to the first.

    Objects may stand in a code fence, in prose, after a chain of thought, inside one wrapping key or a JSON
    string. Small faults are repaired: trailing commas, single quotes, bare keys, comments, line breaks in
    strings. The closing brace may be missing, but an object cut off within a string, a number, a list or an
    inner object is skipped. Lone surrogates are replaced.
    """
    text = clean_surrogates(text)
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
    """Return whether the text ends in the middle of an object."""
    return scan(text)[1] is not None


def clean_surrogates(text: str) -> str:
    """Replace lone surrogates, escaped or not."""
    return _ESCAPE.sub(lambda found: "\\ufffd" if found[1] else found[0], whole(text))


_ESCAPE = re.compile(
    r"\\(?:u[dD][89abAB][0-9a-fA-F]{2}\\u[dD][c-fC-F][0-9a-fA-F]{2}|u([dD][89a-fA-F][0-9a-fA-F]{2})|.)",
    re.DOTALL,
)
"""An escape in a JSON string; its group matches a lone surrogate."""


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
"""Maximum number of false object starts before the scan gives up."""

_MENDED = 100
"""Maximum number of faulty objects to repair before the scan gives up."""

_MENDABLE = 20_000
"""Length of the longest faulty object to repair, in characters; repairing takes quadratic time."""

_OBJECT = re.compile(r"""\{\s*(?:["'}]|[A-Za-z_]\w*\s*:|//|/\*)""")
"""The start of an object, leniently; braces in prose and formulas do not match."""

_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|[{}\[\]"]', re.DOTALL)
"""Strings, brackets, and a quotation mark that opens an unterminated string."""

_TRAILING_COMMA = re.compile(r'("(?:[^"\\]|\\.)*")|,(?=\s*[}\]])', re.DOTALL)


def scan(text: str) -> tuple[list[Found], int | None]:
    """Return the closed outermost objects, and the offset of the first object without an end."""
    found: list[Found] = []
    broken_off: int | None = None
    position = failed = mended = 0
    while failed < _STARTS and mended < _MENDED and (start := _OBJECT.search(text, position)):
        position = start.start()
        value, end = _strict_at(text, position)
        is_mended = not isinstance(value, dict)
        if is_mended:
            end = _matching_brace(text, position)
            value = _mend(text[position:end]) if end else None
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
    """Return the position after the brace that closes the one at `position`, or 0 if there is none."""
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
    """Return the object that a text ends in, if only its closing brace is missing."""
    text = re.sub(r"\s*(?:```)?\s*$", "", text)
    if text.endswith("}") and re.match(r"\{\s*'", text):
        # Quotation marks inside single-quoted strings make brackets uncountable.
        return _mend(text)
    marks = [token.group() for token in _TOKEN.finditer(text)]
    is_missing_a_brace = (
        text.endswith(('"', "]", "}"))
        and '"' not in marks
        and marks.count("{") == marks.count("}") + 1
        and marks.count("[") == marks.count("]")
    )
    return _mend(text + "}") if is_missing_a_brace else None


def _mend(text: str) -> dict[str, Any] | None:
    if len(text) > _MENDABLE:
        return None
    plain = _TRAILING_COMMA.sub(lambda match: match[1] or "", text)
    if isinstance(value := _strict(plain), dict):
        return value
    try:
        value = json_repair.loads(text, skip_json_loads=True)
    # json_repair is made for broken input, but some of it makes it raise.
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
