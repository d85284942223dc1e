"""Exact arithmetic over arrays, with the same bits on every machine.

NumPy's element-wise `+ - * /` are those of IEEE 754, so these functions, but for `sincos_all`, give the bits of
their counterparts in `oodscen.numerics._exact` and in Python.
"""

import numpy as np

from oodscen.numerics._exact import (
    _HALF_PI_HIGH,
    _HALF_PI_LOW,
    _HALF_PI_MIDDLE,
    HALF_PI,
    Floats,
    _cosine_series,
    _sine_series,
)

_HALF_PI_REST = 6.077100506506192e-11
"""The bits of pi/2 after the first 33, in one number."""
_QUARTERS_PER_RAD = 0.6366197723675814
"""Quarter turns per radian, 2/pi."""
_TIE = 1e-15
"""Distance from a tie, relative to the number, below which a product may lie on its wrong side."""


def sincos_each(angle: Floats) -> tuple[Floats, Floats]:
    """Return the sines and cosines of angles, with the same bits as `sincos` for each."""
    turns = np.floor(angle / HALF_PI + 0.5)
    y = ((angle - turns * _HALF_PI_HIGH) - turns * _HALF_PI_MIDDLE) - turns * _HALF_PI_LOW
    z = y * y
    sine = y + y * z * _sine_series(z)
    cosine = 1.0 - 0.5 * z + z * z * _cosine_series(z)
    return _by_quarter(turns % 4.0, sine, cosine)


def sincos_all(angle: Floats) -> tuple[Floats, Floats]:
    """Return the sines and cosines of angles of any shape, up to some hundred turns.

    The last bit may differ from that of `sincos`, but not between machines.
    """
    turns = np.rint(angle * _QUARTERS_PER_RAD)
    y = (angle - turns * _HALF_PI_HIGH) - turns * _HALF_PI_REST
    z = y * y
    sine = y + y * z * _sine_series(z)
    cosine = 1.0 - (0.5 * z - z * z * _cosine_series(z))
    return _by_quarter(turns - 4.0 * np.floor(0.25 * turns), sine, cosine)


def _by_quarter(quarter: Floats, sine: Floats, cosine: Floats) -> tuple[Floats, Floats]:
    """Return the sines and cosines of angles from their quarter turns and those of the remainders."""
    is_odd = (quarter == 1.0) | (quarter == 3.0)
    sin, cos = np.where(is_odd, cosine, sine), np.where(is_odd, sine, cosine)
    is_back = (quarter == 1.0) | (quarter == 2.0)
    return np.where(quarter >= 2.0, -sin, sin), np.where(is_back, -cos, cos)


def rounded(values: Floats) -> Floats:
    """Return numbers rounded to six decimals, with the same bits as `round(value, 6)` for each."""
    with np.errstate(over="ignore", invalid="ignore"):
        scaled = values * 1e6
        nearest = np.rint(scaled) / 1e6
        # The product is inexact: near a tie only Python's own rounding shows on which side it is.
        is_clear = np.abs(scaled - np.floor(scaled) - 0.5) > _TIE * np.abs(scaled)
    for index in np.flatnonzero(~is_clear):
        nearest[index] = round(float(values[index]), 6)
    return nearest


def interpolated(x: Floats, nodes_x: Floats, nodes_y: Floats) -> Floats:
    """Return y at every x on the straight lines between two or more nodes of ascending x, also beyond them."""
    index = np.clip(np.searchsorted(nodes_x, x, side="right") - 1, 0, len(nodes_x) - 2)
    low, high = nodes_x[index], nodes_x[index + 1]
    share = np.divide(x - low, high - low, out=np.zeros_like(x), where=high > low)
    return nodes_y[index] + share * (nodes_y[index + 1] - nodes_y[index])
