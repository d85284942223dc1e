"""Draws maps from above, for the documentation.

Run `python -m tools.maps.picture [FOLDER]` to write one PNG per shipped map; without a folder they go
to `docs/pictures/maps` in the working directory.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor, LaneStrip
from oodscen.driving.maps._shipped import SHIPPED_MAPS

_PIXELS_PER_M = 3.2
_BEHIND, _AHEAD, _ASIDE = 40.0, 220.0, 48.0
"""Area drawn around the ego's start, m."""
_GROUND = (196, 212, 186)
_COLOURS = {
    "driving": (96, 96, 100),
    "shoulder": (128, 126, 122),
    "parking": (112, 112, 120),
    "sidewalk": (188, 184, 178),
    "median": (170, 176, 150),
    "border": (170, 194, 150),
    "rail": (140, 118, 96),
    "none": (150, 150, 150),
}
_BENEATH = ("none", "border", "median", "sidewalk", "parking", "shoulder", "driving", "rail")
"""Painting order of strip kinds, because roads overlap in junctions."""
_WHITE = (245, 245, 245)
_EGO = (214, 60, 48)


def draw_map(corridor: Corridor) -> NDArray[np.uint8]:
    """Return a picture from above, with the ego's start on the left and its route to the right.

    Args:
        corridor: The ego's road with its surroundings.

    Returns:
        [height, width, 3] RGB.
    """
    return _Drawing(corridor).picture


class _Drawing:
    def __init__(self, corridor: Corridor) -> None:
        x, y, _, heading = corridor.point(corridor.start, 0.0)
        self.origin = (x, y, float(np.cos(heading)), float(np.sin(heading)))
        size = round(2 * _ASIDE * _PIXELS_PER_M), round((_BEHIND + _AHEAD) * _PIXELS_PER_M)
        self.picture = np.empty((*size, 3), dtype=np.uint8)
        self.picture[:] = _GROUND
        roads = [*(other.corridor for other in corridor.others), corridor]
        for kind in _BENEATH:
            for road in roads:
                for strip in road.strips:
                    if strip.kind == kind:
                        self._strip(road, strip)
        for road in [*(o.corridor for o in corridor.others if not o.is_connecting), corridor]:
            self._marks(road)
        for outline in corridor.crosswalks:
            self._fill(outline.points, _WHITE if outline.kind == "stop_line" else (214, 214, 206))
        for structure in corridor.structures:
            self._structure(corridor, structure.start, structure.end)
        for signal in corridor.signals:
            colour = (40, 150, 70) if signal.kind == "traffic_light" else (200, 40, 40)
            self._dot(signal.x, signal.y, 4, colour)
        self._ego(corridor)

    def _pixels(self, points: NDArray[np.float64]) -> NDArray[np.int32]:
        """Return pixel coordinates with four fractional bits."""
        x0, y0, cos, sin = self.origin
        dx, dy = points[:, 0] - x0, points[:, 1] - y0
        ahead, left = dx * cos + dy * sin, dy * cos - dx * sin
        column, row = (ahead + _BEHIND) * _PIXELS_PER_M, (_ASIDE - left) * _PIXELS_PER_M
        return np.round(np.stack([column, row], axis=1) * 16.0).astype(np.int32)

    def _fill(self, points: NDArray[np.float64], colour: tuple[int, int, int]) -> None:
        cv2.fillPoly(self.picture, [self._pixels(points)], colour, cv2.LINE_AA, 4)

    def _line(self, points: NDArray[np.float64], colour: tuple[int, int, int], width: int) -> None:
        self._lines([self._pixels(points)], colour, width)

    def _lines(
        self, lines: list[NDArray[np.int32]], colour: tuple[int, int, int], width: int = 1
    ) -> None:
        cv2.polylines(self.picture, lines, False, colour, width, cv2.LINE_AA, 4)

    def _dot(self, x: float, y: float, radius: int, colour: tuple[int, int, int]) -> None:
        centre = self._pixels(np.array([[x, y]]))[0].tolist()
        cv2.circle(self.picture, centre, 16 * radius, colour, -1, cv2.LINE_AA, 4)

    def _strip(self, road: Corridor, strip: LaneStrip) -> None:
        right, left = (self._pixels(_offset(road, t)) for t in (strip.right, strip.left))
        wide = strip.left - strip.right > 0.01
        for index in np.flatnonzero(wide[:-1] & wide[1:] & self._is_shown(right)).tolist():
            corners = np.concatenate([right[index : index + 2], left[index : index + 2][::-1]])
            cv2.fillPoly(self.picture, [corners], _COLOURS[strip.kind], 8, 4)

    def _is_shown(self, pixels: NDArray[np.int32]) -> NDArray[np.bool_]:
        """Return which pieces of a line, [n - 1], can reach the picture with a wide strip."""
        reach = 200.0 * _PIXELS_PER_M
        height, width = self.picture.shape[:2]
        size = np.array([width, height])
        near = np.abs(pixels / 16.0 - 0.5 * size) < size + reach
        return np.asarray(near.all(axis=1)[1:])

    def _marks(self, road: Corridor) -> None:
        for strip in road.strips:
            exists = ~road.in_junction & (strip.left - strip.right > 0.01)
            shown = np.zeros(len(road.s), dtype=np.bool_)
            rows = strip.mark_changes or ((0.0, strip.mark, strip.right_mark),)
            ends = [row[0] for row in rows[1:]] + [road.length + 1.0]
            for (begin, mark, _), end in zip(rows, ends, strict=True):
                here = exists & (road.s >= begin) & (road.s < end)
                if mark == "broken":
                    here &= road.s % 12.0 < 6.0
                if mark in ("solid", "broken"):
                    shown |= here
            line = self._pixels(_offset(road, strip.left))
            pieces = np.flatnonzero(shown[:-1] & shown[1:] & self._is_shown(line)).tolist()
            self._lines([line[index : index + 2] for index in pieces], _WHITE)

    def _structure(self, corridor: Corridor, start: float, end: float) -> None:
        inside = (corridor.s >= start) & (corridor.s <= end)
        for strip in (corridor.strips[0].right, corridor.strips[-1].left):
            self._line(_offset(corridor, strip)[inside], (70, 60, 60), 4)

    def _ego(self, corridor: Corridor) -> None:
        strip = corridor.ego_lanes[-1]
        places = np.arange(corridor.start, min(corridor.start + _AHEAD, corridor.length), 1.0)
        route = [corridor.point(s, corridor.centre(strip, s))[:2] for s in places.tolist()]
        self._line(np.array(route), _EGO, 2)
        x, y, _, _ = corridor.point(corridor.start, corridor.centre(strip, corridor.start))
        self._dot(x, y, 6, _EGO)


def _offset(road: Corridor, t: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points at an offset from a road's reference line, [n, 2]."""
    return np.stack([road.x - t * road.sin, road.y + t * road.cos], axis=1)


def main(arguments: Sequence[str]) -> None:
    """Draw all shipped maps into a folder."""
    if len(arguments) > 1 or any(argument.startswith("-") for argument in arguments):
        sys.exit("usage: python -m tools.maps.picture [FOLDER]")
    folder = Path(arguments[0]) if arguments else Path("docs/pictures/maps")
    folder.mkdir(parents=True, exist_ok=True)
    for road_map in SHIPPED_MAPS:
        picture = draw_map(load_corridor(road_map))
        cv2.imwrite(str(folder / f"{road_map.id}.png"), picture[..., ::-1])


if __name__ == "__main__":
    main(sys.argv[1:])
