"""Strict JSON parsing for outside data, with bounded depth and one-line errors."""

import json
import math
import re
from codecs import BOM_UTF8
from collections.abc import Iterator
from typing import Any

from pydantic_core import from_json

_HALVES = re.compile("[\ud800-\udfff]")

_LONGEST_NUMBER = 100
"""Maximum length of a number, in characters; every number up to it is within a float's range."""


def parse_json(text: str | bytes) -> Any:
    """Parse a UTF-8 JSON document.

    Besides malformed JSON, this refuses NaN and infinity, numbers outside a float's range, objects with
    duplicate keys, lone surrogates, and values nested more than 200 deep.

    Raises:
        ValueError: With a one-line message.
    """
    if isinstance(text, bytes):
        try:
            text = text.decode()
        except UnicodeDecodeError as error:
            raise ValueError(f"byte {error.start} is not UTF-8") from None
    elif (half := _HALVES.search(text)) is not None:
        raise ValueError(f"character {half.start()} is a lone surrogate")
    # `json` nests as deep as the interpreter can; `from_json` has a limit but allows duplicate keys.
    from_json(text, allow_inf_nan=False)
    return _DECODER.decode(text)


def parse_object(text: str | bytes) -> dict[str, Any]:
    """Parse a JSON document that must be an object; the byte order mark of a file before it is skipped.

    Raises:
        ValueError: With a one-line message.
    """
    value = parse_json(text.removeprefix(BOM_UTF8) if isinstance(text, bytes) else text)
    if not isinstance(value, dict):
        raise ValueError("is not a JSON object")
    return value


def object_lines(content: bytes) -> Iterator[tuple[int, dict[str, Any] | ValueError]]:
    """Parse one object per line. Lines end at LF or CR LF only; blank lines are skipped.

    A last line without a line end counts if it is complete. A truncated one is skipped: it is still being
    written, or its writer was killed.

    Yields:
        The line number from 1, with the object or with the error in that line.
    """
    *lines, last = content.split(b"\n")
    for number, line in enumerate(lines, start=1):
        if line.strip():
            try:
                yield number, parse_object(line)
            except ValueError as error:
                yield number, error
    if is_object(last):
        yield len(lines) + 1, parse_object(last)
    elif b"\r" in last.rstrip():
        yield len(lines) + 1, ValueError("lines end with CR alone, not with LF or CR LF")


def is_object(text: bytes) -> bool:
    """Return whether the text is one complete JSON object."""
    try:
        parse_object(text)
    except ValueError:
        return False
    return True


def _distinct(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"the key {twice[:60]!r} occurs twice in one object")
    return found


def _float(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        _refused(text)
    return value


def _int(text: str) -> int:
    if len(text) > _LONGEST_NUMBER:
        _refused(text)
    return int(text)


def _refused(text: str) -> None:
    shown = text if len(text) <= 20 else f"{text[:20]} ..."
    raise ValueError(f"{shown} is not a readable number")


_DECODER = json.JSONDecoder(
    object_pairs_hook=_distinct, parse_float=_float, parse_int=_int, parse_constant=_refused
)
