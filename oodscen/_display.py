"""Short representations of values: five lines at most in a terminal, a table or a picture in a notebook."""

import dataclasses
import html
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

LINES = 5
"""Lines of a representation at most."""
WIDTH = 100
ROOM = 60
"""Characters of one field at most."""


class Brief:
    """Gives a dataclass (made with `repr=False`) a representation of at most five lines."""

    def __repr__(self) -> str:
        fields = dataclasses.fields(self)  # type: ignore[arg-type]  # every subclass is a dataclass
        return brief(self, ((field.name, getattr(self, field.name)) for field in fields))


def brief(value: object, fields: Iterable[tuple[str, Any]]) -> str:
    """Return `Name(field=value, ...)`, with long values abridged and the whole cut to five lines."""
    return cut(f"{type(value).__name__}({', '.join(f'{key}={abridged(item)}' for key, item in fields)})")


def cut(text: str) -> str:
    """Wrap a text, and cut it to five lines."""
    lines = [part for line in text.splitlines() for part in textwrap.wrap(line, WIDTH) or [""]]
    if len(lines) > LINES:
        lines = [*lines[: LINES - 1], f"{lines[LINES - 1][: WIDTH - 2]} …"]
    return "\n".join(lines)


def abridged(value: object) -> str:
    """Return a representation of one line; a large value is described by its type and size."""
    if isinstance(value, np.ndarray):
        return f"<{value.dtype}{list(value.shape)}>"
    if isinstance(value, str):
        return repr(value) if len(value) <= ROOM else f"{value[: ROOM - 1]!r}…"
    if isinstance(value, Mapping):
        inside = [f"{abridged(key)}: {abridged(item)}" for key, item in _first(value.items())]
        return _joined("{", inside, "}", len(value), "entries")
    if isinstance(value, Sequence) and not isinstance(value, bytes) and type(value) in (tuple, list):
        ends = "()" if isinstance(value, tuple) else "[]"
        return _joined(ends[0], [abridged(item) for item in _first(value)], ends[1], len(value), "items")
    text = " ".join(repr(value).split())
    return text if len(text) <= ROOM else f"<{type(value).__name__}>"


def _first(items: Iterable[Any]) -> list[Any]:
    return [item for item, _ in zip(items, range(ROOM), strict=False)]


def _joined(start: str, inside: Sequence[str], end: str, count: int, noun: str) -> str:
    text = f"{start}{', '.join(inside)}{end}"
    return text if count == len(inside) and len(text) <= ROOM else f"<{count:,} {noun}>"


def html_table(
    rows: Iterable[Sequence[object]], *, head: Sequence[str] = (), caption: str = ""
) -> str:
    """Return an HTML table for a notebook; all text is escaped."""

    def line(cells: Sequence[object], tag: str) -> str:
        return f"<tr>{''.join(f'<{tag}>{html.escape(str(cell))}</{tag}>' for cell in cells)}</tr>"

    title = f"<caption>{html.escape(caption)}</caption>" if caption else ""
    top = f"<thead>{line(head, 'th')}</thead>" if head else ""
    return f"<table>{title}{top}<tbody>{''.join(line(row, 'td') for row in rows)}</tbody></table>"


def png(pixels: NDArray[np.uint8]) -> bytes | None:
    """Return an RGB picture [height, width, 3] as PNG; `None` where OpenCV is not installed."""
    try:
        import cv2
    except ImportError:
        return None
    return bytes(cv2.imencode(".png", np.ascontiguousarray(pixels[..., ::-1]))[1].tobytes())
