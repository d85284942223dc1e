"""Smoke, fire and dust: soft balls blended into a developed picture by depth."""

import math
from collections.abc import Sequence

import numpy as np

from oodscen.numerics import _exact as exact
from oodscen.numerics._kernels import Kernel
from oodscen_pybullet._rendering.stage import PlacedPuff, RawPicture
from oodscen_pybullet._rendering.view import NEAR_M, CameraView
from oodscen_pybullet._types import F32, U8, Mask, Point


def add_puffs(image: U8, picture: RawPicture, rate: float, air: Sequence[float]) -> None:
    """Blend smoke, fire and dust into a picture, farthest first, in place.

    Pixels more than half covered by a body's balls get its row, and at most the distance of its middle ball; where
    several bodies cover one, the body with the nearest middle ball counts.

    Args:
        image: [height, width, 3]
        picture: The balls, the camera and the light; balls that emit no light darken with it.
        rate: Extinction coefficient of the air, 1/m.
        air: Colour of the air, 0 to 255.
    """
    view, light, shot = picture.view, picture.light, picture.shot
    covers: dict[int, F32] = {}
    distances: dict[int, list[float]] = {}
    for ahead, (puff, row), circle in _from_afar(view, picture.balls):
        through = exact.exp(-rate * ahead)
        tint: Point = (1.0, 1.0, 1.0) if puff.is_bright else light.tint
        bright = 1.0 if puff.is_bright else light.daylight
        tone = [255.0 * c * (tint[e] * bright) for e, c in enumerate(puff.colour)]
        colour = [air[e] + (tone[e] - air[e]) * through for e in range(3)]
        cover = covers.setdefault(row, np.zeros(shot.depth.shape, np.float32))
        draw_puff(image, shot.depth, cover, circle, np.array(colour, np.float32))
        distances.setdefault(row, []).append(ahead)
    middles = {row: sorted(aheads)[len(aheads) // 2] for row, aheads in distances.items()}
    for row in sorted(middles, key=lambda row: -middles[row]):
        is_filled = covers[row] > np.float32(0.5)
        shot.rows[is_filled] = row
        shot.depth[is_filled] = np.minimum(shot.depth[is_filled], np.float32(middles[row]))


def covered_pixels(view: CameraView, balls: Sequence[PlacedPuff]) -> Mask:
    """Return the pixels that balls would fill without occlusion."""
    shape = (view.height, view.width)
    image, cover = np.zeros((*shape, 3), np.uint8), np.zeros(shape, np.float32)
    depth, black = np.full(shape, np.inf, np.float32), np.zeros(3, np.float32)
    for _, _, circle in _from_afar(view, balls):
        draw_puff(image, depth, cover, circle, black)
    return np.asarray(cover > np.float32(0.5))


def _from_afar(
    view: CameraView, balls: Sequence[PlacedPuff]
) -> list[tuple[float, PlacedPuff, F32]]:
    """Return the balls ahead, farthest first, each with its distance, m, and as `draw_puff` takes it."""
    circles = []
    for ball in balls:
        puff = ball.puff
        across, upwards, ahead = view.to_camera(puff.position)
        if ahead > NEAR_M + 0.2 * puff.radius:
            column = view.width / 2 + view.focal * across / ahead
            row = view.height / 2 - view.focal * upwards / ahead
            radius = max(view.focal * puff.radius / ahead, 0.4)
            shade = 0.0 if puff.is_bright else 0.34
            circle = (column, row, radius, ahead, puff.radius, puff.density, shade)
            circles.append((ahead, ball, np.array(circle, np.float32)))
    return sorted(circles, key=lambda circle: -circle[0])


@Kernel
def draw_puff(image: U8, depth: F32, cover: F32, ball: F32, colour: F32) -> None:
    """Blend one ball into a picture.

    Args:
        image: [height, width, 3], changed in place.
        depth: [height, width] m
        cover: [height, width] coverage of each pixel by the body's earlier balls, changed in place.
        ball: [7] column, row and radius, pixels; distance and radius, m; density; relative darkness
            of its underside.
        colour: [3] 0 to 255.
    """
    height, width = depth.shape
    one, half, zero = np.float32(1.0), np.float32(0.5), np.float32(0.0)
    column, row, radius = ball[0] - half, ball[1] - half, ball[2]
    top, bottom = max(math.ceil(row - radius), 0), min(math.floor(row + radius) + 1, height)
    left, right = max(math.ceil(column - radius), 0), min(math.floor(column + radius) + 1, width)
    scale = one / radius
    for y in range(int(top), int(bottom)):
        dy = (np.float32(y) - row) * scale
        shade = one - ball[6] * (half + half * dy)
        for x in range(int(left), int(right)):
            dx = (np.float32(x) - column) * scale
            rest = one - dx * dx - dy * dy
            if rest <= zero:
                continue
            # An object inside the ball hides only the part of the ball behind it.
            room = (depth[y, x] - ball[3] + ball[4]) / (np.float32(2.0) * ball[4])
            part = ball[5] * rest * np.sqrt(rest) * min(max(room, zero), one)
            cover[y, x] += (one - cover[y, x]) * part
            for e in range(3):
                before = np.float32(image[y, x, e])
                after = before + (min(colour[e] * shade, np.float32(255.0)) - before) * part
                image[y, x, e] = np.uint8(after + half)
