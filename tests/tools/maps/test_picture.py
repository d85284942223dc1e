import pytest

from oodscen.driving import load_corridor
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from tools.maps.picture import draw_map


@pytest.mark.parametrize("road_map", SHIPPED_MAPS, ids=lambda road: road.id)
def test_pictures_show_road_and_ego(road_map) -> None:
    pytest.importorskip("cv2")
    picture = draw_map(load_corridor(road_map))
    assert picture.shape == (307, 832, 3)
    grey = (picture == (96, 96, 100)).all(axis=2).mean()
    red = (picture == (214, 60, 48)).all(axis=2).sum()
    assert 0.01 < grey < 0.6
    assert red > 300
