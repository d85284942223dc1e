from types import SimpleNamespace

import numpy as np
import pytest

from tools import frame_strip as strip

cv2 = pytest.importorskip("cv2")


def test_scenes_stand_above_their_twins(tmp_path):
    shades = {"a": 40, "b": 80, "a~twin": 120, "b~twin": 160}
    for name, shade in shades.items():
        cv2.imwrite(str(tmp_path / f"{name}.png"), np.full((480, 640, 3), shade, np.uint8))
    episodes = [SimpleNamespace(id=name, frames={"last": f"{name}.png"}) for name in shades]
    drawn = strip.draw(SimpleNamespace(folder=tmp_path, episodes=episodes), ["a", "b"])
    width, height = strip.TILE
    assert drawn.shape == (2 * height + strip.GAP, 2 * width + strip.GAP, 3)
    middles = drawn[height // 2 :: height, width // 2 :: width, 0][:2, :2]
    assert middles.tolist() == [[40, 80], [120, 160]]
