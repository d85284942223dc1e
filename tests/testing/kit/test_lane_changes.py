"""A driver whose poses contradict its speed while it changes lanes is found."""

from dataclasses import replace

import numpy as np
import pytest

from oodscen.testing._check import examine_parts
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE
from oodscen.testing._kit.lane_changes import step_fault
from oodscen.testing._kit.tracks import Tracks

CATALOGUE = FLAT_CATALOGUE.model_copy(
    update={
        "assets": (FLAT_CATALOGUE.asset("car"),),
        "behaviours": (FLAT_CATALOGUE.behaviour("cut_in"),),
        "maps": (FLAT_CATALOGUE.map("urban_avenue"),),
    }
)


class Changing(FlatSimulator):
    """Has one behaviour, on one map."""

    def catalogue(self):
        return CATALOGUE


class Jumping(Changing):
    """Puts a car that is between two lanes 0.3 m back."""

    def _publish(self):
        state = super()._publish()
        if len(state.ids) < 2 or not state.poses[1, 1] < -3.4:
            return state
        poses = state.poses.copy()
        poses[1, 0] -= 0.3
        return replace(state, poses=poses, gaps=None, places=None)


def lane_change_lines(simulator: type) -> list[str]:
    result, _ = examine_parts(simulator, parts=("motion",))
    return [line for line in result.lines() if "in a lane change" in line]


def test_a_steady_change_passes_and_a_jump_is_found() -> None:
    assert lane_change_lines(Changing) == []
    (line,) = lane_change_lines(Jumping)
    assert line.startswith("motion: map urban_avenue: covers 0.21 m in a step, by its speed 0.50")


def tracks(*, along: float = 0.0, across: float = 0.0, turn: float = 0.0) -> Tracks:
    """Return the track of one body at 10 m/s, which from the tenth step on is elsewhere."""
    poses = np.zeros((20, 1, 4))
    poses[:, 0, 0] = 0.5 * np.arange(20)
    poses[10:, 0] += (along, across, 0.0, turn)
    return Tracks(0.05, poses, np.full((20, 1), 10.0))


@pytest.mark.parametrize(
    "change",
    [{}, {"along": 0.08}, {"along": -0.08}, {"across": 0.15}, {"turn": 0.05}, {"turn": 2 * np.pi}],
)
def test_small_deviations_are_no_jumps(change) -> None:
    assert step_fault(tracks(**change), 0) == ""


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"along": 0.2}, "covers 0.70 m in a step, by its speed 0.50 m"),
        ({"along": -0.2}, "covers 0.30 m in a step"),
        ({"across": 0.4}, "jumps 0.40 m to the side"),
        ({"turn": -0.15}, "turns by -9 degrees"),
        ({"along": np.nan}, "covers nan m"),
    ],
)
def test_jumps_are_told_with_their_time(change, words) -> None:
    fault = step_fault(tracks(**change), 0)
    assert words in fault
    assert fault.endswith("in a lane change, after 0.50 s")
