"""Lorries, buses and machines."""

import math

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.look import Appearance, Lights
from oodscen_pybullet._meshes.vehicles.bodywork import (
    AMBER,
    arches,
    front_print,
    head_lamps,
    light_bar,
    pillar,
    plates,
    rear_lamps,
    rear_print,
    side_print,
)


def cab(
    mesh: MeshBuilder, lights: Lights, paint: str, front: float, depth: float, top: float
) -> None:
    """Add a cab-over-engine cab that ends at x = front."""
    rear, half = front - depth, 1.18
    mesh.hull((rear, front, -half, half, 0.5), (rear, front, -half, half, 1.45), paint)
    mesh.hull(
        (rear, front - 0.02, -half, half, 1.45),
        (rear, front - 0.22, -half + 0.05, half - 0.05, top - 0.3),
        paint,
        caps="",
        sides=("glass", "glass", "glass", paint),
    )
    mesh.hull(
        (rear, front - 0.2, -half + 0.04, half - 0.04, top - 0.32),
        (rear, front - 0.45, -half + 0.12, half - 0.12, top),
        paint,
        caps="t",
    )
    pillar(
        mesh, (front - 0.04, half - 0.02, 1.45), (front - 0.22, half - 0.07, top - 0.28), paint, 0.1
    )
    pillar(mesh, (rear + 0.3, half - 0.02, 1.45), (rear + 0.3, half - 0.05, top - 0.28), paint, 0.3)
    mesh.box((front - 0.05, 0, 0.55), (0.2, 2.34, 0.34), "dark_grey")
    front_print(mesh, front + 0.012, 0.7, (0.95, 1.35), "grille")
    head_lamps(mesh, lights, front + 0.03, 0.82, 0.78, (0.34, 0.2))
    for side in (-1.0, 1.0):
        mesh.box((front - 0.1, side * 1.28, 1.95), (0.1, 0.14, 0.5), "black")


def truck(mesh: MeshBuilder, shown: Appearance) -> None:
    """A lorry with a box body."""
    cab(mesh, shown.lights, shown.paint, 4.0, 1.9, 2.9)
    mesh.box((-1.0, 0, 2.15), (6.0, 2.44, 2.5), "white")
    mesh.box((-1.0, 0, 0.72), (6.0, 0.9, 0.3), "dark_grey")
    for side in (-1.0, 1.0):
        mesh.box((-1.0, side * 1.225, 1.5), (6.0, 0.02, 0.22), shown.paint)
        mesh.box((0.0, side * 1.1, 0.62), (2.0, 0.12, 0.4), "grey")
        mesh.box((-4.01, side * 0.06, 2.15), (0.03, 0.03, 2.4), "dark_grey")
        mesh.box((-4.01, side * 0.4, 2.15), (0.04, 0.05, 2.3), "light_grey")
        mesh.box((-4.01, side * 1.12, 2.15), (0.02, 0.16, 2.4), "light_grey")
    mesh.box((-3.98, 0, 3.3), (0.08, 2.4, 0.14), shown.paint)
    mesh.box((-3.9, 0, 0.55), (0.1, 2.3, 0.14), "dark_grey")
    rear_print(mesh, -3.955, 1.1, (0.49, 0.61), "stripes")
    rear_lamps(mesh, shown.lights, -3.98, 0.95, 0.84, (0.4, 0.12))
    plates(mesh, (-4.02, 0.8), (4.06, 0.55))
    for x in (-2.6, 2.9):
        for side in (-1.0, 1.0):
            mesh.wheel(x, side * 1.02, 0.5, 0.36, hub="light_grey")


def overturned_truck(mesh: MeshBuilder, shown: Appearance) -> None:
    """The lorry on its right side, with its wheels towards the viewer's left."""
    whole = MeshBuilder()
    truck(whole, shown)
    mesh.add(whole.build(), roll=math.pi / 2).centred()
    if shown.lights.left or shown.lights.right:
        for x in (-4.0, 4.0):
            for y in (-0.9, 0.9):
                mesh.lamp((x, y, 0.5), AMBER, (1.0 if x > 0 else -1.0, 0, 0), 2.5)


def bus(mesh: MeshBuilder, shown: Appearance) -> None:
    """A city bus."""
    mesh.box((0, 0, 0.85), (10.8, 2.5, 1.1), shown.paint)
    mesh.hull((-5.4, 5.4, -1.25, 1.25, 1.4), (-5.38, 5.3, -1.22, 1.22, 2.55), "glass", caps="")
    mesh.hull((-5.4, 5.34, -1.24, 1.24, 2.5), (-5.3, 5.1, -1.12, 1.12, 3.0), shown.paint, caps="t")
    for index in range(8):
        x = -5.3 + 1.5 * index
        for side in (-1.0, 1.0):
            mesh.box((x, side * 1.24, 1.95), (0.14, 0.04, 1.2), shown.paint)
    for side in (-1.0, 1.0):
        mesh.box((0, side * 1.26, 1.32), (10.7, 0.02, 0.1), "white")
        mesh.box((-5.38, side * 1.12, 1.95), (0.06, 0.26, 1.2), shown.paint)
        mesh.box((5.2, side * 1.36, 2.2), (0.12, 0.16, 0.42), "black")
    mesh.box((-5.39, 0, 1.72), (0.06, 2.3, 0.62), shown.paint)
    mesh.box((-5.41, 0, 0.95), (0.04, 1.2, 0.5), "dark_grey")
    mesh.box((-5.41, 0, 2.72), (0.04, 0.9, 0.26), "black")
    mesh.box((-5.44, 0, 2.72), (0.02, 0.6, 0.14), "amber_lit")
    mesh.box((5.36, 0, 2.72), (0.04, 1.6, 0.3), "black")
    mesh.box((5.39, 0, 2.72), (0.02, 1.1, 0.16), "amber_lit")
    mesh.box((-5.41, 0, 0.42), (0.08, 2.4, 0.2), "dark_grey")
    rear_lamps(mesh, shown.lights, -5.41, 1.06, 1.15, (0.2, 0.42))
    head_lamps(mesh, shown.lights, 5.41, 0.9, 0.75, (0.36, 0.2))
    plates(mesh, (-5.46, 0.6), (5.43, 0.5))
    for x in (-3.2, 2.9):
        arches(mesh, x, 1.25, 0.56)
        for side in (-1.0, 1.0):
            mesh.wheel(x, side * 1.1, 0.48, 0.32, hub="light_grey")


def fire_truck(mesh: MeshBuilder, shown: Appearance) -> None:
    """A fire engine with ladder, shutters and beacons."""
    red = "fire_red"
    cab(mesh, shown.lights, red, 4.0, 2.4, 2.75)
    mesh.box((-1.25, 0, 1.75), (5.3, 2.46, 2.3), red)
    mesh.box((-1.25, 0, 0.62), (5.3, 0.9, 0.3), "dark_grey")
    side_print(mesh, (-0.6, 1.2), 1.24, (2.3, 2.75), "fire")
    for side in (-1.0, 1.0):
        for x in (-3.2, -0.2):
            mesh.box((x, side * 1.225, 1.55), (1.3, 0.03, 1.2), "light_grey")
        mesh.box((-1.25, side * 1.235, 0.78), (5.3, 0.02, 0.2), "white")
        mesh.beam((-3.9, side * 0.35, 3.05), (2.2, side * 0.35, 3.05), 0.09, "metal")
    for index in range(13):
        x = -3.8 + 0.48 * index
        mesh.beam((x, -0.35, 3.05), (x, 0.35, 3.05), 0.06, "metal")
    rear_print(mesh, -3.91, 1.15, (0.75, 1.5), "chevrons")
    mesh.box((-3.91, 0, 2.1), (0.03, 1.5, 0.9), "light_grey")
    rear_print(mesh, -3.912, 0.6, (2.62, 2.86), "fire")
    rear_lamps(mesh, shown.lights, -3.92, 1.06, 1.85, (0.18, 0.4))
    mesh.box((-3.9, 0, 0.55), (0.1, 2.3, 0.16), "dark_grey")
    plates(mesh, (-3.96, 0.62), (4.06, 0.55))
    light_bar(mesh, shown.lights, 3.0, 2.74, 0.8)
    for side in (-1.0, 1.0):
        is_lit = shown.lights.beacon and (side > 0) == shown.lights.is_second
        glow = "beacon_lit" if is_lit else "beacon"
        mesh.box((-3.75, side * 1.05, 3.0), (0.2, 0.2, 0.2), glow)
        if is_lit:
            mesh.lamp((-3.75, side * 1.05, 3.0), (0.25, 0.5, 1.0), (0, 0, 0), 4.0)
    for x in (-2.3, 2.7):
        arches(mesh, x, 1.245, 0.56)
        for side in (-1.0, 1.0):
            mesh.wheel(x, side * 1.06, 0.5, 0.36, hub="light_grey")


def tractor(mesh: MeshBuilder, shown: Appearance) -> None:
    """A farm tractor."""
    mesh.hull((0.2, 1.95, -0.36, 0.36, 0.75), (0.2, 1.9, -0.32, 0.32, 1.5), "green")
    mesh.box((1.96, 0, 1.12), (0.06, 0.56, 0.6), "dark_grey")
    mesh.box((0.0, 0, 0.75), (3.0, 0.4, 0.4), "dark_grey")
    mesh.hull((-1.25, 0.25, -0.68, 0.68, 1.3), (-1.1, 0.1, -0.6, 0.6, 2.5), "glass", caps="")
    mesh.box((-0.5, 0, 2.56), (1.5, 1.4, 0.14), "green")
    for x0, x1 in ((-1.23, -1.1), (0.23, 0.1)):
        pillar(mesh, (x0, 0.66, 1.3), (x1, 0.6, 2.5), "dark_grey", 0.09)
    mesh.cylinder((1.2, 0.25, 1.5), (1.2, 0.25, 2.3), 0.05, "dark_grey")
    for side in (-1.0, 1.0):
        mesh.wheel(-0.95, side * 0.86, 0.82, 0.46, hub="yellow")
        mesh.wheel(1.45, side * 0.78, 0.5, 0.34, hub="yellow")
        mesh.hull(
            (-1.7, -0.2, side * 0.88 - 0.24, side * 0.88 + 0.24, 1.62),
            (-1.5, -0.4, side * 0.88 - 0.22, side * 0.88 + 0.22, 1.72),
            "green",
        )
    rear_lamps(mesh, shown.lights, -1.74, 0.88, 1.62, (0.22, 0.1))
    head_lamps(mesh, shown.lights, 1.99, 0.2, 1.34, (0.16, 0.12))
    mesh.beam((-1.5, 0, 0.6), (-2.0, 0, 0.6), 0.12, "dark_grey")
    mesh.polygon([(-1.52, 0.28, 0.82), (-1.52, -0.28, 0.82), (-1.52, 0, 1.3)], "orange")
    blink = "amber_lit" if shown.lights.left and shown.lights.right else "amber"
    mesh.cylinder((-0.9, 0.5, 2.63), (-0.9, 0.5, 2.8), 0.07, blink)
    if shown.lights.left and shown.lights.right:
        mesh.lamp((-0.9, 0.5, 2.72), AMBER, (0, 0, 0), 3.0)
    mesh.centred()


def excavator(mesh: MeshBuilder, shown: Appearance) -> None:
    """A tracked excavator with its boom forward and its bucket down."""
    for side in (-1.0, 1.0):
        y = side * 1.0
        mesh.hull(
            (-1.7, 1.7, y - 0.28, y + 0.28, 0.0),
            (-2.0, 2.0, y - 0.28, y + 0.28, 0.4),
            "black",
            caps="b",
        )
        mesh.hull(
            (-2.0, 2.0, y - 0.28, y + 0.28, 0.4),
            (-1.7, 1.7, y - 0.28, y + 0.28, 0.82),
            "black",
            caps="t",
        )
        for x in (-1.5, -0.75, 0.0, 0.75, 1.5):
            mesh.cylinder((x, y + side * 0.2, 0.4), (x, y + side * 0.3, 0.4), 0.24, "dirty_hub")
    mesh.cylinder((0, 0, 0.7), (0, 0, 1.05), 0.7, "dark_grey")
    mesh.hull((-2.1, 1.3, -1.2, 1.2, 1.05), (-2.1, 1.3, -1.2, 1.2, 1.35), "machine_dark")
    mesh.hull((-2.15, -0.2, -1.2, 1.2, 1.35), (-2.0, -0.3, -1.15, 1.15, 2.15), "machine")
    mesh.box((-2.17, 0, 1.75), (0.04, 1.4, 0.4), "black")
    rear_print(mesh, -2.16, 1.15, (1.1, 1.32), "stripes")
    mesh.hull((-0.1, 1.35, 0.2, 1.2, 1.35), (-0.1, 1.35, 0.2, 1.2, 1.8), "machine")
    mesh.hull((-0.1, 1.35, 0.2, 1.2, 1.8), (0.0, 1.15, 0.26, 1.14, 2.8), "glass", caps="")
    mesh.hull((-0.1, 1.3, 0.2, 1.2, 2.78), (0.0, 1.2, 0.26, 1.14, 2.9), "machine", caps="t")
    for x0, x1, y in ((-0.1, 0.0, 0.2), (1.35, 1.15, 0.22), (-0.1, 0.0, 1.2), (1.35, 1.15, 1.18)):
        mesh.beam((x0, y, 1.8), (x1, 0.28 if y < 0.5 else 1.12, 2.8), 0.1, "machine")
    joint, elbow, wrist = (1.0, -0.35, 1.5), (3.0, -0.35, 3.6), (4.5, -0.35, 1.5)
    mesh.beam(joint, (2.1, -0.35, 3.3), 0.5, "machine", end_width=0.44)
    mesh.beam((2.05, -0.35, 3.25), (3.5, -0.35, 3.45), 0.44, "machine", end_width=0.36)
    mesh.beam((3.1, -0.35, 3.75), wrist, 0.4, "machine", end_width=0.26)
    mesh.cylinder((1.3, -0.35, 1.5), (2.3, -0.35, 2.9), 0.09, "metal")
    mesh.cylinder((2.0, -0.35, 3.65), elbow, 0.09, "metal")
    mesh.hull((4.0, 4.7, -0.85, 0.15, 0.55), (4.2, 4.9, -0.85, 0.15, 1.5), "dark_grey")
    mesh.hull((3.7, 4.2, -0.85, 0.15, 0.2), (4.0, 4.7, -0.85, 0.15, 0.56), "dark_grey")
    for index in range(5):
        mesh.beam(
            (3.8, -0.77 + 0.21 * index, 0.26),
            (3.5, -0.77 + 0.21 * index, 0.04),
            0.09,
            "metal",
            end_width=0.03,
        )
    blink = "amber_lit" if shown.lights.left and shown.lights.right else "amber"
    mesh.cylinder((-0.0, 0.7, 2.9), (-0.0, 0.7, 3.08), 0.08, blink)
    if shown.lights.left and shown.lights.right:
        mesh.lamp((0.0, 0.7, 3.0), AMBER, (0, 0, 0), 3.0)
    rear_lamps(mesh, shown.lights, -2.19, 0.95, 1.55, (0.2, 0.1))
    mesh.centred()


VARIED = (truck, overturned_truck, bus, fire_truck, tractor, excavator)
