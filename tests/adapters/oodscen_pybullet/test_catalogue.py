import subprocess
import sys

import pytest
from oodscen_pybullet.catalogue import load_catalogue
from oodscen_pybullet.meshes import FLAT, asset_ids, asset_mesh, paints_of

from oodscen.catalogue import Asset, Catalogue
from oodscen.driving import BEHAVIOURS, SHIPPED_MAPS

CATALOGUE = load_catalogue()
ALL = (CATALOGUE.ego, *CATALOGUE.assets)


@pytest.mark.parametrize("asset", ALL, ids=lambda asset: asset.id)
def test_sizes_are_those_of_the_meshes(asset: Asset) -> None:
    for state in asset.states or ("",):
        low, high = asset_mesh(asset.id, state).bounds
        assert abs((high - low) - (asset.length, asset.width, asset.height)).max() <= 0.02
        assert abs((high + low)[:2]).max() / 2 <= 0.02
        assert abs(low[2]) <= 0.02


@pytest.mark.parametrize("asset", ALL, ids=lambda asset: asset.id)
def test_every_look_has_the_same_size(asset: Asset) -> None:
    first = asset_mesh(asset.id).bounds
    for paint in paints_of(asset.id):
        for running in (False, True):
            other = asset_mesh(asset.id, paint=paint, running=running).bounds
            assert max(abs(first[0] - other[0]).max(), abs(first[1] - other[1]).max()) <= 0.02


@pytest.mark.parametrize("asset", ALL, ids=lambda asset: asset.id)
def test_what_collides_lies_within_what_is_seen(asset: Asset) -> None:
    solids = asset_mesh(asset.id).solids
    assert bool(solids) == (asset.id not in FLAT)
    for (x, y, z), (half_x, half_y, half_z) in solids:
        assert abs(x) + half_x <= asset.length / 2 + 0.02
        assert abs(y) + half_y <= asset.width / 2 + 0.02
        assert z - half_z >= -0.02
        assert z + half_z <= asset.height + 0.02


def test_there_is_one_mesh_per_asset() -> None:
    assert {asset.id for asset in ALL} == set(asset_ids())


def test_behaviours_maps_and_weather_are_offered() -> None:
    assert CATALOGUE.behaviours == BEHAVIOURS
    assert CATALOGUE.maps == SHIPPED_MAPS
    assert CATALOGUE.weather.min_sun_elevation_deg <= -20.0
    assert CATALOGUE.weather.min_fog_visual_range_m <= 15.0
    assert set(CATALOGUE.weather.precipitation) == {"none", "rain", "snow"}


def test_it_survives_json() -> None:
    assert Catalogue.parse(CATALOGUE.to_json()) == CATALOGUE


def test_neither_import_nor_catalogue_starts_the_engine() -> None:
    code = (
        "import sys; from oodscen_pybullet import PyBulletSimulator;"
        "PyBulletSimulator().catalogue();"
        "print(sorted({'pybullet', 'cv2'} & set(sys.modules)))"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == "[]"
