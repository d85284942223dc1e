"""Draws what lies on a face or on the road: patterns, words, patches and lines."""

import itertools
from collections.abc import Callable, Sequence

import numpy as np

from oodscen.data._designs import shapes
from oodscen.data._designs.lettering import HEIGHT, strokes, width_of
from oodscen.data._designs.tessellation import BLOT_CORNERS, MAX_DASHES, cells
from oodscen.numerics._exact import cos, sin
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.designs.parts import Placing, add
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._meshes.shapes import LEAST_LENGTH, flat_normal
from oodscen_pybullet._types import Array

_LIFT = 0.008
"""Distance of letters and speckles from the face that they are on, m."""
_THREAD = 0.03
"""Width of the threads of a net, m."""
_JOINT = 0.1
"""Share of a board or brick that is its joint."""


class _Face:
    """A quad with coordinates from 0 to 1, from its bottom left; two neighbouring corners may be one."""

    def __init__(self, corners: Sequence[Sequence[float]], side: float) -> None:
        """Take the corners from the bottom left, counter-clockwise; side -1 if they are mirrored."""
        one, two, three, four = (np.asarray(corner, np.float64) for corner in corners)
        if side < 0:
            one, two, three, four = two, one, four, three
        self.corners = one, two, three, four
        self.width = _distance(one, two) or _distance(four, three)
        self.height = _distance(one, four) or _distance(two, three)
        self.normal = _normal(self.corners)

    def point(self, u: float, v: float, lift: float = 0.0) -> Array:
        """Return the point at coordinates, lifted off the face by a distance, m."""
        one, two, three, four = self.corners
        low, high = one * (1 - u) + two * u, four * (1 - u) + three * u
        return np.asarray(low * (1 - v) + high * v + lift * self.normal)

    def cell(self, u0: float, u1: float, v0: float, v1: float, lift: float = 0.0) -> list[Array]:
        """Return the corners of a part of the face, from its bottom left."""
        return [self.point(u, v, lift) for u, v in ((u0, v0), (u1, v0), (u1, v1), (u0, v1))]


def _distance(one: Array, two: Array) -> float:
    return float(np.sqrt(((two - one) ** 2).sum()))


def _normal(corners: tuple[Array, Array, Array, Array]) -> Array:
    """Return the unit normal of a quad at its first corner; if that has no angle, of the quad as a whole."""
    one, two, _, four = corners
    normal = np.cross(two - one, four - one)
    length = np.sqrt(float((normal**2).sum()))
    if length > LEAST_LENGTH:
        return np.asarray(normal / length)
    return np.array(flat_normal([corner.tolist() for corner in corners]) or (0.0, 0.0, 1.0))


Paint = Callable[[Sequence[Array], bool], None]
"""Adds a cell in the first colour, or in the second if the flag is set."""


@add.register
def _(part: shapes.Panel, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    face = _Face([place.point(corner) for corner in part.panel], place.side)
    colours = shown.colour(part.colour), shown.colour(part.second_colour)

    def paint(corners: Sequence[Array], is_second: bool) -> None:
        mesh.polygon(np.array(corners), colours[is_second])
        if part.back:
            mesh.polygon(np.array(corners)[::-1], colours[is_second])

    across, up = cells(part)
    match part.pattern:
        case "plain":
            paint(face.cell(0, 1, 0, 1), False)
        case "speckle":
            paint(face.cell(0, 1, 0, 1), False)
            _speckle(part, face, paint, across * up)
        case "net":
            _net(face, paint, across, up)
        case "planks":
            _planks(face, paint, up)
        case "bricks" | "windows":
            _walling(part, face, paint, across, up)
        case _:
            _checks(face, paint, across, up)


def _planks(face: _Face, paint: Paint, up: int) -> None:
    for row in range(up):
        low, high = row / up, (row + 1) / up
        seam = low + _JOINT * (high - low)
        paint(face.cell(0, 1, low, seam), True)
        paint(face.cell(0, 1, seam, high), False)


def _checks(face: _Face, paint: Paint, across: int, up: int) -> None:
    """Paint checks; stripes are checks in a single row or column."""
    for row in range(up):
        for column in range(across):
            cell = face.cell(column / across, (column + 1) / across, row / up, (row + 1) / up)
            paint(cell, (row + column) % 2 == 1)


def _speckle(part: shapes.Panel, face: _Face, paint: Paint, count: int) -> None:
    rng = np.random.Generator(np.random.PCG64(part.key))
    for u, v, size in rng.uniform(0.0, 1.0, (count, 3)).tolist():
        a = part.pitch * (0.1 + 0.2 * size) / face.width
        b = part.pitch * (0.1 + 0.2 * size) / face.height
        a, b = min(a, 0.4), min(b, 0.4)
        u, v = a + u * (1 - 2 * a), b + v * (1 - 2 * b)
        paint(face.cell(u - a, u + a, v - b, v + b, _LIFT), True)


def _net(face: _Face, paint: Paint, across: int, up: int) -> None:
    a, b = min(0.4, _THREAD / face.width), min(0.4, _THREAD / face.height)
    for column in range(across + 1):
        u = column / across * (1 - a)
        paint(face.cell(u, u + a, 0, 1), False)
    for row in range(up + 1):
        v = row / up * (1 - b)
        paint(face.cell(0, 1, v, v + b), False)


def _walling(part: shapes.Panel, face: _Face, paint: Paint, across: int, up: int) -> None:
    """Paint bricks, shifted row by row, or windows; the joint is of the second colour, or the pane."""
    is_window = part.pattern == "windows"
    joint = 0.3 if is_window else _JOINT
    for row in range(up):
        low, high = row / up, (row + 1) / up
        seam = low + joint * (high - low)
        paint(face.cell(0, 1, low, seam), not is_window)
        shift = 0.5 * (row % 2) if not is_window else 0.0
        edges = [0.0, *((c + shift) / across for c in range(1, across)), 1.0]
        for left, right in itertools.pairwise(edges):
            gap = left + joint * (right - left)
            paint(face.cell(left, gap, seam, high), not is_window)
            paint(face.cell(gap, right, seam, high), is_window)


@add.register
def _(part: shapes.Text, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    face = _Face([place.point(corner) for corner in part.on], place.side)
    if part.paper:
        mesh.polygon(np.array(face.cell(0, 1, 0, 1)), shown.colour(part.paper))
    columns = width_of(part.text)
    dot = min(face.width / (columns + 2), face.height / (HEIGHT + 2))
    a, b = dot / face.width, dot / face.height
    left, top = 0.5 - columns * a / 2, 0.5 + HEIGHT * b / 2
    for row, start, end in strokes(part.text):
        high = top - row * b
        cell = face.cell(left + start * a, left + end * a, high - b, high, _LIFT)
        mesh.polygon(np.array(cell), shown.colour(part.ink))


@add.register
def _(part: shapes.Blot, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    (x, y), (length, width) = part.blot, part.size
    rng = np.random.Generator(np.random.PCG64(part.key))
    waves = [(n, *rng.uniform(0.0, 1.0, 2).tolist()) for n in (2, 3, 5, 7)]
    points = []
    for index in range(BLOT_CORNERS):
        turn = 2 * np.pi * index / BLOT_CORNERS
        swell = sum(size * sin(n * turn + 6.28 * phase) for n, phase, size in waves) / len(waves)
        reach = 0.5 * (1.0 - part.ragged * (0.5 - 0.5 * swell))
        points.append(
            place.point(
                (x + reach * length * cos(turn), y + reach * width * sin(turn), part.height)
            )
        )
    middle = place.point((x, y, part.height))
    for one, two in itertools.pairwise([*points, points[0]]):
        corners = (middle, one, two) if place.side > 0 else (middle, two, one)
        mesh.polygon(corners, shown.colour(part.colour))


@add.register
def _(part: shapes.Strip, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    for (x0, y0), (x1, y1) in itertools.pairwise(part.strip):
        start, way = np.array([x0, y0]), np.array([x1 - x0, y1 - y0])
        length = float(np.sqrt((way**2).sum()))
        aside = np.array([-way[1], way[0]]) / length * part.width / 2
        count = max(1, round(min(length / part.dash, 2 * MAX_DASHES - 1))) if part.dash else 1
        for k in range(0, count, 2):
            first, last = start + way * k / count, start + way * (k + 1) / count
            dash = [first - aside, last - aside, last + aside, first + aside]
            corners = [place.point((*point.tolist(), part.height)) for point in dash]
            mesh.polygon(corners if place.side > 0 else corners[::-1], shown.colour(part.colour))
