import numpy as np
import pytest
from oodscen_pybullet._meshes.atlas import REGIONS, SIZE, Snow, draw_atlas, swatch_uv


def colour(name: str, snow: Snow) -> int:
    column, row = swatch_uv(name) * SIZE
    return int(draw_atlas(snow)[int(SIZE - row), int(column)].min())


@pytest.mark.parametrize("name", ["grass", "hill", "roof_red", "pavement", "gravel"])
def test_lying_snow_whitens_the_land(name: str) -> None:
    assert colour(name, Snow.NONE) < 190 < colour(name, Snow.LAND) == colour(name, Snow.ROADS)


@pytest.mark.parametrize("name", ["asphalt", "asphalt_dark", "mark_worn"])
def test_roads_are_cleared_unless_snow_covers_them_too(name: str) -> None:
    assert colour(name, Snow.NONE) == colour(name, Snow.LAND) != colour(name, Snow.ROADS)


def test_printed_surfaces_agree_with_the_colours() -> None:
    x, y, width, height = REGIONS["turf"]
    bare, land = (draw_atlas(snow)[y : y + height, x : x + width] for snow in Snow if snow < 2)
    assert np.median(land) > 200 > np.median(bare)
