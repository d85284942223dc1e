"""Laws of bird's-eye views."""

import dataclasses

import numpy as np
import pytest

from oodscen.data._scene import Ego, Hazard, Scene, Trigger
from oodscen.data._weather import Weather
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.errors import SceneError
from oodscen.protocols import Camera
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._scenes import example_scene

BLUE, AMBER, RED = (130, 183, 240), (232, 176, 74), (240, 110, 84)


@pytest.fixture
def flat():
    with FlatSimulator() as simulator:
        yield simulator


@pytest.mark.parametrize("road", SHIPPED_MAPS, ids=lambda road: road.id)
def test_the_ego_is_on_a_grey_road_on_every_map(flat, road):
    scene = Scene(
        id="a",
        scenario_id="a",
        map=road.id,
        ego=Ego(speed=5.0),
        hazard=Hazard(weather=Weather(cloud_cover=1.0)),
        decision=Trigger(value=1.0),
    )
    picture = scene.birds_eye(flat.reset(scene, 0), flat.catalogue(), size=320)
    assert picture.shape == (320, 320, 3)
    ego = np.argwhere((picture == BLUE).all(axis=2))
    assert 20 < len(ego) < 400
    row, column = ego.mean(axis=0)
    assert abs(column - 160) < 5
    beside = picture[int(row), int(column) + 9].astype(int)
    assert np.ptp(beside) < 12


def count(picture, colour):
    return int((picture == colour).all(axis=2).sum())


def test_the_hazard_is_amber_and_red_once_it_is_hit(flat):
    scene = example_scene()
    state = flat.reset(scene, 0)
    picture = scene.birds_eye(state, flat.catalogue(), span_m=150)
    assert count(picture, AMBER) >= 4
    assert count(picture, RED) == 0
    hit = dataclasses.replace(state, gaps=np.array([np.inf, 0.0]))
    picture = scene.birds_eye(hit, flat.catalogue(), span_m=150)
    assert count(picture, AMBER) == 0
    assert count(picture, RED) >= 4
    twin = scene.twin(1.0)
    picture = twin.birds_eye(flat.reset(twin, 0), flat.catalogue(), span_m=150)
    assert count(picture, AMBER) == 0


ONE_LANE = b"""<OpenDRIVE><road id="1" length="600" junction="-1" rule="RHT">
<planView><geometry s="0" x="0" y="0" hdg="0" length="600"><line/></geometry></planView>
<lanes><laneSection s="0"><left/>
<center><lane id="0" type="none"><roadMark sOffset="0" type="solid"/></lane></center>
<right><lane id="-1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/>
<roadMark sOffset="0" type="solid"/></lane></right></laneSection></lanes></road></OpenDRIVE>"""


def test_the_marks_on_both_outer_edges_of_a_road_are_drawn(flat, tmp_path):
    path = tmp_path / "own.xodr"
    path.write_bytes(ONE_LANE)
    scene = Scene(
        id="a",
        scenario_id="a",
        map=str(path),
        ego=Ego(speed=5.0),
        hazard=Hazard(weather=Weather(cloud_cover=1.0)),
        decision=Trigger(value=1.0),
    )
    picture = scene.birds_eye(flat.reset(scene, 0), flat.catalogue())
    bright = np.flatnonzero((picture[100] > 190).all(axis=1))
    assert len(bright) >= 2
    assert bright[-1] - bright[0] == pytest.approx(3.5 * 480 / 72, abs=2)


def test_a_catalogue_without_an_actor_s_asset_is_told(flat):
    scene, catalogue = example_scene(), flat.catalogue()
    state = flat.reset(scene, 0)
    poorer = catalogue.model_copy(update={"assets": ()})
    with pytest.raises(SceneError, match="no asset 'cardboard_box'"):
        scene.birds_eye(state, poorer)
    with pytest.raises(SceneError, match="no asset 'cardboard_box'"):
        scene.annotate(flat.render(Camera()), state, poorer)
