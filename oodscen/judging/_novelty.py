"""Novelty of pictures among the ordinary ones, by classical vision."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from oodscen.data._pairing import is_ordinary, scene_of
from oodscen.errors import MissingExtra

Features = NDArray[np.float64]

_GRID = (6, 8)
"""Rows and columns of cells."""
_NEAREST = 5
"""Most ordinary pictures to which a distance is measured."""


def novelty_ranks(pictures: Mapping[str, Path], maps: Mapping[str, str]) -> dict[str, float]:
    """Return the share of ordinary pictures with less novelty than each, by scene id.

    Novelty is the distance to the nearest ordinary pictures on *other maps*, so that the scene, its twin and its
    street are all unseen; where only one map has ordinary pictures, to those of other scenes. What has no map or no
    file is left out.

    Args:
        pictures: Files by scene id, of scenes and twins.
        maps: Map by scene id.

    Raises:
        MissingExtra: If OpenCV is not installed.
    """
    names = [name for name, file in pictures.items() if name in maps and file.is_file()]
    if not names:
        return {}
    rows = np.array([features(pictures[name]) for name in names])
    ordinary = np.array([is_ordinary(name) for name in names])
    groups = np.array([maps[name] for name in names])
    if len(set(groups[ordinary])) < 2:
        groups = np.array([scene_of(name) for name in names])
    novelty = _novelty(rows, groups, ordinary)
    usual = np.sort(novelty[ordinary] if ordinary.any() else novelty)
    below = np.searchsorted(usual, novelty, side="left")
    up_to = np.searchsorted(usual, novelty, side="right")
    shares = 0.5 * (below + up_to) / len(usual)
    return dict(zip(names, shares.tolist(), strict=True))


def features(picture: Path) -> Features:
    """Return the features of a picture file: [cells x 9] means, spreads and edge strengths in Lab colours.

    They are 0 if it is no picture, or one of less than eight rows or columns.

    Raises:
        MissingExtra: If OpenCV is not installed.
    """
    try:
        import cv2
    except ImportError:
        raise MissingExtra("the novelty detector", "pybullet", "opencv-python-headless") from None
    try:
        image = cv2.imread(str(picture), cv2.IMREAD_REDUCED_COLOR_4)
    except cv2.error:  # No row or column would be left.
        image = None
    if image is None or min(image.shape[:2]) < 2:
        return np.zeros(_GRID[0] * _GRID[1] * 9)
    lab = cv2.cvtColor(image, cv2.COLOR_BGR2LAB).astype(np.float32)
    edges = np.abs(lab[1:, 1:] - lab[:-1, 1:]) + np.abs(lab[1:, 1:] - lab[1:, :-1])
    mean, square, edge = (
        cv2.resize(values, _GRID[::-1], interpolation=cv2.INTER_AREA)
        for values in (lab, lab * lab, edges)
    )
    spread = np.sqrt(np.maximum(square - mean * mean, 0.0))
    return np.concatenate([part.ravel() for part in (mean, spread, edge)]).astype(np.float64)


def _novelty(rows: Features, groups: NDArray[np.str_], ordinary: NDArray[np.bool_]) -> Features:
    """Return the [n] distances of pictures to the nearest ordinary ones of other groups; 0 without any."""
    novelty = np.zeros(len(rows))
    for group in np.unique(groups):
        is_here = groups == group
        others = ordinary & ~is_here
        if others.any():
            novelty[is_here] = _distances(rows[is_here], rows[others])
    return novelty


def _distances(rows: Features, ordinary: Features) -> Features:
    """Return the mean distance to the nearest ordinary rows, with features scaled by their spread."""
    scale = ordinary.std(axis=0) + 1.0
    a, b = rows / scale, ordinary / scale
    square = (a * a).sum(axis=1)[:, None] + (b * b).sum(axis=1)[None] - 2.0 * a @ b.T
    near = np.sort(np.maximum(square, 0.0), axis=1)[:, :_NEAREST]
    mean: Features = np.round(np.sqrt(near).mean(axis=1), 6)
    return mean
