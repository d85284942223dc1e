"""Bird's-eye views and videos show what happens."""

import cv2
import numpy as np
import pytest

from oodscen.data._scene import Trigger
from oodscen.driving._drivers.rule_based import RuleBasedDriver
from oodscen.driving._motion.actions import Cruise
from oodscen.errors import FolderTaken, OodscenError, SimulatorCrash, UnknownComponent, UsageError
from oodscen.protocols import Camera, Control
from oodscen.stages._drive import drive
from oodscen.stages._pictures.video import Video
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
    path = scene.record(
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
    example_scene().record(flat, tmp_path / "a.mp4", view="bird", fps=2)
    hit = flat.state().time
    example_scene().record(flat, tmp_path / "b.mp4", driver="emergency_brake", view="bird", fps=2)
    assert hit < flat.state().time


def test_a_driver_of_one_s_own_drives_from_the_start(flat, tmp_path):
    class Standing:
        def act(self, observation):
            return Control(-8.0)

    short = example_scene().model_copy(update={"decision": Trigger(value=2.0), "horizon_s": 1.0})
    short.record(flat, tmp_path / "a.mp4", driver=Standing(), view="bird", fps=5)
    assert flat.state().speeds[0] == 0.0
    assert flat.state().time == pytest.approx(3.0)


def test_a_driver_is_shown_what_it_asks_for_as_in_a_drive(flat, tmp_path):
    pictures = set()

    class Seeing(RuleBasedDriver):
        wants_frames = True
        camera = SMALL

        def act(self, observation):
            pictures.add(observation.frame.rgb.shape)
            return super().act(observation)

    (driven,) = drive([example_scene()], RuleBasedDriver, flat, twins=False)
    assert driven.passed
    example_scene().record(flat, tmp_path / "a.mp4", driver=Seeing(), view="bird", fps=2)
    assert not flat.state().contacts
    assert pictures == {(64, 96, 3)}


class Failing:
    """Drives for a while, and then fails."""

    def __init__(self, control):
        self.control, self.left = control, 5

    def act(self, observation):
        self.left -= 1
        if self.left:
            return Control()
        if isinstance(self.control, Exception):
            raise self.control
        return self.control


@pytest.mark.parametrize("control", [None, "stop", Control(float("nan")), ValueError("lost")])
def test_a_driver_that_fails_leaves_the_earlier_video(flat, tmp_path, control):
    earlier, new = tmp_path / "a.mp4", tmp_path / "new" / "b.mp4"
    earlier.write_text("earlier")
    for path in (earlier, new):
        with pytest.raises(ValueError if isinstance(control, Exception) else UsageError):
            example_scene().record(flat, path, driver=Failing(control), view="bird", fps=20)
    assert earlier.read_text() == "earlier"
    assert list(tmp_path.iterdir()) == [earlier]


@pytest.mark.parametrize("member", ["reset", "step", "observe", "render"])
def test_a_simulator_that_crashes_is_told_of_as_such(tmp_path, member):
    def crash(*arguments):
        raise ValueError("no road")

    with FlatSimulator() as simulator:
        setattr(simulator, member, crash)
        with pytest.raises(SimulatorCrash, match="no road"):
            example_scene().record(simulator, tmp_path / "a.mp4")
    assert not (tmp_path / "a.mp4").exists()


def test_what_is_no_driver_is_refused_before_anything_is_written(flat, tmp_path):
    for driver in (3, lambda: None, Cruise):
        with pytest.raises(UsageError, match="driver"):
            example_scene().record(flat, tmp_path / "a.mp4", driver=driver, view="bird")
    assert list(tmp_path.iterdir()) == []


def test_a_video_follows_a_link_and_goes_through_a_device(flat, tmp_path):
    scene = example_scene().model_copy(update={"decision": Trigger(value=0.1), "horizon_s": 0.2})
    (tmp_path / "b.mp4").write_text("earlier")
    for name, other in (("a.mp4", "b.mp4"), ("null.mp4", "/dev/null")):
        (tmp_path / name).symlink_to(other)
        scene.record(flat, tmp_path / name, view="bird", fps=5)
        assert (tmp_path / name).is_symlink()
    assert frames(tmp_path / "b.mp4")[0]
    (tmp_path / "file").write_text("")
    with pytest.raises(OodscenError, match="cannot write"):
        scene.record(flat, tmp_path / "file" / "a.mp4", view="bird", fps=5)


def test_a_video_is_never_written_among_the_files_of_a_study(flat, tmp_path):
    (tmp_path / "study.json").write_text("{}")
    with pytest.raises(FolderTaken):
        example_scene().record(flat, tmp_path / "videos" / "box-001.mp4")
    assert not (tmp_path / "videos").exists()


def test_unknown_views_and_actions_are_refused(flat, tmp_path):
    with pytest.raises(UnknownComponent):
        example_scene().record(flat, tmp_path / "a.mp4", view="side")
    with pytest.raises(UnknownComponent):
        example_scene().record(flat, tmp_path / "a.mp4", driver="fly")


def test_a_video_that_cannot_be_written_says_so(tmp_path):
    with pytest.raises(OodscenError), Video(tmp_path / "a.nothing") as video:
        video.add(np.zeros((32, 32, 3), np.uint8))
    video.close()
