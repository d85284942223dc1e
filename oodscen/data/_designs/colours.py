"""Colours of parts: named ones, any by its hexadecimal code, and lit ones."""

import re
from typing import Annotated

from pydantic import AfterValidator, Field, ValidationInfo

PALETTE: dict[str, tuple[int, int, int]] = {
    "white": (238, 238, 234), "black": (26, 26, 29), "grey": (126, 128, 130),
    "dark_grey": (66, 68, 72), "light_grey": (186, 188, 188), "silver": (172, 178, 184),
    "red": (200, 28, 34), "orange": (242, 104, 20), "yellow": (244, 200, 28), "green": (38, 128, 62),
    "blue": (36, 84, 184), "navy": (32, 42, 84), "purple": (112, 52, 140), "pink": (236, 130, 170),
    "brown": (112, 74, 46), "beige": (214, 196, 160), "teal": (38, 128, 132),
    "fluor_orange": (255, 112, 28), "fluor_yellow": (214, 244, 40), "wood": (198, 158, 104),
    "rust": (140, 78, 46), "concrete": (176, 174, 168), "asphalt": (82, 83, 86),
    "earth": (126, 104, 76), "leaf": (64, 118, 50), "skin": (216, 168, 134), "glass": (44, 56, 70),
    "water": (92, 112, 136), "tyre": (26, 26, 28), "metal": (148, 154, 160), "hub": (160, 162, 166), "amber": (255, 184, 40),
}  # fmt: skip
"""Red, green and blue of the colours that have a name."""
LIT = "lit "
"""Prefix of a colour that shines in the dark."""
_HEX = re.compile(r"#([0-9a-fA-F]{2})([0-9a-fA-F]{2})([0-9a-fA-F]{2})")


def rgb_of(colour: str) -> tuple[int, int, int] | None:
    """Return red, green and blue of `#rrggbb` or of a name, lit or not; `None` for other words."""
    name = colour.removeprefix(LIT)
    if code := _HEX.fullmatch(name):
        red, green, blue = (int(part, 16) for part in code.groups())
        return red, green, blue
    return PALETTE.get(name)


def unknown_colour(name: str) -> ValueError:
    """Return the error that a colour is neither a code nor a known name."""
    return ValueError(f"unknown colour {name[:40]!r}: use #rrggbb or one of {', '.join(PALETTE)}")


def _known_colour(name: str, info: ValidationInfo) -> str:
    known = (info.context or {}).get("colours", ())
    if name not in known and rgb_of(name) is None:
        raise unknown_colour(name)
    return name


Colour = Annotated[str, Field(max_length=40), AfterValidator(_known_colour)]
"""`#rrggbb` or a name in `PALETTE`, with the prefix `lit ` if it shines.

A reader may allow further names, such as `paint`, through the validation context `colours`.
"""
