"""Draws heaps, swarms and veils."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from oodscen.data._designs import shapes
from oodscen.data._designs.colours import rgb_of
from oodscen.numerics._exact import cos, sin
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.designs.parts import Placing, add
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._meshes.shapes import GOLDEN_ANGLE
from oodscen_pybullet._types import Point


@add.register
def _(part: shapes.Heap, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    rng = np.random.Generator(np.random.PCG64(part.key))
    length, width, height = part.size
    heap = MeshBuilder()
    colours = shown.colour(part.colour), shown.colour(part.second_colour or part.colour)
    mean_radius = 0.85 * math.sqrt(length * width / part.lumps)
    draws = rng.uniform(0.0, 1.0, (part.lumps, 2)).tolist()
    for index, (size_draw, height_draw) in enumerate(draws):
        out = math.sqrt((index + 0.5) / part.lumps)
        lump = min(mean_radius * (0.8 + 0.4 * size_draw), 0.45 * length, 0.45 * width)
        x = (length / 2 - lump) * out * cos(index * GOLDEN_ANGLE)
        y = (width / 2 - lump) * out * sin(index * GOLDEN_ANGLE)
        high = height * (1 - 0.6 * out * out * out) * (0.75 + 0.25 * height_draw)
        tall = min(lump, high)
        grown = 1.0 + part.rough
        middle = high - tall
        ball = MeshBuilder().ball(
            (x, y, middle), (lump / grown, lump / grown, tall / grown),
            colours[index % 3 == 0], around=7, down=4, jitter=part.rough, key=part.key + index,
        ).build()  # fmt: skip
        # The lower half of what would hang in the air reaches down to the ground.
        is_low = ball.vertices[:, 2] < middle
        ball.vertices[is_low, 2] -= max(0.0, middle - tall / grown * (1.0 - part.rough))
        heap.add_surface(ball)
    mesh.add_surface(heap.flatten(0.0).build(), place.point((*part.heap, 0.0)))


@add.register
def _(part: shapes.Swarm, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    rng = np.random.Generator(np.random.PCG64(part.key))
    reaches = [max(0.0, size - part.speck) / 2 for size in part.size]
    colours = shown.colour(part.colour), shown.colour(part.second_colour or part.colour)
    ways = rng.uniform(-1.0, 1.0, (part.count, 4))
    for index, (a, b, c, share) in enumerate(ways.tolist()):
        norm = max(0.3, math.sqrt(a * a + b * b + c * c))
        out = math.sqrt(abs(share)) / norm
        x, y, z = (
            middle + reach * out * way
            for middle, reach, way in zip(part.swarm, reaches, (a, b, c), strict=True)
        )
        radius = part.speck / 2
        mesh.ball(
            place.point((x, y, z)), (radius, radius, radius), colours[index % 2], around=4, down=2
        )


@add.register
def _(part: shapes.Veil, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    rng = np.random.Generator(np.random.PCG64(part.key))
    red, green, blue = rgb_of(part.colour) or (128, 128, 128)
    colour: Point = (red / 255, green / 255, blue / 255)
    x, y, z = part.veil
    for index, draws in enumerate(rng.uniform(0.0, 1.0, (part.puffs, 2)).tolist()):
        share, turn = (index + 0.5) / part.puffs, index * GOLDEN_ANGLE
        puff = _in_cloud(part, share, draws) if part.form == "cloud" else _in_plume(part, share)
        rise = puff.radius + max(0.0, part.size[2] - 2 * puff.radius) * puff.up
        at = (x + puff.ahead * cos(turn), y + puff.aside * sin(turn), z + rise)
        mesh.puff(place.point(at), puff.radius, colour, puff.density, is_bright=part.bright)


class _Puff(NamedTuple):
    """A puff of a veil before it is turned about the veil's middle."""

    radius: float
    ahead: float
    aside: float
    """Largest distances of its centre from the middle along x and y, m."""
    up: float
    """Share of the way from the ground to the top."""
    density: float


def _in_cloud(part: shapes.Veil, share: float, draws: Sequence[float]) -> _Puff:
    """Return a puff anywhere in a cloud, at a share of the way outwards."""
    length, width, height = part.size
    size_draw, up = draws
    radius = max(0.15, min(0.45 * min(length, width, height) * (0.7 + 0.5 * size_draw), 1.5))
    out = math.sqrt(share)
    ahead, aside = max(0.0, length / 2 - radius) * out, max(0.0, width / 2 - radius) * out
    return _Puff(radius, ahead, aside, up, part.density)


def _in_plume(part: shapes.Veil, share: float) -> _Puff:
    """Return a puff of a funnel or jet, at a share of the way up."""
    length, width, height = part.size
    wide = (0.15 + 0.85 * share) if part.form == "funnel" else (0.5 + 0.5 * share)
    radius = max(0.12, min(0.33 * min(length, width) * wide, height / 2))
    sway = 0.5 * wide
    ahead, aside = (length / 2 - radius) * sway, (width / 2 - radius) * sway
    return _Puff(radius, ahead, aside, share, part.density * (1.0 - 0.4 * share))
