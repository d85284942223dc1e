"""Bird's-eye views of states."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from oodscen._arguments import checked, state_of
from oodscen._display import png
from oodscen._numbers import finite_number, whole_number
from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import Scene
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._sight.scene_checks import PlacedBody, bodies
from oodscen.errors import MissingExtra
from oodscen.protocols import MAX_SIZE, State

Pixels = NDArray[np.uint8]
Colour = tuple[int, int, int]

SIZE = 480
"""Default side of a picture, pixels."""
_SPAN_M = 72.0
"""Default side of the ground that a picture shows, m."""
_AHEAD = 0.72
"""Share of a bird's-eye view that lies ahead of the ego."""
_GRASS: Colour = (108, 132, 92)
_GROUND: dict[str, Colour] = {
    "driving": (84, 86, 90),
    "shoulder": (100, 100, 100),
    "parking": (94, 92, 96),
    "sidewalk": (166, 163, 156),
    "median": (122, 124, 112),
}
_MARK: Colour = (236, 236, 230)
_OUTLINE: Colour = (24, 24, 26)
_EGO: Colour = (130, 183, 240)
_HAZARD: Colour = (232, 176, 74)
_HIT: Colour = (240, 110, 84)
_OTHER: Colour = (186, 191, 197)
"""Colours of bodies: those of the report's views from above in its dark theme."""
_CAPTION_PX = 30
"""Height of the band under the caption, pixels."""
_LEAST_M = 1.2
"""Least length and width at which a body is drawn, m."""
_FRACTION_BITS = 4
"""Bits of OpenCV's fixed-point coordinates that are fractions of pixels."""


class _Section:
    """A map section in image coordinates, with the ego heading upwards."""

    def __init__(self, ego: PlacedBody, size: int, span_m: float) -> None:
        self.size, self.scale = size, size / span_m
        self.x, self.y = ego.solid.x, ego.solid.y
        self.cos, self.sin = math.cos(ego.solid.yaw), math.sin(ego.solid.yaw)

    def pixels(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.int32]:
        """Return points in OpenCV's fixed-point format: [n, 2], 1/16 pixels."""
        dx, dy = x - self.x, y - self.y
        along, aside = dx * self.cos + dy * self.sin, dy * self.cos - dx * self.sin
        columns = 0.5 * self.size - aside * self.scale
        rows = _AHEAD * self.size - along * self.scale
        points = np.stack([columns, rows], axis=1)
        scale = float(1 << _FRACTION_BITS)
        return np.rint(np.clip(points, -9e3, 9e3) * scale).astype(np.int32)


@checked
def birds_eye(
    state: State,
    scene: Scene,
    catalogue: Catalogue,
    *,
    size: int = SIZE,
    span_m: float = _SPAN_M,
) -> "BirdsEye":
    """Draw the road and all actors from above; `Scene.birds_eye` tells arguments and errors."""
    size = whole_number("size", size, 1, MAX_SIZE)
    finite_number("span_m", span_m, 1.0, 10_000.0)
    state_of(scene, state)
    cv2 = opencv()
    cast = bodies(scene, catalogue, state.poses)
    corridor = load_corridor(scene.map, catalogue)
    picture = np.empty((size, size, 3), np.uint8)
    picture[:] = _GRASS
    section = _Section(cast[0], size, span_m)
    for other in corridor.others:
        _draw_road(cv2, picture, section, other.corridor, span_m, has_marks=not other.is_connecting)
    _draw_road(cv2, picture, section, corridor, span_m)
    for outline in corridor.crosswalks:
        points = section.pixels(outline.points[:, 0], outline.points[:, 1])
        cv2.fillPoly(picture, [points], _MARK, cv2.LINE_AA, _FRACTION_BITS)
    ego, *others = cast
    for body in [*sorted(others, key=lambda body: -body.solid.length), ego]:
        is_hazard = body.id in scene.hazard.actors
        colour = _EGO if body is ego else _OTHER
        if is_hazard:
            colour = _HAZARD
        if body.id in state.contacts:
            colour = _HIT
        _draw_body(cv2, picture, section, body, colour, colour if is_hazard else _OUTLINE)
    picture[-_CAPTION_PX:] = _OUTLINE
    corner, font = (10, size - 10), cv2.FONT_HERSHEY_SIMPLEX
    cv2.putText(picture, _caption(state), corner, font, 0.5, (255, 255, 255), 1, cv2.LINE_AA)
    return picture.view(BirdsEye)


def _caption(state: State) -> str:
    """Return time and speed, and what has gone wrong."""
    caption = f"{state.time:5.2f} s   {3.6 * float(state.speeds[0]):3.0f} km/h"
    if state.contacts:
        return f"{caption}   touches {', '.join(state.contacts)}"
    return f"{caption}   off the road" if state.off_road else caption


class BirdsEye(np.ndarray[Any, np.dtype[np.uint8]]):
    """An RGB picture that a notebook shows; otherwise a plain array."""

    def __repr__(self) -> str:
        return f"<picture: {self.dtype}{list(self.shape)}>"

    def _repr_png_(self) -> bytes | None:
        return png(self)


def _draw_road(
    cv2: Any,
    picture: Pixels,
    section: _Section,
    road: Corridor,
    span_m: float,
    *,
    has_marks: bool = True,
) -> None:
    """Draw a road's strips and, if `has_marks`, its lane marks outside junctions."""
    near = (road.x - section.x) ** 2 + (road.y - section.y) ** 2 < (1.5 * span_m) ** 2
    if not near.any():
        return
    for part in _runs(near):
        lines = []
        for number, strip in enumerate(road.strips):
            edges = [
                section.pixels(
                    road.x[part] - side[part] * road.sin[part],
                    road.y[part] + side[part] * road.cos[part],
                )
                for side in (strip.right, strip.left)
            ]
            if strip.kind in _GROUND:
                outline = np.concatenate([edges[0], edges[1][::-1]])
                cv2.fillPoly(picture, [outline], _GROUND[strip.kind], cv2.LINE_AA, _FRACTION_BITS)
            if not has_marks:
                continue
            exists = strip.left[part] - strip.right[part] > 0.5
            if len(road.in_junction) == len(road.s):
                exists &= ~road.in_junction[part]
            along = road.s[part]
            is_dash = along - 9.0 * np.floor(along / 9.0) < 3.0
            # Strips share their edges: only the first one's right mark is no other's left one.
            sides = (
                (edges[0], strip.right_mark if number == 0 else "none"),
                (edges[1], strip.mark),
            )
            for edge, mark in sides:
                if mark in ("solid", "broken"):
                    where = exists & is_dash if mark == "broken" else exists
                    lines += [edge[run] for run in _runs(where)]
        marks = [line for line in lines if len(line) > 1]
        cv2.polylines(picture, marks, False, _MARK, 1, cv2.LINE_AA, _FRACTION_BITS)


def _runs(holds: NDArray[np.bool_]) -> Sequence[slice]:
    """Return the runs of true values as slices."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], holds, [False]]).astype(np.int8)))
    return [slice(int(start), int(end)) for start, end in edges.reshape(-1, 2)]


def _draw_body(
    cv2: Any, picture: Pixels, section: _Section, body: PlacedBody, colour: Colour, edge: Colour
) -> None:
    """Draw a footprint with an arrow-head at its front; small bodies are enlarged."""
    solid = body.solid
    front, left = 0.5 * max(solid.length, _LEAST_M), 0.5 * max(solid.width, _LEAST_M)
    cos, sin = math.cos(solid.yaw), math.sin(solid.yaw)

    def pixels(points: Sequence[tuple[float, float]]) -> NDArray[np.int32]:
        x = np.array([solid.x + ahead * cos - aside * sin for ahead, aside in points])
        y = np.array([solid.y + ahead * sin + aside * cos for ahead, aside in points])
        return section.pixels(x, y)

    box = pixels([(front, left), (front, -left), (-front, -left), (-front, left)])
    width = 1 if edge == _OUTLINE else 2
    cv2.fillPoly(picture, [box], colour, cv2.LINE_AA, _FRACTION_BITS)
    cv2.polylines(picture, [box], True, edge, width, cv2.LINE_AA, _FRACTION_BITS)
    if solid.length >= _LEAST_M:
        tip = pixels([(front, 0.0), (0.4 * front, left), (0.4 * front, -left)])
        cv2.fillPoly(picture, [tip], _OUTLINE, cv2.LINE_AA, _FRACTION_BITS)


def opencv() -> Any:
    """Return the module `cv2`.

    Raises:
        MissingExtra: When it is not installed.
    """
    try:
        import cv2
    except ImportError:
        raise MissingExtra("drawing and videos", "pybullet", "opencv-python-headless") from None
    return cv2
