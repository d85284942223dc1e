import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oodscen_pybullet._lighting.reflections import add_reflections, grazing_depth
from oodscen_pybullet._rendering.triangles import GROUND, MIRROR, PLAIN, SHELTERED, SOFT
from oodscen_pybullet._rendering.view import CameraView

from oodscen.protocols import Camera

VIEW = CameraView.of(Camera(width=80, height=60, pitch_deg=0.0), (0.0, 0.0, 0.0, 0.0))
HALF = grazing_depth(1.4)


def mirror(kind: int, wet: float) -> np.ndarray:
    """A red wall 10 m away on a grey plane."""
    _, upwards = VIEW.slopes()
    rise = upwards * np.float32(VIEW.up[2]) + np.float32(VIEW.forward[2])
    ground = -np.float32(VIEW.eye[2]) / np.minimum(rise, np.float32(-1e-3))
    depth = np.minimum(ground, np.float32(10.0))[:, None].repeat(80, axis=1).astype(np.float32)
    is_wall = depth == 10.0
    image = np.where(is_wall[..., None], [200, 0, 0], [60, 60, 60]).astype(np.uint8)
    kinds = np.where(is_wall, PLAIN, kind).astype(np.uint8)
    add_reflections(
        image,
        depth,
        kinds,
        HALF,
        np.float32(wet),
        np.float32(0.0),
        np.uint32(1),
    )
    assert (image[is_wall] == [200, 0, 0]).all()
    return image[~is_wall]


def test_ground_seen_at_the_same_angle_from_higher_up_mirrors_as_much() -> None:
    shares = []
    for scale in (1.0, 5.0):
        depth = np.full((40, 8), 60.0 * scale, np.float32)
        depth[20:] = (28.0 * scale / (0.5 + np.arange(20)))[:, None]
        kinds = np.where(depth < 60.0 * scale, GROUND, PLAIN).astype(np.uint8)
        image = np.where(kinds[..., None] == PLAIN, 200, 0).repeat(3, axis=2).astype(np.uint8)
        half = grazing_depth(1.4 * scale)
        add_reflections(
            image, depth, kinds, half, np.float32(0.6), np.float32(0.0), np.uint32(1)
        )  # fmt: skip
        shares.append(image[20:])
    assert shares[0].max() > 40
    assert (shares[0] == shares[1]).all()


def test_the_higher_the_eye_is_the_less_ground_at_a_distance_mirrors() -> None:
    distance, halves = 15.0, [float(grazing_depth(height)) for height in (0.0, 1.4, 3.0, 8.0)]
    shares = [(distance / (distance + half)) ** 2 for half in halves]
    assert halves[1] == 13.0
    assert shares[0] < 1.0
    assert shares == sorted(shares, reverse=True)
    assert shares[3] < 0.1 * shares[1]


def test_dry_ground_mirrors_nothing() -> None:
    assert (mirror(GROUND, 0.0) == 60).all()


def test_wet_ground_takes_the_colour_of_what_stands_on_it_and_water_more_so() -> None:
    wet, water = mirror(GROUND, 0.6), mirror(MIRROR, 0.0)
    for some in (wet, water):
        assert some[:80, 0].astype(int).mean() > 66 > some[:80, 1].mean()
    assert water[:80, 0].astype(int).mean() > wet[:80, 0].astype(int).mean() + 10


@pytest.mark.parametrize("kind", [GROUND, MIRROR])
def test_a_picture_of_ground_only_mirrors_nothing(kind: int) -> None:
    image = np.full((40, 8, 3), 100, np.uint8)
    depth, kinds = np.full((40, 8), 30.0, np.float32), np.full((40, 8), kind, np.uint8)
    add_reflections(image, depth, kinds, HALF, np.float32(0.6), np.float32(0.0), np.uint32(1))
    assert (image == 100).all()


def test_grass_and_roads_in_tunnels_mirror_nothing() -> None:
    for kind in (GROUND + SOFT, GROUND + SHELTERED):
        assert (mirror(kind, 0.6) == 60).all()


def test_the_sky_is_mirrored_paler_than_it_is() -> None:
    depth = np.full((40, 8), 20.0, np.float32)
    depth[:20] = np.inf
    kinds = np.zeros((40, 8), np.uint8)
    kinds[20:] = MIRROR
    image = np.full((40, 8, 3), 60, np.uint8)
    image[:20] = (90, 150, 220)
    add_reflections(
        image, depth, kinds, HALF, np.float32(0.0), np.float32(0.0), np.uint32(1)
    )  # fmt: skip
    water = image[30].astype(int)
    assert (water[:, 2] > water[:, 0]).all()
    assert (water[:, 2] - water[:, 0] < 0.4 * (220 - 90)).all()


def graded(kind: int, wet: float, seed: int = 1, gain: float = 0.0, lamp: int = 0) -> np.ndarray:
    """Return black ground, [20, 30], below a wall that brightens downwards from 5 to 100, with lamps in its row 12."""
    image = np.zeros((40, 30, 3), np.uint8)
    image[:20] = (5 * np.arange(1, 21))[:, None, None]
    image[12] = np.maximum(image[12], lamp)
    depth = np.full((40, 30), 20.0, np.float32)
    kinds = np.full((40, 30), PLAIN, np.uint8)
    kinds[20:] = kind
    add_reflections(
        image, depth, kinds, HALF, np.float32(wet), np.float32(gain), np.uint32(seed)
    )  # fmt: skip
    return image[20:, :, 0].astype(int)


def test_water_mirrors_a_wall_upside_down_and_row_by_row() -> None:
    rows = graded(MIRROR, 0.0)
    assert (rows == rows[:, :1]).all()
    assert (np.diff(rows[:, 0]) <= 0).all()
    share = rows[:12, 0] / (100 - 5 * np.arange(12))
    assert np.ptp(share) < 0.06


def layered(*layers: tuple[int, int, float, int]) -> np.ndarray:
    """Return the brightness below layers of the picture: each one's rows, brightness, depth and kind, from the top."""
    rows = [count for count, _, _, _ in layers]
    bright, depth, kinds = (
        np.repeat(column, rows) for column in list(zip(*layers, strict=True))[1:]
    )
    image = np.broadcast_to(bright[:, None, None], (sum(rows), 8, 3)).astype(np.uint8).copy()
    add_reflections(
        image,
        np.broadcast_to(depth[:, None], (len(depth), 8)).astype(np.float32),
        np.broadcast_to(kinds[:, None], (len(kinds), 8)).astype(np.uint8),
        HALF,
        np.float32(0.6),
        np.float32(0.0),
        np.uint32(1),
    )  # fmt: skip
    return image[sum(rows[:-1]) :, :, 0].astype(int)


@pytest.mark.parametrize("kind", [GROUND, GROUND + SOFT, GROUND + SHELTERED])
def test_level_ground_is_not_mirrored(kind: int) -> None:
    wall, road = (20, 90, 60.0, PLAIN), (20, 0, 30.0, GROUND)
    assert (layered(wall, (5, 255, 55.0, kind), road)[5:] <= layered(wall, road)[5:] + 1).all()


def test_ground_mirrors_nothing_that_is_nearer_than_itself() -> None:
    wall, road = (20, 90, 60.0, PLAIN), (20, 0, 30.0, GROUND)
    crown = (5, 255, 25.0, PLAIN)
    assert layered(wall, crown, road).max() < 30
    assert layered(wall, (5, 255, 35.0, PLAIN), road).max() > 70


def test_ground_below_nothing_that_it_could_mirror_stays_as_it_is() -> None:
    road = (20, 0, 30.0, GROUND)
    assert layered((25, 255, 25.0, PLAIN), road).max() == 0
    assert layered((1, 255, 55.0, GROUND), (19, 0, 25.0, PLAIN), road).max() == 0


def test_water_mirrors_its_banks() -> None:
    sky, bank, water = (20, 0, 500.0, PLAIN), (20, 200, 40.0, GROUND + SOFT), (20, 0, 30.0, MIRROR)
    assert layered(sky, bank, water).min() > 80


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**20 - 1), st.sampled_from([0.0, 0.62]), st.sampled_from([0.0, 5.0]))
def test_plain_and_compiled_code_give_the_same_bits(seed: int, wet: float, gain: float) -> None:
    rng = np.random.default_rng(seed)
    image = rng.integers(0, 256, (24, 16, 3), np.uint8)
    depth = rng.uniform(1.0, 600.0, (24, 16)).astype(np.float32)
    kinds = rng.choice([PLAIN, GROUND, MIRROR, GROUND + SOFT], (24, 16)).astype(np.uint8)
    plain = image.copy()
    for picture, run in ((image, add_reflections), (plain, add_reflections.plain)):
        run(picture, depth, kinds, HALF, np.float32(wet), np.float32(gain), np.uint32(seed))
    assert (image == plain).all()


def test_a_rough_road_scatters_what_it_mirrors_by_its_seed() -> None:
    columns = np.arange(30)
    image = np.zeros((40, 30, 3), np.uint8)
    image[:20] = (8 * columns)[None, :, None]
    depth, kinds = np.full((40, 30), 20.0, np.float32), np.full((40, 30), PLAIN, np.uint8)
    kinds[20:] = GROUND
    roads = []
    for seed in (1, 1, 2):
        road = image.copy()
        add_reflections(road, depth, kinds, HALF, np.float32(1.0), np.float32(0.0), np.uint32(seed))
        roads.append(road[20:, :, 0].astype(int))
    assert (roads[0] == roads[1]).all()
    assert (roads[0] != roads[2]).any()
    share = (20.0 / 33.0) ** 2
    for road in (roads[0], roads[2]):
        straight = road[10:] - share * 8 * columns
        assert np.ptp(straight[:, 5:25], axis=0).max() > 0
        assert np.abs(straight[:, 5:25]).max() < 8.0


def test_a_lamp_is_reflected_brighter_with_gain_and_nothing_else_is() -> None:
    for kind, wet in ((MIRROR, 0.0), (GROUND, 0.6)):
        lit, more = graded(kind, wet, lamp=255), graded(kind, wet, lamp=255, gain=10.0)
        assert more.max() > lit.max() + 5
        assert (graded(kind, wet) == graded(kind, wet, gain=10.0)).all()
        below = graded(kind, wet, lamp=205)
        assert (below == graded(kind, wet, lamp=205, gain=10.0)).all()
