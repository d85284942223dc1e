"""Addresses of the pictures beside the page."""

from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from oodscen._io.files import inside


@dataclass(frozen=True)
class FramePicture:
    """One frame as the page links to it."""

    href: str = ""
    """Relative address; empty if there is none."""
    problem: str = ""
    """The reason why there is no picture."""


def picture(folder: Path, name: str | None) -> FramePicture:
    """Return the address of a frame.

    Args:
        folder: Folder of the study.
        name: File relative to the study; a path outside the study is rejected.
    """
    if not name:
        return FramePicture(problem="no frame")
    if not _looks_like_one(name):
        return FramePicture(problem="not a picture of this study")
    try:
        is_there = inside(folder, name).is_file()
    except (OSError, ValueError):
        return FramePicture(problem="not a picture of this study")
    return (
        FramePicture(href=quote(name))
        if is_there
        else FramePicture(problem="frame file is missing")
    )


def _looks_like_one(name: str) -> bool:
    """Return whether a browser would find a picture under an address with this name."""
    suffixes = (".jpg", ".jpeg", ".png")
    return not any(char in name for char in ":\\?#\n\r") and name.lower().endswith(suffixes)
