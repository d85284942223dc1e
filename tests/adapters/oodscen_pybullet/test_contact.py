"""One notion of contact: gaps, outcomes and conflict measures follow the footprints."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from oodscen_pybullet import PyBulletSimulator

from oodscen import simulate
from oodscen.data._scene import Actor, Ego, Hazard, Scene, Trigger
from oodscen.driving._surrogate_safety import Footprints, overlap
from oodscen.driving._trace import Course

MakeActor = Callable[..., Actor]
BESIDE = (
    ("cardboard_box", "urban_three_lane", 2, 10.3, 46.4, -0.19, 15.3, 15.7),
    ("stump", "residential_two_lane", 0, 7.5, 45.0, 0.03, 72.4, 11.3),
    ("spilled_gravel", "rural_curve", 0, 13.7, 65.0, -0.08, -27.4, 42.3),
    ("stop_sign", "rural_curve", 0, 11.3, 37.7, 0.04, 0.0, 15.5),
    ("pothole", "urban_avenue", 0, 11.5, 39.2, 0.15, -49.3, 14.9),
    ("level_crossing_gate", "residential_two_lane", 0, 9.0, 40.0, 0.0, 0.0, 20.0),
    ("drone", "urban_avenue", 0, 10.0, 40.0, 0.0, 0.0, 20.0),
)
"""Asset, map, lane, speed, place and distance at the decision: some action passes close by."""


@pytest.mark.parametrize("one", BESIDE, ids=lambda one: one[0])
def test_contact_gap_and_footprints_agree_in_every_step_of_every_action(
    simulator: PyBulletSimulator, make_actor: MakeActor, one: tuple[Any, ...]
) -> None:
    asset, road, lane, speed, ahead, offset, heading, decision = one
    behaviour = {"behaviour": "blown", "lift": 3.0} if asset == "drone" else {}
    state = "open" if asset == "level_crossing_gate" else ""
    body = make_actor(asset, ahead, offset=offset, heading=heading, state=state, **behaviour)
    scene = Scene(
        id="test",
        scenario_id="test",
        map=road,
        ego=Ego(lane=lane, speed=speed),
        actors=(body,),
        hazard=Hazard(actors={"a": None}),
        decision=Trigger(kind="distance", value=decision, actor=body.id),
    )
    result = simulate(scene, simulator, render=False, traces=True)
    course = Course.of(scene, simulator.catalogue())
    passable = simulator.catalogue().asset(asset).is_passable(state)
    assert passable == (asset in ("pothole", "level_crossing_gate"))
    for action, trace in result.rollouts.items():
        outcome, met = result.episode.actions[action], trace.summary()["a"]
        boxes = Footprints(
            trace["x"], trace["y"], np.cos(trace["yaw"]), np.sin(trace["yaw"]),
            trace["length"] / 2, trace["width"] / 2,
        )  # fmt: skip
        meets = overlap(boxes.at(slice(None), 0), boxes.at(slice(None), 1))
        ground = np.interp(trace["s"][:, 1], course.corridor.s, course.corridor.z)
        meets &= (trace["z"][:, 1] - ground <= 1.5) & (not passable)
        assert np.array_equal(trace["contact"][:, 1], meets)
        assert np.array_equal(trace["gap_m"][:, 1] == 0.0, meets)
        touched = meets.any()
        if not outcome.marginal:
            assert outcome.safe == (not touched and not outcome.off_road)
        assert (outcome.margin_m == 0.0) == (met.min_ttc_s == 0.0) == (met.pet_s == 0.0) == touched
        assert (outcome.margin_m is None) == passable
