import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._meshes.atlas import COLOURS, EMISSIVE, REGIONS, SIZE, SWATCH, swatch_uv
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.mesh import Mesh

sizes = st.floats(0.05, 5.0)
spots = st.floats(-10.0, 10.0)
ways = st.sampled_from([-14.0, -2.0, -0.5, 0.0, 1.0, 3.0])


def volume(mesh: Mesh) -> float:
    """Return the volume inside a closed mesh whose triangles face outwards."""
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    return float((a * np.cross(b, c)).sum() / 6.0)


@given(spots, spots, spots, sizes, sizes, sizes)
def test_boxes_are_closed_and_face_outwards(
    x: float, y: float, z: float, a: float, b: float, c: float
) -> None:
    mesh = MeshBuilder().box((x, y, z), (a, b, c), "red").build()
    assert volume(mesh) == pytest.approx(a * b * c, rel=1e-6)
    low, high = mesh.bounds
    assert np.allclose(high - low, (a, b, c))


@given(st.sampled_from("xz"), sizes, sizes, sizes, st.integers(3, 14))
def test_columns_are_closed_and_face_outwards(
    axis: str, one: float, two: float, length: float, sides: int
) -> None:
    end = (length, 0.0, 0.0) if axis == "x" else (0.0, 0.0, length)
    rings = [((0.0, 0.0, 0.0), one, two), (end, one, two)]
    mesh = MeshBuilder().column(rings, "red", axis=axis, sides=sides).build()
    polygon = 0.5 * sides * math.sin(2 * math.pi / sides)
    assert volume(mesh) == pytest.approx(polygon * one * two * length, rel=1e-6)
    assert np.allclose((mesh.normals**2).sum(axis=1), 1.0)


@given(st.floats(0.1, 3.0), spots)
def test_puffs_and_lamps_move_with_the_mesh(scale: float, away: float) -> None:
    mesh = MeshBuilder().box((0, 0, 0.5), (1, 1, 1), "red").lamp((1, 0, 1), (1, 1, 1), (1, 0, 0))
    built = mesh.puff((1, 0, 1), 0.5, (0.1, 0.1, 0.1), 0.9).shift((away, 0, 0), scale=scale).build()
    assert built.puffs[0].position == pytest.approx((scale + away, 0, scale))
    assert built.puffs[0].radius == pytest.approx(0.5 * scale)
    assert built.lamps[0].position == built.puffs[0].position


@given(st.tuples(ways, ways, ways).filter(any), st.floats(1e-200, 1e200))
def test_the_length_of_a_beams_direction_plays_no_part(
    way: tuple[float, float, float], length: float
) -> None:
    beams = [
        MeshBuilder().lamp((0, 0, 1), (1, 1, 1), facing).build().lamps[0].facing
        for facing in (way, tuple(part * length for part in way))
    ]
    assert math.hypot(*beams[0]) == pytest.approx(1.0)
    assert beams[0] == pytest.approx(beams[1])
    assert np.dot(beams[0], way) == pytest.approx(math.hypot(*way))


def test_a_beam_without_direction_shines_in_all() -> None:
    mesh = MeshBuilder().lamp((0, 0, 1), (1, 1, 1), (0, 0, 0)).build()
    assert mesh.lamps[0].facing == (0, 0, 0)


@pytest.mark.parametrize("axis", ["x", "z"])
def test_a_sticker_shows_only_its_region(axis: str) -> None:
    square = [(0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1)]
    shares = [(0.1, 0.1), (0.9, 0.1), (0.9, 0.9), (0.1, 0.9)]
    mesh = MeshBuilder().textured_polygon(square, shares, "sign_stop").build()
    x, y, width, height = REGIONS["sign_stop"]
    columns, rows = mesh.uvs[:, 0] * SIZE, (1 - mesh.uvs[:, 1]) * SIZE
    assert ((columns > x) & (columns < x + width)).all()
    assert ((rows > y) & (rows < y + height)).all()


def test_regions_and_colours_have_room_of_their_own() -> None:
    owner = np.zeros((SIZE, SIZE), int)
    rows = -(-len(COLOURS) // (SIZE // SWATCH)) * SWATCH
    owner[:rows] += 1
    for x, y, width, height in REGIONS.values():
        assert x + width <= SIZE
        assert y + height <= SIZE
        owner[y : y + height, x : x + width] += 1
    assert owner.max() == 1
    assert set(COLOURS) | set(REGIONS) >= EMISSIVE


@given(st.integers(0, 1000))
def test_the_second_colour_of_a_rock_is_in_its_hollows(key: int) -> None:
    mesh = MeshBuilder().ball(
        (0, 0, 0), (1, 1, 1), "rock", jitter=0.2, key=key, second_colour="rock_dark"
    )
    built = mesh.build()
    middles = built.vertices[built.triangles].mean(axis=1)
    is_dark = np.isclose(built.uvs[built.triangles[:, 0]], swatch_uv("rock_dark")).all(axis=1)
    reach = np.sqrt((middles**2).sum(axis=1))
    assert 0 < is_dark.sum() < len(is_dark)
    assert reach[is_dark].mean() < reach[~is_dark].mean()
