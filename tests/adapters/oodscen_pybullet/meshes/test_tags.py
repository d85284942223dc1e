from oodscen_pybullet._meshes import asset_mesh
from oodscen_pybullet._meshes.tags import Tag, on_posts, tagged
from oodscen_pybullet._scenery.furniture import LIMITS, TAGS, load_furniture, speed_sign


def test_a_mesh_of_one_class_keeps_its_shape():
    mesh = asset_mesh("cone")
    again = tagged(mesh, Tag.STATIC)
    assert again.vertices is mesh.vertices
    assert set(again.classes) == {Tag.STATIC}
    assert set(mesh.classes) == {Tag.NONE}


def test_signs_and_lights_stand_on_poles():
    signs = [on_posts(asset_mesh(name), Tag.TRAFFIC_SIGNS) for name in ("stop_sign", "yield_sign")]
    light = on_posts(asset_mesh("traffic_light", "red"), Tag.TRAFFIC_LIGHT)
    assert {*light.classes} == {Tag.POLES, Tag.TRAFFIC_LIGHT}
    for mesh in (*signs, *map(speed_sign, LIMITS), light):
        high = mesh.vertices[mesh.triangles][:, :, 2]
        is_pole = mesh.classes == Tag.POLES
        assert high[is_pole].min() <= 0.0
        assert high[~is_pole].min() > 1.0


def test_classes_of_furniture_name_pieces():
    assert set(TAGS) <= set(load_furniture())
