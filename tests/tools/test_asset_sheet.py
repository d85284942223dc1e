from pathlib import Path

import numpy as np
import pytest
from oodscen_pybullet._catalogue import load_catalogue
from oodscen_pybullet._meshes import SMOKING

from tools import asset_sheet as sheet

ROOT = Path(__file__).parents[2]
ASSETS = load_catalogue().assets


def test_the_page_lists_every_asset_and_is_the_one_that_is_committed() -> None:
    page = sheet.page()
    for asset in ASSETS:
        assert f"| `{asset.id}` | {asset.description} |" in page
    assert (ROOT / "docs" / "assets.md").read_text(encoding="utf-8") == page


def test_every_category_is_on_a_sheet_whose_picture_is_there() -> None:
    shown = [category for categories in sheet.SHEETS.values() for category in categories]
    assert sorted(shown) == sorted({asset.category for asset in ASSETS})
    folder = ROOT / "docs" / "pictures" / "assets"
    names = {f"{name}.jpg" for name in (*sheet.SHEETS, "gaits", "lights")}
    assert {path.name for path in folder.iterdir()} == names
    assert sum(path.stat().st_size for path in folder.iterdir()) < 1_500_000


@pytest.fixture(scope="module")
def looks() -> dict[str, np.ndarray]:
    """Return a coarse picture of every asset, seen from ahead at an angle."""
    coarse = {}
    for asset in ASSETS:
        turn = sheet.best_side(asset)
        image = sheet.render(sheet.rest_look(asset), turn_deg=turn).astype(float)
        height, width = image.shape[0] // 12 * 12, image.shape[1] // 13 * 13
        blocks = image[:height, :width].reshape(12, height // 12, 13, width // 13, 3)
        coarse[asset.id] = blocks.mean(axis=(1, 3))
    return coarse


def test_every_asset_fills_its_picture(looks: dict[str, np.ndarray]) -> None:
    for name, picture in looks.items():
        ground = np.median(picture.reshape(-1, 3), axis=0)
        shown = np.abs(picture - ground).max(axis=2) > 6.0
        assert shown.sum() >= 4, name


def test_no_two_assets_look_the_same(looks: dict[str, np.ndarray]) -> None:
    names = [name for name in looks if name not in SMOKING]
    pictures = np.array([looks[name].reshape(-1) for name in names])
    for row, name in enumerate(names):
        apart = np.abs(pictures - pictures[row]).mean(axis=1)
        apart[row] = np.inf
        assert apart.min() > 0.4, (name, names[int(apart.argmin())])
