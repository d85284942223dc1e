"""The plain facts of an item that a shortcut may use: distances, counts, pixels, colours, sizes of files."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from oodscen.data._bird_sketch import Sketch
from oodscen.data._episode import Episode
from oodscen.data._pairing import scene_of
from oodscen.data._scene import Scene
from oodscen.errors import MissingExtra
from oodscen.statistics._intervals import Floats

FAR_M = 1_000.0
"""The distance of the nearest body where there is none, m."""
NEAR_M = 40.0
"""The distance of the fixed rule, m."""
_HALF_LANE_M = 1.75
THUMBNAIL = (16, 12)
"""Columns and rows."""


def lane_distance(drawn: Sketch | None) -> float:
    """Return the distance to the nearest body ahead whose middle is in the ego's lane, m."""
    if drawn is None or "ego" not in drawn.bodies:
        return FAR_M
    right, left = -_HALF_LANE_M, _HALF_LANE_M
    for lane in drawn.lanes:
        if lane.kind == "driving" and lane.right <= 0.0 <= lane.left:
            right, left = lane.right, lane.left
    ahead = [
        body.x
        for name, body in drawn.bodies.items()
        if name != "ego" and body.x > 0.0 and right <= body.y <= left
    ]
    return min(ahead, default=FAR_M)


def swept_distance(drawn: Sketch | None) -> float:
    """Return the distance to the nearest body ahead that reaches into the strip that the ego would sweep, m."""
    if drawn is None or "ego" not in drawn.bodies:
        return FAR_M
    half = drawn.bodies["ego"].width / 2
    ahead = []
    for name, body in drawn.bodies.items():
        turn = math.radians(body.heading_deg)
        reach = (abs(math.sin(turn)) * body.length + abs(math.cos(turn)) * body.width) / 2
        if name != "ego" and body.x > 0.0 and abs(body.y) - reach < half:
            ahead.append(body.x)
    return min(ahead, default=FAR_M)


def nearest_places(drawn: Sketch | None) -> list[float]:
    """Return how far ahead and to the left the middles of the three nearest bodies ahead are: 6 numbers, m."""
    ahead = sorted(
        (body.x, body.y)
        for name, body in (drawn.bodies.items() if drawn else ())
        if name != "ego" and body.x > 0.0
    )
    found = [*ahead, *3 * [(FAR_M, 0.0)]][:3]
    return [number for place in found for number in place]


def keeping_fails(episode: Episode) -> float:
    """Return 1 if keeping the speed is unsafe, 0 if it is safe, and 0.5 otherwise."""
    outcome = episode.actions.get("keep_speed")
    if outcome is None:
        return 0.5
    return 0.0 if outcome.safe else 1.0 if outcome.is_unsafe else 0.5


def ground_truth(episodes: Sequence[Episode]) -> dict[str, Floats]:
    """Return the facts about bodies that the simulator knows, by name: [n] each."""
    seen = [episode.visible.get("last", {}) for episode in episodes]
    lane = [lane_distance(one.sketch) for one in episodes]
    rows = {
        "body in the lane within 40 m": [far <= NEAR_M for far in lane],
        "body in the lane within d": [-far for far in lane],
        "body in the swept strip within d": [-swept_distance(one.sketch) for one in episodes],
        "number of actors": [len(one.sketch.bodies) - 1 if one.sketch else 0 for one in episodes],
        "number of visible actors": [len(one) for one in seen],
        "pixels of visible actors": [sum(one.values()) for one in seen],
    }
    return {name: np.array(values, np.float64) for name, values in rows.items()}


def settings(episodes: Sequence[Episode], scenes: Mapping[str, Scene]) -> dict[str, Floats]:
    """Return the map and the weather of the items as numbers: [n, k] each; zeros where a scene is not known.

    The weather of an ordinary drive is that of the ordinary road.
    """
    known = [scenes.get(scene_of(episode.scene_id)) for episode in episodes]
    maps = sorted({one.map for one in known if one})
    weather = []
    for one, scene in zip(episodes, known, strict=True):
        own = None
        if scene is not None:
            calm = scene.hazard.weather
            own = scene.weather if one.scene_id == scene.id or calm is None else calm
        numbers = own.model_dump() if own else {}
        weather.append(
            {key: float(value) for key, value in numbers.items() if isinstance(value, int | float)}
        )
    keys = sorted({key for row in weather for key in row})
    return {
        "map": np.array(
            [[float(one is not None and one.map == name) for name in maps] for one in known]
        ).reshape(len(known), -1),
        "weather": np.array([[row.get(key, 0.0) for key in keys] for row in weather]).reshape(
            len(known), -1
        ),
    }


def pictures(files: Sequence[Path]) -> dict[str, Floats]:
    """Return thumbnails, colour statistics and sizes of picture files: [n, k] each; zeros if unreadable.

    Raises:
        MissingExtra: If OpenCV is not installed.
    """
    try:
        import cv2
    except ImportError:
        raise MissingExtra("the audit", "pybullet", "opencv-python-headless") from None
    small: list[NDArray[np.float64]] = []
    colours: list[NDArray[np.float64]] = []
    sizes = []
    for file in files:
        image = cv2.imread(str(file), cv2.IMREAD_REDUCED_COLOR_4) if file.is_file() else None
        sizes.append(float(file.stat().st_size) if image is not None else 0.0)
        if image is None:
            small.append(np.zeros(THUMBNAIL[0] * THUMBNAIL[1] * 3))
            colours.append(np.zeros(12))
            continue
        thumbnail = cv2.resize(image, THUMBNAIL, interpolation=cv2.INTER_AREA)
        small.append(thumbnail.astype(np.float64).ravel() / 255)
        hue = cv2.cvtColor(image, cv2.COLOR_BGR2HSV).astype(np.float64).reshape(-1, 3)
        flat = image.astype(np.float64).reshape(-1, 3)
        colours.append(
            np.concatenate([f(x, axis=0) for x in (flat, hue) for f in (np.mean, np.std)])
        )
    return {
        "thumbnails": np.array(small),
        "colour statistics": np.array(colours),
        "size of the JPEG file": np.array(sizes)[:, None],
    }
