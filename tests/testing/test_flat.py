import pytest

from oodscen import run_study, simulate
from oodscen.data._catalogue import WeatherRange
from oodscen.errors import UsageError
from oodscen.protocols import Camera
from oodscen.testing import check_simulator, example_scene
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE
from oodscen.testing._kit.samples import plain_scene
from tests.driving.staging import actor, scene
from tests.pipeline.quick import SMALL


class FromAbove(FlatSimulator):
    """Draws views straight down only."""

    name = "above"

    def catalogue(self):
        weather = WeatherRange(min_sun_elevation_deg=-90.0, min_fog_visual_range_m=150.0)
        return super().catalogue().model_copy(update={"camera": "top", "weather": weather})

    def draw(self, camera):
        assert camera.pitch_deg == 90.0
        return super().draw(camera)


def test_a_simulator_that_sees_from_above_keeps_the_protocol() -> None:
    parts = ("appearance", "weather", "frames", "pictures", "determinism")
    road = FLAT_CATALOGUE.map("urban_avenue")
    check_simulator(FromAbove, parts=parts, scenes=[plain_scene(FLAT_CATALOGUE, road)])


@pytest.mark.parametrize("size", [(640, 480), (480, 640), (1280, 720), (300, 300)])
@pytest.mark.parametrize(("ahead", "is_seen"), [(-8.0, True), (72.0, True), (85.0, False)])
def test_a_picture_from_above_reaches_as_far_as_most_hazards_are_staged(
    size, ahead, is_seen
) -> None:
    with FromAbove() as simulator:
        simulator.reset(scene(actor("one", ahead=ahead, offset=3.2)), 0)
        frame = simulator.render(Camera.above(*size))
    assert ((frame.ids == 2).sum() > 4) == is_seen


def test_an_episode_from_above_has_frames_from_above() -> None:
    episode = simulate(example_scene(), FromAbove()).episode
    assert episode.hazard_visible
    assert "stop" in episode.safe_set


def test_models_are_not_asked_about_a_drivers_view_that_is_none(tmp_path) -> None:
    config = SMALL.model_copy(update={"simulator": f"{__name__}:FromAbove", "vlms": ("gpt-4o",)})
    with pytest.raises(UsageError, match="views from above only"):
        run_study(tmp_path / "out", config)


def test_a_study_from_above_says_so_in_its_report(tmp_path) -> None:
    config = SMALL.model_copy(
        update={"simulator": f"{__name__}:FromAbove", "demands": False, "catalogues": ()}
    )
    study = run_study(tmp_path / "out", config)
    assert study.info["camera"] == "top"
    assert "These scenes are for driving stacks" in (study.folder / "report.html").read_text()
