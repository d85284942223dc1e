import numpy as np
from oodscen_pybullet.reflections import add_reflections
from oodscen_pybullet.view import View

from oodscen.protocols import Camera

VIEW = View.of(Camera(width=80, height=60, pitch_deg=0.0), (0.0, 0.0, 0.0, 0.0))


def mirror(kind: int, wet: float) -> np.ndarray:
    """A red wall 10 m away on a grey plane."""
    across, upwards = VIEW.slopes()
    rise = upwards * np.float32(VIEW.up[2]) + np.float32(VIEW.forward[2])
    ground = -np.float32(VIEW.eye[2]) / np.minimum(rise, np.float32(-1e-3))
    depth = np.minimum(ground, np.float32(10.0))[:, None].repeat(80, axis=1).astype(np.float32)
    is_wall = depth == 10.0
    image = np.where(is_wall[..., None], [200, 0, 0], [60, 60, 60]).astype(np.uint8)
    kinds = np.where(is_wall, 0, kind).astype(np.uint8)
    add_reflections(
        image,
        depth,
        np.full(depth.shape, -1, np.int32),
        kinds,
        across,
        rise,
        np.float32(VIEW.eye[2]),
        np.float32(wet),
        np.float32(0.0),
        np.uint32(1),
    )
    assert (image[is_wall] == [200, 0, 0]).all()
    return image[~is_wall]


def test_dry_ground_mirrors_nothing() -> None:
    assert (mirror(0, 0.0) == 60).all()


def test_wet_ground_takes_the_colour_of_what_stands_on_it_and_water_more_so() -> None:
    wet, water = mirror(0, 0.6), mirror(2, 0.0)
    for some in (wet, water):
        assert some[:80, 0].astype(int).mean() > 66 > some[:80, 1].mean()
    assert water[:80, 0].astype(int).mean() > wet[:80, 0].astype(int).mean() + 10
