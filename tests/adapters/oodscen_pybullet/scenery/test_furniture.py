"""Laws of the meshes that stand beside roads: furniture, plants and buildings."""

from collections.abc import Callable

import numpy as np
import pytest
from oodscen_pybullet._meshes import Mesh
from oodscen_pybullet._scenery import buildings, furniture, greenery

PIECES = [name for name in furniture.load_furniture() if name != "drive"]
MAKERS: dict[str, Callable[[], Mesh]] = {
    "street_lamp": lambda: furniture.street_lamp(2.0, 8.0, is_night=True),
    "speed_sign": lambda: furniture.speed_sign(50),
    **{name: lambda name=name: furniture.piece(name, paint="red") for name in PIECES},
    "lit_bus_stop": lambda: furniture.piece("bus_stop", is_night=True),
    "gantry": lambda: furniture.gantry(12.0),
    "block": lambda: buildings.city_block(18, 4, 1, 2, has_shop=True, is_night=True),
    "house": lambda: buildings.any_house(np.random.default_rng(1), is_night=True),
    "tower": lambda: buildings.tower(2, 3, is_night=True),
    "barn": lambda: buildings.barn("red"),
    "broad_tree": lambda: greenery.broad_tree(1),
    "conifer": lambda: greenery.conifer(1),
    "bush": lambda: greenery.bush(2),
    "thicket": lambda: greenery.thicket(2),
}


@pytest.mark.parametrize("maker", MAKERS.values(), ids=MAKERS)
def test_they_face_outwards_stand_on_the_ground_and_are_light(maker: Callable[[], Mesh]) -> None:
    mesh = maker()
    corners, normals = mesh.vertices[mesh.triangles], mesh.normals[mesh.triangles]
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (facing[:, None] * normals).sum(axis=2).min() >= 0.0
    assert abs((normals**2).sum(axis=2) - 1.0).max() < 1e-6
    low, high = mesh.bounds
    assert low[2] <= 0.1 < high[2]
    assert 8 <= len(mesh.triangles) <= 200
    away = corners - mesh.vertices.mean(axis=0)
    enclosed = (away[:, 0] * np.cross(away[:, 1], away[:, 2])).sum() / 6.0
    assert 0.0 < enclosed < 1.2 * np.prod(high - low)


def test_every_digit_of_a_speed_limit_is_different() -> None:
    signs = [furniture.speed_sign(limit).vertices.tobytes() for limit in sorted(furniture.LIMITS)]
    assert len(set(signs)) == len(signs)
