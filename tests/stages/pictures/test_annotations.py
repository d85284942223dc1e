"""Annotations: what they say of a frame is what the frame shows."""

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest

from oodscen.data._scene import Actor, Ego, Hazard, Placement, Scene, Trigger
from oodscen.errors import FolderTaken, OodscenError, UsageError
from oodscen.protocols import Camera, Frame
from oodscen.stages._pictures.annotations import (
    CLASSES,
    FrameAnnotations,
)
from oodscen.testing._flat import FlatSimulator

CAMERA = Camera(width=320, height=240)


def actor(name, asset, ahead, lane=0, **place):
    return Actor(id=name, asset=asset, placement=Placement(ahead_m=ahead, lane=lane, **place))


SCENE = Scene(
    id="annotated",
    scenario_id="annotated",
    map="urban_avenue",
    ego=Ego(speed=10.0),
    actors=(
        actor("bus", "bus", 20.0),
        actor("hidden", "child", 34.0),
        actor("deer", "deer", 14.0, offset_m=-2.6, heading_deg=90.0),
        actor("behind", "car", -20.0),
        actor("cut", "truck", 8.0, lane=1),
    ),
    hazard=Hazard(actors={"deer": None}),
    decision=Trigger(value=1.0),
)


@pytest.fixture(scope="module")
def seen():
    with FlatSimulator() as simulator:
        state = simulator.reset(SCENE, 0)
        frame = simulator.render(CAMERA)
        catalogue = simulator.catalogue()
    return frame, state, catalogue


@pytest.fixture(scope="module")
def notes(seen):
    frame, state, catalogue = seen
    return SCENE.annotate(frame, state, catalogue, CAMERA)


def by_id(notes):
    return {one.id: one for one in notes.actors}


def test_pixels_and_boxes_are_those_of_the_ids(seen, notes):
    frame = seen[0]
    for one in notes.actors:
        mask = frame.ids == one.instance
        assert one.visible_px == mask.sum()
        if one.box is None:
            assert not mask.any()
            continue
        left, top, right, bottom = map(int, one.box)
        assert mask[top:bottom, left:right].sum() == mask.sum()
        assert mask[top].any()
        assert mask[bottom - 1].any()
        assert mask[:, left].any()
        assert mask[:, right - 1].any()


def test_the_projected_box_holds_the_visible_one(notes):
    deer = by_id(notes)["deer"]
    assert deer.is_hazard
    assert deer.truncation == 0.0
    for index, (visible, projected) in enumerate(zip(deer.box, deer.box_projected, strict=True)):
        assert visible == pytest.approx(projected, abs=1.5), index


@pytest.mark.parametrize(
    "camera",
    [CAMERA, CAMERA.behind(), Camera(x=1.2, y=-0.8, pitch_deg=15.0, yaw_deg=40.0)],
    ids=("ahead", "behind", "turned"),
)
def test_the_pose_of_the_camera_takes_places_of_the_world_into_its_axes(camera):
    with FlatSimulator() as simulator:
        state = simulator.reset(SCENE, 0)
        notes = SCENE.annotate(simulator.render(camera), state, simulator.catalogue(), camera)
    cos, sin = math.cos(notes.camera_yaw), math.sin(notes.camera_yaw)
    level, down = (f(math.radians(notes.camera_pitch_deg)) for f in (math.cos, math.sin))
    axes = [(sin, -cos, 0.0), (-cos * down, -sin * down, -level), (cos * level, sin * level, -down)]
    for one in notes.actors:
        expected = np.array(axes) @ np.subtract(one.centre_world, notes.camera_position)
        assert one.centre_camera == pytest.approx(expected, abs=1e-3)


def test_what_is_hidden_behind_or_cut_off_says_so(notes):
    found = by_id(notes)
    assert found["hidden"].visible_px == 0
    assert found["hidden"].box_projected is not None
    assert found["behind"].box_projected is None
    assert found["behind"].truncation == 1.0
    assert found["behind"].centre_camera[2] < 0.0
    assert 0.2 < found["cut"].truncation < 1.0


def test_visibility_needs_to_know_what_is_unhidden(seen, notes):
    frame, state, catalogue = seen
    assert by_id(notes)["bus"].visible_share is None
    counts = np.array([0, 0, 40, 0, 0, 0], np.int32)
    counts[1] = 2 * (frame.ids == 2).sum()
    told = Frame(frame.rgb, frame.depth, frame.ids, counts)
    found = by_id(SCENE.annotate(told, state, catalogue, CAMERA))
    assert found["bus"].visible_share == pytest.approx(0.5)
    assert found["bus"].occlusion == pytest.approx(0.5)
    assert found["hidden"].occlusion == 1.0
    assert found["behind"].occlusion is None


def test_every_pixel_has_a_class(seen):
    frame, state, catalogue = seen
    classes = FrameAnnotations.semantic_map(frame, state, SCENE, catalogue, CAMERA)
    assert classes.shape == frame.ids.shape
    assert (classes[frame.ids == 2] == CLASSES["vehicle"]).all()
    assert (classes[frame.ids == 4] == CLASSES["animal"]).all()
    assert (classes[np.isinf(frame.depth)] == CLASSES["sky"]).all()
    assert classes[-1, CAMERA.width // 2] == CLASSES["road"]
    assert {CLASSES["pavement"], CLASSES["scenery"]} <= set(np.unique(classes).tolist())
    road = frame.rgb[classes == CLASSES["road"]].astype(int)
    assert np.ptp(np.median(road, axis=0)) < 12, "asphalt is grey"


@pytest.mark.parametrize("name", ["", "..", "../x", "/x", "a/b"])
def test_a_name_stays_in_the_folder(seen, notes, tmp_path, name):
    frame = seen[0]
    with pytest.raises(UsageError, match="name must be"):
        notes.save(tmp_path / "in", name, frame, np.zeros(frame.ids.shape, np.uint8))
    assert list(tmp_path.iterdir()) == []


def test_what_cannot_be_written_is_named(seen, notes, tmp_path):
    frame = seen[0]
    (tmp_path / "file").write_text("")
    for folder in (tmp_path / "file", tmp_path / "file" / "x", tmp_path / ("a" * 300), "a\0b"):
        with pytest.raises(OodscenError, match="cannot write"):
            notes.save(folder, "last", frame, np.zeros(frame.ids.shape, np.uint8))


@pytest.mark.parametrize(
    ("argument", "change"),
    [
        ("name", {"name": 3}),
        ("frame", {"frame": None}),
        ("frame", {"frame": Frame(*(np.zeros((3, 3)),) * 3)}),
        ("classes", {"classes": None}),
        ("classes", {"classes": np.zeros((3, 3), np.uint8)}),
        ("classes", {"classes": np.zeros((CAMERA.height, CAMERA.width), np.int64)}),
    ],
)
def test_what_is_of_another_picture_or_kind_is_not_saved(seen, notes, tmp_path, argument, change):
    frame = seen[0]
    good = {"name": "last", "frame": frame, "classes": np.zeros(frame.ids.shape, np.uint8)}
    with pytest.raises(UsageError, match=f"^{argument} must "):
        notes.save(tmp_path, **good | change)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("place", range(5))
def test_a_map_of_other_kinds_of_values_is_refused(seen, place):
    good = [seen[0], seen[1], SCENE, seen[2], CAMERA]
    good[place] = 3
    with pytest.raises(UsageError, match="must be"):
        FrameAnnotations.semantic_map(*good)


def test_files_hold_all_of_it(seen, notes, tmp_path):
    frame, state, catalogue = seen
    classes = FrameAnnotations.semantic_map(frame, state, SCENE, catalogue, CAMERA)
    files = notes.save(tmp_path / "deep", "last", frame, classes)
    assert FrameAnnotations.load(files[0]) == notes
    ids, semantic, depth = (cv2.imread(str(file), cv2.IMREAD_UNCHANGED) for file in files[1:])
    np.testing.assert_array_equal(ids, frame.ids)
    np.testing.assert_array_equal(semantic, classes)
    near = np.isfinite(frame.depth) & (frame.depth < 600.0)
    np.testing.assert_allclose(0.01 * depth[near], frame.depth[near], atol=0.006)
    assert (depth[~np.isfinite(frame.depth)] == 0).all()


@pytest.mark.parametrize(
    "change",
    [
        lambda frame: {"ids": frame.ids[::2, ::2]},
        lambda frame: {"ids": frame.ids.astype(float)},
        lambda frame: {"ids": None},
        lambda frame: {"rgb": frame.rgb[:, :, 0]},
        lambda frame: {"depth": frame.depth[1:]},
        lambda frame: {"depth": np.full_like(frame.depth, np.nan)},
        lambda frame: {"ids": frame.ids + 90},
        lambda frame: {"ids": frame.ids - 1},
        lambda frame: {"unhidden": np.zeros(2, np.int32)},
    ],
)
def test_a_frame_that_is_not_the_camera_s_is_refused(seen, change):
    frame, state, catalogue = seen
    with pytest.raises(UsageError, match="frame: "):
        SCENE.annotate(replace(frame, **change(frame)), state, catalogue, CAMERA)
    with pytest.raises(UsageError, match="frame: "):
        FrameAnnotations.semantic_map(
            replace(frame, **change(frame)), state, SCENE, catalogue, CAMERA
        )


def test_a_frame_of_another_camera_is_refused(seen):
    frame, state, catalogue = seen
    with pytest.raises(
        UsageError, match=r"\(240, 320, 3\), not uint8 \(480, 640, 3\); name the camera"
    ):
        SCENE.annotate(frame, state, catalogue)
    with pytest.raises(UsageError, match="name the camera"):
        FrameAnnotations.semantic_map(frame, state, SCENE, catalogue)


@pytest.mark.parametrize(
    ("camera", "ahead_m"),
    [(CAMERA.behind(), 0.0), (replace(CAMERA, z=10.0), 0.0), (CAMERA, -6.0), (CAMERA, 6.0)],
)
def test_a_frame_that_shows_a_body_elsewhere_is_refused(seen, camera, ahead_m):
    frame, state, catalogue = seen
    poses = state.poses.copy()
    poses[3, 0] += ahead_m
    state = replace(state, poses=poses)
    with pytest.raises(UsageError, match=r"frame shows '\w+' where"):
        SCENE.annotate(frame, state, catalogue, camera)
    with pytest.raises(UsageError, match=r"frame shows '\w+' where"):
        FrameAnnotations.semantic_map(frame, state, SCENE, catalogue, camera)


def test_notes_are_not_written_into_the_frames_of_a_study(seen, notes, tmp_path):
    (tmp_path / "study.json").write_text("{}")
    frame, _, _ = seen
    classes = np.zeros(frame.ids.shape, np.uint8)
    with pytest.raises(FolderTaken):
        notes.save(tmp_path / "frames", "last", frame, classes)
    assert not (tmp_path / "frames").exists()
