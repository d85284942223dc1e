"""Other types of car, a caravan and a car on fire, facing x."""

import math

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.fire import flames, smoke_column
from oodscen_pybullet._meshes.look import Appearance, Lights
from oodscen_pybullet._meshes.vehicles.bodywork import (
    Section,
    arches,
    front_print,
    head_lamps,
    pillar,
    plates,
    rear_lamps,
    shell,
    side_print,
    underside,
)
from oodscen_pybullet._meshes.vehicles.cars import car_body

_SUV: tuple[Section, ...] = (
    (-2.30, ((0.80, 0.46), (0.90, 0.80), (0.84, 1.10))),
    (-2.20, ((0.90, 0.36), (0.95, 0.80), (0.88, 1.14))),
    (1.05, ((0.92, 0.34), (0.95, 0.80), (0.88, 1.12))),
    (2.05, ((0.90, 0.36), (0.93, 0.78), (0.84, 1.04))),
    (2.30, ((0.80, 0.44), (0.86, 0.72), (0.78, 0.94))),
)


def _wheels(mesh: MeshBuilder, xs: tuple[float, ...], half: float, radius: float, hub: str) -> None:
    for x in xs:
        arches(mesh, x, half, radius + 0.06)
        for side in (-1.0, 1.0):
            mesh.wheel(x, side * (half - 0.1), radius, 0.25, hub=hub)


def _off_road_front(mesh: MeshBuilder, lights: Lights, x: float) -> None:
    mesh.box((x, 0, 0.50), (0.1, 1.6, 0.22), "dark_grey")
    front_print(mesh, x + 0.03, 0.42, (0.68, 0.94), "grille")
    head_lamps(mesh, lights, x - 0.04, 0.62, 0.84, (0.28, 0.16))


def suv(mesh: MeshBuilder, shown: Appearance) -> None:
    """A tall off-road estate car with roof rails."""
    lights, paint = shown.lights, shown.paint
    shell(mesh, _SUV, (paint, paint, paint), front=paint, rear=paint)
    mesh.hull((-2.18, 1.15, -0.86, 0.86, 1.10), (-1.98, 0.45, -0.70, 0.70, 1.68), "glass", caps="")
    mesh.hull((-2.02, 0.48, -0.72, 0.72, 1.66), (-1.9, 0.3, -0.64, 0.64, 1.74), paint, caps="t")
    pillar(mesh, (1.13, 0.85, 1.1), (0.46, 0.70, 1.68), paint)
    pillar(mesh, (-2.14, 0.85, 1.1), (-1.96, 0.70, 1.68), paint, 0.14)
    pillar(mesh, (-0.35, 0.87, 1.1), (-0.35, 0.71, 1.68), paint, 0.06)
    pillar(mesh, (-1.3, 0.87, 1.1), (-1.28, 0.71, 1.68), paint, 0.06)
    for side in (-1.0, 1.0):
        mesh.beam((-1.8, side * 0.6, 1.79), (0.2, side * 0.6, 1.79), 0.05, "dark_grey")
        mesh.box((0.0, side * 0.95, 0.52), (3.9, 0.03, 0.14), "dark_grey")
        mesh.box((0.84, side * 0.97, 1.16), (0.14, 0.18, 0.15), paint)
    mesh.box((-2.32, 0, 0.52), (0.08, 1.6, 0.24), "dark_grey")
    mesh.cylinder((-2.31, 0.1, 1.0), (-2.46, 0.1, 1.0), 0.33, "tyre", sides=12)
    mesh.cylinder((-2.46, 0.1, 1.0), (-2.465, 0.1, 1.0), 0.22, "light_grey", sides=12)
    _off_road_front(mesh, lights, 2.30)
    rear_lamps(mesh, lights, -2.29, 0.80, 1.0, (0.14, 0.26))
    plates(mesh, (-2.365, 0.56), (2.352, 0.50))
    _wheels(mesh, (-1.4, 1.42), 0.955, 0.38, "hub")
    underside(mesh, 1.42, -1.4, 0.75, 0.32)


_PICKUP: tuple[Section, ...] = (
    (-0.55, ((0.92, 0.40), (0.95, 0.80), (0.88, 1.10))),
    (1.25, ((0.92, 0.38), (0.95, 0.80), (0.88, 1.10))),
    (2.35, ((0.90, 0.40), (0.93, 0.78), (0.84, 1.04))),
    (2.62, ((0.80, 0.46), (0.86, 0.72), (0.78, 0.94))),
)


def pickup(mesh: MeshBuilder, shown: Appearance) -> None:
    """A pickup truck with crates in its open bed."""
    lights, paint = shown.lights, shown.paint
    shell(mesh, _PICKUP, (paint, paint, paint), front=paint, rear=paint)
    mesh.hull((-0.56, 1.36, -0.86, 0.86, 1.08), (-0.45, 0.66, -0.7, 0.7, 1.66), "glass", caps="")
    mesh.hull((-0.48, 0.7, -0.72, 0.72, 1.64), (-0.36, 0.52, -0.64, 0.64, 1.72), paint, caps="t")
    pillar(mesh, (1.34, 0.85, 1.08), (0.67, 0.7, 1.66), paint)
    pillar(mesh, (-0.5, 0.85, 1.08), (-0.42, 0.7, 1.66), paint, 0.14)
    pillar(mesh, (0.3, 0.86, 1.08), (0.3, 0.71, 1.66), paint, 0.06)
    mesh.hull((-2.65, -0.55, -0.93, 0.93, 0.5), (-2.68, -0.55, -0.93, 0.93, 0.62), paint)
    mesh.box((-1.6, 0, 0.64), (2.1, 1.7, 0.04), "dark_grey")
    for side in (-1.0, 1.0):
        mesh.box((-1.6, side * 0.9, 0.88), (2.14, 0.1, 0.52), paint)
        mesh.box((1.05, side * 0.97, 1.16), (0.14, 0.18, 0.15), "black")
    mesh.box((-2.66, 0, 0.88), (0.08, 1.88, 0.52), paint)
    mesh.box((-1.1, 0.3, 0.95), (0.7, 0.7, 0.6), "wood")
    mesh.box((-1.05, -0.42, 0.88), (0.6, 0.6, 0.46), "cardboard")
    mesh.box((-2.7, 0, 0.46), (0.14, 1.84, 0.2), "silver")
    _off_road_front(mesh, lights, 2.62)
    rear_lamps(mesh, lights, -2.69, 0.85, 0.94, (0.12, 0.26))
    plates(mesh, (-2.775, 0.47), (2.672, 0.50))
    _wheels(mesh, (-1.65, 1.7), 0.955, 0.38, "hub")
    mesh.polygon(
        [(-2.6, -0.8, 0.4), (-2.6, 0.8, 0.4), (2.5, 0.8, 0.4), (2.5, -0.8, 0.4)], "underbody"
    )


def taxi(mesh: MeshBuilder, shown: Appearance) -> None:
    """A yellow taxi with a lit roof sign."""
    car_body(mesh, shown.lights, "taxi")
    mesh.box((-0.5, 0, 1.49), (0.3, 0.7, 0.04), "black")
    mesh.box((-0.5, 0, 1.58), (0.2, 0.62, 0.18), "lamp_glass")
    for x, region_side in ((-0.605, 1.0), (-0.395, -1.0)):
        y = 0.3 * region_side
        mesh.picture([(x, y, 1.5), (x, -y, 1.5), (x, -y, 1.66), (x, y, 1.66)], "sign_taxi")
    side_print(mesh, (-1.0, 0.95), 0.912, (0.6, 0.76), "sign_checks")
    mesh.lamp((-0.5, 0, 1.6), (1.0, 0.9, 0.6), (0, 0, 0), 0.6)


def camper(mesh: MeshBuilder, shown: Appearance) -> None:
    """A motor home with a sleeping alcove over the cab."""
    lights = shown.lights
    mesh.box((-0.85, 0, 1.62), (4.5, 2.2, 2.3), "white")
    mesh.hull((1.4, 2.35, -1.1, 1.1, 2.05), (1.4, 2.2, -1.1, 1.1, 2.77), "white")
    nose: tuple[Section, ...] = (
        (1.40, ((0.98, 0.34), (1.0, 1.12))),
        (2.30, ((0.97, 0.34), (0.98, 1.08))),
        (2.85, ((0.90, 0.36), (0.92, 0.92))),
        (3.0, ((0.80, 0.4), (0.82, 0.74))),
    )
    shell(mesh, nose, ("white", "white"), front="white", rear="white")
    mesh.hull((1.38, 2.34, -0.96, 0.96, 1.08), (1.38, 1.72, -0.92, 0.92, 2.06), "glass", caps="")
    pillar(mesh, (2.32, 0.95, 1.07), (1.7, 0.91, 2.06), "white", 0.09)
    for side in (-1.0, 1.0):
        mesh.box((-0.85, side * 1.105, 1.0), (4.48, 0.02, 0.18), "teal")
        mesh.box((-0.85, side * 1.105, 0.78), (4.48, 0.02, 0.1), "orange")
        mesh.box((-0.2, side * 1.105, 1.85), (0.9, 0.03, 0.6), "glass")
        mesh.box((-2.2, side * 1.105, 1.85), (0.7, 0.03, 0.55), "glass")
        mesh.box((1.85, side * 1.105, 2.4), (0.6, 0.03, 0.3), "glass")
        mesh.box((2.0, side * 1.05, 1.3), (0.14, 0.2, 0.3), "black")
    mesh.box((-1.2, -1.11, 1.45), (0.65, 0.02, 1.8), "light_grey")
    mesh.box((-3.105, 0, 1.95), (0.03, 1.1, 0.6), "glass")
    mesh.box((-0.6, 0, 2.85), (0.8, 0.8, 0.14), "light_grey")
    for y in (-0.6, -0.25):
        mesh.beam((-3.16, y, 0.7), (-3.16, y, 2.7), 0.04, "silver")
    for k in range(6):
        mesh.beam((-3.16, -0.6, 0.9 + 0.32 * k), (-3.16, -0.25, 0.9 + 0.32 * k), 0.035, "silver")
    mesh.box((-3.08, 0, 0.5), (0.1, 2.1, 0.2), "dark_grey")
    mesh.box((3.0, 0, 0.46), (0.08, 1.6, 0.2), "dark_grey")
    front_print(mesh, 3.045, 0.4, (0.58, 0.72), "grille")
    rear_lamps(mesh, lights, -3.11, 0.98, 0.92, (0.14, 0.3))
    head_lamps(mesh, lights, 2.94, 0.64, 0.78, (0.26, 0.18))
    plates(mesh, (-3.14, 0.62), (3.046, 0.47))
    _wheels(mesh, (-1.75, 2.05), 1.0, 0.36, "light_grey")


def trailer(mesh: MeshBuilder, shown: Appearance) -> None:
    """A caravan to be towed, with its drawbar forward."""
    lights = shown.lights
    profile: tuple[Section, ...] = (
        (-2.3, ((1.0, 0.75), (1.02, 1.4), (0.98, 2.2))),
        (-2.15, ((1.05, 0.5), (1.08, 1.4), (1.0, 2.45))),
        (1.5, ((1.05, 0.5), (1.08, 1.4), (1.0, 2.45))),
        (1.85, ((1.05, 0.6), (1.08, 1.3), (1.0, 2.1))),
        (1.95, ((1.0, 0.75), (1.02, 1.2), (0.96, 1.5))),
    )
    shell(mesh, profile, ("white", "white", "white"), front="white", rear="white")
    for side in (-1.0, 1.0):
        mesh.box((-0.2, side * 1.085, 1.0), (3.7, 0.02, 0.14), "blue")
        mesh.box((-1.2, side * 1.075, 1.75), (1.1, 0.06, 0.55), "glass")
        mesh.box((0.9, side * 1.075, 1.75), (0.8, 0.06, 0.55), "glass")
        mesh.wheel(-0.3, side * 0.98, 0.33, 0.2)
        mesh.beam((1.8, side * 0.6, 0.48), (3.0, 0, 0.46), 0.1, "dark_grey")
    mesh.box((0.0, -1.085, 1.35), (0.6, 0.03, 1.6), "light_grey")
    mesh.box((-2.31, 0, 1.8), (0.05, 1.3, 0.5), "glass")
    mesh.polygon(
        [(1.955, -0.7, 1.55), (1.955, 0.7, 1.55), (1.87, 0.7, 2.0), (1.87, -0.7, 2.0)], "glass"
    )
    mesh.cylinder((2.6, 0, 0.06), (2.6, 0, 0.8), 0.04, "metal", sides=6)
    mesh.cylinder((2.6, -0.04, 0.11), (2.6, 0.04, 0.11), 0.11, "tyre", sides=10)
    mesh.ball((3.02, 0, 0.48), (0.1, 0.08, 0.08), "dark_grey")
    mesh.box((2.2, 0, 0.66), (0.5, 0.6, 0.36), "light_grey")
    rear_lamps(mesh, lights, -2.31, 0.86, 0.85, (0.14, 0.26))
    mesh.picture(
        [(-2.345, 0.27, 0.84), (-2.345, -0.27, 0.84), (-2.345, -0.27, 0.97), (-2.345, 0.27, 0.97)],
        "plate_rear",
    )
    mesh.polygon([(-2.1, -1, 0.5), (-2.1, 1, 0.5), (1.7, 1, 0.5), (1.7, -1, 0.5)], "underbody")


def burning_car(mesh: MeshBuilder, shown: Appearance) -> None:
    """A burnt-out car in flames under a column of black smoke."""
    car_body(mesh, Lights(), "char")
    seats = (
        (1.3, 0.0, 0.9),
        (0.3, 0.3, 1.35),
        (-0.6, -0.25, 1.4),
        (-1.5, 0.2, 1.05),
        (1.7, 0.4, 0.75),
    )
    flames(mesh, shown, seats, 0.42)
    smoke_column(mesh, shown, (-0.1, 0.0, 1.7), 0.75, 5.0)
    for index in range(6):
        turn = index * 1.05
        x, y = 1.7 * math.cos(turn), 0.7 * math.sin(turn)
        mesh.puff((x, y, 0.9), 0.4, (1.0, 0.55, 0.15), 0.5, is_bright=True)
    mesh.lamp((0.4, 0, 1.6), (1.0, 0.6, 0.2), (0, 0, 0), 6.0)


VARIED = (suv, pickup, taxi, camper, trailer, burning_car)
