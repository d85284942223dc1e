"""Cars, vans and vehicles built on them."""

import itertools

from oodscen_pybullet._meshes.builder import Mesh, MeshBuilder
from oodscen_pybullet._meshes.look import Appearance, Lights
from oodscen_pybullet._meshes.vehicles.bodywork import (
    Section,
    arches,
    front_print,
    head_lamps,
    light_bar,
    pillar,
    plates,
    rear_lamps,
    rear_print,
    shell,
    side_print,
    underside,
)

_CAR: tuple[Section, ...] = (
    (-2.20, ((0.70, 0.34), (0.80, 0.62), (0.74, 0.90))),
    (-2.08, ((0.82, 0.28), (0.88, 0.64), (0.80, 0.97))),
    (-1.30, ((0.86, 0.22), (0.90, 0.64), (0.82, 0.97))),
    (1.10, ((0.86, 0.22), (0.90, 0.62), (0.82, 0.94))),
    (1.95, ((0.84, 0.24), (0.87, 0.58), (0.76, 0.79))),
    (2.20, ((0.72, 0.30), (0.78, 0.52), (0.66, 0.68))),
)


def car(mesh: MeshBuilder, shown: Appearance) -> None:
    """A mid-size hatchback."""
    car_body(mesh, shown.lights, shown.paint)


def car_body(mesh: MeshBuilder, lights: Lights, paint: str) -> None:
    """Add a hatchback with wheels, lamps, plates and underside."""
    shell(mesh, _CAR, (paint, paint, paint), front=paint, rear=paint)
    mesh.polygon(
        [(-2.15, -0.8, 0.24), (-2.15, 0.8, 0.24), (2.1, 0.8, 0.24), (2.1, -0.8, 0.24)], "underbody"
    )
    low, high = (-2.02, 1.18, -0.78, 0.78, 0.94), (-1.55, 0.42, -0.60, 0.60, 1.40)
    mesh.hull(low, high, "glass", caps="")
    mesh.hull((-1.58, 0.46, -0.62, 0.62, 1.39), (-1.42, 0.22, -0.54, 0.54, 1.46), paint, caps="t")
    pillar(mesh, (1.16, 0.77, 0.94), (0.44, 0.60, 1.41), paint)
    pillar(mesh, (-2.00, 0.77, 0.94), (-1.55, 0.60, 1.41), paint, 0.11)
    pillar(mesh, (-0.42, 0.79, 0.94), (-0.42, 0.61, 1.41), paint, 0.05)
    mesh.box((-2.21, 0, 0.42), (0.06, 1.44, 0.20), "dark_grey")
    mesh.box((2.20, 0, 0.38), (0.06, 1.36, 0.18), "dark_grey")
    front_print(mesh, 2.236, 0.34, (0.52, 0.66), "grille")
    rear_lamps(mesh, lights, -2.17, 0.64, 0.80, (0.24, 0.18))
    head_lamps(mesh, lights, 2.12, 0.56, 0.66, (0.28, 0.15))
    plates(mesh, (-2.246, 0.60), (2.236, 0.40))
    if lights.brake:
        mesh.box((-1.60, 0, 1.36), (0.06, 0.5, 0.05), "brake_lit")
    mesh.box((-2.1, 0, 0.985), (0.1, 1.3, 0.02), paint)
    for side in (-1.0, 1.0):
        mesh.box((0.86, side * 0.89, 1.0), (0.12, 0.14, 0.12), paint)
        mesh.box((-0.2, side * 0.885, 0.78), (0.2, 0.03, 0.035), "black")
    for x in (-1.32, 1.34):
        arches(mesh, x, 0.895, 0.37)
        for side in (-1.0, 1.0):
            mesh.wheel(x, side * 0.80, 0.32, 0.21)
    underside(mesh, 1.34, -1.32, 0.7, 0.22)


def ego_car(mesh: MeshBuilder, shown: Appearance) -> None:
    """The vehicle under test: a car of 4.5 x 1.85 x 1.5 m."""
    whole = MeshBuilder()
    car(whole, shown)
    built = whole.build()
    low, high = built.bounds
    size = high - low
    scale = (4.5 / size[0], 1.85 / size[1], 1.5 / size[2])
    scaled = Mesh(
        vertices=(built.vertices - (low + high) / 2 * (1, 1, 0)) * scale,
        normals=built.normals,
        uvs=built.uvs,
        triangles=built.triangles,
    )
    mesh.add(scaled)


def bonnet(paint: str) -> MeshBuilder:
    """The bonnet of the ego as its dash camera sees it."""
    mesh = MeshBuilder()
    rows = ((1.30, 0.90, 0.965), (1.85, 0.86, 0.875), (2.12, 0.78, 0.775), (2.22, 0.62, 0.70))
    for (x0, y0, z0), (x1, y1, z1) in itertools.pairwise(rows):
        mesh.polygon(
            [
                (x0, -y0 * 0.5, z0 + 0.02),
                (x1, -y1 * 0.5, z1 + 0.02),
                (x1, y1 * 0.5, z1 + 0.02),
                (x0, y0 * 0.5, z0 + 0.02),
            ],
            paint,
        )
        for side in (-1.0, 1.0):
            strip = [
                (x0, side * y0 * 0.5, z0 + 0.02),
                (x0, side * y0, z0 - 0.05),
                (x1, side * y1, z1 - 0.05),
                (x1, side * y1 * 0.5, z1 + 0.02),
            ]
            mesh.polygon(strip if side < 0 else strip[::-1], paint)
    return mesh


def police_car(mesh: MeshBuilder, shown: Appearance) -> None:
    """A patrol car with livery and light bar."""
    car_body(mesh, shown.lights, "white")
    side_print(mesh, (-1.0, 1.0), 0.912, (0.46, 0.84), "police")
    side_print(mesh, (-2.0, -1.62), 0.908, (0.46, 0.76), "checks")
    rear_print(mesh, -2.246, 0.50, (0.68, 0.90), "police")
    mesh.polygon(
        [(1.15, -0.4, 0.952), (1.9, -0.36, 0.80), (1.9, 0.36, 0.80), (1.15, 0.4, 0.952)], "navy"
    )
    rear_print(mesh, -2.248, 0.70, (0.33, 0.50), "chevrons")
    light_bar(mesh, shown.lights, -0.35, 1.45, 0.56)


def overturned_car(mesh: MeshBuilder, shown: Appearance) -> None:
    """A car on its crushed roof, wheels up, with glass and parts around it."""
    whole = MeshBuilder()
    car(whole, shown)
    mesh.add(whole.build(), upside_down=1.44)
    for index, (x, y) in enumerate(((1.9, 0.5), (-1.7, 0.6), (1.75, -0.7), (-1.2, -0.8))):
        mesh.box((x, y, 0.02 + 0.01 * index), (0.14, 0.1, 0.03), "glass_light")
    mesh.beam((1.5, 0.75, 0.04), (2.05, 0.5, 0.06), 0.08, shown.paint)
    mesh.centred()
    if shown.lights.left or shown.lights.right:
        for x in (-2.1, 2.1):
            for y in (-0.7, 0.7):
                mesh.lamp((x, y, 0.75), (1.0, 0.62, 0.08), (1.0 if x > 0 else -1.0, 0, 0), 2.5)


_VAN: tuple[Section, ...] = (
    (-2.60, ((0.90, 0.34), (0.95, 1.05), (0.88, 2.06))),
    (-2.45, ((0.95, 0.26), (0.98, 1.05), (0.90, 2.14))),
    (0.75, ((0.95, 0.26), (0.98, 1.05), (0.90, 2.14))),
)


def _van_body(mesh: MeshBuilder, lights: Lights, paint: str) -> None:
    shell(mesh, _VAN, (paint, paint, paint), front=paint, rear=paint)
    nose: tuple[Section, ...] = (
        (0.75, ((0.95, 0.26), (0.98, 1.08))),
        (1.95, ((0.95, 0.26), (0.96, 1.06))),
        (2.45, ((0.90, 0.28), (0.92, 0.92))),
        (2.60, ((0.80, 0.32), (0.82, 0.74))),
    )
    shell(mesh, nose, (paint, paint), front=paint, rear=paint)
    mesh.hull(
        (0.70, 1.98, -0.93, 0.93, 1.06),
        (0.70, 1.12, -0.86, 0.86, 2.04),
        "glass",
        caps="",
        sides=("glass", "glass", "glass", paint),
    )
    mesh.hull((0.70, 1.14, -0.87, 0.87, 2.03), (0.70, 0.95, -0.84, 0.84, 2.13), paint, caps="t")
    pillar(mesh, (1.97, 0.93, 1.05), (1.12, 0.86, 2.05), paint, 0.09)
    mesh.polygon(
        [(-2.5, -0.9, 0.27), (-2.5, 0.9, 0.27), (2.5, 0.9, 0.27), (2.5, -0.9, 0.27)], "underbody"
    )
    mesh.box((-2.61, 0, 0.42), (0.08, 1.7, 0.18), "dark_grey")
    mesh.box((2.60, 0, 0.42), (0.08, 1.56, 0.2), "dark_grey")
    front_print(mesh, 2.645, 0.4, (0.55, 0.7), "grille")
    rear_lamps(mesh, lights, -2.58, 0.84, 1.05, (0.14, 0.42))
    head_lamps(mesh, lights, 2.54, 0.62, 0.74, (0.26, 0.18))
    plates(mesh, (-2.656, 0.62), (2.646, 0.42))
    for side in (-1.0, 1.0):
        mesh.box((1.55, side * 1.02, 1.22), (0.14, 0.16, 0.26), "black")
    for x in (-1.6, 1.62):
        arches(mesh, x, 0.975, 0.41)
        for side in (-1.0, 1.0):
            mesh.wheel(x, side * 0.87, 0.36, 0.24)


def van(mesh: MeshBuilder, shown: Appearance) -> None:
    """A delivery van."""
    _van_body(mesh, shown.lights, shown.paint)
    for side in (-1.0, 1.0):
        window = [
            (-2.637, side * 0.08, 1.32),
            (-2.637, side * 0.74, 1.32),
            (-2.625, side * 0.72, 1.84),
            (-2.625, side * 0.08, 1.84),
        ]
        mesh.polygon(window if side < 0 else window[::-1], "glass")
    mesh.box((-2.61, 0, 1.2), (0.05, 0.03, 1.5), "dark_grey")


def ambulance(mesh: MeshBuilder, shown: Appearance) -> None:
    """An ambulance built on a van, with stripes and beacons."""
    _van_body(mesh, shown.lights, "white")
    side_print(mesh, (-1.9, 0.3), 0.955, (1.45, 1.82), "ambulance")
    side_print(mesh, (-2.4, 0.7), 0.985, (0.86, 1.14), "checks")
    rear_print(mesh, -2.65, 0.74, (1.28, 1.58), "ambulance")
    rear_print(mesh, -2.662, 0.70, (0.76, 1.16), "chevrons")
    for side in (-1.0, 1.0):
        window = [
            (-2.632, side * 0.1, 1.64),
            (-2.632, side * 0.70, 1.64),
            (-2.617, side * 0.70, 1.96),
            (-2.617, side * 0.1, 1.96),
        ]
        mesh.polygon(window if side < 0 else window[::-1], "glass")
    light_bar(mesh, shown.lights, 0.7, 2.13, 0.7)
    light_bar(mesh, shown.lights, -2.3, 2.13, 0.6)


VARIED = (car, ego_car, police_car, overturned_car, van, ambulance)
