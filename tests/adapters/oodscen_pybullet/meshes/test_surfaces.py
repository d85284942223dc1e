"""Patterns and words on faces, and lines on the road."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.designs import surfaces  # noqa: F401  # registers the shapes
from oodscen_pybullet._meshes.designs.parts import Placing, add
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._meshes.mesh import Mesh

from oodscen.data._designs.shapes import Panel, Part, Strip

A, B, C, D = (0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 1.0, 1.0), (0.0, 0.0, 1.0)
TRIANGLES = {
    "no right": (A, A, C, D),
    "no top": (A, B, C, C),
    "no left": (A, B, C, A),
    "no bottom": (A, B, B, D),
}
PATTERNS = ("plain", "stripes", "checks", "planks", "bricks", "windows", "net", "speckle")


def drawn(part: Part, side: float = 1.0) -> Mesh:
    mesh = MeshBuilder()
    add(part, mesh, Appearance(), Placing(side=side))
    return mesh.build()


def area(mesh: Mesh) -> float:
    corners = mesh.vertices[mesh.triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(np.sqrt((faces**2).sum(axis=1)).sum() / 2.0)


@pytest.mark.parametrize("corners", TRIANGLES.values(), ids=TRIANGLES)
@pytest.mark.parametrize("pattern", PATTERNS)
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_panel_may_be_a_triangle(corners, pattern: str, side: float) -> None:
    mesh = drawn(Panel(panel=corners, pattern=pattern, colour="red", back=False), side)
    low, high = mesh.bounds
    assert np.abs(mesh.vertices[:, 0]).max() < 0.01
    assert (high - low)[1:] == pytest.approx((1.0, 1.0), abs=0.02)
    if pattern not in ("net", "speckle"):
        assert area(mesh) == pytest.approx(0.5, abs=1e-6)


@example(5e-324, 10.0)
@given(st.floats(0.0, 10.0), st.floats(0.1, 20.0))
def test_a_line_is_painted_over_half_its_length_or_all_of_it(dash: float, length: float) -> None:
    mesh = drawn(Strip(strip=((0.0, 0.0), (length, 0.0)), width=0.5, colour="white", dash=dash))
    share = area(mesh) / (0.5 * length)
    assert share == pytest.approx(1.0) or 0.5 - 1e-6 < share < 2.0 / 3.0 + 1e-6
    assert dash > 0.0 or share == pytest.approx(1.0)
    assert len(mesh.triangles) <= 2 * 40
