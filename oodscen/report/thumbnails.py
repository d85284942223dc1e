"""Small pictures inside the page, from the full-size frames beside it."""

import base64
import importlib
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any
from urllib.parse import quote

BUDGET = 5_400_000
"""Characters that all thumbnails of a page share, unless there are more than fit at `FLOOR` each."""
CEILING = 14_000
"""Most characters for one thumbnail."""
FLOOR = 5_000
"""Characters that one thumbnail may always take."""

_STEPS = ((256, 70), (256, 55), (256, 40), (208, 40), (160, 35))
"""Width in pixels and JPEG quality, tried in order until a thumbnail is small enough."""


@dataclass(frozen=True)
class Thumbnail:
    """One frame as the page shows it."""

    moment: str
    href: str = ""
    """Relative address of the full-size file; empty if there is none."""
    source: str = ""
    """`data:` address of the small picture, or `href` where it could not be made."""
    width: int = 4
    height: int = 3
    """Of the small picture, in pixels (the ratio is what matters)."""
    problem: str = ""
    """Why there is no picture."""


class Thumbnails:
    """Makes thumbnails that together stay within a budget.

    Args:
        folder: Of the study.
        count: How many thumbnails the page will hold.
    """

    def __init__(self, folder: Path, count: int) -> None:
        self.folder = folder
        self.limit = min(CEILING, max(FLOOR, BUDGET // max(count, 1)))
        self._cv2 = _cv2()

    @property
    def can_shrink(self) -> bool:
        """Whether OpenCV is there; without it the page shows the full-size files beside it."""
        return self._cv2 is not None

    def make(self, moment: str, name: str | None) -> Thumbnail:
        """Return the thumbnail of one frame.

        Args:
            moment: Which frame it is.
            name: File relative to the study; anything outside the study is refused.
        """
        if not name:
            return Thumbnail(moment, problem="no frame")
        if not is_inside(name):
            return Thumbnail(moment, problem="not a picture of this study")
        href = quote(name)
        path = self.folder / name
        if not path.is_file():
            return Thumbnail(moment, problem="frame file is missing")
        if self._cv2 is None:
            return Thumbnail(moment, href=href, source=href)
        return self._shrunk(moment, href, path)

    def _shrunk(self, moment: str, href: str, path: Path) -> Thumbnail:
        cv2 = self._cv2
        picture = self._read(path)
        if picture is None:
            return Thumbnail(moment, href=href, problem="frame file is not a picture")
        encoded, small = "", picture
        for wide, quality in _STEPS:
            height, width = small.shape[:2]
            if wide < width:
                size = (wide, max(round(height * wide / width), 1))
                small = cv2.resize(small, size, interpolation=cv2.INTER_AREA)
            _, data = cv2.imencode(".jpg", small, [cv2.IMWRITE_JPEG_QUALITY, quality])
            encoded = base64.b64encode(data.tobytes()).decode("ascii")
            if len(encoded) <= self.limit:
                break
        height, width = small.shape[:2]
        return Thumbnail(moment, href, f"data:image/jpeg;base64,{encoded}", width, height)

    def _read(self, path: Path) -> Any:
        """Decode a picture, at half its size where that is enough (four times as quick)."""
        cv2 = self._cv2
        try:
            half = cv2.imread(str(path), cv2.IMREAD_REDUCED_COLOR_2)
            if half is not None and half.shape[1] < _STEPS[0][0]:
                return cv2.imread(str(path), cv2.IMREAD_COLOR)
        except cv2.error:
            return None
        return half


def is_inside(name: str) -> bool:
    """Whether a file name is relative, stays inside the study and looks like a picture."""
    path = PurePosixPath(name)
    return (
        not path.is_absolute()
        and ".." not in path.parts
        and not any(char in name for char in ":\\?#\0\n\r")
        and path.suffix.lower() in (".jpg", ".jpeg", ".png")
    )


def _cv2() -> Any:
    try:
        return importlib.import_module("cv2")
    except ImportError:
        return None
