"""Lights as a camera sees them: the halos of lamps and the glare of the sun."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from oodscen.numerics import _exact as exact
from oodscen.numerics._kernels import Kernel
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._meshes.mesh import Lamp
from oodscen_pybullet._rendering.view import CameraView
from oodscen_pybullet._types import F32, U8, Point

_STREET_LAMPS_OFF = 0.5
"""Daylight above which lamps of streets and tunnels have no halo."""
_FARTHEST_M = 300.0
"""Distance beyond which lamps have no halo, m."""
_BESIDE = 0.1
"""Distance beside the picture, as a share of its width, up to which a lamp's halo may reach into it."""
_CLEARANCE_M = 0.35
"""Distance in front of a lamp within which surfaces do not hide it, m: its own glass is there."""
_VISIBLE_BESIDE = 0.6
"""Share of a lamp or a sun beside the picture that counts as visible."""
_MURKY_M = 60.0
"""Distance whose extinction tells how murky the air is, m."""
_RADIUS_M = 0.055
"""Radius of a lamp of power 1, m."""
_LEAST_PX = 0.7
"""Least radius of a lamp in the picture, pixels."""
_CORE = 1.5
"""Radius of a core relative to its lamp's."""
_WIDEST_HALO = 0.16
"""Greatest radius of a halo relative to the picture's width."""
_HALO_BY_DAY = 2.6
"""Radius of a halo by day relative to its lamp's."""
_HALO_IN_DARK = 2.5
"""Added to the radius of a halo in the dark."""
_HALO_IN_FOG, _FOG_BY_DAY = 3.0, 0.3
"""Added to the radius of a halo by dense fog: the first, times the sum of the darkness and the second."""
_CORE_LIGHT, _HALO_LIGHT = 235.0, 95.0
"""Light at the centres of a core and a halo, 0 to 255."""
_CORE_WHITE = 0.5
"""Share of white in the core of a lamp that has no light-emitting diodes."""
_BEAM_GAIN = 1.4
"""Gain by which a lamp seen somewhat from the side still shines fully."""
_LED = 0.5
"""Share of a lamp's glow by day above which it has light-emitting diodes, as signals do: its core is coloured."""
_SUN_M = 1_000.0
"""Distance of the point that stands for the sun, m."""
_SKY_M = 399.0
"""Depth of the sky, m: nearer things hide the sun."""
_SCATTERED = 0.55
"""Share of the veil around a hidden sun that is left, since the air scatters it."""
_EPSILON = np.float32(1e-6)
"""Added to the square of a spot's reach, px^2: no reach is 0, but without it some bytes of pictures would differ."""


class _PixelPlace(NamedTuple):
    """A point as seen by a camera."""

    column: float
    row: float
    depth: float
    """Distance along the camera's axis, m."""


class _Disc(NamedTuple):
    """A part of the sun's glare."""

    radius: float
    """As a share of the picture's width."""
    light: float
    """At the centre, 0 to 255."""
    colour: Point
    is_veil: bool
    """True if some of it is left where the sun is hidden."""


_GLARE = (
    _Disc(0.6, 52.0, (1.0, 0.94, 0.80), is_veil=True),
    _Disc(0.12, 150.0, (1.0, 0.90, 0.66), is_veil=False),
    _Disc(0.04, 255.0, (1.0, 0.98, 0.9), is_veil=False),
)


def add_glows(
    image: U8,
    view: CameraView,
    depth: F32,
    light: Light,
    lamps: Sequence[Lamp],
    extinction: float,
) -> None:
    """Add the halos of visible lamps, in place.

    Args:
        image: [height, width, 3]
        view: The camera.
        depth: m
        light: The light of the scene; by day halos are faint.
        lamps: All lamps.
        extinction: Extinction coefficient of the air, 1/m: it dims lamps and widens their halos.
    """
    for lamp in lamps:
        if lamp.is_street and light.daylight > _STREET_LAMPS_OFF:
            continue
        place = _place(view, lamp)
        if place is None:
            continue
        visible = _facing_share(view, lamp) * _visible_share(depth, place, _VISIBLE_BESIDE)
        if visible <= 0.0:
            continue
        column, row, ahead = place
        size = math.sqrt(lamp.power)
        strength = visible * exact.exp(-extinction * ahead) * _glow_share(lamp, light) * size
        radius = max(_LEAST_PX, view.focal * _RADIUS_M * size / ahead)
        halo = min(radius * _spread(light, extinction), view.width * _WIDEST_HALO)
        _add_spot(image, column, row, radius * _CORE, _CORE_LIGHT * strength, _core(lamp))
        _add_spot(image, column, row, halo, _HALO_LIGHT * strength, lamp.colour)


def add_glare(
    image: U8, view: CameraView, depth: F32, light: Light, *, is_inside: bool = False
) -> None:
    """Add the glare of a low sun ahead, in place; in a tunnel, whose air is in the shade, only if the sun is seen."""
    if not light.has_glare:
        return
    x, y, z = (view.eye[axis] + _SUN_M * light.sun[axis] for axis in range(3))
    place = view.pixel((x, y, z))
    if place is None:
        return
    column, row, _ = place
    beside, scattered = (0.0, 0.0) if is_inside else (_VISIBLE_BESIDE, _SCATTERED)
    visible = _visible_share(depth, _PixelPlace(column, row, _SKY_M), beside)
    veil = scattered + (1.0 - scattered) * visible
    for disc in _GLARE:
        strength = disc.light * (veil if disc.is_veil else visible)
        _add_spot(image, column, row, view.width * disc.radius, strength, disc.colour)


def _place(view: CameraView, lamp: Lamp) -> _PixelPlace | None:
    """Return the place in the picture of a lamp whose halo may reach into it."""
    pixel = view.pixel(lamp.position)
    if pixel is None:
        return None
    place = _PixelPlace(*pixel)
    reach = view.width * _BESIDE
    in_columns = -reach < place.column < view.width + reach
    in_rows = -reach < place.row < view.height + reach
    return place if in_columns and in_rows and place.depth <= _FARTHEST_M else None


def _glow_share(lamp: Lamp, light: Light) -> float:
    """Return the share of its glow in the dark that a lamp has at this daylight."""
    return lamp.by_day + (1.0 - lamp.by_day) * (1.0 - light.daylight)


def _spread(light: Light, extinction: float) -> float:
    """Return the radius of a halo relative to the lamp's: wider in the dark, and in murky air."""
    dark, murk = 1.0 - light.daylight, min(1.0, extinction * _MURKY_M)
    return _HALO_BY_DAY + _HALO_IN_DARK * dark + _HALO_IN_FOG * murk * (_FOG_BY_DAY + dark)


def _facing_share(view: CameraView, lamp: Lamp) -> float:
    """Return the share of a lamp's light that shines towards the camera."""
    fx, fy, fz = lamp.facing
    if fx == fy == fz == 0.0:
        return 1.0
    dx, dy, dz = (view.eye[axis] - lamp.position[axis] for axis in range(3))
    length = math.sqrt(dx * dx + dy * dy + dz * dz) or 1.0
    return max(0.0, min(1.0, _BEAM_GAIN * (fx * dx + fy * dy + fz * dz) / length))


def _visible_share(depth: F32, place: _PixelPlace, beside: float) -> float:
    """Return the fraction of the pixels around a point that nothing in front of it occludes.

    Args:
        depth: [height, width] m
        place: The point.
        beside: The fraction for a point beside the picture.
    """
    height, width = depth.shape
    c, r = round(place.column - 0.5), round(place.row - 0.5)
    patch = depth[
        max(r - 1, 0) : max(min(r + 2, height), 0), max(c - 1, 0) : max(min(c + 2, width), 0)
    ]
    if patch.size == 0:
        return beside
    return np.count_nonzero(patch > place.depth - _CLEARANCE_M) / patch.size


def _core(lamp: Lamp) -> Point:
    """Return the colour of a lamp's core: nearly white, or the colour of light-emitting diodes."""
    if lamp.by_day > _LED:
        return lamp.colour
    coloured = 1.0 - _CORE_WHITE
    red, green, blue = (_CORE_WHITE + coloured * part for part in lamp.colour)
    return red, green, blue


def _add_spot(
    image: U8, column: float, row: float, radius: float, strength: float, colour: Point
) -> None:
    """Add a round spot of coloured light."""
    light = np.array([value * strength for value in colour], np.float32)
    _splash(image, np.float32(column), np.float32(row), np.float32(radius), light)


@Kernel
def _splash(image: U8, column: np.float32, row: np.float32, radius: np.float32, light: F32) -> None:
    """Add a round spot of light that fades to zero at twice its radius.

    Args:
        image: [height, width, 3], changed in place.
        column: Column of the centre, pixels.
        row: Row of the centre.
        radius: Pixels.
        light: [3] light to add at the centre, 0 to 255.
    """
    height, width = image.shape[0], image.shape[1]
    one, half = np.float32(1.0), np.float32(0.5)
    reach = np.float32(2.0) * radius + one
    left, right = max(int(column - reach), 0), min(int(column + reach) + 1, width)
    top, bottom = max(int(row - reach), 0), min(int(row + reach) + 1, height)
    if left >= right or top >= bottom:
        return
    scale = one / (np.float32(4.0) * radius * radius + _EPSILON)
    aside = np.arange(left, right).astype(np.float32) + (half - column)
    aside = aside * aside
    for y in range(top, bottom):
        aloft = np.float32(y) + half - row
        fall = np.maximum(one - (aside + aloft * aloft) * scale, np.float32(0.0))
        fall = fall * fall * fall
        for e in range(3):
            bright = image[y, left:right, e] + (fall * light[e] + half)
            image[y, left:right, e] = np.minimum(bright, np.float32(255.0)).astype(np.uint8)
