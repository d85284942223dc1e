"""Runs for reactive files: what an actor does before and after it reacts to the ego."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.data._scene import Actor, Scene
from oodscen.interchange._writing.reactions import reactions
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE


@given(st.sampled_from(["time", "distance", "ttc"]), st.sampled_from(["cross_road", "walk_along"]))
@settings(deadline=None, max_examples=6)
def test_who_waits_for_the_ego_rests_in_the_quiet_run(kind, name):
    walker = Actor.parse(
        {
            "id": "walker",
            "asset": "adult",
            "placement": {"ahead_m": 40.0, "offset_m": -3.0, "heading_deg": 90.0},
            "behaviour": {"name": name, "trigger": {"kind": kind, "value": 2.0}},
        }
    )
    scene = Scene.parse(
        {
            "id": "walker",
            "scenario_id": "walker",
            "map": "urban_three_lane",
            "ego": {"speed": 8.0},
            "actors": [walker.model_dump(mode="json")],
            "hazard": {"actors": {"walker": None}},
            "decision": {"kind": "ttc", "value": 1.5, "actor": "walker"},
        }
    )
    run = reactions(scene, FLAT_CATALOGUE, 0)
    fired = run.triggered["walker"]
    assert np.array_equal(
        run.nominal.poses[:fired, 1], np.repeat(run.nominal.poses[:1, 1], fired, 0)
    )
    moves = np.ptp(run.quiet.poses[:, 1, :2], axis=0).max() > 0.0
    assert moves == (kind == "time")
    assert np.array_equal(run.quiet.poses[:, 0], run.nominal.poses[:, 0])
    assert not run.mindful
