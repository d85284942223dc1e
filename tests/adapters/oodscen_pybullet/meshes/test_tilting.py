import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from oodscen_pybullet._meshes import asset_mesh
from oodscen_pybullet._meshes.tilting import UPRIGHT, tilt_of, tilted

from oodscen.driving._motion import columns as col
from oodscen.driving._motion.bodies import Situation
from oodscen.driving._motion.tilting import tilted_box

_ANGLE = st.integers(-60, 60).map(lambda steps: math.radians(3 * steps))


@settings(max_examples=30, deadline=None)
@given(_ANGLE, _ANGLE, st.sampled_from([0.0, 0.5, 3.0]))
def test_a_tilted_mesh_is_rigid_and_within_the_tilted_box(
    pitch: float, roll: float, pivot: float
) -> None:
    mesh = asset_mesh("crate")
    turned = tilted(mesh, tilt_of(pitch, roll, pivot))
    hinge = np.array([0.0, 0.0, pivot])
    before = np.linalg.norm(mesh.vertices - hinge, axis=1)
    assert np.allclose(np.linalg.norm(turned.vertices - hinge, axis=1), before)
    assert np.allclose(np.linalg.norm(turned.normals, axis=1), 1.0)
    low, high = mesh.bounds
    box = _box_of((high - low).tolist(), pitch, roll, pivot)
    middle = (turned.vertices.max(axis=0) + turned.vertices.min(axis=0)) / 2
    assert abs(middle[0] - box.x) <= box.half_length + 0.05
    assert turned.vertices[:, 0].max() <= box.x + box.half_length + 0.05
    assert turned.vertices[:, 1].min() >= box.y - box.half_width - 0.05
    assert turned.vertices[:, 2].max() <= box.high + 0.05
    assert turned.vertices[:, 2].min() >= box.low - 0.05


def _box_of(size: list[float], pitch: float, roll: float, pivot: float):
    """Return the kernel's box around a body of this size."""
    state = np.zeros((1, col.STATE_WIDTH))
    traits = np.zeros((1, col.TRAITS_WIDTH))
    state[0, col.PITCH], state[0, col.ROLL] = pitch, roll
    traits[0, [col.LENGTH, col.WIDTH, col.HEIGHT]] = size
    traits[0, col.PIVOT] = pivot
    none = np.zeros((1, 1))
    world = Situation(None, state, traits, none, none, none, 0.05, 1.0, 1e4, 1e4)
    return tilted_box(world, 0)


def test_an_upright_body_keeps_its_mesh() -> None:
    assert tilt_of(0.01, -0.01, 2.0) == UPRIGHT
    assert tilt_of(math.pi / 2, 0.0, 2.0) == (90, 0, 2.0)


def test_positive_pitch_tips_the_top_ahead_and_positive_roll_to_the_right() -> None:
    mesh = asset_mesh("cone")
    top = mesh.vertices[:, 2].argmax()
    assert tilted(mesh, (60, 0, 0.0)).vertices[top, 0] > 0.3
    assert tilted(mesh, (0, 60, 0.0)).vertices[top, 1] < -0.3
