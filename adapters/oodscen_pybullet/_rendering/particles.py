"""Smoke, fire and dust: soft balls blended into a postprocessed picture by depth."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from oodscen.numerics import _exact as exact
from oodscen.numerics._kernels import Kernel
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._meshes.builder import Puff
from oodscen_pybullet._rendering.view import NEAR, CameraView, Point

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]
U8 = NDArray[np.uint8]

Pose = tuple[float, float, float, float]


@dataclass(frozen=True)
class Ball:
    """A puff in world coordinates."""

    position: Point
    radius: float
    colour: Point
    density: float
    is_bright: bool
    row: int
    """Row of the body it belongs to."""


def placed(puffs: Sequence[Puff], pose: Pose, row: int) -> list[Ball]:
    """Return a body's puffs in world coordinates."""
    x, y, z, yaw = pose
    s, c = exact.sincos(yaw)
    balls = []
    for puff in puffs:
        px, py, pz = puff.position
        place = (x + c * px - s * py, y + s * px + c * py, z + pz)
        balls.append(Ball(place, puff.radius, puff.colour, puff.density, puff.is_bright, row))
    return balls


def add_puffs(
    image: U8,
    depth: F32,
    rows: I32,
    view: CameraView,
    balls: Sequence[Ball],
    light: Light,
    rate: float,
    air: Sequence[float],
) -> None:
    """Blend balls into a picture, farthest first, in place.

    Args:
        image: [height, width, 3]
        depth: [height, width] m; in pixels more than half covered by balls, capped at the distance
            of the body's middle ball.
        rows: [height, width] actors; pixels more than half covered by a body's balls get its row.
        view: The camera.
        balls: The balls to blend.
        light: The light of the scene; balls that emit no light darken with it.
        rate: Extinction coefficient of the air, 1/m.
        air: Colour of the air, 0 to 255.
    """
    near = []
    for number, ball in enumerate(balls):
        across, upwards, ahead = view.to_camera(ball.position)
        if ahead > NEAR + 0.2 * ball.radius:
            near.append((-ahead, number, across, upwards, ball))
    if not near:
        return
    cover = np.zeros((len({ball.row for *_, ball in near}), *depth.shape), np.float32)
    layers = {row: index for index, row in enumerate(sorted({ball.row for *_, ball in near}))}
    for behind, _, across, upwards, ball in sorted(near, key=lambda one: one[:2]):
        ahead = -behind
        through = exact.exp(-rate * ahead)
        bright = 1.0 if ball.is_bright else light.daylight
        tone = [
            255.0 * c * (1.0 if ball.is_bright else light.tint[e] * bright)
            for e, c in enumerate(ball.colour)
        ]
        tone = [air[e] + (tone[e] - air[e]) * through for e in range(3)]
        draw_puff(
            image,
            depth,
            cover[layers[ball.row]],
            np.array(
                [
                    view.width / 2 + view.focal * across / ahead,
                    view.height / 2 - view.focal * upwards / ahead,
                    max(view.focal * ball.radius / ahead, 0.4),
                    ahead,
                    ball.radius,
                    ball.density,
                    0.0 if ball.is_bright else 0.34,
                ],
                np.float32,
            ),
            np.array(tone, np.float32),
        )
    for row, index in layers.items():
        filled_up = cover[index] > np.float32(0.5)
        way = sorted(-behind for behind, *_, ball in near if ball.row == row)
        rows[filled_up] = row
        depth[filled_up] = np.minimum(depth[filled_up], np.float32(way[len(way) // 2]))


def filled(view: CameraView, balls: Sequence[Ball], row: int) -> NDArray[np.bool_]:
    """Return the pixels that a body's balls would fill without occlusion."""
    shape = (view.height, view.width)
    image, rows = np.zeros((*shape, 3), np.uint8), np.full(shape, -1, np.int32)
    depth = np.full(shape, np.inf, np.float32)
    some = [ball for ball in balls if ball.row == row]
    add_puffs(image, depth, rows, view, some, _DAY, 0.0, (0.0, 0.0, 0.0))
    return np.asarray(rows == row)


_DAY = Light((0.0, 0.0, 1.0), 1.0, 0.0, 1.0, 0.0, (1.0, 1.0, 1.0), has_glare=False)


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
