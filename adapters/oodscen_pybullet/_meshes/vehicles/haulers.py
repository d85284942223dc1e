"""Specialised lorries, buses and machines, facing x."""

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.look import Appearance, Lights
from oodscen_pybullet._meshes.vehicles.bodywork import (
    AMBER,
    arches,
    front_print,
    head_lamps,
    plates,
    rear_lamps,
    rear_print,
    side_print,
)
from oodscen_pybullet._meshes.vehicles.heavy import cab


def _axles(mesh: MeshBuilder, xs: tuple[float, ...], radius: float = 0.5) -> None:
    for x in xs:
        for side in (-1.0, 1.0):
            mesh.wheel(x, side * 1.02, radius, 0.36, hub="light_grey")


def _chassis(mesh: MeshBuilder, rear: float, front: float) -> None:
    mesh.box(((rear + front) / 2, 0, 0.74), (front - rear, 0.9, 0.3), "dark_grey")
    mesh.box((rear + 0.06, 0, 0.55), (0.1, 2.3, 0.16), "dark_grey")
    rear_print(mesh, rear + 0.005, 1.1, (0.49, 0.61), "stripes")


def _beacon(mesh: MeshBuilder, lights: Lights, x: float, y: float, z: float) -> None:
    """Add an amber lamp that rotates while the beacon or the hazard lamps are on."""
    is_lit = (lights.left and lights.right) or (lights.beacon and not lights.is_second)
    mesh.cylinder((x, y, z), (x, y, z + 0.2), 0.1, "amber_lit" if is_lit else "amber", sides=8)
    if is_lit:
        mesh.lamp((x, y, z + 0.12), AMBER, (0, 0, 0), 3.0)


def school_bus(mesh: MeshBuilder, shown: Appearance) -> None:
    """A yellow school bus with a bonnet; the hazard state flashes its red lamps."""
    lights, paint = shown.lights, "school_bus"
    mesh.box((-0.9, 0, 1.15), (8.2, 2.4, 1.3), paint)
    mesh.hull((-5.0, 3.2, -1.2, 1.2, 1.8), (-4.98, 3.02, -1.17, 1.17, 2.55), "glass", caps="")
    mesh.hull((-5.0, 3.04, -1.19, 1.19, 2.5), (-4.9, 2.9, -0.95, 0.95, 2.95), paint, caps="t")
    mesh.hull((3.2, 4.7, -1.0, 1.0, 0.7), (3.2, 4.6, -0.9, 0.9, 1.62), paint)
    for side in (-1.0, 1.0):
        for k in range(9):
            mesh.box((-4.98 + 0.98 * k, side * 1.19, 2.15), (0.12, 0.04, 0.78), paint)
        for z in (1.0, 1.45, 1.76):
            mesh.box((-0.9, side * 1.205, z), (8.2, 0.02, 0.07), "black")
        mesh.box((3.3, side * 1.38, 1.9), (0.12, 0.14, 0.5), "black")
        mesh.box((3.95, side * 1.0, 0.72), (1.3, 0.36, 0.16), "black")
    side_print(mesh, (-2.6, 1.2), 1.212, (1.5, 1.74), "sign_school")
    rear_print(mesh, -5.012, 0.95, (2.56, 2.86), "sign_school")
    front_print(mesh, 2.99, 0.95, (2.6, 2.9), "sign_school")
    mesh.box((-5.0, 0, 2.1), (0.04, 1.4, 0.6), "glass")
    mesh.box((-5.0, 0, 1.3), (0.03, 0.8, 0.9), "school_bus")
    for side in (-1.0, 1.0):
        lit = lights.left if side > 0 else lights.right
        for x, out in ((-5.01, -1.0), (3.02, 1.0)):
            mesh.cylinder(
                (x, side * 1.0, 2.7), (x + out * 0.05, side * 1.0, 2.7), 0.12,
                "red_lit" if lit else "tail", sides=10,
            )  # fmt: skip
            if lit:
                mesh.lamp((x, side * 1.0, 2.7), (1.0, 0.12, 0.08), (out, 0, 0), 2.5)
    mesh.box((-5.05, 0, 0.62), (0.12, 2.4, 0.24), "black")
    mesh.box((4.7, 0, 0.62), (0.14, 2.2, 0.28), "black")
    front_print(mesh, 4.71, 0.5, (0.9, 1.4), "grille")
    head_lamps(mesh, lights, 4.66, 0.74, 1.1, (0.24, 0.2))
    rear_lamps(mesh, lights, -5.02, 0.98, 1.3, (0.22, 0.22))
    plates(mesh, (-5.12, 0.62), (4.78, 0.62))
    for x in (-2.9, 3.9):
        arches(mesh, x, 1.2, 0.54)
        for side in (-1.0, 1.0):
            mesh.wheel(x, side * 1.05, 0.48, 0.3, hub="black")


def garbage_truck(mesh: MeshBuilder, shown: Appearance) -> None:
    """A refuse lorry with a rounded body and a loader at the rear."""
    lights = shown.lights
    cab(mesh, lights, "white", 4.0, 1.8, 2.8)
    _chassis(mesh, -3.9, 2.2)
    mesh.hull((-2.6, 2.1, -1.22, 1.22, 0.95), (-2.6, 2.1, -1.24, 1.24, 2.6), "garbage")
    mesh.hull((-2.6, 2.1, -1.24, 1.24, 2.6), (-2.5, 2.0, -0.8, 0.8, 3.2), "garbage", caps="t")
    for side in (-1.0, 1.0):
        for x in (-2.1, -1.1, -0.1, 0.9, 1.8):
            mesh.box((x, side * 1.245, 1.8), (0.14, 0.04, 1.6), "bin_dark")
        mesh.box((-4.1, side * 0.9, 1.5), (0.3, 0.12, 1.0), "machine")
        mesh.box((-4.05, side * 1.15, 0.6), (0.4, 0.3, 0.06), "silver")
    mesh.hull((-4.0, -2.6, -1.2, 1.2, 0.95), (-3.5, -2.6, -1.2, 1.2, 3.05), "garbage")
    mesh.polygon(
        [(-4.005, 1.0, 1.05), (-4.005, -1.0, 1.05), (-3.76, -1.0, 2.1), (-3.76, 1.0, 2.1)], "black"
    )
    mesh.box((-4.0, 0, 1.1), (0.3, 2.0, 0.16), "machine")
    rear_print(mesh, -4.17, 1.1, (0.62, 0.92), "chevrons")
    mesh.box((-4.1, 0, 0.76), (0.12, 2.3, 0.34), "dark_grey")
    for y in (-0.45, 0.45):
        mesh.hull(
            (-4.7, -4.2, y - 0.26, y + 0.26, 0.3),
            (-4.75, -4.15, y - 0.3, y + 0.3, 1.2),
            "bin_green",
        )
        mesh.box((-4.45, y, 1.24), (0.64, 0.62, 0.08), "bin_dark")
    rear_lamps(mesh, lights, -3.98, 1.06, 2.3, (0.16, 0.36))
    _beacon(mesh, lights, 3.0, 0.8, 2.78)
    _beacon(mesh, lights, -3.2, 0.9, 3.04)
    plates(mesh, (-4.18, 0.76), (4.06, 0.55))
    _axles(mesh, (-2.6, -1.5, 2.9))


def tow_truck(mesh: MeshBuilder, shown: Appearance) -> None:
    """A recovery lorry with a crane and an empty flatbed."""
    lights = shown.lights
    cab(mesh, lights, "orange", 4.0, 1.9, 2.7)
    _chassis(mesh, -3.9, 2.0)
    mesh.hull((-3.95, 1.9, -1.2, 1.2, 0.95), (-3.95, 1.9, -1.2, 1.2, 1.1), "orange")
    mesh.hull((-3.9, 1.9, -1.15, 1.15, 1.1), (-3.9, 1.9, -1.15, 1.15, 1.12), "dark_grey", caps="t")
    for side in (-1.0, 1.0):
        mesh.box((0.9, side * 1.0, 1.4), (1.6, 0.36, 0.6), "orange")
        for k in range(6):
            mesh.box((-3.6 + 0.7 * k, side * 1.205, 1.02), (0.34, 0.02, 0.13), "black")
    mesh.box((0.9, 0, 1.5), (0.9, 0.8, 0.8), "dark_grey")
    mesh.beam((0.9, 0, 1.8), (-2.9, 0, 3.1), 0.36, "machine", end_width=0.26)
    mesh.cylinder((0.2, 0, 1.3), (-1.2, 0, 2.4), 0.1, "silver")
    mesh.cylinder((-2.85, 0, 3.05), (-2.85, 0, 1.9), 0.025, "black", sides=5)
    mesh.cylinder((-2.85, -0.05, 1.82), (-2.85, 0.05, 1.82), 0.12, "red", sides=8)
    _beacon(mesh, lights, 2.9, 0.7, 2.68)
    _beacon(mesh, lights, 2.9, -0.7, 2.68)
    mesh.box((2.9, 0, 2.75), (0.3, 1.1, 0.12), "dark_grey")
    rear_lamps(mesh, lights, -3.97, 0.95, 0.84, (0.4, 0.12))
    plates(mesh, (-4.0, 0.72), (4.06, 0.55))
    _axles(mesh, (-2.5, 2.9))


def cement_mixer(mesh: MeshBuilder, shown: Appearance) -> None:
    """A concrete mixer lorry with a striped drum."""
    lights = shown.lights
    cab(mesh, lights, "blue", 4.0, 1.8, 2.7)
    _chassis(mesh, -3.9, 2.2)
    rings = (
        (-3.3, 3.05, 0.5),
        (-2.6, 2.85, 0.85),
        (-1.3, 2.45, 1.2),
        (0.4, 2.05, 1.2),
        (1.6, 1.8, 0.75),
        (1.9, 1.7, 0.4),
    )
    colours = ("light_grey", "orange", "white", "orange", "light_grey")
    for (x0, z0, r0), (x1, z1, r1), colour in zip(rings, rings[1:], colours, strict=False):
        mesh.cylinder(
            (x0, 0, z0), (x1, 0, z1), r0, colour, sides=12, end_radius=r1, cap_colour="dark_grey"
        )
    mesh.hull((1.2, 2.0, -0.5, 0.5, 0.9), (1.4, 2.0, -0.4, 0.4, 1.7), "dark_grey")
    for side in (-1.0, 1.0):
        mesh.beam((-2.9, side * 0.7, 0.9), (-2.6, side * 0.7, 2.4), 0.14, "dark_grey")
        mesh.box((-1.0, side * 1.15, 1.05), (4.0, 0.16, 0.12), "blue")
    mesh.hull((-3.7, -3.2, -0.4, 0.4, 2.9), (-3.9, -3.2, -0.6, 0.6, 3.5), "dark_grey")
    mesh.beam((-3.5, 0, 2.7), (-4.2, 0, 1.4), 0.5, "metal", end_width=0.36)
    _beacon(mesh, lights, 3.0, 0.7, 2.68)
    rear_lamps(mesh, lights, -3.93, 0.95, 0.84, (0.4, 0.12))
    plates(mesh, (-3.98, 0.66), (4.06, 0.55))
    _axles(mesh, (-2.7, -1.5, 2.9))


def tanker(mesh: MeshBuilder, shown: Appearance) -> None:
    """A fuel tanker with a polished tank and hazard plates."""
    lights = shown.lights
    cab(mesh, lights, shown.paint, 4.8, 1.9, 2.9)
    _chassis(mesh, -4.6, 2.9)
    rings = [
        ((-4.5, 0, 2.05), 0.9, 0.8),
        ((-4.3, 0, 2.05), 1.22, 1.08),
        ((2.5, 0, 2.05), 1.22, 1.08),
        ((2.7, 0, 2.05), 0.9, 0.8),
    ]
    mesh.column(rings, "silver", axis="x", sides=14)
    for x in (-2.4, -0.3, 1.6):
        mesh.column(
            [((x, 0, 2.05), 1.235, 1.095), ((x + 0.12, 0, 2.05), 1.235, 1.095)],
            "light_grey",
            axis="x",
            sides=14,
            caps="",
        )
        mesh.cylinder((x + 0.9, 0, 3.1), (x + 0.9, 0, 3.28), 0.26, "grey")
    side_print(mesh, (-3.0, 1.4), 1.24, (1.86, 2.24), "sign_fuel")
    rear_print(mesh, -4.51, 0.62, (2.1, 2.4), "sign_fuel")
    mesh.picture(
        [(-4.515, 0.3, 1.45), (-4.515, -0.3, 1.45), (-4.515, -0.3, 2.05), (-4.515, 0.3, 2.05)],
        "sign_danger",
    )
    for side in (-1.0, 1.0):
        mesh.box((-1.0, side * 1.1, 0.95), (6.8, 0.14, 0.1), "dark_grey")
        mesh.box((0.6, side * 1.05, 0.66), (1.8, 0.16, 0.42), "grey")
    mesh.beam((-4.55, 0.8, 0.8), (-4.55, 0.8, 3.1), 0.05, "grey")
    rear_lamps(mesh, lights, -4.62, 0.95, 0.84, (0.4, 0.12))
    plates(mesh, (-4.66, 0.66), (4.86, 0.55))
    _axles(mesh, (-3.5, -2.4, 3.7))


def tram(mesh: MeshBuilder, shown: Appearance) -> None:
    """A single-car tram with a pantograph, broken down or in the way."""
    lights, paint = shown.lights, "red"
    mesh.hull((-6.8, 6.8, -1.25, 1.25, 0.3), (-7.0, 7.0, -1.25, 1.25, 1.2), paint)
    mesh.hull((-7.0, 7.0, -1.25, 1.25, 1.2), (-6.75, 6.75, -1.22, 1.22, 2.6), "glass", caps="")
    mesh.hull((-6.8, 6.8, -1.24, 1.24, 2.5), (-6.6, 6.6, -1.1, 1.1, 3.2), "white", caps="t")
    for side in (-1.0, 1.0):
        for k in range(10):
            mesh.box((-6.3 + 1.4 * k, side * 1.24, 1.85), (0.16, 0.05, 1.4), "white")
        mesh.box((0, side * 1.255, 1.24), (13.8, 0.02, 0.14), "white")
        for x in (-3.5, 3.5):
            mesh.box((x, side * 1.255, 1.4), (1.3, 0.03, 2.0), "dark_grey")
            mesh.box((x, side * 1.27, 1.7), (1.1, 0.02, 1.2), "glass_light")
        for x in (-6.85, 6.85):
            mesh.beam((x, side * 1.18, 1.2), (0.965 * x, side * 1.16, 2.6), 0.14, "white")
    for out in (-1.0, 1.0):
        x = 6.82 * out
        y = 0.8 if out < 0 else -0.8
        mesh.picture(
            [(x, y, 2.62), (x, -y, 2.62), (0.995 * x, -y, 2.95), (0.995 * x, y, 2.95)], "sign_tram"
        )
        mesh.box((6.95 * out, 0, 0.5), (0.3, 1.6, 0.36), "dark_grey")
    head_lamps(mesh, lights, 6.96, 0.8, 0.95, (0.3, 0.2))
    rear_lamps(mesh, lights, -6.98, 0.9, 1.0, (0.28, 0.18))
    for x in (-4.2, 4.2):
        mesh.box((x, 0, 0.4), (2.6, 2.0, 0.3), "dark_grey")
        for dx in (-0.8, 0.8):
            for side in (-1.0, 1.0):
                start, end = (x + dx, side * 0.9, 0.35), (x + dx, side * 1.0, 0.35)
                mesh.cylinder(start, end, 0.35, "metal", sides=12)
    mesh.box((0, 0, 3.25), (3.0, 1.4, 0.16), "grey")
    for side in (-1.0, 1.0):
        mesh.beam((-0.8, side * 0.4, 3.3), (0.5, side * 0.2, 3.8), 0.05, "dark_grey")
        mesh.beam((0.5, side * 0.2, 3.8), (-0.2, side * 0.5, 4.3), 0.05, "dark_grey")
    mesh.beam((-0.2, -0.9, 4.3), (-0.2, 0.9, 4.3), 0.07, "dark_grey")


def forklift(mesh: MeshBuilder, shown: Appearance) -> None:
    """A yellow forklift carrying a crate."""
    lights = shown.lights
    mesh.hull((-1.1, 0.75, -0.5, 0.5, 0.25), (-1.1, 0.7, -0.5, 0.5, 0.85), "machine")
    mesh.hull((-1.25, -0.45, -0.52, 0.52, 0.35), (-1.2, -0.5, -0.48, 0.48, 1.15), "machine_dark")
    for x, tip in ((-0.9, -0.75), (0.6, 0.35)):
        for side in (-1.0, 1.0):
            mesh.beam((x, side * 0.44, 0.85), (tip, side * 0.42, 2.1), 0.07, "black")
    mesh.box((-0.2, 0, 2.13), (1.2, 0.96, 0.07), "black")
    mesh.box((-0.3, 0, 1.1), (0.5, 0.5, 0.14), "black")
    mesh.box((-0.52, 0, 1.36), (0.12, 0.5, 0.5), "black")
    mesh.beam((0.25, 0, 0.85), (0.1, 0, 1.3), 0.05, "black")
    for side in (-1.0, 1.0):
        mesh.box((0.85, side * 0.3, 1.25), (0.12, 0.12, 2.3), "dark_grey")
        mesh.box((1.4, side * 0.3, 0.16), (1.1, 0.12, 0.06), "metal")
        mesh.wheel(0.45, side * 0.5, 0.3, 0.22, hub="white")
        mesh.wheel(-0.85, side * 0.48, 0.24, 0.2, hub="white")
    for z in (0.5, 1.4, 2.3):
        mesh.box((0.86, 0, z), (0.1, 0.7, 0.1), "dark_grey")
    mesh.box((1.45, 0, 0.6), (0.8, 0.9, 0.8), "wood")
    for z in (0.3, 0.6, 0.9):
        mesh.box((1.45, 0, z), (0.83, 0.93, 0.07), "wood_dark")
    rear_print(mesh, -1.255, 0.4, (0.5, 0.8), "stripes")
    _beacon(mesh, lights, -0.5, 0.0, 2.16)
    head_lamps(mesh, lights, 0.42, 0.4, 1.98, (0.12, 0.12))
    rear_lamps(mesh, lights, -1.24, 0.36, 0.98, (0.14, 0.1))


def road_roller(mesh: MeshBuilder, shown: Appearance) -> None:
    """A yellow road roller with two steel drums."""
    lights = shown.lights
    for x in (-1.5, 1.5):
        mesh.cylinder(
            (x, -0.85, 0.65), (x, 0.85, 0.65), 0.65, "metal", sides=18, cap_colour="dark_grey"
        )
        for side in (-1.0, 1.0):
            mesh.beam((x, side * 0.92, 0.65), (0.55 * x, side * 0.92, 1.2), 0.16, "machine_dark")
            mesh.cylinder(
                (x, side * 0.86, 0.65), (x, side * 0.95, 0.65), 0.16, "machine_dark", sides=8
            )
    mesh.hull((-1.9, 1.9, -0.9, 0.9, 1.05), (-1.8, 1.7, -0.85, 0.85, 1.5), "machine")
    mesh.hull((0.3, 1.75, -0.6, 0.6, 1.5), (0.4, 1.6, -0.5, 0.5, 1.8), "machine")
    mesh.box((-0.9, 0, 1.6), (0.5, 0.6, 0.14), "black")
    mesh.box((-1.16, 0, 1.86), (0.12, 0.6, 0.5), "black")
    mesh.beam((0.2, 0, 1.5), (-0.15, 0, 1.95), 0.06, "black")
    for x in (-1.5, 0.2):
        for side in (-1.0, 1.0):
            mesh.beam((x, side * 0.75, 1.5), (x, side * 0.75, 2.65), 0.07, "black")
    mesh.box((-0.65, 0, 2.7), (2.1, 1.75, 0.1), "machine")
    rear_print(mesh, -1.87, 0.8, (1.1, 1.45), "stripes")
    _beacon(mesh, lights, -0.65, 0.0, 2.74)
    head_lamps(mesh, lights, 1.82, 0.55, 1.3, (0.2, 0.14))
    rear_lamps(mesh, lights, -1.9, 0.65, 1.62, (0.2, 0.1))


VARIED = (school_bus, garbage_truck, tow_truck, cement_mixer, tanker, tram, forklift, road_roller)
