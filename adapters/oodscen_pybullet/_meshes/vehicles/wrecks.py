"""Vehicles that lie on their roof or side, or burn."""

import math

from oodscen.numerics._exact import cos, sin
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.designs import assemble
from oodscen_pybullet._meshes.fire import flames, smoke_column
from oodscen_pybullet._meshes.look import AMBER, Appearance


def overturned_car(mesh: MeshBuilder, shown: Appearance) -> None:
    """A car on its crushed roof, wheels up, with glass and parts around it."""
    mesh.add_surface(assemble("car", shown).build(), roof_z=1.44)
    for index, (x, y) in enumerate(((1.9, 0.5), (-1.7, 0.6), (1.75, -0.7), (-1.2, -0.8))):
        mesh.box((x, y, 0.02 + 0.01 * index), (0.14, 0.1, 0.03), "glass_light")
    mesh.beam((1.5, 0.75, 0.04), (2.05, 0.5, 0.06), 0.08, shown.paint)
    mesh.centred()
    _hazard_lamps(mesh, shown, 2.1, 0.7, 0.75)


def overturned_truck(mesh: MeshBuilder, shown: Appearance) -> None:
    """The lorry on its right side, with its wheels towards the viewer's left."""
    mesh.add_surface(assemble("truck", shown).build(), roll=math.pi / 2).centred()
    _hazard_lamps(mesh, shown, 4.0, 0.9, 0.5)


def _hazard_lamps(mesh: MeshBuilder, shown: Appearance, x: float, y: float, z: float) -> None:
    """Light the lamps at the four corners of a wreck."""
    if shown.lights.left or shown.lights.right:
        for end in (-1.0, 1.0):
            for side in (-1.0, 1.0):
                mesh.lamp((end * x, side * y, z), AMBER, (end, 0, 0), 2.5)


def burning_car(mesh: MeshBuilder, shown: Appearance) -> None:
    """A burnt-out car in flames under a column of black smoke."""
    mesh.add_surface(assemble("car", Appearance(paint="char")).build())
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
        x, y = 1.7 * cos(turn), 0.7 * sin(turn)
        mesh.puff((x, y, 0.9), 0.4, (1.0, 0.55, 0.15), 0.5, is_bright=True)
    mesh.lamp((0.4, 0, 1.6), (1.0, 0.6, 0.2), (0, 0, 0), 6.0)


VARIED = (overturned_car, overturned_truck, burning_car)
