"""Pictures in a terminal: kitty's, iTerm2's and sixel graphics, or half blocks of characters."""

from base64 import standard_b64encode
from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

Pixels = NDArray[np.uint8]
"""[height, width, 3], red first."""

GRAPHICS = ("auto", "kitty", "iterm", "sixel", "blocks", "none")

_KITTY = ("xterm-kitty", "xterm-ghostty")
_SIXEL = ("foot", "foot-extra", "mlterm", "contour", "yaft-256color")
_CHUNK = 4_096
"""Maximum length of one of kitty's commands, in characters of base64."""
_LEVELS = 6
"""Levels of each colour in sixel graphics, which allow 256 colours."""


def graphics_of(environment: Mapping[str, str]) -> str:
    """Return the graphics that a terminal shows, by the variables that it sets."""
    term, program = environment.get("TERM", ""), environment.get("TERM_PROGRAM", "")
    if term in ("", "dumb"):
        return "none"
    if term.startswith(("screen", "tmux")) or "TMUX" in environment:
        return "blocks"  # A multiplexer passes graphics on only if told to.
    if term in _KITTY or "KITTY_WINDOW_ID" in environment or program == "ghostty":
        return "kitty"
    if program in ("iTerm.app", "WezTerm", "vscode"):
        return "iterm"
    if term in _SIXEL:
        return "sixel"
    return "blocks"


def kitty(png: bytes, columns: int) -> str:
    """Return a PNG as commands of kitty's graphics protocol."""
    data = standard_b64encode(png).decode()
    parts = [data[start : start + _CHUNK] for start in range(0, len(data), _CHUNK)]
    commands = []
    for number, part in enumerate(parts):
        more = int(number + 1 < len(parts))
        keys = f"a=T,f=100,c={columns},m={more}" if number == 0 else f"m={more}"
        commands.append(f"\x1b_G{keys};{part}\x1b\\")
    return "".join(commands)


def iterm(picture: bytes, columns: int) -> str:
    """Return an image file of any common format as a command of iTerm2."""
    data = standard_b64encode(picture).decode()
    keys = f"inline=1;size={len(picture)};width={columns};preserveAspectRatio=1"
    return f"\x1b]1337;File={keys}:{data}\x07"


def blocks(pixels: Pixels, columns: int) -> str:
    """Return a picture as lines of half blocks in 24-bit colours; a character shows two pixels."""
    height, width = pixels.shape[:2]
    rows = max(1, round(columns * height / width / 2))
    small = _resized(pixels, 2 * rows, columns)
    lines = []
    for row in range(rows):
        line = "".join(
            f"\x1b[38;2;{top[0]};{top[1]};{top[2]}m\x1b[48;2;{low[0]};{low[1]};{low[2]}m▀"
            for top, low in zip(small[2 * row].tolist(), small[2 * row + 1].tolist(), strict=True)
        )
        lines.append(f"{line}\x1b[0m")
    return "\n".join(lines)


def sixel(pixels: Pixels) -> str:
    """Return a picture as sixels in the 216 colours of a cube."""
    height, width = pixels.shape[:2]
    wide = pixels.astype(np.int64)
    level = (wide * (_LEVELS - 1) + 127) // 255
    index = (level[..., 0] * _LEVELS + level[..., 1]) * _LEVELS + level[..., 2]
    palette = [
        f"#{colour};2;{_percent(colour // 36)};{_percent(colour // 6 % 6)};{_percent(colour % 6)}"
        for colour in np.unique(index).tolist()
    ]
    bands = [_band(index[top : top + 6]) for top in range(0, height, 6)]
    return f'\x1bPq"1;1;{width};{height}{"".join(palette)}{"-".join(bands)}\x1b\\'


def _percent(level: int) -> int:
    return round(100 * level / (_LEVELS - 1))


def _band(index: NDArray[np.int64]) -> str:
    """Return up to six rows of colours as sixels: a pass over the row of characters per colour."""
    bits = 1 << np.arange(len(index))
    passes = []
    for colour in np.unique(index).tolist():
        codes = ((index == colour) * bits[:, None]).sum(axis=0) + 63
        passes.append(f"#{colour}{''.join(_runs(codes.tolist()))}")
    return "$".join(passes)


def _runs(codes: list[int]) -> Iterator[str]:
    """Yield characters, runs of the same one as a count."""
    start = 0
    for end in range(1, len(codes) + 1):
        if end == len(codes) or codes[end] != codes[start]:
            length, char = end - start, chr(codes[start])
            yield f"!{length}{char}" if length > 3 else char * length
            start = end


def _resized(pixels: Pixels, height: int, width: int) -> Pixels:
    """Return the picture in another size; every pixel is the mean of those that it covers."""
    means = pixels.astype(np.float64)
    for axis, size in enumerate((height, width)):
        edges = np.linspace(0, means.shape[axis], size + 1)
        first = np.minimum(edges[:-1].astype(np.int64), means.shape[axis] - 1)
        last = np.maximum(np.ceil(edges[1:]).astype(np.int64), first + 1)
        sums = np.insert(means.cumsum(axis=axis), 0, 0.0, axis=axis)
        spans = (last - first).reshape([-1 if other == axis else 1 for other in range(3)])
        means = (sums.take(last, axis) - sums.take(first, axis)) / spans
    return np.rint(means).astype(np.uint8)
