"""The vehicle under test."""

import itertools

import numpy as np

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.designs import assemble
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._meshes.mesh import Mesh


def ego_car(mesh: MeshBuilder, shown: Appearance) -> None:
    """The vehicle under test: a car of 4.5 x 1.85 x 1.5 m."""
    built = assemble("car", shown).build()
    low, high = built.bounds
    size = high - low
    middle, scale = (low + high) / 2 * (1, 1, 0), (4.5 / size[0], 1.85 / size[1], 1.5 / size[2])
    scaled = Mesh(
        vertices=(built.vertices - middle) * scale,
        normals=built.normals,
        uvs=built.uvs,
        triangles=built.triangles,
    )
    mesh.add_surface(scaled)
    for lamp in built.lamps:
        x, y, z = ((np.array(lamp.position) - middle) * scale).tolist()
        mesh.lamp((x, y, z), lamp.colour, lamp.facing, lamp.power, by_day=lamp.by_day)


def bonnet() -> MeshBuilder:
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
            "silver",
        )
        for side in (-1.0, 1.0):
            strip = [
                (x0, side * y0 * 0.5, z0 + 0.02),
                (x0, side * y0, z0 - 0.05),
                (x1, side * y1, z1 - 0.05),
                (x1, side * y1 * 0.5, z1 + 0.02),
            ]
            mesh.polygon(strip if side < 0 else strip[::-1], "silver")
    return mesh


VARIED = (ego_car,)
