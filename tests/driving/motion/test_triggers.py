import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._scene import Trigger
from oodscen.driving._motion.triggers import CODES, TIE, fires, is_due, value_in
from oodscen.protocols import Control, State
from tests.driving.staging import actor, scene, world

speeds = st.floats(-30, 30)


@given(st.floats(-100, 100), speeds, speeds, st.floats(0, 20))
def test_time_to_collision_is_when_the_distance_is_zero(
    ahead: float, ego: float, other: float, limit: float
) -> None:
    due = fires(CODES["ttc"], limit, 0.0, ahead, ego, other)
    later = np.linspace(0.0, limit, 2001)
    distance = ahead + (other - ego) * later
    meets = bool((np.sign(distance) != np.sign(ahead)).any()) or ahead == 0.0
    margin = abs(abs(ahead) - limit * abs(ego - other))
    assert due == meets or min(margin, abs(ahead)) <= 2 * TIE


@given(st.floats(0, 50), st.floats(0, 50))
def test_time_triggers_stay_due(value: float, time: float) -> None:
    due = fires(CODES["time"], value, time, 0.0, 0.0, 0.0)
    assert due == (time >= value - TIE)


@given(st.integers(1, 200_000), st.floats(0, 500), st.floats(-1e-6, 1e-6))
def test_a_value_taken_from_a_state_fires_there_wherever_the_road_begins(
    millimetres: int, start: float, noise: float
) -> None:
    value = millimetres / 1000
    ahead = (start + value + noise) - start
    assert fires(CODES["distance"], value, 0.0, ahead, 10.0, 0.0)


@pytest.mark.parametrize("kind", ["time", "distance", "ttc"])
@pytest.mark.parametrize("map", ["urban_avenue", "rural_curve"])
def test_a_state_tells_what_the_world_knows(kind: str, map: str) -> None:
    staged = scene(actor("a", "car", "wrong_way", ahead=120.0, speed=9.0), map=map)
    one = world(staged)
    trigger = Trigger(kind=kind, value=2.0 if kind != "distance" else 40.0)
    seen = set()
    for step in range(100):
        state = State(
            step=step,
            time=one.time,
            ids=one.ids,
            poses=one.poses(),
            speeds=one.speeds(),
            gaps=np.full(2, np.inf),
            off_road=False,
        )
        known = one.is_due(trigger, "a")
        assert is_due(trigger, "a", state, one.corridor) == known
        seen.add(known)
        one.step(Control())
    assert seen == {False, True}


@pytest.mark.parametrize("kind", ["time", "distance", "ttc"])
def test_a_trigger_can_be_set_to_fire_first_in_a_given_state(kind: str) -> None:
    one = world(scene(actor("a", "car", "wrong_way", ahead=120.0, speed=9.0)))
    trigger = Trigger(kind=kind, value=1.0, actor="a")
    states = []
    for step in range(60):
        states.append(
            State(
                step=step,
                time=one.time,
                ids=one.ids,
                poses=one.poses(),
                speeds=one.speeds(),
                gaps=np.full(2, np.inf),
                off_road=False,
            )
        )
        one.step(Control())
    for place in (20, 40):
        value = value_in(trigger, states[place], one.corridor)
        moved = trigger.model_copy(update={"value": value})
        due = [is_due(moved, None, state, one.corridor) for state in states]
        assert due.index(True) == place


def test_a_trigger_may_watch_another_actor() -> None:
    watcher = actor("w", "adult", "walk_along", ahead=200.0, offset=-3.0,
                    trigger=Trigger(kind="distance", value=30.0, actor="mark"))  # fmt: skip
    one = world(scene(actor("mark", ahead=60.0, offset=3.0), watcher))
    while one.motion("w").triggered < 0.0:
        one.step(Control())
    assert 29.0 < one.motion("mark").s - one.ego.s <= 30.0
