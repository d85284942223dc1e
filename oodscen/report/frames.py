"""Addresses of the pictures beside the page."""

from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from urllib.parse import quote


@dataclass(frozen=True)
class Picture:
    """One frame as the page links to it."""

    href: str = ""
    """Relative address; empty if there is none."""
    problem: str = ""
    """Why there is no picture."""


def picture(folder: Path, name: str | None) -> Picture:
    """Return the address of a frame.

    Args:
        folder: Of the study.
        name: File relative to the study; anything outside the study is refused.
    """
    if not name:
        return Picture(problem="no frame")
    if not is_inside(name):
        return Picture(problem="not a picture of this study")
    if not (folder / name).is_file():
        return Picture(problem="frame file is missing")
    return Picture(href=quote(name))


def is_inside(name: str) -> bool:
    """Whether a file name is relative, stays inside the study and looks like a picture."""
    path = PurePosixPath(name)
    return (
        not path.is_absolute()
        and ".." not in path.parts
        and not any(char in name for char in ":\\?#\0\n\r")
        and path.suffix.lower() in (".jpg", ".jpeg", ".png")
    )
