"""Lost cargo, vehicle parts and windblown objects."""

import itertools
import math

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.look import Appearance


def car_door(mesh: MeshBuilder, shown: Appearance) -> None:
    """A car door, upright as when shut, hinged at its front edge and visible from both sides."""
    paint = shown.paint
    mesh.hull((-0.52, 0.52, -0.04, 0.06, 0.32), (-0.56, 0.54, -0.05, 0.05, 0.94), paint)
    mesh.hull((-0.5, 0.46, -0.085, -0.04, 0.4), (-0.5, 0.48, -0.09, -0.05, 0.9), "dark_grey")
    mesh.box((0.1, -0.1, 0.62), (0.5, 0.04, 0.08), "grey")
    mesh.box((-0.4, 0.065, 0.82), (0.2, 0.03, 0.04), "black")
    top = [(-0.54, 0.94), (-0.42, 1.36), (0.02, 1.36), (0.52, 0.94)]
    for (x0, z0), (x1, z1) in itertools.pairwise(top):
        mesh.beam((x0, 0.0, z0), (x1, -0.06, z1), 0.06, paint)
    glass = [(x, -0.02 - 0.04 * (z > 1), z) for x, z in top]
    mesh.polygon(glass, "glass_light").polygon(glass[::-1], "glass_light")
    mesh.box((0.4, 0.13, 1.0), (0.1, 0.16, 0.13), paint)


def bumper(mesh: MeshBuilder, shown: Appearance) -> None:
    """A torn-off bumper with its number plate, across the lane."""
    paint = shown.paint
    spots = [
        (0.35, -0.86, 0.24),
        (0.08, -0.72, 0.30),
        (0.0, -0.4, 0.32),
        (0.0, 0.4, 0.3),
        (0.06, 0.7, 0.22),
        (0.3, 0.9, 0.14),
    ]
    for (x0, y0, z0), (x1, y1, z1) in itertools.pairwise(spots):
        low0, low1 = max(0.0, z0 - 0.3), max(0.0, z1 - 0.3)
        for dx, colour in ((0.0, paint), (0.03, "dark_grey")):
            quad = [(x0 + dx, y1, low1), (x0 + dx, y0, low0), (x0 + dx, y0, z0), (x0 + dx, y1, z1)]
            quad[0] = (x1 + dx, y1, low1)
            quad[3] = (x1 + dx, y1, z1)
            mesh.polygon(quad if dx == 0.0 else quad[::-1], colour)
        mesh.beam((x0 + 0.05, y0, z0), (x1 + 0.05, y1, z1), 0.1, paint)
        mesh.beam((x0 + 0.05, y0, low0 + 0.04), (x1 + 0.05, y1, low1 + 0.04), 0.08, "dark_grey")
    mesh.picture(
        [(-0.05, 0.27, 0.1), (-0.05, -0.27, 0.1), (-0.05, -0.27, 0.23), (-0.05, 0.27, 0.23)],
        "plate_rear",
    )
    for x, y in ((-0.4, 0.3), (-0.25, -0.5), (-0.5, -0.1), (0.4, 0.1)):
        mesh.box((x, y, 0.015), (0.16, 0.09, 0.03), "tail" if y > 0 else "glass_light")


def barrel(mesh: MeshBuilder, shown: Appearance) -> None:
    """Two steel drums, one upright and one lying."""
    colour = shown.paint

    def one() -> MeshBuilder:
        part = MeshBuilder()
        for low, high in ((0.0, 0.29), (0.31, 0.58), (0.60, 0.88)):
            part.cylinder(
                (0, 0, low), (0, 0, high), 0.285, colour, sides=14, cap_colour="dark_grey"
            )
        for z in (0.0, 0.285, 0.585, 0.86):
            part.cylinder((0, 0, z), (0, 0, z + 0.03), 0.305, "dark_grey", sides=14)
        return part

    mesh.add(one().build(), (0, 0.42, 0))
    mesh.add(one().build(), (0.1, -0.1, 0.305), roll=math.pi / 2)
    mesh.picture(
        [(-0.29, 0.62, 0.3), (-0.29, 0.22, 0.3), (-0.29, 0.22, 0.7), (-0.29, 0.62, 0.7)],
        "sign_danger",
    )


def crate(mesh: MeshBuilder) -> None:
    """A big wooden crate with diagonal battens."""
    half = 0.5
    mesh.box((0, 0, half), (0.96, 0.96, 0.96), "wood")
    for side in (-1.0, 1.0):
        for z in (0.07, 0.93):
            mesh.box((side * 0.48, 0, z), (0.05, 1.0, 0.13), "wood_dark")
            mesh.box((0, side * 0.48, z), (1.0, 0.05, 0.13), "wood_dark")
        for y in (-0.44, 0.44):
            mesh.box((side * 0.48, y, half), (0.05, 0.13, 0.8), "wood_dark")
            mesh.box((y, side * 0.48, half), (0.13, 0.05, 0.8), "wood_dark")
        mesh.beam((side * 0.485, -0.4, 0.14), (side * 0.485, 0.4, 0.86), 0.06, "wood_dark")
        mesh.beam((-0.4, side * 0.485, 0.14), (0.4, side * 0.485, 0.86), 0.06, "wood_dark")


def spilled_logs(mesh: MeshBuilder) -> None:
    """Tree trunks that rolled off a lorry, lying across each other."""
    logs = (
        ((-0.9, -2.0, 0.24), (-0.7, 2.0, 0.24), 0.24),
        ((-0.3, -2.1, 0.22), (-0.2, 1.8, 0.22), 0.22),
        ((0.3, -1.7, 0.25), (0.3, 2.2, 0.25), 0.25),
        ((0.9, -2.2, 0.2), (0.8, 1.6, 0.2), 0.2),
        ((-0.6, -1.8, 0.62), (-0.3, 1.9, 0.64), 0.22),
        ((0.1, -1.9, 0.62), (0.2, 1.5, 0.62), 0.2),
        ((-1.2, 1.2, 0.85), (1.3, -0.7, 0.92), 0.18),
    )
    for index, (start, end, radius) in enumerate(logs):
        bark = ("bark", "bark_dark")[index % 2]
        mesh.cylinder(
            start, end, radius, bark, sides=10, end_radius=0.88 * radius, cap_colour="wood_fresh"
        )
        length = math.sqrt(sum((b - a) ** 2 for a, b in zip(start, end, strict=True)))
        for point, other, r in ((start, end, radius), (end, start, 0.88 * radius)):
            out = tuple(p + 0.006 * (p - q) / length for p, q in zip(point, other, strict=True))
            mesh.cylinder(point, (out[0], out[1], out[2]), 0.55 * r, "wood", sides=8)


def spilled_gravel(mesh: MeshBuilder) -> None:
    """A heap of gravel with stones around it."""
    mesh.ball(
        (0, 0, 0.0),
        (1.3, 1.6, 0.62),
        "gravel",
        around=12,
        down=8,
        jitter=0.13,
        key=401,
    )
    mesh.ball(
        (-0.5, 0.7, 0.0),
        (0.8, 0.7, 0.36),
        "gravel",
        around=10,
        down=6,
        jitter=0.1,
        key=402,
    )
    for index in range(24):
        turn, reach = index * 2.4, 1.0 + 0.05 * (index % 5)
        x, y = 1.25 * reach * math.cos(turn), 1.6 * reach * math.sin(turn)
        size = 0.07 + 0.03 * (index % 3)
        mesh.ball(
            (x, y, 0.6 * size),
            (size, size, 0.8 * size),
            "rock",
            around=5,
            down=4,
            jitter=0.2,
            key=410 + index,
        )
    mesh.flatten(0.0)


def fridge(mesh: MeshBuilder) -> None:
    """A white refrigerator lying on its back, its door ajar."""
    mesh.hull((-0.85, 0.85, -0.32, 0.32, 0.0), (-0.85, 0.85, -0.32, 0.32, 0.52), "white", caps="b")
    mesh.polygon(
        [(-0.85, -0.32, 0.5), (0.85, -0.32, 0.5), (0.85, 0.32, 0.5), (-0.85, 0.32, 0.5)],
        "light_grey",
    )
    mesh.hull((-0.8, 0.8, -0.27, 0.27, 0.505), (-0.8, 0.8, -0.27, 0.27, 0.51), "sky_blue", caps="t")
    for x in (-0.4, 0.0, 0.4):
        mesh.box((x, 0, 0.515), (0.03, 0.54, 0.02), "silver")
    door = [(-0.85, 0.32, 0.52), (0.3, 0.32, 0.52), (0.3, 0.62, 1.04), (-0.85, 0.62, 1.04)]
    mesh.polygon(door, "light_grey").polygon(door[::-1], "white")
    thick = [(x, y + 0.07, z + 0.03) for x, y, z in door]
    mesh.polygon(thick[::-1], "white")
    for a, b in ((0, 1), (1, 2), (2, 3), (3, 0)):
        quad = [door[a], door[b], thick[b], thick[a]]
        mesh.polygon(quad, "light_grey").polygon(quad[::-1], "light_grey")
    mesh.hull((0.32, 0.85, -0.32, 0.32, 0.52), (0.33, 0.85, -0.32, 0.32, 0.6), "white", caps="t")
    mesh.beam((0.4, 0.2, 0.63), (0.7, 0.2, 0.63), 0.04, "silver")
    mesh.beam((-0.4, 0.6, 0.86), (0.0, 0.6, 0.86), 0.05, "silver")
    mesh.box((-0.86, 0.0, 0.16), (0.03, 0.5, 0.2), "black")


def tarpaulin(mesh: MeshBuilder) -> None:
    """A crumpled blue tarpaulin."""
    columns, rows = 9, 8
    heights: dict[tuple[int, int], float] = {}
    for i in range(columns):
        for j in range(rows):
            bump = math.sin(1.7 * i + 0.8 * j) * math.cos(1.1 * j - 0.6 * i) + 0.6 * math.sin(
                2.9 * j + i
            )
            edge = min(i, columns - 1 - i, j, rows - 1 - j)
            heights[i, j] = (
                max(0.02, (0.08 + 0.12 * bump + 0.07 * edge))
                if edge
                else 0.02 + 0.05 * (bump > 0.6)
            )

    def at(i: int, j: int) -> tuple[float, float, float]:
        wave = 0.12 * math.sin(2.1 * j) if i in (0, columns - 1) else 0.0
        return -1.1 + 2.2 * i / (columns - 1) + wave, -1.3 + 2.6 * j / (rows - 1), heights[i, j]

    for i in range(columns - 1):
        for j in range(rows - 1):
            colour = "blue" if (i + j) % 3 else "sky_blue"
            mesh.polygon([at(i, j), at(i + 1, j), at(i + 1, j + 1)], colour)
            mesh.polygon([at(i, j), at(i + 1, j + 1), at(i, j + 1)], "blue")
    for x, y in ((-1.1, -1.3), (1.1, -1.3), (1.1, 1.3), (-1.1, 1.3)):
        mesh.cylinder((x, y, 0.0), (0.97 * x, 0.97 * y, 0.04), 0.05, "silver", sides=6)


def plastic_bag(mesh: MeshBuilder) -> None:
    """A white plastic carrier bag inflated by the wind, printed in blue, with loop handles."""
    mesh.hull((-0.12, 0.12, -0.17, 0.17, 0.0), (-0.17, 0.17, -0.24, 0.24, 0.16), "plastic")
    mesh.hull((-0.17, 0.17, -0.24, 0.24, 0.16), (-0.14, 0.14, -0.23, 0.23, 0.34), "white", caps="")
    mesh.hull((-0.14, 0.14, -0.23, 0.23, 0.34), (-0.06, 0.06, -0.2, 0.2, 0.42), "plastic", caps="t")
    for x, out in ((-0.05, -1.0), (0.05, 1.0)):
        for side in (-1.0, 1.0):
            start, bend = (x, side * 0.17, 0.42), (x + 0.02 * out, side * 0.11, 0.54)
            mesh.beam(start, bend, 0.045, "white")
            mesh.beam(bend, (x + 0.02 * out, 0.0, 0.57), 0.04, "white")
    for side in (-1.0, 1.0):
        mesh.box((side * 0.158, 0, 0.25), (0.012, 0.28, 0.05), "blue")
        mesh.box((side * 0.166, 0, 0.17), (0.012, 0.2, 0.04), "blue")


def tumbleweed(mesh: MeshBuilder) -> None:
    """A ball of dry twigs."""
    middle, radius = 0.42, 0.40
    for index in range(44):
        turn, rise = index * 2.399963, -1 + 2 * (index + 0.5) / 44
        flat = math.sqrt(1 - rise * rise)
        a = (radius * flat * math.cos(turn), radius * flat * math.sin(turn), middle + radius * rise)
        turn += 1.5 + 0.3 * (index % 3)
        rise *= 0.6
        flat = math.sqrt(1 - rise * rise)
        b = (
            radius * flat * math.cos(turn),
            radius * flat * math.sin(turn),
            middle - radius * rise * 0.9,
        )
        mesh.beam(a, b, 0.022, ("straw", "wood_dark", "bark")[index % 3], end_width=0.012)
    mesh.ball(
        (0, 0, middle),
        (0.26, 0.26, 0.26),
        "straw",
        around=7,
        down=5,
        jitter=0.3,
        key=511,
        second_colour="wood_dark",
    )


STILL = (crate, spilled_logs, spilled_gravel, fridge, tarpaulin, plastic_bag, tumbleweed)
VARIED = (car_door, bumper, barrel)
