"""Objects that lie on roads."""

import itertools
import math

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.shapes import upright
from oodscen_pybullet._types import Point


def plant_pot(mesh: MeshBuilder) -> None:
    """A big terracotta pot with a bushy plant."""
    mesh.cylinder((0, 0, 0), (0, 0, 0.46), 0.22, "terracotta", sides=14, end_radius=0.32)
    mesh.cylinder((0, 0, 0.44), (0, 0, 0.54), 0.36, "terracotta", sides=14, cap_colour="soil")
    for index in range(11):
        turn = index * 2.4
        reach, rise = 0.34 + 0.08 * (index % 3), 0.86 + 0.12 * (index % 4)
        tip = (reach * math.cos(turn), reach * math.sin(turn), rise)
        bend = (reach * 0.5 * math.cos(turn), reach * 0.5 * math.sin(turn), rise - 0.06)
        mesh.beam((0, 0, 0.52), bend, 0.035, "leaf_dark")
        _leaf(mesh, bend, tip, 0.11, ("leaf", "leaf_light", "leaf_dark")[index % 3])
    mesh.ball(
        (0, 0, 0.86), (0.22, 0.22, 0.26), "leaf", jitter=0.2, key=3, second_colour="leaf_dark"
    )
    for index in range(5):
        turn = index * 1.3 + 0.4
        mesh.ball(
            (0.2 * math.cos(turn), 0.2 * math.sin(turn), 1.08),
            (0.055, 0.055, 0.05),
            "red",
            around=6,
            down=4,
        )


def _leaf(mesh: MeshBuilder, start: Point, end: Point, width: float, colour: str) -> None:
    """Add a leaf visible from above and below."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = math.sqrt(dx * dx + dy * dy) or 1.0
    ax, ay = -dy / length * width, dx / length * width
    mx, my, mz = (start[0] + end[0]) / 2, (start[1] + end[1]) / 2, (start[2] + end[2]) / 2 + 0.05
    outline = [start, (mx - ax, my - ay, mz), end, (mx + ax, my + ay, mz)]
    mesh.polygon(outline, colour).polygon(outline[::-1], colour)


def _torus(mesh: MeshBuilder, centre: Point, radius: float, thick: float, colour: str) -> None:
    """Add a ring that lies flat."""
    ring, sides = 18, 8
    x, y, z = centre
    points = []
    for i in range(ring):
        turn = 2 * math.pi * i / ring
        for j in range(sides):
            tilt = 2 * math.pi * j / sides
            reach = radius + thick * math.cos(tilt)
            points.append(
                (x + reach * math.cos(turn), y + reach * math.sin(turn), z + thick * math.sin(tilt))
            )
    for i in range(ring):
        for j in range(sides):
            k, m = (i + 1) % ring, (j + 1) % sides
            rows = ((i, j), (k, j), (k, m), (i, m))
            mesh.polygon([points[row * sides + column] for row, column in rows], colour)


def tyre(mesh: MeshBuilder) -> None:
    """A lorry tyre leaning on another one that lies flat."""
    _torus(mesh, (0, 0, 0.14), 0.36, 0.14, "tyre")
    _torus(mesh, (0, 0, 0.14), 0.25, 0.03, "dark_grey")
    lean = MeshBuilder()
    _torus(lean, (0, 0, 0), 0.36, 0.14, "tyre")
    _torus(lean, (0, 0, 0.1), 0.25, 0.03, "grey")
    mesh.add_surface(lean.build(), (0.0, 0.36, 0.60), roll=math.radians(62))


def mattress(mesh: MeshBuilder) -> None:
    """A sagging mattress with striped sides and one end bent up."""
    rows = [(-1.0, 0.0), (-0.4, 0.0), (0.2, 0.0), (0.6, 0.12), (0.92, 0.42)]
    half, thick = 0.72, 0.24
    for (x0, z0), (x1, z1) in itertools.pairwise(rows):
        for index in range(6):
            y0, y1 = -half + 0.24 * index, -half + 0.24 * (index + 1)
            colour = "mattress_stripe" if index % 2 else "mattress"
            mesh.polygon(
                [
                    (x0, y0, z0 + thick),
                    (x1, y0, z1 + thick),
                    (x1, y1, z1 + thick),
                    (x0, y1, z0 + thick),
                ],
                colour,
            )
        mesh.polygon([(x0, -half, z0), (x0, half, z0), (x1, half, z1), (x1, -half, z1)], "mattress")
        for side in (-1.0, 1.0):
            edge = [
                (x0, side * half, z0),
                (x1, side * half, z1),
                (x1, side * half, z1 + thick),
                (x0, side * half, z0 + thick),
            ]
            mesh.polygon(edge if side < 0 else edge[::-1], "mattress_edge")
    (x0, z0), (x1, z1) = rows[0], rows[-1]
    mesh.polygon(upright((x0, half), (x0, -half), z0, z0 + thick), "mattress_edge")
    mesh.polygon(upright((x1, -half), (x1, half), z1, z1 + thick), "mattress_edge")


def debris(mesh: MeshBuilder) -> None:
    """A heap of broken planks, bent metal and rubble."""
    planks = (
        ((-0.9, -0.7, 0.05), (0.8, 0.4, 0.30), "wood"),
        ((-0.7, 0.8, 0.06), (0.6, -0.6, 0.42), "wood_dark"),
        ((-0.2, -1.0, 0.05), (0.3, 0.9, 0.22), "wood_fresh"),
        ((0.9, -0.8, 0.05), (-0.3, 0.2, 0.62), "wood"),
        ((-1.0, 0.1, 0.05), (0.4, 0.3, 0.52), "wood_dark"),
        ((0.1, 1.0, 0.05), (0.0, -0.1, 0.74), "wood_fresh"),
        ((0.95, 0.6, 0.05), (-0.6, -0.3, 0.34), "wood"),
    )
    for start, end, colour in planks:
        mesh.beam(start, end, 0.12, colour)
    for turn in (0.3, 2.1, 4.0):
        x, y = 0.6 * math.cos(turn), 0.6 * math.sin(turn)
        sheet = [
            (x - 0.4, y - 0.25, 0.05),
            (x + 0.3, y - 0.3, 0.12),
            (x + 0.35, y + 0.3, 0.36),
            (x - 0.35, y + 0.25, 0.22),
        ]
        mesh.polygon(sheet, "rust").polygon(sheet[::-1], "metal")
    for index in range(9):
        turn = index * 0.7
        reach = 0.55 + 0.08 * (index % 5)
        mesh.ball(
            (reach * math.cos(turn), reach * math.sin(turn), 0.08),
            (0.15, 0.13, 0.10),
            "concrete_dark" if index % 2 else "wall_brick",
            around=6,
            down=4,
            jitter=0.25,
            key=20 + index,
        )
    mesh.ball((0, 0, 0.1), (0.75, 0.7, 0.24), "earth", around=9, down=4, jitter=0.2, key=31)


def shopping_cart(mesh: MeshBuilder) -> None:
    """A supermarket trolley."""
    bottom = [(-0.28, -0.2), (0.36, -0.2), (0.36, 0.2), (-0.28, 0.2)]
    top = [(-0.42, -0.28), (0.46, -0.28), (0.46, 0.28), (-0.42, 0.28)]
    for i in range(4):
        j = (i + 1) % 4
        for k in range(6):
            a, b = (_between(rim[i], rim[j], k / 5) for rim in (bottom, top))
            mesh.beam((*a, 0.42), (*b, 0.92), 0.018, "silver")
        for k in range(4):
            z = 0.42 + 0.5 * (k / 3)
            a, b = (_between(bottom[corner], top[corner], k / 3) for corner in (i, j))
            mesh.beam((*a, z), (*b, z), 0.022, "silver" if k < 3 else "light_grey")
    mesh.polygon([(x, y, 0.42) for x, y in bottom], "metal")
    mesh.beam((-0.50, -0.28, 1.0), (-0.50, 0.28, 1.0), 0.05, "red")
    for side in (-1.0, 1.0):
        mesh.beam((-0.42, side * 0.27, 0.92), (-0.50, side * 0.27, 1.0), 0.03, "silver")
        mesh.beam((-0.34, side * 0.24, 0.14), (-0.40, side * 0.27, 0.9), 0.035, "silver")
        mesh.beam((-0.36, side * 0.22, 0.16), (0.42, side * 0.20, 0.16), 0.035, "silver")
        mesh.beam((0.38, side * 0.2, 0.16), (0.30, side * 0.2, 0.42), 0.03, "silver")
        for x in (-0.34, 0.40):
            mesh.cylinder((x, side * 0.19, 0.07), (x, side * 0.24, 0.07), 0.07, "black", sides=8)
    mesh.box((0.05, -0.05, 0.56), (0.3, 0.2, 0.26), "cardboard")
    mesh.box((-0.15, 0.09, 0.52), (0.16, 0.16, 0.18), "shirt_green")


def _between(a: tuple[float, float], b: tuple[float, float], f: float) -> tuple[float, float]:
    return a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1])


STILL = (plant_pot, tyre, mattress, debris, shopping_cart)
