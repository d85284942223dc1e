"""Draws one frame of every path of a study on one picture: the fastest way to see its content.

Run it with `python examples/contact_sheet.py [STUDY [PICTURE [MOMENT]]]`; it needs OpenCV. Each
frame shows the path's first scene, by default at the ego's decision.
"""

import sys
from pathlib import Path

import cv2
import numpy as np

from oodscen import Study
from oodscen.errors import OodscenError

TILE = (320, 240)
LABEL = 22
COLUMNS = 6


def tile(file: Path, label: str) -> np.ndarray:
    """Return a frame with its label below."""
    read = cv2.imread(str(file))
    if read is None:
        raise OSError(f"{file} is missing or no picture")
    frame = cv2.resize(read, TILE, interpolation=cv2.INTER_AREA)
    strip = np.full((LABEL, TILE[0], 3), 255, np.uint8)
    text = label if len(label) <= 50 else label[:48] + " ..."
    cv2.putText(strip, text, (4, 15), cv2.FONT_HERSHEY_SIMPLEX, 0.38, (0, 0, 0), 1, cv2.LINE_AA)
    return np.vstack([frame, strip])


def main(folder: str = "out", picture: str = "contact_sheet.jpg", moment: str = "last") -> None:
    """Draw the contact sheet."""
    study = Study.open(folder)
    paths = {scenario.id: scenario.path for scenario in study.scenarios}
    seen, tiles, moments = set(), [], dict[str, None]()
    for episode in study.episodes:
        path = paths.get(episode.scene_id)
        moments |= dict.fromkeys(episode.frames)
        if path is not None and path not in seen and moment in episode.frames:
            seen.add(path)
            tiles.append(tile(Path(folder) / episode.frames[moment], path[-1]))
    if not tiles:
        raise OSError(f"no frame of {moment!r} in {folder}; it has {', '.join(moments) or 'none'}")
    blank = np.full((TILE[1] + LABEL, TILE[0], 3), 255, np.uint8)
    tiles += [blank] * (-len(tiles) % COLUMNS)
    rows = [np.hstack(tiles[i : i + COLUMNS]) for i in range(0, len(tiles), COLUMNS)]
    if not cv2.haveImageWriter(picture):
        raise OSError(f"{picture} has no suffix of a picture, such as .jpg or .png")
    is_jpeg = picture.lower().endswith((".jpg", ".jpeg"))
    options = [cv2.IMWRITE_JPEG_QUALITY, 80] if is_jpeg else []
    if not cv2.imwrite(picture, np.vstack(rows), options):
        raise OSError(f"{picture} cannot be written; is its folder there?")
    print(f"{len(seen)} paths on {picture}")


if __name__ == "__main__":
    try:
        main(*sys.argv[1:4])
    except (OodscenError, OSError) as error:
        sys.exit(f"contact_sheet: {error}")
