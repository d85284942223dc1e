"""Sunlight, darkness, headlamps, street lamps, glows and shadows, added to a picture."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from oodscen.scene import Weather
from oodscen_pybullet.view import NEAR, Point, View

Float = NDArray[np.float32]
Pose = tuple[float, float, float, float]

_DAYLIGHT = ((-18.0, 0.06), (-6.0, 0.14), (0.0, 0.42), (8.0, 0.92), (15.0, 1.0))
"""Sun elevation, degrees, and how bright the day is."""
STREET_LAMP: Point = (1.0, 0.82, 0.55)
_BEAM: Point = (1.0, 0.97, 0.88)
GLARE_DEG = 12.0
"""Below this elevation the sun stands ahead of the ego and dazzles."""


@dataclass(frozen=True)
class Light:
    """Where the light comes from and how bright it is."""

    sun: Point
    """Direction towards the sun, unit length."""
    ambient: float
    """Share of light that comes from everywhere."""
    diffuse: float
    """Share that comes from the sun."""
    daylight: float
    """0 in the deepest night, 1 at noon."""
    shadow: float
    """How dark shadows are, 0 to 1."""
    tint: Point
    """Colour of the light."""
    has_glare: bool

    @classmethod
    def of(cls, weather: Weather, heading: float, *, is_snowy: bool) -> "Light":
        """Derive the light from the weather.

        Args:
            weather: Of the scene.
            heading: Of the road where the ego starts, rad.
            is_snowy: Whether snow lies, which throws light back.
        """
        elevation = weather.sun_elevation_deg
        daylight = _between(_DAYLIGHT, elevation)
        hidden = max(
            weather.cloud_cover,
            1.0 if weather.precipitation != "none" else 0.0,
            1.0 if weather.fog_visual_range_m < 600.0 else 0.0,
        )
        has_glare = 0.0 < elevation < GLARE_DEG and hidden < 0.6
        turn = heading + (math.radians(6.0) if has_glare else math.radians(144.0))
        height = math.radians(max(elevation, 4.0 if has_glare else 12.0))
        sun = (
            math.cos(height) * math.cos(turn),
            math.cos(height) * math.sin(turn),
            math.sin(height),
        )
        clear = (1.0 - hidden) * (1.0 if elevation > 0.0 else 0.0)
        warm = max(0.0, 1.0 - max(elevation, 0.0) / 20.0) * clear
        dark = 1.0 - daylight
        return cls(
            sun=sun,
            ambient=0.60 + 0.22 * (1.0 - clear) + (0.06 if is_snowy else 0.0),
            diffuse=0.10 + 0.42 * clear,
            daylight=daylight,
            shadow=0.22 + 0.26 * clear,
            tint=(
                1.0 + 0.08 * warm - 0.22 * dark * (1 - warm),
                1.0 - 0.04 * warm - 0.10 * dark * (1 - warm),
                1.0 - 0.20 * warm + 0.10 * dark * (1 - warm),
            ),
            has_glare=has_glare,
        )


@dataclass(frozen=True)
class Caster:
    """Something that throws a shadow."""

    pose: Pose
    solids: tuple[tuple[Point, Point], ...]


@dataclass(frozen=True)
class Glow:
    """A lamp that is on, in world coordinates."""

    position: Point
    colour: Point
    facing: Point
    """Where it shines to; (0, 0, 0) is all around."""
    power: float
    is_street: bool = False


def three(plane: Float) -> Float:
    """Return a plane as a picture of three equal channels: numpy is slow along short axes."""
    import cv2

    return np.asarray(cv2.merge((plane, plane, plane)), np.float32)


def line(colour: Sequence[float], width: int) -> Float:
    """Return one row of a picture that has one colour, [1, width, 3]."""
    return np.tile(np.array(colour, np.float32), width).reshape(1, width, 3)


def _between(table: Sequence[tuple[float, float]], value: float) -> float:
    """Interpolate in a table with ascending first column."""
    if value <= table[0][0]:
        return table[0][1]
    for (x0, y0), (x1, y1) in itertools.pairwise(table):
        if value <= x1:
            return y0 + (y1 - y0) * (value - x0) / (x1 - x0)
    return table[-1][1]


# ------------------------------------------------------------------ shadows


def shadow_mask(view: View, casters: Sequence[Caster], sun: Point, ground: float) -> Float:
    """Return how much each pixel would lie in shadow if it showed the ground, 0 to 1.

    Args:
        view: The camera.
        casters: What throws shadows.
        sun: Direction towards the sun.
        ground: Height of the road at the camera, m.
    """
    import cv2

    mask = np.zeros((view.height, view.width), np.uint8)
    lean = min(1.0 / max(sun[2], 0.2), 3.0)
    push = (-sun[0] * lean, -sun[1] * lean)
    for caster in casters:
        x, y, z, yaw = caster.pose
        ahead = view.to_camera((x, y, ground))[2]
        if not -8.0 < ahead < 90.0:
            continue
        cos, sin = math.cos(yaw), math.sin(yaw)
        for (cx, cy, cz), (hx, hy, hz) in caster.solids:
            corners = []
            for a in (-hx, hx):
                for b in (-hy, hy):
                    px, py = (
                        x + cos * (cx + a) - sin * (cy + b),
                        y + sin * (cx + a) + cos * (cy + b),
                    )
                    levels = (max(cz - hz, 0.0), cz + hz)
                    corners += [(px + push[0] * c, py + push[1] * c) for c in levels]
            hull = cv2.convexHull(np.array(corners, np.float32))[:, 0]
            outline = _clip([view.to_camera((float(u), float(v), z)) for u, v in hull])
            if len(outline) < 3:
                continue
            pixels = [
                (view.width / 2 + view.focal * r / f, view.height / 2 - view.focal * u / f)
                for r, u, f in outline
            ]
            limit = 8.0 * max(view.width, view.height)
            points = np.clip(np.array(pixels), -limit, limit) * 16
            cv2.fillConvexPoly(mask, np.round(points).astype(np.int32), 255, cv2.LINE_AA, 4)
    soft = cv2.blur(mask, (3, 3))
    return np.asarray(soft * np.float32(1 / 255), np.float32)


def _clip(points: list[Point]) -> list[Point]:
    """Cut a polygon in camera coordinates at the near plane."""
    kept: list[Point] = []
    near = 2 * NEAR
    for (r0, u0, f0), (r1, u1, f1) in zip(points, points[1:] + points[:1], strict=True):
        if f0 >= near:
            kept.append((r0, u0, f0))
        if (f0 >= near) != (f1 >= near):
            k = (near - f0) / (f1 - f0)
            kept.append((r0 + k * (r1 - r0), u0 + k * (u1 - u0), near))
    return kept


# ------------------------------------------------------------------ the dark


def illumination(
    view: View, depth: Float, light: Light, glows: Sequence[Glow], ground: float
) -> Float:
    """Return how brightly each pixel is lit in the dark, [height, width, 3].

    The ego's low beams shine with a soft cut-off at lamp height; street lamps make pools.

    Args:
        view: The camera.
        depth: Metres along the optical axis, infinity for the sky.
        light: Of the scene.
        glows: All lamps; street lamps light the ground.
        ground: Height of the road, m.
    """
    import cv2

    across, upwards = view.slopes()
    near = np.minimum(depth, np.float32(400.0))
    height = near * (upwards * np.float32(view.up[2]) + np.float32(view.forward[2]))[:, None]
    height += np.float32(view.eye[2] - ground)
    beam = cv2.exp(-((across / np.float32(0.42)) ** 2).reshape(1, -1)).astype(np.float32)
    range_ = near * np.float32(1 / 36.0)
    strength = (
        np.float32(1.15 * (1.0 - light.daylight)) * beam / (np.float32(1.0) + range_ * range_)
    )
    cut = np.clip(
        (np.float32(0.9) - height) / (np.float32(0.25) + near * np.float32(0.03)), 0.0, 1.0
    )
    beams = strength * (np.float32(0.42) + np.float32(0.58) * cut)
    lamps = [glow for glow in glows if glow.is_street and light.daylight < 0.5]
    lamps = [glow for glow in lamps if -15.0 < view.to_camera(glow.position)[2] < 90.0]
    pool = np.zeros(depth.shape, np.float32)
    if lamps:
        x = near * (
            np.float32(view.forward[0])
            + across[None, :] * np.float32(view.right[0])
            + upwards[:, None] * np.float32(view.up[0])
        )
        y = near * (
            np.float32(view.forward[1])
            + across[None, :] * np.float32(view.right[1])
            + upwards[:, None] * np.float32(view.up[1])
        )
        fall, part = np.empty_like(pool), np.empty_like(pool)
        for glow in lamps:
            np.subtract(x, np.float32(glow.position[0] - view.eye[0]), out=fall)
            np.subtract(y, np.float32(glow.position[1] - view.eye[1]), out=part)
            fall *= fall
            part *= part
            fall += part
            fall *= np.float32(1 / 55.0)
            fall += np.float32(1.0)
            fall *= fall
            np.divide(np.float32(0.62), fall, out=fall)
            pool += fall
        pool *= np.float32(1.0 - light.daylight)
    total = [
        beams * np.float32(beam) + pool * np.float32(lamp) + np.float32(tint * light.daylight)
        for tint, beam, lamp in zip(light.tint, _BEAM, STREET_LAMP, strict=True)
    ]
    return np.asarray(cv2.merge(total), np.float32)


def add_glows(
    image: Float, view: View, depth: Float, glows: Sequence[Glow], light: Light, extinction: float
) -> None:
    """Add the halos of lamps that the camera sees, in place.

    Args:
        image: [height, width, 3], 0 to 255.
        view: The camera.
        depth: Metres.
        glows: All lamps.
        light: Of the scene; by day halos are faint.
        extinction: Of the air, 1/m: it dims lamps and widens their halos.
    """
    dark = 1.0 - light.daylight
    for glow in glows:
        if glow.is_street and light.daylight > 0.5:
            continue
        spot = view.pixel(glow.position)
        if spot is None or spot[2] > 300.0:
            continue
        column, row, ahead = spot
        reach = view.width * 0.1
        if not (-reach < column < view.width + reach and -reach < row < view.height + reach):
            continue
        seen = _facing(view, glow) * _visible(depth, column, row, ahead)
        if seen <= 0.0:
            continue
        through = math.exp(-extinction * ahead)
        murk = min(1.0, extinction * 60.0)
        strength = seen * through * (0.22 + 0.78 * dark) * math.sqrt(glow.power)
        core = max(0.7, view.focal * 0.055 * math.sqrt(glow.power) / ahead)
        wide = core * (2.6 + 2.5 * dark + 3.0 * murk * (0.3 + dark))
        _splash(image, column, row, core * 1.5, 235.0 * strength, _paler(glow.colour))
        _splash(image, column, row, min(wide, view.width * 0.16), 95.0 * strength, glow.colour)


def _facing(view: View, glow: Glow) -> float:
    fx, fy, fz = glow.facing
    if fx == fy == fz == 0.0:
        return 1.0
    dx, dy, dz = (view.eye[i] - glow.position[i] for i in range(3))
    length = math.sqrt(dx * dx + dy * dy + dz * dz) or 1.0
    return max(0.0, min(1.0, 1.4 * (fx * dx + fy * dy + fz * dz) / length))


def _visible(depth: Float, column: float, row: float, ahead: float) -> float:
    """Return the share of a few pixels around a place at which nothing stands before it."""
    height, width = depth.shape
    c, r = round(column - 0.5), round(row - 0.5)
    patch = depth[
        max(r - 1, 0) : max(min(r + 2, height), 0), max(c - 1, 0) : max(min(c + 2, width), 0)
    ]
    if patch.size == 0:
        return 0.6
    return float((patch > ahead - 0.35).mean())


def _paler(colour: Point) -> Point:
    return (0.5 + 0.5 * colour[0], 0.5 + 0.5 * colour[1], 0.5 + 0.5 * colour[2])


def _splash(
    image: Float, column: float, row: float, radius: float, strength: float, colour: Point
) -> None:
    """Add a round blot of light that fades to nothing at twice its radius."""
    height, width = image.shape[:2]
    reach = 2.0 * radius + 1.0
    c0, c1 = max(int(column - reach), 0), min(int(column + reach) + 1, width)
    r0, r1 = max(int(row - reach), 0), min(int(row + reach) + 1, height)
    if c0 >= c1 or r0 >= r1:
        return
    dx = (np.arange(c0, c1, dtype=np.float32) + np.float32(0.5 - column))[None, :]
    dy = (np.arange(r0, r1, dtype=np.float32) + np.float32(0.5 - row))[:, None]
    fall = np.maximum(
        1.0 - (dx * dx + dy * dy) * np.float32(1.0 / (4.0 * radius * radius + 1e-6)), 0.0
    )
    fall = fall * fall * fall
    image[r0:r1, c0:c1] += (fall * np.float32(strength))[..., None] * np.array(colour, np.float32)


def add_glare(image: Float, view: View, light: Light, depth: Float) -> None:
    """Add the dazzle of a low sun ahead, in place."""
    far = tuple(view.eye[i] + 1000.0 * light.sun[i] for i in range(3))
    spot = view.pixel((far[0], far[1], far[2]))
    if not light.has_glare or spot is None:
        return
    column, row, _ = spot
    warm = (1.0, 0.90, 0.66)
    disc = _visible(depth, column, row, 399.0)
    shown = 0.55 + 0.45 * disc
    _splash(image, column, row, view.width * 0.7, 84.0 * shown, warm)
    _splash(image, column, row, view.width * 0.12, 150.0 * disc, warm)
    _splash(image, column, row, view.width * 0.04, 255.0 * disc, (1.0, 0.98, 0.9))
