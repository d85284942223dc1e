import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.data._motion import ABILITIES, Motion
from oodscen.data._scene import Scene
from oodscen.driving._motion.keyframes import CARRIED_MPS
from oodscen.driving._motion.world import KinematicWorld
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._sight.placement import staging_issues
from oodscen.protocols import Control
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE
from tests.motions import sound_motions

_ASSETS = {
    "person": "adult", "animal": "dog", "cyclist": "cyclist", "car": "car", "truck": "truck",
    "loose": "cone", "flying": "cone",
}  # fmt: skip


def scene_of(motion: Motion | dict[str, Any], *, speed: float = 8.0, **more: Any) -> Scene:
    """Return a scene in which one actor moves so, beside a car that it may follow."""
    made = motion if isinstance(motion, Motion) else Motion.parse(motion)
    other = "lead" if made.frame == "other" else None
    placement = more.pop("placement", {"ahead_m": 25.0, "offset_m": -0.5})
    return Scene.parse(
        {
            "id": "moves",
            "scenario_id": "moves",
            "map": "urban_three_lane",
            "ego": {"speed": speed},
            "actors": [
                {
                    "id": "lead",
                    "asset": "car",
                    "placement": {"ahead_m": 40.0, "lane": 1},
                    "behaviour": {"name": "follow_lane", "parameters": {"speed": 7.0}},
                },
                {
                    "id": "thing",
                    "asset": more.pop("asset", _ASSETS[made.body]),
                    "placement": placement,
                    "behaviour": {"name": made.id, "other": other, **more},
                },
            ],
            "hazard": {"actors": {"thing": None, "lead": None}},
            "decision": {"kind": "time", "value": 2.0},
            "motions": [made.model_dump(mode="json")],
        }
    )


def world_of(scene: Scene, seed: int = 0) -> KinematicWorld:
    return KinematicWorld(load_corridor(scene.map, FLAT_CATALOGUE), scene, FLAT_CATALOGUE, seed)


@settings(max_examples=25, deadline=None)
@given(sound_motions(), st.integers(0, 5), st.sampled_from([0.0, 1.0]))
def test_every_motion_is_finite_continuous_and_repeats(
    motion: Motion, seed: int, begins: float
) -> None:
    scene = scene_of(motion, trigger={"kind": "time", "value": begins})
    world = world_of(scene, seed)
    able = ABILITIES[motion.body]
    fastest = CARRIED_MPS if motion.frame == "other" else able.speed
    before, trace = world.poses()[2], []
    for k in range(70):
        if k == 30:
            saved = world.snapshot()
        world.step(Control(0.5 if k < 40 else -2.0, 0.01))
        state = world.state()
        pose = state.poses[2]
        assert np.isfinite(pose).all()
        moved = math.dist(pose[:2], before[:2])
        let_go = 1.0 if motion.let_go is None else 1.2
        assert moved <= fastest * world.dt * let_go + 1e-5
        assert abs(pose[2] - before[2]) <= 1.5
        assert state.gaps[2] >= 0.0
        before = pose
        trace.append(pose)
    world.restore(saved)
    again = world_of(Scene.parse(scene.to_json()), seed)
    for k in range(70):
        again.step(Control(0.5 if k < 40 else -2.0, 0.01))
        assert (again.poses()[2] == trace[k]).all()
        if k >= 30:
            world.step(Control(0.5 if k < 40 else -2.0, 0.01))
            assert (world.poses()[2] == trace[k]).all()


def course(scene: Scene, steps: int, control: Control | None = None) -> np.ndarray[Any, Any]:
    """Return the poses of the thing and its gap to the ego at every step: [steps, 5]."""
    world = world_of(scene)
    rows = []
    for _ in range(steps):
        world.step(control or Control())
        rows.append([*world.poses()[2], world.state().gaps[2]])
    return np.array(rows)


def made(**members: Any) -> dict[str, Any]:
    return {"id": "moves", "description": "moves somehow", **members}


def test_keys_are_reached_at_their_times() -> None:
    keys = [
        {"at": 0},
        {"at": 2, "ahead": 3, "left": 1},
        {"at": 4, "ahead": 3, "left": 1},
        {"at": 6},
    ]
    start = world_of(scene_of(made(body="person", keys=keys))).poses()[2]
    seen = course(scene_of(made(body="person", keys=keys)), 140)
    apart = seen[:, :2] - start[:2]
    assert np.allclose(apart[39], [3, 1], atol=0.02)
    assert np.allclose(apart[79], [3, 1], atol=0.02)
    assert np.allclose(apart[130], [0, 0], atol=0.02)


def test_nothing_moves_before_its_trigger() -> None:
    scene = scene_of(
        made(body="loose", keys=[{"up": -0.9}, {"at": 1}]), trigger={"kind": "time", "value": 1.0}
    )
    seen = course(scene, 60)
    assert (seen[:18, 2] == -0.9).all()
    assert seen[-1, 2] == 0.0


def test_what_has_sunk_blocks_nobody_until_it_rises() -> None:
    motion = made(body="loose", keys=[{"up": -0.9}, {"at": 1}])
    place = {"ahead_m": 6.0}
    sunk = scene_of(motion, trigger={"kind": "time", "value": 50.0}, placement=place)
    assert (course(sunk, 40)[:, 4] == math.inf).all()
    assert course(scene_of(motion, placement=place), 40)[:, 4].min() == 0.0


def test_a_fall_reaches_what_an_upright_box_does_not() -> None:
    fall = made(body="person", keys=[{"at": 0}, {"at": 1, "pitch": 90}])
    still = made(body="person", keys=[{"at": 0}, {"at": 1, "roll": 1}])
    beside = {"ahead_m": 16.0, "offset_m": 2.3, "heading_deg": -90.0}
    assert course(scene_of(still, placement=beside), 60)[:, 4].min() > 0.0
    assert course(scene_of(fall, placement=beside), 60)[:, 4].min() == 0.0


def test_what_is_towed_is_let_go() -> None:
    motion = made(body="car", frame="other", let_go=2.0, keys=[{"at": 0}])
    scene = scene_of(
        motion, asset="car", placement={"ahead_m": 33.0, "lane": 1, "heading_deg": 180.0}
    )
    seen = course(scene, 200)
    assert np.ptp(np.diff(seen[:38, 0])) < 0.02
    assert np.diff(seen[-5:, 0]).max() < np.diff(seen[:38, 0]).min()
    assert abs(abs(seen[-1, 3]) - math.pi) < 1e-3


def test_a_crowd_differs_by_actor_and_seed() -> None:
    motion = made(body="person", delay=4, pace=0.3, walk={"distance": 8})
    one = scene_of(motion)
    assert (course(one, 80)[:, :2] == course(one, 80)[:, :2]).all()
    world, other = world_of(one, 0), world_of(one, 1)
    for _ in range(80):
        world.step(Control())
        other.step(Control())
    assert (world.poses()[2] != other.poses()[2]).any()


def test_the_ego_drives_a_motion_over_its_distance() -> None:
    motion = made(body="loose", by="ego", keys=[{"at": 0}, {"at": 10, "left": 2}])
    assert np.ptp(course(scene_of(motion, speed=0.0), 40)[:, 1]) == 0.0
    assert np.ptp(course(scene_of(motion, speed=8.0), 40)[:, 1]) == pytest.approx(2.0, abs=0.02)


def test_a_motion_off_the_map_is_refused_with_its_key() -> None:
    far = made(
        body="car", keys=[{"at": 0}, {"at": 20, "ahead": 190}, {"at": 40, "left": 99, "ahead": 190}]
    )
    (fault,) = staging_issues(scene_of(far), FLAT_CATALOGUE)
    assert fault.path == "motions[0].keys[2]"
