"""A search for JSON objects in the text of a language model."""

import json
import re
from collections.abc import Iterable, Iterator
from itertools import accumulate
from typing import Any, NamedTuple

import json_repair

from oodscen._words.text import clean_surrogates, whole


class Members(dict[str, Any]):
    """An object with repeated members of different values; it holds the later ones."""

    repeated: tuple[str, ...] = ()
    """Names of the repeated members, in order."""


class JsonObject(NamedTuple):
    """One JSON object in a text."""

    value: dict[str, Any]
    width: int
    """Number of characters it was read from; 0 for objects nested in another object or a string."""
    is_complete: bool = True
    """False if the closing brace is missing, so that members may be missing too."""
    start: int = 0
    """Offset of its first character, set by `scan`."""
    is_altered: bool = False
    """True if repairing its faults dropped or changed more than punctuation and comments: its values may be others."""
    comments: tuple[str, ...] = ()

    @property
    def repeated(self) -> tuple[str, ...]:
        """Names of the members, in it or in what it holds, that repeat with different values, in order."""
        return tuple(dict.fromkeys(_repeated_members(self.value)))


def find_objects(text: str) -> list[tuple[JsonObject, ...]]:
    """Return the JSON objects in a text from the first to the last, each followed by the one that it wraps.

    Objects may stand in a code fence, in prose, inside one wrapping key or a JSON string. Small faults are
    repaired: trailing commas, single quotes, bare keys, comments, line breaks in strings. The closing brace may be
    missing, but an object cut off within a string, a number, a list or an inner object is skipped. Lone surrogates
    are replaced.
    """
    text = clean_surrogates(text)
    quoted = _strict(text)
    if isinstance(quoted, str):
        inner = scan(quoted)[0]
        return [(JsonObject(item.value, 0, is_altered=item.is_altered),) for item in inner]
    objects, broken_off = scan(text)
    if broken_off is not None and (last := _without_brace(text[broken_off:])) is not None:
        objects = [*(item for item in objects if item.start < broken_off), last]
    return [(outer, *_wrapped(outer)) for outer in objects]


def _wrapped(outer: JsonObject) -> Iterator[JsonObject]:
    """Yield the object that an object of one member holds."""
    if len(outer.value) == 1 and isinstance(inner := next(iter(outer.value.values())), dict):
        yield JsonObject(inner, 0, is_altered=outer.is_altered)


def _repeated_members(value: object) -> Iterator[str]:
    if isinstance(value, Members):
        yield from value.repeated
    for inner in held_values(value):
        yield from _repeated_members(inner)


def held_values(value: object) -> Iterable[Any]:
    """Return the values that an object or a list holds; nothing for any other value."""
    if isinstance(value, dict):
        return value.values()
    return value if isinstance(value, list) else ()


def is_cut_off(text: str) -> bool:
    """Return whether the text ends in the middle of an object."""
    return scan(text)[1] is not None


def _members(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    value = dict(pairs)
    if len(value) == len(pairs):
        return value
    repeated = tuple(dict.fromkeys(name for name, earlier in pairs if value[name] != earlier))
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

_OBJECT = re.compile(r"""\{\s*(?:["'}\u201c]|[A-Za-z_]\w*\s*:|//|/\*|#)""")
"""The start of an object, leniently; braces in prose and formulas do not match."""

_STRING = r'"(?:[^"\\]|\\.)*(?:"|(?P<open>\\?\Z))'
"""A string; an unterminated one is `open` and ends with the text, where otherwise each of its marks would be tried."""

_TOKEN = re.compile(rf"{_STRING}|[{{}}\[\]]", re.DOTALL)
"""Strings and brackets."""

_BRACE = re.compile(r"[{}]")

_TRAILING_COMMA = re.compile(rf"({_STRING})|,(?=\s*[}}\]])", re.DOTALL)


def scan(text: str) -> tuple[list[JsonObject], int | None]:
    """Return the closed outermost objects, and the offset of the first object without an end."""
    objects: list[JsonObject] = []
    broken_off: int | None = None
    position = failed = mended = 0
    while failed < _STARTS and mended < _MENDED and (start := _OBJECT.search(text, position)):
        position = start.start()
        parsed = _strict_at(text, position)
        if parsed is None:
            end = _matching_brace(text, position)
            if end is not None:
                parsed = _mended(text[position:end], is_inner=_is_before_end(text, end))
            elif broken_off is None:
                broken_off = position
            mended += parsed is not None
        if parsed is None:
            position += 1
            failed += 1
        else:
            objects.append(parsed._replace(start=position))
            position += parsed.width
    return objects, broken_off


def _is_before_end(text: str, position: int) -> bool:
    """Return whether a brace after `position` closes what was opened before it."""
    marks = (1 if brace[0] == "{" else -1 for brace in _BRACE.finditer(text, position))
    return any(depth < 0 for depth in accumulate(marks))


def _matching_brace(text: str, position: int) -> int | None:
    """Return the position after the brace that closes the one at `position`; `None` if there is none."""
    depth = 0
    for token in _TOKEN.finditer(text, position):
        mark = token.group()
        depth += (mark == "{") - (mark == "}")
        if token["open"] is not None:
            return None
        if depth == 0:
            return token.end()
    return None


def _without_brace(text: str) -> JsonObject | None:
    """Return the object that a text ends in, if only its closing brace is missing."""
    part = re.sub(r"\s*(?:```)?\s*$", "", text)
    # Quotation marks inside single-quoted strings make brackets uncountable.
    if not (part.endswith("}") and re.match(r"\{\s*'", part)):
        tokens = list(_TOKEN.finditer(part))
        marks = [token.group() for token in tokens]
        is_missing_a_brace = (
            part.endswith(('"', "]", "}"))
            and all(token["open"] is None for token in tokens)
            and marks.count("{") == marks.count("}") + 1
            and marks.count("[") == marks.count("]")
        )
        if not is_missing_a_brace:
            return None
        part += "}"
    mended = _mended(part)
    return mended and mended._replace(width=len(text), is_complete=False)


def _mended(text: str, *, is_inner: bool = False) -> JsonObject | None:
    """Return a faulty object, repaired; if it ends inside another one, its end may be missing."""
    if len(text) > _MENDABLE:
        return None
    value = _strict(_TRAILING_COMMA.sub(lambda match: match[1] or "", text))
    if isinstance(value, dict):
        return JsonObject(value, len(text))
    try:
        value = json_repair.loads(text, skip_json_loads=True)
    # json_repair is made for broken input, but some of it makes it raise.
    except Exception:
        return None
    if not (isinstance(value, dict) and value):
        return None
    comments = [mark[0].strip("/*# \n") for mark in _COMMENT.finditer(text) if mark[1] is None]
    plain = _COMMENT.sub(lambda match: match[1] or "", text)
    is_altered = is_inner or _essence(plain) != _essence(json.dumps(value))
    return JsonObject(value, len(text), is_altered=is_altered, comments=tuple(comments))


def _strict(text: str) -> Any:
    try:
        return _DECODER.decode(text)
    except (ValueError, RecursionError):
        return None


def _strict_at(text: str, position: int) -> JsonObject | None:
    try:
        value, end = _DECODER.raw_decode(text, position)
    except (ValueError, RecursionError):
        return None
    return JsonObject(value, end - position) if isinstance(value, dict) else None


def _essence(text: str) -> str:
    """Return the characters of an object that carry its values; commas between digits may be part of a number."""
    text = _CODE.sub(lambda match: chr(int(match[1], 16)), _BREAK.sub(" ", text))
    return _FORM.sub("", _COMMA.sub(",", whole(text).casefold().replace("none", "null")))


_COMMENT = re.compile(rf"""({_STRING}|'(?:[^'\\]|\\.)*')|(?://|#)[^\n]*|/\*.*?\*/""", re.DOTALL)
_BREAK = re.compile(r"\\[bfnrt]")
_CODE = re.compile(r"\\u([0-9a-fA-F]{4})")
_COMMA = re.compile(r"\s*,\s*")
_FORM = re.compile(r"""[\s"'\\\u201c\u201d:]|(?<!\d),|,(?!\d)""")
