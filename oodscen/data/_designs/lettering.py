"""Capitals of five by seven dots, for words on things and captions of pictures."""

from functools import cache

_COLUMNS = {
    "A": "7c1211127c", "B": "7f49494936", "C": "3e41414122", "D": "7f4141413e", "E": "7f49494941",
    "F": "7f09090901", "G": "3e41415173", "H": "7f0808087f", "I": "00417f4100", "J": "2040413f01",
    "K": "7f08142241", "L": "7f40404040", "M": "7f021c027f", "N": "7f0408107f", "O": "3e4141413e",
    "P": "7f09090906", "Q": "3e4151215e", "R": "7f09192946", "S": "2649494932", "T": "03017f0103",
    "U": "3f4040403f", "V": "1f2040201f", "W": "3f4038403f", "X": "6314081463", "Y": "0304780403",
    "Z": "6159494d43", "0": "3e5149453e", "1": "00427f4000", "2": "7249494946", "3": "2141494d33",
    "4": "1814127f10", "5": "2745454539", "6": "3c4a494931", "7": "4121110907", "8": "3649494936",
    "9": "464949291e", ".": "0060600000", "!": "00005f0000", "?": "0201590906", "-": "0808080808",
    " ": "0000000000",
}  # fmt: skip
"""Five columns of each letter from the left; the lowest bit is the top dot."""
HEIGHT = 7
"""Dots of a letter from top to bottom."""
PITCH = 6
"""Dots from one letter to the next."""


@cache
def strokes(text: str) -> tuple[tuple[int, int, int], ...]:
    """Return the horizontal strokes of a text: row from the top, first dot and the one after the last."""
    found = []
    for row in range(HEIGHT):
        start = None
        lit = [*_row(text, row), False]
        for column, is_lit in enumerate(lit):
            if is_lit and start is None:
                start = column
            elif not is_lit and start is not None:
                found.append((row, start, column))
                start = None
    return tuple(found)


def width_of(text: str) -> int:
    """Return the number of dots from the left to the right end of a text."""
    return PITCH * len(text) - 1


def _row(text: str, row: int) -> list[bool]:
    dots: list[bool] = []
    for letter in text:
        columns = bytes.fromhex(_COLUMNS[letter])
        dots += [bool(column >> row & 1) for column in columns] + [False]
    return dots
