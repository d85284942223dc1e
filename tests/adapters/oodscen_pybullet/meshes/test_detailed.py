"""Vehicles with open parts, loads and words; people with things in their hands."""

import numpy as np
import pytest
from oodscen_pybullet._catalogue import load_catalogue
from oodscen_pybullet._meshes import asset_mesh, register_design
from oodscen_pybullet._meshes.atlas import swatch_uv

from oodscen.data._designs.prop import Prop
from oodscen.data._details import Details
from oodscen.data._scene import Actor, Placement
from tests.made import WALL

CATALOGUE = load_catalogue()
CASES = [(one, part) for one in CATALOGUE.assets if one.offers for part in one.offers.parts]


def shown(name, details):
    """Return the size that the catalogue tells of an asset with details."""
    one = CATALOGUE.shown(
        Actor(id="a", asset=name, placement=Placement(ahead_m=1), details=details)
    )
    return np.array((one.length, one.width, one.height))


def within(mesh, size, tolerance):
    low, high = mesh.bounds
    half = np.maximum(-low[:2], high[:2])
    return bool((half <= size[:2] / 2 + tolerance).all() and high[2] <= size[2] + tolerance)


@pytest.mark.parametrize(("asset", "part"), CASES, ids=lambda one: getattr(one, "id", one))
def test_a_part_changes_the_picture_and_stays_in_its_box(asset, part):
    details = Details(parts=(part,))
    mesh = asset_mesh(asset.id, running=True, details=details)
    plain = asset_mesh(asset.id, running=True)
    assert within(mesh, shown(asset.id, details), 0.03)
    assert -0.02 <= mesh.bounds[0][2] <= 0.02
    assert mesh.vertices.tobytes() != plain.vertices.tobytes() or (
        mesh.uvs.tobytes() != plain.uvs.tobytes()
    )
    corners = mesh.vertices[mesh.triangles]
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    is_above = (corners[:, :, 2].min(axis=1) > 1e-6) & ((facing**2).sum(axis=1) > 1e-9)
    along = (facing[:, None] * mesh.normals[mesh.triangles]).sum(axis=2)[is_above]
    assert along.min() > 0.0
    assert len(mesh.triangles) <= 12_000


def test_one_headlamp_is_dark_and_its_neighbour_shines():
    plain = asset_mesh("car", running=True).lamps
    lamps = asset_mesh("car", running=True, details=Details(parts=("one_headlamp",))).lamps
    assert len(plain) - len(lamps) == 1
    assert [lamp.position[1] < 0 for lamp in lamps if lamp.facing[0] > 0] == [True]


def test_dirt_keeps_the_shape_and_lamps_and_a_crushed_end_is_shorter():
    plain = asset_mesh("car", "hazard", "red", running=True)
    dirty = asset_mesh("car", "hazard", "red", running=True, details=Details(parts=("dirty",)))
    assert np.allclose(plain.bounds, dirty.bounds)
    assert dirty.lamps == plain.lamps
    front, rear = (
        asset_mesh("car", details=Details(parts=(f"crushed_{end}",))).bounds
        for end in ("front", "rear")
    )
    assert front[1][0] < plain.bounds[1][0] - 0.1
    assert rear[0][0] > plain.bounds[0][0] + 0.1


@pytest.mark.parametrize("colour", ["pink", "#12ab9f", "orange"])
def test_the_colour_is_on_the_body(colour):
    uvs = asset_mesh("van", details=Details(colour=colour)).uvs
    assert np.isclose(uvs, swatch_uv(colour)).all(axis=1).mean() > 0.05


@pytest.mark.parametrize(
    "name", [asset.id for asset in CATALOGUE.assets if asset.offers and asset.offers.has_text]
)
def test_words_are_on_both_sides_and_nowhere_else(name):
    plain, mesh = asset_mesh(name), asset_mesh(name, details=Details(text="FRESH FISH 24"))
    known = {row.tobytes() for row in plain.vertices.round(4)}
    added = np.array([row for row in mesh.vertices if row.round(4).tobytes() not in known])
    assert len(added) > 500
    middle = np.abs(added[:, 1]).min()
    assert middle > 0.75 * plain.bounds[1][1] - 0.1
    assert within(mesh, np.ptp(np.stack(plain.bounds), axis=0), 0.08)
    left, right = (int((sign * added[:, 1] > 0).sum()) for sign in (1, -1))
    assert left == right


@pytest.mark.parametrize(
    ("name", "details"),
    [
        ("car", Details(cargo="ladder")),
        ("pickup", Details(cargo="sofa")),
        ("van", Details(cargo="mattress", parts=("doors_open",))),
        ("adult", Details(holds="ladder")),
        ("adult", Details(holds="mattress", pose="carry_overhead")),
        ("child", Details(holds="suitcase", pose="carry_at_side")),
        ("worker", Details(holds="road_closed_sign")),
    ],
)
def test_what_is_carried_is_in_the_box(name, details):
    mesh = asset_mesh(name, details=details)
    assert within(mesh, shown(name, details), 0.05)
    assert len(mesh.triangles) > len(asset_mesh(details.holds or details.cargo).triangles)


def test_things_made_to_order_can_be_held():
    board = Prop.parse(
        {
            **WALL,
            "id": "board",
            "mass_kg": 5,
            "parts": [{"box": [0, 0, 0.5], "size": [0.1, 1.6, 1], "colour": "white"}],
        }
    )
    details = Details(pose="carry").model_copy(update={"holds": register_design(board)})
    mesh = asset_mesh("adult", details=details)
    assert mesh.bounds[1][1] == pytest.approx(0.8, abs=0.02)
