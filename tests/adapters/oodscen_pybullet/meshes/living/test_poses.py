"""People in poses stand on the ground and fill their box."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._catalogue import load_catalogue
from oodscen_pybullet._meshes import asset_mesh
from oodscen_pybullet._meshes.living.poses import KeyFrame, Pose, load_poses
from oodscen_pybullet._meshes.look import BEATS, beating
from pydantic import ValidationError

from oodscen.data._details import Details

CATALOGUE = load_catalogue()
PEOPLE = [one for one in CATALOGUE.assets if one.offers and one.offers.poses]
CASES = [(person, pose) for person in PEOPLE for pose in person.offers.poses]


@pytest.mark.parametrize(
    "wrong",
    [
        {"left_arm": [200, 0, 0, 0]}, {"right_arm": [0, 0, -5, 0]}, {"left_leg": [0, 0, 170]},
        {"lean": 120}, {"head": [80, 0]}, {"second": {}}, {"period_s": 1}, {"tail": [1]},
        {"second": {}, "period_s": 1, "stride_m": 1}, {"second": {}, "period_s": 0.01},
    ],
)  # fmt: skip
def test_joints_have_limits(wrong):
    with pytest.raises(ValidationError):
        Pose.model_validate(wrong)


@given(st.sampled_from(sorted(load_poses())), st.integers(0, 40))
def test_a_cycle_goes_from_one_key_frame_to_the_other_and_back(name, beat):
    pose = load_poses()[name]
    frame = pose.at(beat)
    assert frame == pose.at(beat + BEATS)
    assert frame.right_arm == pose.at(-beat % BEATS).right_arm
    KeyFrame.model_validate({key: getattr(frame, key) for key in KeyFrame.model_fields})


def test_the_catalogue_tells_of_every_pose():
    assert [kind.id for kind in CATALOGUE.details.poses] == list(load_poses())
    for kind in CATALOGUE.details.poses:
        pose = load_poses()[kind.id]
        assert kind.is_backwards == pose.backwards
        assert not kind.is_still or (pose.bends_legs and not pose.walks and not pose.second)
        assert kind.doing


@pytest.mark.parametrize(("asset", "pose"), CASES, ids=lambda one: getattr(one, "id", one))
def test_a_pose_stands_on_the_ground_in_its_box_with_its_faces_outwards(asset, pose):
    size = np.array(asset.offers.poses[pose])
    beats = (0, BEATS // 2) if load_poses()[pose].second else (0,)
    for beat in beats:
        mesh = asset_mesh(asset.id, frame=beating(0, beat), details=Details(pose=pose))
        low, high = mesh.bounds
        assert abs(low[2]) <= 0.005
        assert (np.maximum(-low[:2], high[:2]) <= size[:2] / 2 + 0.02).all()
        assert high[2] <= size[2] + 0.02
        assert len(mesh.triangles) <= 1_500
        corners = mesh.vertices[mesh.triangles]
        facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        wide = (facing**2).sum(axis=1) > 1e-10
        assert ((facing[:, None] * mesh.normals[mesh.triangles]).sum(axis=2)[wide] > 0.0).all()
        assert abs((mesh.normals**2).sum(axis=1) - 1.0).max() < 1e-6


@pytest.mark.parametrize("pose", ["push", "wave_on", "backwards", "crawl"])
def test_who_moves_in_a_pose_stays_on_the_ground(pose):
    shown = set()
    for frame in range(1, 9):
        mesh = asset_mesh("adult", frame=beating(frame, frame - 1), details=Details(pose=pose))
        assert abs(mesh.bounds[0][2]) <= 0.005
        shown.add(mesh.vertices.round(4).tobytes())
    assert len(shown) >= 5


def test_a_pose_has_the_same_triangles_every_time():
    one, two = (
        asset_mesh.__wrapped__("child", frame=beating(3, 2), details=Details(pose="wave_on"))
        for _ in range(2)
    )
    assert one.vertices.tobytes() == two.vertices.tobytes()
    assert one.uvs.tobytes() == two.uvs.tobytes()
