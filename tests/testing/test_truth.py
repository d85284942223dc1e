"""The rendered check finds what a frame or a state does not show as the scene says."""

import dataclasses

import numpy as np
import pytest

from oodscen.data._scene import Hazard, Trigger, Weather
from oodscen.protocols import Camera
from oodscen.testing import check_truth
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._scenes import example_scene
from oodscen.testing._truth import measured_visual_range

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


@pytest.mark.parametrize("metres", [25.0, 60.0, 150.0, 300.0])
def test_the_visual_range_is_measured(metres):
    with FlatSimulator() as simulator:
        frames = []
        for fog in (metres, 10_000.0):
            simulator.reset(foggy(fog), 0)
            frames.append(simulator.render(Camera()))
    found = measured_visual_range(frames[0], frames[1], Camera())
    assert found == pytest.approx(metres, rel=0.08)


def test_without_contrast_there_is_no_visual_range():
    with FlatSimulator() as simulator:
        simulator.reset(example_scene(), 0)
        frame = simulator.render(CAMERA)
    grey = dataclasses.replace(frame, rgb=np.full_like(frame.rgb, 128))
    assert measured_visual_range(grey, grey, CAMERA) is None
