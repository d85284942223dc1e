"""The maps of railways, gaps, exits and slopes are what their descriptions say."""

import numpy as np
import pytest

from oodscen import make_catalogue
from oodscen.data import Scene
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._sight.placement import check_scene
from oodscen.prompts._layout import layout


@pytest.fixture(scope="module")
def catalogue():
    return make_catalogue("pybullet")


def road(name):
    return load_corridor(name, make_catalogue("flat"))


def test_the_passage_leaves_one_lane_for_both_directions():
    corridor = road("narrow_passage")
    widths = []
    for ahead in range(40, 160):
        right, left = corridor.drivable_range(corridor.start + ahead, 0.0)
        widths.append(left - right)
    assert min(widths) == pytest.approx(3.7)
    assert max(widths) > 10.0
    assert [widths[ahead - 40] for ahead in (92, 128)] == pytest.approx([3.7, 3.7])


def test_the_slope_falls_and_bends():
    corridor = road("downhill_bend")
    assert corridor.z[0] - corridor.z[-1] == pytest.approx(13.2)
    assert (np.diff(corridor.z) <= 1e-9).all()
    assert np.abs(corridor.curvature).max() == pytest.approx(1 / 120, abs=1e-6)


def test_the_exit_opens_beside_the_ego_and_its_ramp_leaves():
    corridor = road("exit_ramp")
    before, beside = (corridor.drivable_range(corridor.start + m, -8.0) for m in (0.0, 100.0))
    assert before[0] - beside[0] == pytest.approx(3.5)
    ramp = next(other.corridor for other in corridor.others if other.road_id == "4")
    _, t = corridor.locate(float(ramp.x[-1]), float(ramp.y[-1]))
    assert t < -40.0


def test_the_track_is_told_and_carries_rail_vehicles_only():
    corridor = road("level_crossing")
    assert "railway track 110 m ahead" in layout(corridor)
    s = corridor.start + 110.0
    assert corridor.is_on_track(s, -60.0)
    assert not corridor.is_on_track(s - 5.0, -60.0)
    assert not corridor.is_drivable(s, -60.0, -60.0)


def crossing(asset, near, far):
    def gate(name, ahead, lane, heading, state):
        place = {"ahead_m": ahead, "lane": lane, "heading_deg": heading}
        return {"id": name, "asset": "level_crossing_gate", "placement": place, "state": state}

    mover = {
        "id": "train",
        "asset": asset,
        "placement": {"ahead_m": 110.0, "offset_m": -60.0, "heading_deg": 90.0},
        "behaviour": {"name": "run_red", "parameters": {"speed": 14.0}},
    }
    gates = [gate("near", 104.0, 0, 0, near), gate("far", 116.0, 1, 0, far)]
    return Scene.parse(
        {
            "id": "crossing",
            "scenario_id": "crossing",
            "map": "level_crossing",
            "ego": {"speed": 12.0},
            "actors": [*gates, mover],
            "hazard": {"actors": {"near": None, "far": None, "train": None}},
            "decision": {"kind": "distance", "value": 50.0, "actor": "near"},
        }
    )


@pytest.mark.parametrize(
    "states", [("open", "open"), ("closed", "closed"), ("open", "closed"), ("half", "half")]
)
def test_gates_stand_on_both_sides_and_a_tram_crosses(states, catalogue):
    assert check_scene(crossing("tram", *states), catalogue) == []


def test_a_lorry_does_not_start_on_the_track(catalogue):
    issues = check_scene(crossing("truck", "open", "open"), catalogue)
    assert "must start on the road" in issues[0].message
