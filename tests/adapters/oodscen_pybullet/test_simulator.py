import hashlib
import math
from collections.abc import Callable

import numpy as np
import pytest
from oodscen_pybullet import PyBulletSimulator
from oodscen_pybullet._catalogue import load_catalogue
from oodscen_pybullet._meshes import SMOKING

from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._details import Details
from oodscen.data._scene import Actor, Scene
from oodscen.data._weather import Weather
from oodscen.driving._motion.boxes import Footprint, gap
from oodscen.errors import SceneError, SpawnError
from oodscen.protocols import Camera, Control, Frame
from oodscen.testing._check import PARTS, check_simulator
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._kit.samples import plain_scene

MakeActor = Callable[..., Actor]
MakeScene = Callable[..., Scene]


def digest(frame: Frame) -> str:
    parts = (frame.rgb, frame.depth, frame.ids)
    return hashlib.sha256(b"".join(part.tobytes() for part in parts)).hexdigest()


REPEATED = ("determinism", "process")


def test_it_keeps_the_protocols_promises() -> None:
    # How every asset looks in every state is looked at below and in the tests of the catalogue.
    parts = [part for part in PARTS if part not in ("appearance", *REPEATED)]
    check_simulator(PyBulletSimulator, parts=parts, resets=60)


class Fires(PyBulletSimulator):
    """Offers what smokes alone, and a car."""

    def catalogue(self) -> Catalogue:
        whole = super().catalogue()
        return whole.model_copy(update={"assets": [whole.asset(one) for one in ("car", *SMOKING)]})


def test_smoke_may_leave_its_box() -> None:
    check_simulator(Fires, parts=["appearance"])


def test_runs_repeat_in_town_by_night_in_a_tunnel_and_on_a_bridge() -> None:
    catalogue = load_catalogue()
    scenes = [plain_scene(catalogue, catalogue.map(road)) for road in ("tunnel", "bridge")]
    night = Weather(fog_visual_range_m=50.0, sun_elevation_deg=-20.0)
    scenes.append(plain_scene(catalogue, catalogue.map("urban_three_lane"), night))
    check_simulator(PyBulletSimulator, scenes=scenes, parts=REPEATED)


@pytest.mark.parametrize("asset", [asset.id for asset in load_catalogue().assets])
def test_every_asset_is_seen_at_twelve_metres(
    asset: str, simulator: PyBulletSimulator, camera: Camera,
    make_scene: MakeScene, make_actor: MakeActor,
) -> None:  # fmt: skip
    simulator.reset(make_scene(make_actor(asset, 12.0)), 0)
    frame = simulator.render(camera)
    shown = frame.ids == 2
    size = load_catalogue().asset(asset)
    assert shown.sum() >= min(20, 90 * size.width * max(size.height, 0.25))
    reach = size.length / 2 + 0.1
    depth = frame.depth[shown]
    assert abs(depth - (12.0 - camera.x)).max() <= reach + 0.6
    rows, columns = np.nonzero(shown)
    assert abs(columns.mean() - camera.width / 2) < 40
    beside = frame.rgb[rows.max() + 3, columns.mean().astype(int)].astype(int)
    assert abs(frame.rgb[shown].astype(int) - beside).max() > 25


def test_depth_is_the_distance_to_a_flat_face(
    simulator: PyBulletSimulator, make_scene: MakeScene, make_actor: MakeActor
) -> None:
    camera = Camera(width=160, height=120, pitch_deg=0.0)
    for ahead in (8.0, 15.0, 40.0):
        simulator.reset(make_scene(make_actor("cardboard_box", ahead)), 0)
        frame = simulator.render(camera)
        nearest = float(frame.depth[frame.ids == 2].min())
        assert nearest == pytest.approx(ahead - camera.x - 0.454, rel=0.004, abs=0.02)


def test_depth_of_the_road_is_that_of_a_plane(
    simulator: PyBulletSimulator, make_scene: MakeScene, make_actor: MakeActor
) -> None:
    camera = Camera(width=160, height=120, pitch_deg=0.0)
    simulator.reset(make_scene(make_actor("cone", 60.0)), 0)
    frame = simulator.render(camera)
    focal = 80 / math.tan(math.radians(30))
    for row in (75, 85, 95):
        expected = camera.z * focal / (row + 0.5 - 60)
        assert frame.depth[row, 80] == pytest.approx(expected, rel=0.01)
    assert np.isinf(frame.depth[0, 80])


def test_ids_follow_the_states_order(
    simulator: PyBulletSimulator, camera: Camera, make_scene: MakeScene, make_actor: MakeActor
) -> None:
    left = make_actor("sofa", 14.0, name="left", offset=2.5)
    right = make_actor("car", 16.0, name="right", offset=-2.5)
    state = simulator.reset(make_scene(left, right), 0)
    assert state.ids == ("ego", "left", "right")
    ids = simulator.render(camera).ids
    assert np.nonzero(ids == 2)[1].mean() < 80 < np.nonzero(ids == 3)[1].mean()
    assert set(np.unique(ids)) == {0, 1, 2, 3}
    outside = simulator.render(Camera(160, 120, x=-9.0, z=4.0, pitch_deg=12.0))
    assert (outside.ids == 1).sum() > 300


def test_frames_are_the_same_after_another_scene(
    simulator: PyBulletSimulator, camera: Camera, make_scene: MakeScene, make_actor: MakeActor,
) -> None:  # fmt: skip
    weathers: list[dict[str, object]] = [
        {},
        {"fog_visual_range_m": 50.0, "sun_elevation_deg": -20.0},
        {"precipitation": "snow", "precipitation_mm_h": 5.0, "friction": 0.3},
    ]
    actors = (
        make_actor("police_car", 22.0, state="beacon"),
        make_actor("adult", 18.0, name="b", offset=2.0, behaviour="walk_along", speed=1.0),
    )
    scenes = [make_scene(*actors, **weather) for weather in weathers]

    def show(one: PyBulletSimulator, scene: Scene) -> str:
        one.reset(scene, 7)
        for _ in range(3):
            one.step(Control(acceleration=-0.5, steering=0.02))
        return digest(one.render(camera))

    first = [show(simulator, scene) for scene in scenes]
    simulator.reset(make_scene(make_actor("bus", 30.0), road="rural_curve"), 1)
    simulator.render(camera)
    assert [show(simulator, scene) for scene in reversed(scenes)] == first[::-1]


def test_a_twin_differs_by_its_hazard_only(
    simulator: PyBulletSimulator, camera: Camera, make_scene: MakeScene, make_actor: MakeActor
) -> None:
    scene = make_scene(make_actor("car", 20.0), fog_visual_range_m=40.0)
    plain = make_scene(make_actor("car", 20.0))
    simulator.reset(scene, 0)
    fog = simulator.render(camera)
    simulator.reset(scene.twin(1.0), 0)
    twin = simulator.render(camera)
    simulator.reset(plain, 0)
    assert digest(twin) == digest(simulator.render(camera))
    assert np.array_equal(fog.depth, twin.depth)
    assert np.array_equal(fog.ids, twin.ids)
    far = (fog.depth > 60.0) & np.isfinite(fog.depth)
    assert fog.rgb[far].std() < 0.5 * twin.rgb[far].std()


def test_nights_are_darker_than_days_and_snow_is_brighter_than_rain(
    simulator: PyBulletSimulator, camera: Camera, make_scene: MakeScene, make_actor: MakeActor
) -> None:
    def brightness(**weather: object) -> float:
        simulator.reset(make_scene(make_actor("cone", 15.0), road="rural_curve", **weather), 0)
        return float(simulator.render(camera).rgb.mean())

    day, night = brightness(), brightness(sun_elevation_deg=-20.0)
    rain = brightness(precipitation="rain", precipitation_mm_h=20.0)
    snow = brightness(precipitation="snow", precipitation_mm_h=5.0)
    assert night < 0.5 * day
    assert night < rain < snow


def test_gaps_are_those_of_boxes(
    simulator: PyBulletSimulator, make_scene: MakeScene, make_actor: MakeActor
) -> None:
    scene = make_scene(make_actor("bus", 14.0, heading=30.0), make_actor("barrier", 5.0, name="b"))
    state = simulator.reset(scene, 0)
    sizes = {"a": (10.9, 2.88), "b": (0.62, 2.0)}
    for _ in range(8):
        rows = state.poses.tolist()
        ego = Footprint(rows[0][0], rows[0][1], rows[0][3], 4.5, 1.85)
        for row, name in ((1, "a"), (2, "b")):
            box = Footprint(rows[row][0], rows[row][1], rows[row][3], *sizes[name])
            assert state.gaps[row] == pytest.approx(gap(ego, box), abs=2e-3)
        state = simulator.step(Control(acceleration=1.0))
    while state.time < 3.0:
        state = simulator.step(Control(acceleration=1.0))
    assert "b" in state.contacts or state.gaps[2] > 0.0


def test_refusals_say_what_and_where(
    simulator: PyBulletSimulator, make_scene: MakeScene, make_actor: MakeActor
) -> None:
    with pytest.raises(SceneError) as refused:
        simulator.reset(make_scene(make_actor("unicorn", 10.0)), 0)
    assert any("asset" in issue.path for issue in refused.value.issues)
    simulator.reset(make_scene(make_actor("cone", 10.0)), 0)
    ghost = Asset(id="ghost", category="object", description="a ghost", length=1, width=1, height=1)
    pose = (1.0, 2.0, 0.0, 0.5)
    with pytest.raises(SpawnError) as caught:
        simulator.spawn("g", ghost, "", pose)
    assert (caught.value.actor, caught.value.asset, caught.value.pose) == ("g", "ghost", pose)
    assert caught.value.reason
    car = load_catalogue().asset("car")
    with pytest.raises(SpawnError):
        simulator.spawn("n", car, "off", (math.nan, 0.0, 0.0, 0.0))


def test_it_can_be_opened_again_after_close(
    camera: Camera, make_scene: MakeScene, make_actor: MakeActor
) -> None:
    one = PyBulletSimulator()
    one.close()
    scene = make_scene(make_actor("cone", 10.0))
    shots = []
    for _ in range(2):
        one.reset(scene, 0)
        shots.append(digest(one.render(camera)))
        one.close()
        one.close()
    assert shots[0] == shots[1]


def test_gestures_go_on_and_lying_people_are_low_and_elsewhere_both_are_refused(
    simulator: PyBulletSimulator,
    make_scene: MakeScene,
    make_actor: Callable[..., Actor],
    camera: Camera,
) -> None:
    waver = make_actor("adult", 14.0, heading=180.0)
    frames = []
    for details in (None, Details(pose="wave_on"), Details(pose="wave_on"), Details(pose="lie")):
        scene = make_scene(waver.model_copy(update={"details": details}))
        simulator.reset(scene, 3)
        frames.append(simulator.render(camera))
        for _ in range(8):
            simulator.step(Control())
        frames.append(simulator.render(camera))
    plain, _, one, later, again, later_again, lying, _ = frames
    assert np.array_equal(one.rgb, again.rgb)
    assert np.array_equal(later.rgb, later_again.rgb)
    assert not np.array_equal(plain.ids, one.ids)
    assert np.nonzero(lying.ids == 2)[0].min() > np.nonzero(plain.ids == 2)[0].min() + 3
    flat = FlatSimulator().catalogue().lacks(scene)
    assert "actors[0].details.pose" in [issue.path for issue in flat]


def test_from_outside_the_ego_lights_the_road_by_its_own_lamps(
    simulator: PyBulletSimulator, make_scene: MakeScene, make_actor: MakeActor
) -> None:
    scene = make_scene(make_actor("cone", 60.0), road="rural_curve", sun_elevation_deg=-20.0)
    simulator.reset(scene, 0)
    image = simulator.draw(Camera.above(200, 150, x=0.0, z=40.0)).rgb.astype(int)
    ahead, behind = image[20:60, 95:105].mean(), image[90:130, 95:105, 1:].mean()
    assert ahead > behind + 15
    assert image[:, :40].mean() < 20
