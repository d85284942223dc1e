"""Sheets of pictures of things made to order, for eyes that name what they see."""

from collections.abc import Iterable

import numpy as np

from oodscen.data._designs.lettering import HEIGHT, strokes, width_of
from oodscen.errors import UsageError
from oodscen.stages._making.looking import DISTANCES_M, Pixels, ShownProp

_INK, _PAPER = 20, 250
"""Grey levels of a caption."""
_DOT_PX = 2
"""Side of one dot of a caption's letters, pixels."""


def sheet(seen: Iterable[ShownProp], *, captions: bool = False, seed: int = 0) -> Pixels:
    """Return a picture with one row per thing: by day and by night, at three distances.

    Args:
        seen: The things.
        captions: Write the names beside them; otherwise the order is random, and they are only numbered.
        seed: Seed of the order.

    Raises:
        UsageError: When there is nothing to show.
    """
    props = list(seen)
    if not props:
        raise UsageError("there is nothing to show: no design was given")
    if not captions:
        props = [props[index] for index in row_order(len(props), seed)]
    strips = []
    for number, prop in enumerate(props, start=1):
        cells = [np.pad(_middle(picture), ((2, 2), (2, 2), (0, 0))) for picture in prop.pictures]
        strip = np.concatenate(cells, axis=1)
        text = f"{number}"
        if captions:
            pixels = " ".join(f"{view.pixels}" for view in prop.look.views)
            text = f"{number} {prop.look.id.replace('_', ' ')} - PX {pixels}"
        strips += [caption(text, strip.shape[1]), strip]
    return np.concatenate(strips)


def views_of(seen: ShownProp) -> Pixels:
    """Return a picture of one thing: by day above and by night below, at the three distances."""
    cells = [_middle(picture) for picture in seen.pictures]
    count = len(DISTANCES_M)
    day, night = (np.concatenate(row, axis=1) for row in (cells[:count], cells[count:]))
    return np.concatenate((day, night))


def row_order(count: int, seed: int) -> list[int]:
    """Return the random order of the rows of a sheet without captions."""
    order: list[int] = np.random.Generator(np.random.PCG64(seed)).permutation(count).tolist()
    return order


def caption(text: str, width: int) -> Pixels:
    """Return a line of black capitals on white."""
    image = np.full(((HEIGHT + 4) * _DOT_PX, width, 3), _PAPER, np.uint8)
    letters = (width // _DOT_PX - 4) // (width_of("AA") - width_of("A"))
    for row, start, end in strokes(text.upper()[:letters]):
        top, left, right = ((dots + 2) * _DOT_PX for dots in (row, start, end))
        image[top : top + _DOT_PX, left:right] = _INK
    return image


def _middle(image: Pixels) -> Pixels:
    """Return the part of a picture around the road ahead, pixel by pixel."""
    height, width = image.shape[:2]
    return image[height * 3 // 16 : height * 11 // 16, width // 4 : width * 3 // 4]
