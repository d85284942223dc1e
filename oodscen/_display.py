"""Short representations of values: five lines at most in a terminal, a table or a picture in a notebook."""

import dataclasses
import html
import textwrap
from base64 import b64encode
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice
from pathlib import PurePath
from typing import Any, ClassVar

from oodscen._words.redaction import HIDDEN, redact, redact_repr, secrets_in

LINES = 5
"""Maximum number of lines of a representation."""
WIDTH = 100
"""Maximum length of a line, in characters."""
_ROOM = 60
"""Maximum length of one field, in characters."""
_MOST = 30
"""Maximum number of items of a field that are looked at."""


class Brief:
    """Gives a class a representation of at most five lines without credentials.

    A pydantic model shows the fields that differ from their defaults, a dataclass (made with `repr=False`) all
    its fields, and any other class the attributes named in `_repr_fields`.
    """

    _repr_fields: ClassVar[tuple[str, ...]] = ()
    """Names of the attributes to show; a leading underscore is left out."""

    def __repr__(self) -> str:
        return brief(self, ((name, getattr(self, name, None)) for name in _names(self)))

    def __str__(self) -> str:
        return repr(self)


def brief(value: object, fields: Iterable[tuple[str, Any]]) -> str:
    """Return `Name(field=value, ...)`, with long values abridged and the whole cut to five lines."""
    shown = ", ".join(f"{name.lstrip('_')}={_abridged(item)}" for name, item in fields)
    return cut(f"{type(value).__name__}({shown})")


def cut(text: str) -> str:
    """Remove the credentials in a text, wrap it, and cut it to five lines."""
    lines = [part for line in redact(text).splitlines() for part in textwrap.wrap(line, WIDTH)]
    if len(lines) > LINES:
        lines = [*lines[: LINES - 1], f"{lines[LINES - 1][: WIDTH - 2]} …"]
    return "\n".join(lines)


def _names(value: Any) -> Iterator[str]:
    kind = type(value)
    if kind._repr_fields:
        yield from kind._repr_fields
    elif dataclasses.is_dataclass(value):
        yield from (field.name for field in dataclasses.fields(value) if field.repr)
    else:
        for name, field in getattr(kind, "model_fields", {}).items():
            is_default = getattr(value, name, None) == field.get_default(call_default_factory=True)
            if field.repr and (field.is_required() or not is_default):
                yield name


def _abridged(value: object) -> str:
    """Return a representation of one line; a large value is described by its type and size."""
    if isinstance(value, str | PurePath):
        text = redact(str(value))
        return repr(text) if len(text) <= _ROOM else f"{text[: _ROOM - 1]!r}…"
    if isinstance(value, bytes):
        return f"<{len(value):,} bytes>"
    if hasattr(value, "dtype") and hasattr(value, "shape"):
        return f"<{value.dtype}{list(value.shape)}>"
    if isinstance(value, Mapping):
        items = (
            (key, item if isinstance(item, Mapping) or not secrets_in({key: item}) else HIDDEN)
            for key, item in value.items()
        )
        parts = [f"{_abridged(key)}: {_abridged(item)}" for key, item in islice(items, _MOST)]
        if parts and len(parts[0]) > _ROOM // 2:
            parts = [f"{_abridged(key)}: …" for key in islice(value, _MOST)]
        return _joined("{", parts, "}", len(value))
    if type(value) in (tuple, list) and isinstance(value, Sequence):
        ends = "()" if isinstance(value, tuple) else "[]"
        return _joined(ends[0], map(_abridged, islice(value, _MOST)), ends[1], len(value))
    try:
        text = " ".join(redact_repr(repr(value)).split())
    except Exception:  # The class may be anybody's.
        text = ""
    if not text or " at 0x" in text:
        return f"<{getattr(value, '__qualname__', type(value).__name__)}>"
    if len(text) <= _ROOM:
        return text
    head = text[: _ROOM - 3].rpartition(", ")[0] if isinstance(value, Brief) else ""
    return f"{head}, …)" if head else f"<{type(value).__name__}>"


def _joined(start: str, parts: Iterable[str], end: str, count: int) -> str:
    """Join as many parts as fit, with the number of all if some do not."""
    inside = list(parts)
    text = ", ".join(inside)
    if len(text) <= _ROOM and len(inside) == count:
        return f"{start}{text}{',' if start == '(' and count == 1 else ''}{end}"
    while inside and len(", ".join(inside)) > _ROOM - 12:
        inside.pop()
    return f"{start}{''.join(f'{part}, ' for part in inside)}… {count:,} in all{end}"


def html_table(
    rows: Iterable[Sequence[object]], *, head: Sequence[str] = (), caption: str = ""
) -> str:
    """Return an HTML table for a notebook; all text is escaped."""

    def line(cells: Sequence[object], tag: str) -> str:
        return f"<tr>{''.join(f'<{tag}>{escaped(cell)}</{tag}>' for cell in cells)}</tr>"

    title = f"<caption>{escaped(caption)}</caption>" if caption else ""
    top = f"<thead>{line(head, 'th')}</thead>" if head else ""
    return f"<table>{title}{top}<tbody>{''.join(line(row, 'td') for row in rows)}</tbody></table>"


def escaped(value: object) -> str:
    """Return a value as text for HTML, without credentials."""
    return html.escape(redact(str(value)))


def picture(data: bytes | None, caption: str) -> str:
    """Return a PNG as a figure that holds its own data; nothing without data."""
    if data is None:
        return ""
    source = f"data:image/png;base64,{b64encode(data).decode()}"
    return (
        '<figure style="display: inline-block; margin: 0 1em 0 0">'
        f'<img src="{source}" alt="{escaped(caption)}" style="max-height: 320px">'
        f"<figcaption>{escaped(caption)}</figcaption></figure>"
    )


def png(pixels: Any) -> bytes | None:
    """Return a picture as PNG.

    Args:
        pixels: [height, width, 3] uint8, red first, or [height, width] uint8 or uint16.

    Returns:
        `None` for any other array, and where OpenCV is not installed.
    """
    if getattr(pixels, "ndim", 0) not in (2, 3):
        return None
    is_colour = pixels.ndim == 3 and pixels.shape[2] == 3 and str(pixels.dtype) == "uint8"
    is_grey = pixels.ndim == 2 and str(pixels.dtype) in ("uint8", "uint16")
    if not (is_colour or is_grey) or not pixels.size:
        return None
    try:
        import cv2
    except ImportError:
        return None
    image = pixels[..., ::-1].copy() if is_colour else pixels
    return bytes(cv2.imencode(".png", image)[1].tobytes())
