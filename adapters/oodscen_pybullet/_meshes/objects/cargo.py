"""Lost cargo and windblown objects that take arithmetic to describe."""

import math

from oodscen_pybullet._meshes.builder import MeshBuilder


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


STILL = (crate, spilled_logs, spilled_gravel, tarpaulin, tumbleweed)
