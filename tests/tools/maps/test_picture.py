import pytest

from oodscen.driving._roads.building import load_corridor
from oodscen.driving.maps._shipped import SHIPPED_MAPS

picture = pytest.importorskip("tools.maps.picture", exc_type=ImportError)


@pytest.mark.parametrize("road_map", SHIPPED_MAPS, ids=lambda road: road.id)
def test_pictures_show_road_and_ego(road_map) -> None:
    drawn = picture.draw_map(load_corridor(road_map))
    assert drawn.shape == (307, 832, 3)
    grey = (drawn == (96, 96, 100)).all(axis=2).mean()
    red = (drawn == (214, 60, 48)).all(axis=2).sum()
    assert 0.01 < grey < 0.6
    assert red > 300
