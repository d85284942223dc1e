"""Bird's-eye views and videos show what happens."""

import cv2
import numpy as np
import pytest

from oodscen.data._scene import Trigger
from oodscen.errors import OodscenError, UnknownComponent
from oodscen.protocols import Camera, Control
from oodscen.stages._video import Video, record
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._scenes import example_scene

SMALL = Camera(width=96, height=64)


@pytest.fixture
def flat():
    with FlatSimulator() as simulator:
        yield simulator


def frames(path):
    video = cv2.VideoCapture(str(path))
    found = []
    while True:
        there, picture = video.read()
        if not there:
            return found, video.get(cv2.CAP_PROP_FPS)
        found.append(picture)


@pytest.mark.parametrize(
    ("view", "size"), [("ego", (64, 96)), ("bird", (480, 480)), ("both", (64, 160))]
)
def test_a_video_has_the_views_that_are_asked_for(flat, tmp_path, view, size):
    scene = example_scene().model_copy(update={"horizon_s": 1.0})
    steps = []
    path = record(
        scene,
        flat,
        tmp_path / "new" / "a.mp4",
        driver="stop",
        view=view,
        camera=SMALL,
        fps=5,
        progress=lambda stage, done, total: steps.append((done, total)),
    )
    pictures, fps = frames(path)
    assert pictures[0].shape[:2] == size
    assert fps == pytest.approx(5.0)
    assert [done for done, _ in steps] == list(range(len(steps)))
    assert all(done < total for done, total in steps[:-1])
    assert steps[-1][0] == steps[-1][1]
    assert len(pictures) == pytest.approx(5 * flat.state().time, abs=2)
    assert (np.abs(pictures[0].astype(int) - pictures[-1]).mean(axis=2) > 20).any()


def test_a_video_ends_soon_after_a_collision(flat, tmp_path):
    record(example_scene(), flat, tmp_path / "a.mp4", view="bird", fps=2)
    hit = flat.state().time
    record(example_scene(), flat, tmp_path / "b.mp4", driver="emergency_brake", view="bird", fps=2)
    assert hit < flat.state().time


def test_a_driver_of_one_s_own_drives_from_the_start(flat, tmp_path):
    class Standing:
        def act(self, observation):
            return Control(-8.0)

    short = example_scene().model_copy(update={"decision": Trigger(value=2.0), "horizon_s": 1.0})
    record(short, flat, tmp_path / "a.mp4", driver=Standing(), view="bird", fps=5)
    assert flat.state().speeds[0] == 0.0
    assert flat.state().time == pytest.approx(3.0)


def test_unknown_views_and_actions_are_refused(flat, tmp_path):
    with pytest.raises(UnknownComponent):
        record(example_scene(), flat, tmp_path / "a.mp4", view="side")
    with pytest.raises(UnknownComponent):
        record(example_scene(), flat, tmp_path / "a.mp4", driver="fly")


def test_a_video_that_cannot_be_written_says_so(tmp_path):
    with pytest.raises(OodscenError), Video(tmp_path / "a.nothing") as video:
        video.add(np.zeros((32, 32, 3), np.uint8))
    video.close()
