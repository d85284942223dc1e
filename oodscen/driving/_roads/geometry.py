"""Plan view curves parametrised by arc length: line, arc, clothoid and polynomials.

Formulae: ASAM OpenDRIVE 1.7, section 7. Only plain arithmetic is used, so that simulations do not depend
on the last bits of a mathematical library.
"""

import math
from abc import ABC, abstractmethod
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from oodscen.numerics._arrays import sincos_each
from oodscen.numerics._exact import Floats, Real, atan2, cos, sin, sincos

Points = tuple[Floats, Floats, Floats, Floats]
"""x, y, heading and curvature of many points, as in `CurvePoint`; [n] each."""

_GAUSS = (
    (-0.9061798459386640, 0.2369268850561891),
    (-0.5384693101056831, 0.4786286704993665),
    (0.0, 0.5688888888888889),
    (0.5384693101056831, 0.4786286704993665),
    (0.9061798459386640, 0.2369268850561891),
)
"""Nodes and weights of five-point Gauss-Legendre quadrature on [-1, 1]."""

_ARC_TOLERANCE_M = 1e-9
"""Rounding of an arc length, m."""
_ROUNDING_M = 1e-9
"""Distance before a piece from which a place belongs to it, m."""
_STRAIGHT_RAD = 1e-12
"""Half the turn of an arc up to which its chord is its length, rad."""
_STALLED = 1e-6
"""Speed of a curve in its parameter, relative to its mean, at which no Newton step is taken."""
_AT_REST = 1e-9
"""The same speed, absolute, at which a curve has no direction and so no bend."""
_MOST_STEPS = 8
"""Newton steps to the parameter of an arc length; uneven parametrisations need more than two."""


class CurvePoint(NamedTuple):
    """One point of a reference line."""

    x: float
    y: float
    heading: float
    """Heading, rad."""
    curvature: float
    """Curvature, 1/m, left positive."""


@dataclass(frozen=True)
class Cubic:
    """A cubic valid from `start` on: a + b d + c d^2 + d d^3 with d = s - start."""

    start: float
    a: float
    b: float = 0.0
    c: float = 0.0
    d: float = 0.0

    def at(self, s: float) -> float:
        """Return the value at `s`."""
        along = s - self.start
        return self.a + along * (self.b + along * (self.c + along * self.d))


def piecewise(pieces: tuple[Cubic, ...], s: float) -> float:
    """Return the value at `s` of cubics sorted by start; 0 before the first."""
    count = bisect_right(pieces, s + _ROUNDING_M, key=lambda piece: piece.start)
    return pieces[count - 1].at(s) if count else 0.0


def piecewise_all(pieces: tuple[Cubic, ...], s: Floats) -> Floats:
    """Return `piecewise` at many positions, with the same bits for each."""
    if not pieces:
        return np.zeros_like(s)
    table = np.array([(piece.start, piece.a, piece.b, piece.c, piece.d) for piece in pieces])
    count = np.searchsorted(table[:, 0], s + _ROUNDING_M, side="right")
    start, a, b, c, d = table[np.maximum(count - 1, 0)].T
    along = s - start
    return np.where(count > 0, a + along * (b + along * (c + along * d)), 0.0)


@dataclass(frozen=True)
class Curve(ABC):
    """One piece of a plan view."""

    s: float
    """Position on the road where the piece starts, m."""
    x: float
    y: float
    heading: float
    length: float

    @abstractmethod
    def at(self, along: float) -> CurvePoint:
        """Return the point `along` metres after this piece's start."""

    def at_all(self, along: Floats) -> Points:
        """Return many points, with the same bits as `at` for each."""
        x, y, heading, curvature = np.array([self.at(distance) for distance in along.tolist()]).T
        return x, y, heading, curvature

    def _place(
        self, u: Real, v: Real, turn: Real, curvature: Real
    ) -> tuple[Real, Real, Real, Real]:
        """Transform points of the local frame (u forward, v left) into the road's frame."""
        across, along = sincos(self.heading)
        return (
            self.x + u * along - v * across,
            self.y + u * across + v * along,
            self.heading + turn,
            curvature,
        )


@dataclass(frozen=True)
class Line(Curve):
    """A straight piece."""

    def at(self, along: float) -> CurvePoint:
        """Return the point `along` metres after this piece's start."""
        return CurvePoint(*self._place(along, 0.0, 0.0, 0.0))

    def at_all(self, along: Floats) -> Points:
        """Return many points, with the same bits as `at` for each."""
        none = np.zeros_like(along)
        return self._place(along, none, none, none)


@dataclass(frozen=True)
class Arc(Curve):
    """A circular piece."""

    curvature: float

    def at(self, along: float) -> CurvePoint:
        """Return the point `along` metres after this piece's start."""
        half = 0.5 * self.curvature * along
        chord = along * (sin(half) / half if abs(half) > _STRAIGHT_RAD else 1.0)
        return CurvePoint(
            *self._place(chord * cos(half), chord * sin(half), 2.0 * half, self.curvature)
        )

    def at_all(self, along: Floats) -> Points:
        """Return many points, with the same bits as `at` for each."""
        half = 0.5 * self.curvature * along
        sine, cosine = sincos_each(half)
        share = np.divide(sine, half, out=np.ones_like(half), where=np.abs(half) > _STRAIGHT_RAD)
        chord = along * share
        curvature = np.full_like(along, self.curvature)
        return self._place(chord * cosine, chord * sine, 2.0 * half, curvature)


@dataclass(frozen=True)
class Spiral(Curve):
    """A clothoid: its curvature changes linearly."""

    curvature_start: float
    curvature_end: float
    _nodes: tuple[tuple[float, float, float], ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        bend = max(abs(self.curvature_start), abs(self.curvature_end))
        count = max(1, math.ceil(self.length * (0.1 + 4.0 * bend)))
        nodes = [(0.0, 0.0, 0.0)]
        for index in range(count):
            start, end = self.length * index / count, self.length * (index + 1) / count
            du, dv = self._integrate(start, end, sincos)
            nodes.append((end, nodes[-1][1] + du, nodes[-1][2] + dv))
        object.__setattr__(self, "_nodes", tuple(nodes))

    @property
    def _rate(self) -> float:
        return (self.curvature_end - self.curvature_start) / self.length

    def _turn(self, along: Real) -> Real:
        return along * (self.curvature_start + 0.5 * self._rate * along)

    def _bend(self, along: Real) -> Real:
        return self.curvature_start + self._rate * along

    def _integrate(
        self, start: Real, end: Real, sincos: Callable[[Real], tuple[Real, Real]]
    ) -> tuple[Real, Real]:
        middle, half = 0.5 * (start + end), 0.5 * (end - start)
        u = v = 0.0 * half
        for node, weight in _GAUSS:
            sine, cosine = sincos(self._turn(middle + half * node))
            u = u + weight * cosine
            v = v + weight * sine
        return half * u, half * v

    def at(self, along: float) -> CurvePoint:
        """Return the point `along` metres after this piece's start."""
        index = min(int(along / self.length * (len(self._nodes) - 1)), len(self._nodes) - 1)
        start, u, v = self._nodes[max(index, 0)]
        du, dv = self._integrate(start, along, sincos)
        return CurvePoint(*self._place(u + du, v + dv, self._turn(along), self._bend(along)))

    def at_all(self, along: Floats) -> Points:
        """Return many points, with the same bits as `at` for each."""
        last = len(self._nodes) - 1
        index = (along / self.length * last).astype(np.int64).clip(0, last)
        start, u, v = np.array(self._nodes)[index].T
        du, dv = self._integrate(start, along, sincos_each)
        return self._place(u + du, v + dv, self._turn(along), self._bend(along))


@dataclass(frozen=True)
class ParamPoly3(Curve):
    """A parametric cubic, evaluated by arc length.

    `scale` is the parameter's value at the end of the piece. If the stated length differs from the arc
    length, the curve is stretched evenly.
    """

    u: tuple[float, float, float, float]
    v: tuple[float, float, float, float]
    scale: float
    _nodes: tuple[float, ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        count = min(max(8, math.ceil(self.length)), 5_000)
        nodes = [0.0]
        for index in range(count):
            nodes.append(nodes[-1] + self._arc(*self._ends(index, count)))
        object.__setattr__(self, "_nodes", tuple(nodes))

    @property
    def arc(self) -> float:
        """Length of the curve itself, m."""
        return self._nodes[-1]

    def _ends(self, index: int, count: int) -> tuple[float, float]:
        """Return the parameters at the ends of one of `count` equal parts."""
        return self.scale * index / count, self.scale * (index + 1) / count

    def _speed(self, p: float) -> float:
        du, dv = _derivatives(self.u, p)[1], _derivatives(self.v, p)[1]
        return math.sqrt(du * du + dv * dv)

    def _arc(self, start: float, end: float) -> float:
        """Return the arc length between two parameter values, m."""
        middle, half = 0.5 * (start + end), 0.5 * (end - start)
        return half * sum(weight * self._speed(middle + half * node) for node, weight in _GAUSS)

    def _parameter(self, along: float) -> float:
        """Return the parameter at the same share of the curve's own length as `along` is of the stated one."""
        share = along / self.length
        if not self.arc > _ARC_TOLERANCE_M:
            return share * self.scale
        arc = share * self.arc
        count = len(self._nodes) - 1
        index = min(max(bisect_right(self._nodes, arc) - 1, 0), count - 1)
        low, high = self._nodes[index], self._nodes[index + 1]
        begin, end = self._ends(index, count)
        if not high > low:
            return begin
        p = begin + (arc - low) / (high - low) * self.scale / count
        for _ in range(_MOST_STEPS):
            speed, rest = self._speed(p), arc - low - self._arc(begin, p)
            if not speed > _STALLED * self.arc / self.scale or abs(rest) < _ARC_TOLERANCE_M:
                break
            p += rest / speed
        return min(max(p, begin), end)

    def at(self, along: float) -> CurvePoint:
        """Return the point `along` metres after this piece's start."""
        p = self._parameter(along)
        u, du, ddu = _derivatives(self.u, p)
        v, dv, ddv = _derivatives(self.v, p)
        return CurvePoint(*self._place(u, v, atan2(dv, du), _bend(du, dv, ddu, ddv)))


@dataclass(frozen=True)
class Poly3(Curve):
    """A cubic v(u) over the local forward axis, evaluated by arc length."""

    v: tuple[float, float, float, float]
    _nodes: tuple[tuple[float, float], ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        nodes = [(0.0, 0.0)]
        step = min(max(0.25, self.length / 40_000.0), self.length)
        while nodes[-1][0] < self.length:
            u, arc = nodes[-1][1], nodes[-1][0]
            _, slope, _ = _derivatives(self.v, u + 0.5 * step)
            if not abs(slope) < 1e6:
                nodes.append((self.length + 1.0, u + step))
                break
            nodes.append((arc + step * math.sqrt(1.0 + slope * slope), u + step))
        object.__setattr__(self, "_nodes", tuple(nodes))

    def at(self, along: float) -> CurvePoint:
        """Return the point `along` metres after this piece's start."""
        index = bisect_right(self._nodes, along, key=lambda node: node[0]) - 1
        index = min(max(index, 0), len(self._nodes) - 2)
        (arc0, u0), (arc1, u1) = self._nodes[index], self._nodes[index + 1]
        u = u0 + (u1 - u0) * (along - arc0) / (arc1 - arc0)
        v, slope, bend = _derivatives(self.v, u)
        return CurvePoint(*self._place(u, v, atan2(slope, 1.0), _bend(1.0, slope, 0.0, bend)))


def _derivatives(k: tuple[float, float, float, float], p: float) -> tuple[float, float, float]:
    """Return a cubic's value, slope and second derivative."""
    a, b, c, d = k
    return (
        a + p * (b + p * (c + p * d)),
        b + p * (2.0 * c + p * 3.0 * d),
        2.0 * c + 6.0 * d * p,
    )


def _bend(du: float, dv: float, ddu: float, ddv: float) -> float:
    """Return the signed curvature of a parametric curve."""
    speed = math.sqrt(du * du + dv * dv)
    return (du * ddv - dv * ddu) / speed**3 if speed > _AT_REST else 0.0
