from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oodscen_pybullet._catalogue import load_catalogue
from oodscen_pybullet._meshes import asset_mesh, register_design
from oodscen_pybullet._meshes.atlas import draw_atlas
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.designs.parts import Placing, add
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._rendering.triangles import SHINING, Triangles

from oodscen.author._knowledge.designs import load_designs
from oodscen.data._designs import shapes
from oodscen.data._designs.prop import MOST_TRIANGLES, Prop, check_prop, sizes_of
from oodscen.data._designs.survey import survey
from tests.made import CLOUD, WALL, designs

SIZES = sizes_of(load_catalogue().assets)


def mesh_of(prop: Prop, state: str = "") -> Mesh:
    """Return the mesh of a design."""
    return asset_mesh(register_design(prop), state)


@settings(max_examples=60)
@given(designs())
def test_a_random_design_fills_its_box_and_no_more(table: dict[str, Any]) -> None:
    prop = Prop.parse(table)
    asset = prop.asset(SIZES)
    for state in prop.states:
        mesh = mesh_of(prop, state)
        low, high = mesh.bounds
        half = np.array([asset.length, asset.width]) / 2 + 0.02
        assert (np.abs(mesh.vertices[:, :2]) <= half).all()
        assert 0.0 <= low[2] <= 0.02
        assert high[2] <= asset.height + 0.02
        assert len(mesh.triangles) <= survey(prop.parts, state).triangles <= MOST_TRIANGLES
        assert (mesh.normals**2).sum(axis=1) == pytest.approx(1.0)
        assert np.isfinite(mesh.vertices).all()


@given(st.tuples(*[st.floats(0.3, 8.0)] * 3), st.integers(3, 80), st.sampled_from([0.0, 0.3, 0.5]))
def test_every_lump_of_a_heap_lies_on_the_ground_or_in_it(
    size: tuple[float, float, float], lumps: int, rough: float
) -> None:
    heap = shapes.Heap(heap=(0.0, 0.0), size=size, colour="grey", lumps=lumps, rough=rough)
    builder = MeshBuilder()
    add(heap, builder, Appearance(), Placing())
    heights = builder.build().vertices[:, 2].reshape(lumps, -1)
    assert heights.min(axis=1) == pytest.approx(0.0, abs=1e-9)
    assert heights.max() <= size[2] + 1e-9


@given(
    st.tuples(*[st.floats(0.3, 8.0)] * 3), st.integers(3, 40), st.sampled_from(["funnel", "jet"])
)
def test_a_veil_that_rises_stays_within_its_size(
    size: tuple[float, float, float], puffs: int, form: Any
) -> None:
    veil = shapes.Veil(veil=(0.0, 0.0, 0.0), size=size, colour="grey", form=form, puffs=puffs)
    builder = MeshBuilder()
    add(veil, builder, Appearance(), Placing())
    for puff in builder.build().puffs:
        x, y, z = puff.position
        assert abs(x) + puff.radius <= size[0] / 2 + 1e-9
        assert abs(y) + puff.radius <= size[1] / 2 + 1e-9
        assert puff.radius - 1e-9 <= z <= size[2] - puff.radius + 1e-9


@settings(max_examples=15)
@given(designs())
def test_the_same_design_has_the_same_triangles(table: dict[str, Any]) -> None:
    prop = Prop.parse(table)
    first = mesh_of(prop, "on")
    asset_mesh.cache_clear()
    again = mesh_of(Prop.parse(prop.to_json()), "on")
    assert first.vertices.tobytes() == again.vertices.tobytes()
    assert first.uvs.tobytes() == again.uvs.tobytes()
    assert first.puffs == again.puffs


def test_turned_and_mirrored_bodies_face_outwards() -> None:
    box = {"box": [0.5, 0.5, 0.8], "size": [0.4, 0.6, 0.8], "colour": "red"}
    for part in (
        {"turned": [box], "roll": 30, "yaw": 50, "to": [0, 0, -0.1]},
        {"both_sides": [{"turned": [box], "yaw": 50, "to": [0, 0, -0.4]}]},
    ):
        mesh = mesh_of(Prop.parse({**WALL, "parts": [*WALL["parts"], part]}))
        a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
        inside = float((a * np.cross(b, c)).sum() / 6.0)
        count = 2 if "both_sides" in part else 1
        assert inside == pytest.approx(0.4 * 3 * 1 + count * 0.4 * 0.6 * 0.8, rel=1e-6)
        facing = np.cross(b - a, c - a)
        assert ((facing * mesh.normals[mesh.triangles[:, 0]]).sum(axis=1) > 0.0).all()


def test_colours_of_a_design_reach_the_triangles_and_lit_ones_shine() -> None:
    table = {**WALL, "parts": [{**WALL["parts"][0], "colour": "lit #12ab9f"}]}
    found = Triangles.of(mesh_of(Prop.parse(table)), draw_atlas(False), is_chunked=False)
    assert (found.colours == (0x12, 0xAB, 0x9F)).all()
    assert (found.kinds == SHINING).all()
    assert (found.regions == -1).all()


def test_designs_of_one_name_do_not_mix() -> None:
    cloud = Prop.parse({**CLOUD, "id": "low_wall"})
    assert len(mesh_of(cloud).triangles) != len(mesh_of(Prop.parse(WALL)).triangles)


@pytest.mark.parametrize("name", load_designs())
def test_the_authors_designs_can_be_drawn(name: str) -> None:
    prop = load_designs()[name]
    assert not check_prop(prop, load_catalogue().assets)
    assert len(mesh_of(prop).triangles) <= MOST_TRIANGLES


def test_a_lamp_shines_as_much_by_day_in_a_design_as_alone() -> None:
    part = {"asset": "traffic_light", "to": [0, 0, 0], "yaw": 90}
    design = mesh_of(Prop.parse({**WALL, "parts": [*WALL["parts"], part]}))
    alone = {lamp.by_day for lamp in asset_mesh("traffic_light").lamps}
    assert alone
    assert alone <= {lamp.by_day for lamp in design.lamps}
