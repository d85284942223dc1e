"""Laws that the mesh of every asset keeps; `test_catalogue` measures their sizes."""

import math

import numpy as np
import pytest
from oodscen_pybullet._catalogue import load_catalogue
from oodscen_pybullet._meshes import GAITS, PAINTS, Mesh, asset_ids, asset_mesh
from oodscen_pybullet._meshes.atlas import REGIONS, SIZE, SWATCH
from oodscen_pybullet._meshes.look import AMBER

from oodscen.errors import UnknownComponent

CATALOGUE = load_catalogue()
SOLID = ("vehicle", "cyclist", "pedestrian", "animal")


def faces(mesh: Mesh) -> np.ndarray:
    """Return the normal of every triangle by its corners' order, scaled by twice its area."""
    corners = mesh.vertices[mesh.triangles]
    normals: np.ndarray = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return normals


def volume(mesh: Mesh) -> float:
    """Return the volume that the triangles enclose as far as they are closed and face outwards."""
    middle = mesh.vertices.mean(axis=0)
    corners = mesh.vertices[mesh.triangles] - middle
    return float((corners[:, 0] * np.cross(corners[:, 1], corners[:, 2])).sum() / 6.0)


@pytest.mark.parametrize("asset", asset_ids())
def test_normals_point_to_the_side_that_shows(asset: str) -> None:
    mesh = asset_mesh(asset)
    corners, facing = mesh.vertices[mesh.triangles], faces(mesh)
    # Heaps are cut off at the ground: what is left of their undersides may be folded.
    is_above = (corners[:, :, 2].min(axis=1) > 1e-6) & ((facing**2).sum(axis=1) > 1e-10)
    along = (facing[is_above][:, None] * mesh.normals[mesh.triangles][is_above]).sum(axis=2)
    assert is_above.any()
    assert along.min() > 0.0


@pytest.mark.parametrize("asset", asset_ids())
def test_no_mesh_is_bent_by_a_sine_whose_last_bit_differs_between_machines(
    asset: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = asset_mesh(asset)
    for name in ("sin", "cos"):
        monkeypatch.setattr(math, name, lambda _: math.nan)
    again = asset_mesh.__wrapped__(asset)
    assert again.vertices.tobytes() == expected.vertices.tobytes()
    assert (again.lamps, again.puffs) == (expected.lamps, expected.puffs)


@pytest.mark.parametrize("asset", [one.id for one in CATALOGUE.assets if one.category in SOLID])
def test_what_is_solid_encloses_part_of_its_box(asset: str) -> None:
    mesh, one = asset_mesh(asset), CATALOGUE.asset(asset)
    assert 0.02 < volume(mesh) / (one.length * one.width * one.height) < 1.0


@pytest.mark.parametrize("asset", asset_ids())
def test_every_triangle_shows_one_colour_or_one_region(asset: str) -> None:
    mesh = asset_mesh(asset)
    texels = np.stack([mesh.uvs[:, 0] * SIZE, (1.0 - mesh.uvs[:, 1]) * SIZE], axis=1)
    places = texels[mesh.triangles]
    is_plain = (np.abs(places - places[:, :1]) < 1e-6).all(axis=(1, 2))
    assert (places[is_plain] % SWATCH == SWATCH / 2).all()
    boxes = np.array(list(REGIONS.values()))
    for place in places[~is_plain]:
        inside = (place.min(axis=0) >= boxes[:, :2]) & (
            place.max(axis=0) <= boxes[:, :2] + boxes[:, 2:]
        )
        assert inside.all(axis=1).sum() == 1


@pytest.mark.parametrize("name", [asset.id for asset in CATALOGUE.assets if asset.states])
def test_lamps_are_on_their_asset(name: str) -> None:
    one = CATALOGUE.asset(name)
    size = np.array((one.length, one.width, one.height))
    for state in one.states:
        for lamp in asset_mesh(one.id, state, running=True).lamps:
            assert (np.abs(lamp.position - size * (0, 0, 0.5)) <= size / 2 + 0.1).all()
            assert sum(part**2 for part in lamp.facing) in (0.0, 1.0)
            assert lamp.power > 0.0


@pytest.mark.parametrize("name", ["car", "van", "truck", "bus", "school_bus", "motorcycle"])
def test_indicators_blink_on_their_side(name: str) -> None:
    for state, sides in (("indicate_left", {1}), ("indicate_right", {-1}), ("hazard", {1, -1})):
        lamps = asset_mesh(name, state).lamps
        blinking = [lamp.position[1] for lamp in lamps if lamp.colour == AMBER]
        assert {int(np.sign(y)) for y in blinking} == sides


def test_paints_and_strides_are_of_assets() -> None:
    assert {*PAINTS, *GAITS} <= set(asset_ids())
    assert all(0.1 < stride < 5.0 for stride in GAITS.values())


@pytest.mark.parametrize("asset", [one.id for one in CATALOGUE.assets])
def test_a_mesh_is_the_same_every_time(asset: str) -> None:
    again, mesh = asset_mesh.__wrapped__(asset), asset_mesh(asset)
    assert np.array_equal(again.vertices, mesh.vertices)
    assert np.array_equal(again.uvs, mesh.uvs)
    assert (again.lamps, again.puffs) == (mesh.lamps, mesh.puffs)


def test_unknown_assets_are_refused_with_close_matches() -> None:
    with pytest.raises(UnknownComponent) as caught:
        asset_mesh("dear")
    assert "deer" in caught.value.matches
