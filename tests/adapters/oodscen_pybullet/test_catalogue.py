import subprocess
import sys

import numpy as np
import pytest
from numpy.typing import NDArray
from oodscen_pybullet._catalogue import load_catalogue
from oodscen_pybullet._meshes import FLASHING, GAITS, SMOKING, asset_ids, asset_mesh, paints_of

from oodscen.data._catalogue import Asset, Catalogue
from oodscen.driving._motion.behaviours.table import BEHAVIOURS
from oodscen.driving.maps._shipped import SHIPPED_MAPS

CATALOGUE = load_catalogue()
ALL = (CATALOGUE.ego, *CATALOGUE.assets)


def spans(asset: Asset, **look: object) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the bounds over all states of an asset at rest."""
    bounds = [asset_mesh(asset.id, state, **look).bounds for state in asset.states or ("",)]
    return np.min([low for low, _ in bounds], axis=0), np.max([high for _, high in bounds], axis=0)


@pytest.mark.parametrize("asset", ALL, ids=lambda asset: asset.id)
def test_sizes_are_those_of_the_meshes(asset: Asset) -> None:
    low, high = spans(asset)
    assert abs((high - low) - (asset.length, asset.width, asset.height)).max() <= 0.02
    assert abs((high + low)[:2]).max() / 2 <= 0.02
    assert abs(low[2]) <= 0.02


@pytest.mark.parametrize("asset", ALL, ids=lambda asset: asset.id)
def test_every_look_has_the_same_size_and_every_normal_length_one(asset: Asset) -> None:
    low, high = spans(asset)
    ours = spans(asset, running=True)
    assert max(abs(low - ours[0]).max(), abs(high - ours[1]).max()) <= 0.05
    state = asset.states[0] if asset.states else ""
    low, high = asset_mesh(asset.id, state).bounds
    for paint in paints_of(asset.id):
        mesh = asset_mesh(asset.id, state, paint)
        ours = mesh.bounds
        assert max(abs(low - ours[0]).max(), abs(high - ours[1]).max()) <= 0.05
        assert np.isfinite(mesh.vertices).all()
        assert abs((mesh.normals**2).sum(axis=1) - 1.0).max() < 1e-6


@pytest.mark.parametrize("asset", sorted(GAITS))
def test_a_walk_stays_on_the_ground_and_about_its_place(asset: str) -> None:
    rest = asset_mesh(asset).bounds
    pictures = set()
    for frame in range(1, 17):
        mesh = asset_mesh(asset, frame=frame)
        low, high = mesh.bounds
        assert abs(low[2]) <= 0.02
        assert high[2] <= rest[1][2] + 0.08
        assert max(abs(low - rest[0])[:2].max(), abs(high - rest[1])[:2].max()) <= 0.6
        pictures.add(mesh.vertices.round(3).tobytes())
    assert len(pictures) >= 8


@pytest.mark.parametrize("asset", ALL, ids=lambda asset: asset.id)
def test_assets_are_neither_coarse_nor_heavy(asset: Asset) -> None:
    assert 8 <= len(asset_mesh(asset.id).triangles) <= 1500
    assert asset.description
    assert asset.tags


def test_smoke_moves_and_lamps_flash() -> None:
    for asset in SMOKING:
        steps = [asset_mesh(asset, frame=frame).puffs for frame in range(8)]
        assert len(set(steps)) == 8
        assert all(0.0 < puff.density <= 1.0 and puff.radius > 0.0 for puff in steps[0])
    for asset in ALL:
        for state in set(asset.states) & FLASHING:
            lit, dark = (len(asset_mesh(asset.id, state, frame=frame).lamps) for frame in (0, 1))
            assert lit >= dark
            assert lit > 0


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
