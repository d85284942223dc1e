import math
from dataclasses import replace

import numpy as np
import pytest

from oodscen.data._weather import Weather
from oodscen.driving._flat_frame import _transmittance
from oodscen.driving._roads.building import read_map
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.protocols import Camera
from oodscen.testing._flat import FlatSimulator
from tests.driving.staging import actor, scene
from tests.mirrors import mirrored, mirrored_map

CAMERA = Camera(width=160, height=120, pitch_deg=0.0)


def render(staged, camera: Camera = CAMERA):
    with FlatSimulator() as simulator:
        simulator.reset(staged, 0)
        return simulator.render(camera)


def with_weather(staged, **weather: object):
    return staged.model_copy(update={"weather": Weather(**weather)})


def test_a_box_is_where_the_camera_model_puts_it() -> None:
    ahead, size = 20.0, 1.0
    frame = render(scene(actor("box", "cardboard_box", ahead=ahead)))
    rows, columns = np.nonzero(frame.ids == 2)
    focal = 80.0 / math.tan(math.radians(30.0))
    face = ahead - 0.5 * size - CAMERA.x
    assert abs(columns.max() - columns.min() + 1 - focal * size / face) <= 1.0
    assert abs(0.5 * (columns.max() + columns.min()) + 0.5 - 80.0) <= 0.5
    assert abs(rows.max() + 1 - (60.0 + focal * CAMERA.z / face)) <= 1.0
    assert math.isclose(frame.depth[frame.ids == 2].min(), face, abs_tol=1e-4)


def test_the_ground_has_the_depth_of_a_plane() -> None:
    frame = render(scene(map="urban_three_lane"))
    focal = 80.0 / math.tan(math.radians(30.0))
    v = np.arange(61, 120) + 0.5 - 60.0
    expected = CAMERA.z * focal / v
    assert np.allclose(frame.depth[61:, 80], expected, rtol=1e-5)
    assert np.isinf(frame.depth[:60]).all()
    assert (frame.ids == 0).all()


def test_the_nearer_of_two_hides_the_other() -> None:
    frame = render(scene(actor("far", "truck", ahead=40.0), actor("near", "truck", ahead=20.0)))
    assert (frame.ids == 3).any()
    assert not (frame.ids == 2).any()


def test_left_is_left_in_the_picture() -> None:
    frame = render(scene(actor("left", "cone", ahead=15.0, offset=2.0),
                         actor("right", "cone", ahead=15.0, offset=-2.0)))  # fmt: skip
    left, right = (np.nonzero(frame.ids == name)[1].mean() for name in (2, 3))
    assert left < 80.0 < right


@pytest.mark.parametrize("road", SHIPPED_MAPS, ids=lambda road: road.id)
def test_roads_show_marks_and_asphalt(road) -> None:
    frame = render(scene(map=road.id))
    colours = {tuple(colour) for colour in frame.rgb[70:].reshape(-1, 3)}
    assert (224, 224, 219) in colours
    assert (77, 77, 82) in colours


def test_fog_hides_what_is_far_first() -> None:
    staged = scene(actor("near", "truck", ahead=20.0), actor("far", "truck", ahead=90.0, lane=2))
    clear, fog = render(staged), render(with_weather(staged, fog_visual_range_m=40.0))

    def contrast(frame, name: int) -> float:
        body = frame.rgb[frame.ids == name].astype(float).mean(axis=0)
        return float(np.abs(body - frame.rgb[0, 0]).sum())

    kept = [contrast(fog, name) / contrast(clear, name) for name in (2, 3)]
    assert kept[1] < kept[0] < 0.8
    assert kept[1] < 0.1
    assert np.array_equal(clear.depth, fog.depth)


def test_night_is_dark_but_for_the_headlights() -> None:
    day = render(scene())
    night = render(with_weather(scene(), sun_elevation_deg=-20.0))
    assert night.rgb.mean() < 0.35 * day.rgb.mean()
    assert night.rgb[115, 80].mean() > 2 * night.rgb[70, 80].mean()


@pytest.mark.parametrize("yaw_deg", [90.0, 180.0, -135.0])
def test_headlights_shine_ahead_also_if_the_camera_is_turned(yaw_deg: float) -> None:
    night = with_weather(scene(), sun_elevation_deg=-20.0)
    ahead, turned = render(night), render(night, replace(CAMERA, yaw_deg=yaw_deg))
    assert turned.rgb[115, 80].mean() < 0.3 * ahead.rgb[115, 80].mean()


@pytest.mark.parametrize("z", [0.0, -0.5, -30.0])
def test_the_ground_has_no_underside(z: float) -> None:
    frame = render(scene(actor("a", "truck", ahead=20.0)), replace(CAMERA, z=z))
    assert (frame.depth > 0.0).all()
    assert np.isinf(frame.depth[frame.ids == 0]).all()


def test_snow_whitens_the_ground() -> None:
    snowy = with_weather(scene(), precipitation="snow", precipitation_mm_h=2.0)
    assert render(snowy).rgb[100:].mean() > 1.4 * render(scene()).rgb[100:].mean()


def test_transmittance_is_koschmieders_law() -> None:
    depth = np.linspace(0.0, 200.0, 50)
    assert np.allclose(_transmittance(depth, 60.0), 0.05 ** (depth / 60.0), atol=0.01)


def test_something_at_the_bumper_is_drawn() -> None:
    frame = render(scene(actor("a", "truck", ahead=7.5)), Camera(width=64, height=48))
    assert (frame.ids == 2).mean() > 0.3


def test_a_mirrored_scene_gives_the_mirrored_picture_and_annotations(tmp_path) -> None:
    road = next(road for road in SHIPPED_MAPS if road.id == "urban_avenue")
    files = [tmp_path / "plain.xodr", tmp_path / "mirrored.xodr"]
    data = read_map(road.file)
    for file, content in zip(files, (data, mirrored_map(data)), strict=True):
        file.write_bytes(content)
    plain = scene(
        actor("a", "truck", ahead=30.0, lane=1, heading=20.0), actor("b", "cone", ahead=12.0)
    ).model_copy(update={"map": str(files[0])})
    drawn = []
    for one in (plain, mirrored(plain, road.lanes, map=str(files[1]))):
        with FlatSimulator() as simulator:
            state = simulator.reset(one, 0)
            frame = simulator.render(CAMERA)
            told = one.annotate(frame, state, simulator.catalogue(), CAMERA)
            classes = told.semantic_map(frame, state, one, simulator.catalogue(), CAMERA)
        drawn.append((frame, classes, told.actors))
    (frame, classes, actors), (other, other_classes, others) = drawn
    for name in ("rgb", "ids", "depth", "tags"):
        assert np.array_equal(getattr(frame, name), getattr(other, name)[:, ::-1]), name
    assert np.array_equal(classes, other_classes[:, ::-1])
    for one, twin in zip(actors, others, strict=True):
        assert one.box is not None
        assert twin.box is not None
        left, top, right, bottom = twin.box
        assert one.box == (CAMERA.width - right, top, CAMERA.width - left, bottom)
