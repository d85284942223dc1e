"""The road's surface: strips, marks and kerbs, as one mesh along a corridor."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from oodscen.driving import Corridor, LaneStrip
from oodscen_pybullet.meshes.atlas import region_uv, swatch_uv
from oodscen_pybullet.meshes.builder import Mesh

Array = NDArray[np.float64]

STEP = 3.0
"""Length of one piece of road, m; also of one dash of a broken mark."""
KERB = 0.10
"""Height of pavements above the road, m."""
BEHIND = 60.0
"""How far the road is drawn behind the ego's start, m."""
SEEN_M, DRIVEN_S = 400.0, 30.0
"""It is drawn as far as one sees after driving at the speed limit for so long, m and s."""


@dataclass(frozen=True, eq=False)
class Course:
    """A corridor's line, resampled for drawing and continued straight beyond its end."""

    s: Array
    """[n], m, every `STEP`."""
    x: Array
    y: Array
    z: Array
    cos: Array
    sin: Array

    @classmethod
    def of(cls, corridor: Corridor) -> "Course":
        """Resample a corridor from behind the ego's start to where nobody sees further."""
        first = max(0.0, corridor.start - BEHIND)
        last = corridor.start + DRIVEN_S * corridor.speed_limit + SEEN_M
        count = int((last - first) / STEP)
        s: Array = first + STEP * np.arange(count + 1, dtype=np.float64)
        inside = np.minimum(s, corridor.length)
        cos, sin = (
            np.interp(inside, corridor.s, corridor.cos),
            np.interp(inside, corridor.s, corridor.sin),
        )
        beyond = s - inside
        return cls(
            s=s,
            x=np.interp(inside, corridor.s, corridor.x) + beyond * cos,
            y=np.interp(inside, corridor.s, corridor.y) + beyond * sin,
            z=np.interp(inside, corridor.s, corridor.z),
            cos=cos,
            sin=sin,
        )

    def points(self, t: Array | float, height: float = 0.0) -> Array:
        """Return the points at lateral offset `t`, [n, 3]."""
        return np.stack([self.x - t * self.sin, self.y + t * self.cos, self.z + height], axis=1)


class Ribbons:
    """Collects bands that run along a course."""

    def __init__(self, course: Course) -> None:
        self.course = course
        self._vertices: list[Array] = []
        self._normals: list[Array] = []
        self._uvs: list[Array] = []

    def band(
        self,
        right: Array | float,
        left: Array | float,
        surface: str,
        *,
        heights: tuple[float, float] = (0.0, 0.0),
        is_region: bool = False,
        dashes: tuple[int, int] | None = None,
        gap_surface: str = "",
    ) -> None:
        """Add a band between two offsets.

        Args:
            right: t of its right edge, m, along the course.
            left: t of its left edge.
            surface: A colour, or a region of the atlas that repeats on every piece.
            heights: Of the right and the left edge above the road, m.
            is_region: Whether `surface` is a region.
            dashes: Pieces painted, and pieces in a period; the others have `gap_surface`.
            gap_surface: Colour between dashes.
        """
        a, b = self.course.points(right, heights[0]), self.course.points(left, heights[1])
        quads = np.stack([a[:-1], a[1:], b[1:], b[:-1]], axis=1)
        count = len(quads)
        if is_region:
            uv = np.tile(region_uv(surface)[[0, 1, 2, 3]], (count, 1, 1))
        else:
            uv = np.tile(swatch_uv(surface), (count, 4, 1))
        if dashes is not None:
            painted, period = dashes
            pieces = np.round(self.course.s[:-1] / STEP).astype(int)
            uv[pieces % period >= painted] = swatch_uv(gap_surface)
        across, along = quads[:, 3] - quads[:, 0], quads[:, 1] - quads[:, 0]
        normal = np.cross(along, across)
        length = np.sqrt((normal * normal).sum(axis=1, keepdims=True))
        keep = length[:, 0] > 1e-9
        normal = normal / np.maximum(length, 1e-9)
        order = [0, 1, 2, 0, 2, 3]
        self._vertices.append(quads[keep][:, order].reshape(-1, 3))
        self._uvs.append(uv[keep][:, order].reshape(-1, 2))
        self._normals.append(np.repeat(normal[keep], 6, axis=0))

    def mesh(self) -> Mesh:
        """Return everything that was added."""
        vertices = np.concatenate(self._vertices)
        return Mesh(
            vertices=vertices,
            normals=np.concatenate(self._normals),
            uvs=np.concatenate(self._uvs),
            triangles=np.arange(len(vertices)).reshape(-1, 3),
        )


def strip_edges(corridor: Corridor, course: Course, strip: LaneStrip) -> tuple[Array, Array]:
    """Return t of a strip's right and left edge along a course."""
    return (
        np.interp(course.s, corridor.s, strip.right),
        np.interp(course.s, corridor.s, strip.left),
    )


def extents(corridor: Corridor, course: Course) -> tuple[Array, Array]:
    """Return t of the right and the left edge of the whole cross-section along a course."""
    return (
        strip_edges(corridor, course, corridor.strips[0])[0],
        strip_edges(corridor, course, corridor.strips[-1])[1],
    )


def lay_road(corridor: Corridor, ribbons: Ribbons, traits: frozenset[str]) -> None:
    """Add every strip of a corridor with its marks and kerbs."""
    course, strips = ribbons.course, corridor.strips
    edges = [strip_edges(corridor, course, strip) for strip in strips]
    marks = [_half_width(strips, index) for index in range(len(strips) + 1)]
    for index, strip in enumerate(strips):
        right, left = edges[index]
        right, left = right + marks[index], left - marks[index + 1]
        left = np.maximum(left, right)
        surface, is_region = _surface(strip, traits)
        height = _height(strip)
        ribbons.band(right, left, surface, heights=(height, height), is_region=is_region)
    for index in range(len(strips) + 1):
        half = marks[index]
        if half > 0.0:
            middle = edges[index][0] if index < len(strips) else edges[-1][1]
            _paint(ribbons, strips, index, middle, half)


def _mark(strips: tuple[LaneStrip, ...], index: int) -> str:
    """Return the mark on the boundary to the right of strip `index`."""
    return strips[0].right_mark if index == 0 else strips[index - 1].mark


def _half_width(strips: tuple[LaneStrip, ...], index: int) -> float:
    mark = _mark(strips, index)
    if mark == "none":
        return 0.0
    if mark == "curb":
        return 0.09
    return 0.20 if _is_double(strips, index) else 0.075


def _is_double(strips: tuple[LaneStrip, ...], index: int) -> bool:
    if not 0 < index < len(strips) or _mark(strips, index) != "solid":
        return False
    one, two = strips[index - 1], strips[index]
    return one.kind == two.kind == "driving" and one.direction != two.direction


def _paint(
    ribbons: Ribbons, strips: tuple[LaneStrip, ...], index: int, t: Array, half: float
) -> None:
    mark = _mark(strips, index)
    if mark == "curb":
        below = _height(strips[index - 1]) if index > 0 else 0.0
        above = _height(strips[index]) if index < len(strips) else 0.0
        high = max(below, above, KERB)
        _wall(ribbons, t - half, below, high, faces_left=False)
        ribbons.band(t - half, t + half, "kerb", heights=(high, high))
        _wall(ribbons, t + half, above, high, faces_left=True)
    elif _is_double(strips, index):
        ribbons.band(t - half, t - 0.07, "mark")
        ribbons.band(t - 0.07, t + 0.07, "asphalt")
        ribbons.band(t + 0.07, t + half, "mark")
    elif mark == "broken":
        ribbons.band(t - half, t + half, "mark", dashes=(1, 3), gap_surface="asphalt")
    else:
        ribbons.band(t - half, t + half, "mark")


def _wall(ribbons: Ribbons, t: Array, low: float, high: float, *, faces_left: bool) -> None:
    if high - low > 1e-6:
        order = (high, low) if faces_left else (low, high)
        ribbons.band(t, t + 1e-6, "kerb_side", heights=order)


def _height(strip: LaneStrip) -> float:
    return KERB if strip.kind == "sidewalk" else 0.0


def _surface(strip: LaneStrip, traits: frozenset[str]) -> tuple[str, bool]:
    """Return the colour or region of a strip, and whether it is a region."""
    if strip.kind == "driving":
        return "asphalt", True
    if strip.kind == "parking":
        return "asphalt_light", False
    if strip.kind == "shoulder":
        return ("asphalt", True) if "highway" in traits else ("gravel", True)
    if strip.kind == "sidewalk":
        return "paving", True
    if strip.kind == "median":
        return "gravel" if "highway" in traits else "grass", False
    return "turf", True
