import pytest
from oodscen_pybullet._catalogue import load_catalogue

from oodscen.data._catalogue import Catalogue
from oodscen.data._designs.prop import Prop
from oodscen.data._details import DetailKinds
from oodscen.errors import DataError, SceneError
from oodscen.protocols import Camera
from oodscen.stages._making.files import read_props
from oodscen.stages._making.looking import (
    DISTANCES_M,
    UNSEEN,
    look_at,
    look_at_details,
)
from oodscen.testing._flat import FlatSimulator
from tests.made import WALL

CAMERA = Camera(width=160, height=120)
KINDS = load_catalogue().details or DetailKinds()


def test_a_wall_is_seen_and_a_post_on_the_horizon_is_not() -> None:
    post = {"cylinder": [0, 0, 0], "to": [0, 0, 0.4], "radius": 0.02, "colour": "asphalt"}
    thin = Prop.parse({**WALL, "id": "thin_post", "parts": [post]})
    with FlatSimulator() as simulator:
        wall, thin_one = look_at([Prop.parse(WALL), thin], simulator, camera=CAMERA)
    assert not wall.look.faults
    assert wall.look.recognised == UNSEEN
    assert len(wall.pictures) == len(wall.look.views) == 2 * len(DISTANCES_M)
    near, *_, far = [view.pixels for view in wall.look.views if not view.is_night]
    assert near > far > 0
    assert thin_one.look.faults


def test_a_refused_design_is_no_picture() -> None:
    prop = Prop.parse({**WALL, "id": "cone"})
    with FlatSimulator() as simulator, pytest.raises(SceneError):
        list(look_at([prop], simulator))


def test_designs_are_read_from_files_and_folders(tmp_path) -> None:
    wall = Prop.parse(WALL)
    (tmp_path / "a.json").write_text(wall.to_json())
    (tmp_path / "b.toml").write_text(
        '[kerb]\ndescription = "a kerb"\nmass_kg = 90\nparts = ['
        '{ box = [0, 0, 0.2], size = [0.3, 2, 0.4], colour = "grey" }]\n'
    )
    (tmp_path / "c.jsonl").write_text(f'{{"id": "low_wall", "prop": {wall.to_json()}}}\n')
    assert [prop.id for prop in read_props(tmp_path).props] == ["low_wall", "kerb"]
    assert read_props(tmp_path / "c.jsonl") == ([wall], [])
    for name, text in (
        ("x.json", "{"),
        ("x.toml", "= 1"),
        ("x.jsonl", "{}\n"),
        ("y.toml", "a = 1"),
    ):
        (tmp_path / name).write_text(text)
        with pytest.raises(DataError):
            read_props(tmp_path / name)


def test_every_pose_and_part_has_a_row_that_a_camera_sees() -> None:
    few = DetailKinds(
        poses=tuple(pose for pose in KINDS.poses if pose.id in ("kneel", "carry_at_side")),
        parts=tuple(part for part in KINDS.parts if part.id == "doors_open"),
    )

    class Painter(FlatSimulator):
        def catalogue(self) -> Catalogue:
            shown = super().catalogue()
            known = {asset.id: asset for asset in load_catalogue().assets}
            assets = tuple(
                asset.model_copy(update={"offers": known[asset.id].offers})
                if asset.id in known
                else asset
                for asset in shown.assets
            )
            return shown.model_copy(update={"assets": assets, "details": few})

    with Painter() as simulator:
        seen = list(look_at_details(simulator, camera=CAMERA))
    assert [one.look.id for one in seen] == ["carry_at_side", "kneel", "doors_open"]
    assert all(one.look.views[0].pixels > 0 for one in seen)
    with FlatSimulator() as simulator:
        assert not list(look_at_details(simulator, camera=CAMERA))
