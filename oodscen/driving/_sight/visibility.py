"""Visibility of boxes from a camera on the ego, computed without rendering."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

from oodscen.data._weather import Weather
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._sight.outlines import Outline, Pixel, area, clipped, hull
from oodscen.driving._sight.weather import visual_range
from oodscen.protocols import Camera

LEAST_AREA_PX = 60.0
"""Minimum silhouette for recognition, square pixels at 640 x 480."""
_FROM_ABOVE = 0.15
"""Share of a minimum that is enough from above, where a body is a mark in a plan."""
MOST_HIDDEN = 0.8
"""Hidden share of a silhouette from which a body is no longer recognised."""

_GRIDS = (6, 24, 96)
"""Numbers of sight lines per direction around a silhouette; a finer grid is for one that the others miss."""
NEAR_M = 0.1
"""Closest distance that a camera shows, m."""
_CREST_SHARES = (0.2, 0.35, 0.5, 0.65, 0.8, 0.92)
"""Shares of the distance to a body at which the road may rise above a sight line."""
_CREST_M = 0.05
"""Height of the road above a sight line from which it blocks the sight, m."""
_EDGES = tuple((i, i | bit) for i in range(8) for bit in (1, 2, 4) if not i & bit)
"""Edges of a box, as pairs of indices into `UprightBox.corners`."""

_PARALLEL = 1e-12
"""Component of a ray below which it does not meet the faces across that axis."""

Point = tuple[float, float, float]


@dataclass(frozen=True)
class UprightBox:
    """A body as an upright box."""

    x: float
    y: float
    z: float
    """Height of its underside, m."""
    yaw: float
    length: float
    width: float
    height: float

    def corners(self) -> list[Point]:
        """Return the box's eight corners."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        return [
            (
                self.x + a * self.length * cos - b * self.width * sin,
                self.y + a * self.length * sin + b * self.width * cos,
                self.z + c * self.height,
            )
            for a in (-0.5, 0.5)
            for b in (-0.5, 0.5)
            for c in (0.0, 1.0)
        ]

    def local(self, point: Point) -> Point:
        """Return a point in the box's own axes, with the origin in the middle of its underside."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        dx, dy = point[0] - self.x, point[1] - self.y
        return dx * cos + dy * sin, dy * cos - dx * sin, point[2] - self.z


def least_area(pixels: float, camera: Camera) -> float:
    """Return the area that a minimum for a driver's view of 640 x 480 pixels is in the pictures of a camera."""
    share = _FROM_ABOVE if camera.pitch_deg == 90.0 else 1.0
    return share * pixels * camera.width * camera.height / (640 * 480)


@dataclass(frozen=True)
class Sight:
    """The appearance of one body in a picture."""

    area_px: float
    """Area of its silhouette inside the picture, square pixels; 0 outside."""
    distance: float
    """Distance from the camera, m."""
    hidden: float
    """Share of the silhouette behind other bodies or a crest, 0 to 1."""
    is_behind: bool = False
    """True if it is outside the picture and behind the ego."""

    def fault(self, weather: Weather, camera: Camera) -> str | None:
        """Return why the body cannot be recognised, or `None` if it can."""
        if self.area_px <= 0.0:
            return "it is behind the ego" if self.is_behind else "it is outside the camera's view"
        reach = visual_range(weather)
        if self.distance > reach:
            return f"it is {self.distance:.0f} m away, and the visual range is {reach:.0f} m"
        if self.area_px < least_area(LEAST_AREA_PX, camera):
            return f"it covers {self.area_px:.0f} square pixels only, {self.distance:.0f} m away"
        if self.hidden > MOST_HIDDEN:
            return f"{100.0 * self.hidden:.0f} % of it is hidden"
        return None


class Eye:
    """A camera at a position in the world."""

    def __init__(self, camera: Camera, ego: UprightBox) -> None:
        """Mount a camera on the ego."""
        cos, sin = math.cos(ego.yaw), math.sin(ego.yaw)
        pitch, turn = math.radians(camera.pitch_deg), ego.yaw + math.radians(camera.yaw_deg)
        down, level = math.sin(pitch), math.cos(pitch)
        self.camera, self.ego = camera, ego
        self.focal = 0.5 * camera.width / math.tan(0.5 * math.radians(camera.fov_deg))
        self.place: Point = (
            ego.x + camera.x * cos - camera.y * sin,
            ego.y + camera.x * sin + camera.y * cos,
            ego.z + camera.z,
        )
        cos, sin = math.cos(turn), math.sin(turn)
        self.forward = (cos * level, sin * level, -down)
        self.right = (sin, -cos, 0.0)
        self.down = (-cos * down, -sin * down, -level)

    def to_camera(self, point: Point) -> Point:
        """Return a point in camera coordinates: metres to the right, down and ahead."""
        d = [a - b for a, b in zip(point, self.place, strict=True)]
        across, below, ahead = (
            sum(a * b for a, b in zip(d, axis, strict=True))
            for axis in (self.right, self.down, self.forward)
        )
        return across, below, ahead

    def silhouette(self, body: UprightBox) -> list[Pixel]:
        """Return the outline of a box in the picture plane, not clipped; empty behind the camera."""
        corners = [self.to_camera(corner) for corner in body.corners()]
        points = [corner for corner in corners if corner[2] >= NEAR_M]
        if len(points) < len(corners):
            points += [cut for i, j in _EDGES if (cut := _cut(corners[i], corners[j])) is not None]
        width, height, focal = self.camera.width, self.camera.height, self.focal
        return hull(
            [(0.5 * width + focal * x / z, 0.5 * height + focal * y / z) for x, y, z in points]
        )

    def distance(self, body: UprightBox) -> float:
        """Return the distance from the camera to the middle of a body, m."""
        return math.dist(self.place, (body.x, body.y, body.z + 0.5 * body.height))

    def see(
        self, body: UprightBox, others: Sequence[UprightBox], road: Corridor | None = None
    ) -> Sight:
        """Return the appearance of one body.

        Args:
            body: The body to look for.
            others: Bodies that may hide it, without the ego and the body itself.
            road: The road whose crest may hide it.
        """
        outline = self.silhouette(body)
        distance = self.distance(body)
        shown = clipped(outline, self.camera.width, self.camera.height)
        size = area(shown)
        if size <= 0.0:
            is_behind = self.ego.local((body.x, body.y, body.z))[0] < 0.0
            return Sight(0.0, distance, 0.0, is_behind)
        return Sight(size, distance, self._hidden(body, shown, others, road))

    def _hidden(
        self,
        body: UprightBox,
        shown: Outline,
        others: Sequence[UprightBox],
        road: Corridor | None,
    ) -> float:
        """Return the share of the rays to a body's silhouette that other bodies or a crest block."""
        own = _Faces.of(body, self.place)
        obstacles = [_Faces.of(box, self.place) for box in others]
        lowest = min(self.place[2], body.z)
        if road is not None and lowest >= float(road.z.max()) - 0.5 * _CREST_M:
            road = None  # No sight line to the body runs below the highest point of the road.
        blocked = [
            any((entry := box.entry(ray)) is not None and entry < hit for box in obstacles)
            or (road is not None and _is_behind_crest(self.place, ray, hit, road))
            for ray, hit in self._sight_lines(own, shown)
        ]
        return sum(blocked) / len(blocked) if blocked else 1.0

    def _sight_lines(self, own: "_Faces", shown: Outline) -> list[tuple[Point, float]]:
        """Return rays to a body and the distances along them, from a grid fine enough to meet its silhouette."""
        left, right = min(u for u, _ in shown), max(u for u, _ in shown)
        top, bottom = min(v for _, v in shown), max(v for _, v in shown)
        lines: list[tuple[Point, float]] = []
        for grid in _GRIDS:
            for i, j in product(range(grid), range(grid)):
                u = left + (right - left) * (i + 0.5) / grid
                v = top + (bottom - top) * (j + 0.5) / grid
                ray = self._ray(u, v)
                hit = own.entry(ray)
                if hit is not None:
                    lines.append((ray, hit))
            if lines:
                break
        return lines

    def _ray(self, u: float, v: float) -> Point:
        """Return the direction through a pixel, with unit length along the optical axis."""
        across = (u - 0.5 * self.camera.width) / self.focal
        below = (v - 0.5 * self.camera.height) / self.focal
        x, y, z = (
            a + across * b + below * c
            for a, b, c in zip(self.forward, self.right, self.down, strict=True)
        )
        return x, y, z


def _cut(a: Point, b: Point) -> Point | None:
    """Return the point where an edge crosses the near plane, or `None`."""
    if (a[2] >= NEAR_M) == (b[2] >= NEAR_M):
        return None
    f = (NEAR_M - a[2]) / (b[2] - a[2])
    return a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1]), NEAR_M


class _Faces(NamedTuple):
    """A box as rays from one point meet it, in the box's own axes."""

    cos: float
    sin: float
    start: Point
    """The point from which the rays come."""
    limits: tuple[tuple[float, float], ...]

    @classmethod
    def of(cls, body: UprightBox, origin: Point) -> "_Faces":
        return cls(
            math.cos(body.yaw),
            math.sin(body.yaw),
            body.local(origin),
            (
                (-0.5 * body.length, 0.5 * body.length),
                (-0.5 * body.width, 0.5 * body.width),
                (0.0, body.height),
            ),
        )

    def entry(self, ray: Point) -> float | None:
        """Return the distance along a ray to the box, or `None` if the ray misses it."""
        x, y, z = ray
        turned = (x * self.cos + y * self.sin, y * self.cos - x * self.sin, z)
        enter, leave = 0.0, math.inf
        for begin, speed, (low, high) in zip(self.start, turned, self.limits, strict=True):
            if abs(speed) < _PARALLEL:
                if not low <= begin <= high:
                    return None
                continue
            to_low, to_high = (low - begin) / speed, (high - begin) / speed
            if to_low > to_high:
                to_low, to_high = to_high, to_low
            enter, leave = max(enter, to_low), min(leave, to_high)
            if enter > leave:
                return None
        return enter


def _is_behind_crest(origin: Point, ray: Point, hit: float, road: Corridor) -> bool:
    """Return whether the road rises above a sight line before the hit."""
    near = None
    for share in _CREST_SHARES:
        x, y, z = (a + share * hit * b for a, b in zip(origin, ray, strict=True))
        s, t = road.locate(x, y, near)
        near = s
        if z < road.point(s, t)[2] - _CREST_M:
            return True
    return False
