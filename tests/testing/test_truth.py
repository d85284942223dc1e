"""The rendered check finds what a frame or a state does not show as the scene says."""

import dataclasses

import numpy as np
import pytest

from oodscen.data._scene import Hazard, Trigger
from oodscen.data._weather import Weather
from oodscen.driving._flat_frame import tangents
from oodscen.protocols import Camera, Frame
from oodscen.testing import check_truth
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._scenes import example_scene
from oodscen.testing._truth import fog_fault

CAMERA = Camera(width=320, height=240)


def foggy(metres, **fields):
    weather = Weather(fog_visual_range_m=metres, **fields)
    return example_scene().model_copy(
        update={
            "weather": weather,
            "hazard": Hazard(weather=Weather()),
            "decision": Trigger(value=1.0),
        }
    )


def paths(simulator, scene):
    with simulator:
        return [issue.path for issue in check_truth(scene, simulator, camera=CAMERA)]


@pytest.mark.parametrize(
    "scene",
    [example_scene(), foggy(60.0), foggy(100.0, sun_elevation_deg=-20.0)],
    ids=["box", "fog", "fog at night"],
)
def test_true_scenes_have_no_issue(scene):
    assert paths(FlatSimulator(), scene) == []


class Blind(FlatSimulator):
    def draw(self, camera):
        frame = super().draw(camera)
        return dataclasses.replace(frame, ids=np.zeros_like(frame.ids))


class Mirrored(FlatSimulator):
    def draw(self, camera):
        frame = super().draw(camera)
        return dataclasses.replace(frame, ids=np.roll(frame.ids, camera.width // 3, axis=1))


class Deep(FlatSimulator):
    def draw(self, camera):
        frame = super().draw(camera)
        return dataclasses.replace(frame, depth=frame.depth * np.float32(1.5))


class Clear(FlatSimulator):
    def load(self, corridor, scene, seed):
        super().load(corridor, scene, seed)
        self._weather = self._weather.model_copy(update={"fog_visual_range_m": 2_000.0})


class Opaque(FlatSimulator):
    """Shows nothing but grey in any fog."""

    def draw(self, camera):
        frame = super().draw(camera)
        if self._weather.fog_visual_range_m > 1_000.0:
            return frame
        return dataclasses.replace(frame, rgb=np.full_like(frame.rgb, 150))


class Shifted(FlatSimulator):
    def _publish(self):
        state = super()._publish()
        poses = state.poses.copy()
        poses[1:, 0] += 3.0
        poses[1:, 2] += 1.0
        return dataclasses.replace(state, poses=poses)


@pytest.mark.parametrize(
    ("kind", "scene", "path"),
    [
        (Blind, example_scene(), "hazard"),
        (Mirrored, example_scene(), "actors[0]"),
        (Deep, example_scene(), "actors[0]"),
        (Clear, foggy(60.0), "weather.fog_visual_range_m"),
        (Opaque, foggy(60.0), "weather.fog_visual_range_m"),
        (Shifted, example_scene(), "actors[0].placement"),
    ],
    ids=lambda value: getattr(value, "__name__", ""),
)
def test_what_is_not_true_is_found(kind, scene, path):
    assert path in paths(kind(), scene)


def test_a_refused_scene_says_why():
    assert paths(FlatSimulator(), example_scene().model_copy(update={"map": "nowhere"})) == ["map"]


def fault_of(drawn_m, told_m):
    """Return the fault of a fog of one visual range in a scene that has another."""
    with FlatSimulator() as simulator:

        def render(visual_range_m):
            simulator.reset(foggy(drawn_m if visual_range_m == told_m else visual_range_m), 0)
            return simulator.render(Camera())

        return fog_fault(told_m, Camera(), render)


@pytest.mark.parametrize("metres", [25.0, 60.0, 150.0, 300.0])
def test_the_visual_range_is_measured(metres):
    assert not fault_of(metres, 0.92 * metres)
    assert not fault_of(metres, 1.1 * metres)
    assert "the visual range is" in fault_of(metres, 0.77 * metres)
    assert "the visual range is" in fault_of(metres, 1.45 * metres)


def test_a_fog_that_is_not_drawn_is_told_in_words():
    assert fault_of(10_000.0, 60.0) == (
        "contrast does not fall with distance, with a visual range of 60 m"
    )


def test_without_contrast_there_is_no_visual_range():
    with FlatSimulator() as simulator:
        simulator.reset(example_scene(), 0)
        frame = simulator.render(CAMERA)
    grey = dataclasses.replace(frame, rgb=np.full_like(frame.rgb, 128))
    assert not fog_fault(60.0, CAMERA, lambda visual_range_m: grey)


def surfaces(visual_range_m, distances_m, step):
    """Return the frame of speckled surfaces at some distances, one above another, in a fog of 180 grey levels."""
    u, v = tangents(CAMERA)
    distance = np.repeat(distances_m, CAMERA.height // len(distances_m))[:, None]
    speckles = np.random.default_rng(0).integers(0, 2, (CAMERA.height, CAMERA.width))
    clearness = np.exp(-3.0 * distance / visual_range_m)
    grey = ((100.0 + step * speckles) * clearness + 180.0 * (1.0 - clearness)).round()
    depth = distance / np.sqrt(1.0 + u[None, :] ** 2 + v[:, None] ** 2)
    return Frame(
        rgb=np.repeat(grey[:, :, None], 3, axis=2).astype(np.uint8),
        depth=depth.astype(np.float32),
        ids=np.zeros(speckles.shape, np.int32),
    )


@pytest.mark.parametrize("step", [3, 6, 10, 40])
@pytest.mark.parametrize("distances_m", [(5.0, 6.5), (10.0, 14.0), (20.0, 26.0)])
def test_two_distances_are_too_few_for_a_visual_range(distances_m, step):
    assert not fog_fault(60.0, CAMERA, lambda metres: surfaces(metres, distances_m, step))


def test_three_distances_tell_of_a_visual_range():
    def render(visual_range_m):
        return surfaces(30.0 if visual_range_m == 60.0 else visual_range_m, (8.0, 14.0, 24.0), 60)

    assert "is 30 m in the frame" in fog_fault(60.0, CAMERA, render)
