"""The plain facts of an item that a shortcut may use: distances, counts, pixels, colours, sizes of files."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

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


def lane_distance(sketch: Sketch | None) -> float:
    """Return the distance to the nearest body ahead whose middle is in the ego's lane, m."""
    if sketch is None or "ego" not in sketch.bodies:
        return FAR_M
    right, left = -_HALF_LANE_M, _HALF_LANE_M
    for lane in sketch.lanes:
        if lane.kind == "driving" and lane.right <= 0.0 <= lane.left:
            right, left = lane.right, lane.left
    ahead = [
        body.x
        for name, body in sketch.bodies.items()
        if name != "ego" and body.x > 0.0 and right <= body.y <= left
    ]
    return min(ahead, default=FAR_M)


def swept_distance(sketch: Sketch | None) -> float:
    """Return the distance to the nearest body ahead that reaches into the strip that the ego would sweep, m."""
    if sketch is None or "ego" not in sketch.bodies:
        return FAR_M
    half_width = sketch.bodies["ego"].width / 2
    ahead = []
    for name, body in sketch.bodies.items():
        heading = math.radians(body.heading_deg)
        reach = (abs(math.sin(heading)) * body.length + abs(math.cos(heading)) * body.width) / 2
        if name != "ego" and body.x > 0.0 and abs(body.y) - reach < half_width:
            ahead.append(body.x)
    return min(ahead, default=FAR_M)


def nearest_places(sketch: Sketch | None) -> list[float]:
    """Return how far ahead and to the left the middles of the three nearest bodies ahead are: 6 numbers, m."""
    bodies = sketch.bodies if sketch else {}
    ahead = sorted(
        (body.x, body.y) for name, body in bodies.items() if name != "ego" and body.x > 0.0
    )
    nearest = [*ahead, *3 * [(FAR_M, 0.0)]][:3]
    return [coordinate for place in nearest for coordinate in place]


def keeping_fails(episode: Episode) -> float:
    """Return 1 if keeping the speed is unsafe, 0 if it is safe, and 0.5 otherwise."""
    outcome = episode.actions.get("keep_speed")
    if outcome is None:
        return 0.5
    if outcome.safe:
        return 0.0
    return 1.0 if outcome.is_unsafe else 0.5


def ground_truth(episodes: Sequence[Episode]) -> dict[str, Floats]:
    """Return the facts about bodies that the simulator knows, by name: [n] each."""
    sketches = [episode.sketch for episode in episodes]
    pixels = [episode.visible.get("last", {}) for episode in episodes]
    distances = [lane_distance(sketch) for sketch in sketches]
    facts = {
        "body in the lane within 40 m": [distance <= NEAR_M for distance in distances],
        "body in the lane within d": [-distance for distance in distances],
        "body in the swept strip within d": [-swept_distance(sketch) for sketch in sketches],
        "number of actors": [len(sketch.bodies) - 1 if sketch else 0 for sketch in sketches],
        "number of visible actors": [len(by_actor) for by_actor in pixels],
        "pixels of visible actors": [sum(by_actor.values()) for by_actor in pixels],
    }
    return {name: np.array(values, np.float64) for name, values in facts.items()}


def settings(episodes: Sequence[Episode], scenes: Mapping[str, Scene]) -> dict[str, Floats]:
    """Return the map and the weather of the items as numbers: [n, k] each; zeros where a scene is not known.

    The weather of an ordinary drive is that of the ordinary road.
    """
    staged = [scenes.get(scene_of(episode.scene_id)) for episode in episodes]
    maps = sorted({scene.map for scene in staged if scene})
    is_on_map = [[scene is not None and scene.map == name for name in maps] for scene in staged]
    weather = [_weather(*pair) for pair in zip(episodes, staged, strict=True)]
    fields = sorted({field for numbers in weather for field in numbers})
    weather_rows = [[numbers.get(field, 0.0) for field in fields] for numbers in weather]
    return {
        "map": np.array(is_on_map, np.float64).reshape(len(staged), -1),
        "weather": np.array(weather_rows, np.float64).reshape(len(staged), -1),
    }


def _weather(episode: Episode, scene: Scene | None) -> dict[str, float]:
    """Return the numbers of the weather of an episode; empty if its scene is not known."""
    if scene is None:
        return {}
    weather = scene.weather
    if episode.scene_id != scene.id and scene.hazard.weather is not None:
        weather = scene.hazard.weather
    numbers = weather.model_dump().items()
    return {field: float(value) for field, value in numbers if isinstance(value, int | float)}


def pictures(files: Sequence[Path]) -> dict[str, Floats]:
    """Return thumbnails, colour statistics and sizes of picture files: [n, k] each; zeros if unreadable.

    Raises:
        MissingExtra: If OpenCV is not installed.
    """
    try:
        import cv2
    except ImportError:
        raise MissingExtra("the audit", "pybullet", "opencv-python-headless") from None
    thumbnails: list[Floats] = []
    colours: list[Floats] = []
    sizes = []
    for file in files:
        image = cv2.imread(str(file), cv2.IMREAD_REDUCED_COLOR_4) if file.is_file() else None
        sizes.append(float(file.stat().st_size) if image is not None else 0.0)
        if image is None:
            thumbnails.append(np.zeros(THUMBNAIL[0] * THUMBNAIL[1] * 3))
            colours.append(np.zeros(12))
            continue
        thumbnail = cv2.resize(image, THUMBNAIL, interpolation=cv2.INTER_AREA)
        thumbnails.append(thumbnail.astype(np.float64).ravel() / 255)
        bgr = image.astype(np.float64).reshape(-1, 3)
        hsv = cv2.cvtColor(image, cv2.COLOR_BGR2HSV).astype(np.float64).reshape(-1, 3)
        statistics = (bgr.mean(axis=0), bgr.std(axis=0), hsv.mean(axis=0), hsv.std(axis=0))
        colours.append(np.concatenate(statistics))
    return {
        "thumbnails": np.array(thumbnails),
        "colour statistics": np.array(colours),
        "size of the JPEG file": np.array(sizes)[:, None],
    }
