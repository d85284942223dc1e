"""Draws scenes of a study above their ordinary twins, at the decision, as the site's first picture.

`python -m tools.frame_strip STUDY SCENE...` writes `docs/pictures/strip.jpg`; the study must have
been run with the PyBullet adapter.
"""

import sys
from pathlib import Path

import cv2
import numpy as np

from oodscen import Study

PICTURE = Path(__file__).parents[1] / "docs" / "pictures" / "strip.jpg"
TILE = (320, 240)
GAP = 4


def frame(study: Study, episode_id: str) -> np.ndarray:
    """Return the last frame before the decision, reduced to a tile with a white margin."""
    episode = next(episode for episode in study.episodes if episode.id == episode_id)
    picture = cv2.imread(str(Path(study.folder) / episode.frames["last"]))
    reduced = cv2.resize(picture, TILE, interpolation=cv2.INTER_AREA)
    return cv2.copyMakeBorder(reduced, 0, GAP, 0, GAP, cv2.BORDER_CONSTANT, value=(255,) * 3)


def draw(study: Study, scenes: list[str]) -> np.ndarray:
    """Return the scenes in a row, and each one's twin below it."""
    above = np.hstack([frame(study, scene) for scene in scenes])
    below = np.hstack([frame(study, f"{scene}~twin") for scene in scenes])
    return np.vstack([above, below])[:-GAP, :-GAP]


if __name__ == "__main__":
    strip = draw(Study.open(sys.argv[1]), sys.argv[2:])
    cv2.imwrite(str(PICTURE), strip, [cv2.IMWRITE_JPEG_QUALITY, 72])
    print(f"{PICTURE}: {PICTURE.stat().st_size} bytes")
