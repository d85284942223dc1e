from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.data._episode import ACTIONS
from oodscen.data._scene import Demand, Scene, Trigger
from oodscen.driving._motion.actions import Cruise, action_driver, is_available
from oodscen.driving._motion.rollouts import Variation
from oodscen.driving._motion.world import KinematicWorld
from oodscen.driving._trace import Course
from oodscen.errors import UnknownComponent
from oodscen.stages._safe_actions import runs_red
from tests.driving.staging import CATALOGUE, actor, scene, world

HORIZON_S = 4.0


def stage(ahead: float, offset: float, friction: float, speed: float) -> Scene:
    return scene(
        actor("box", "cardboard_box", ahead=ahead, offset=offset),
        actor("behind", "truck", "follow_lane", ahead=-14.0, speed=speed, headway=0.3),
        speed=speed,
        friction=friction,
    )


def driven(one: KinematicWorld, action: str, reaction_s: float) -> bool:
    driver = action_driver(action, reaction_s)
    for _ in range(round(HORIZON_S / one.dt)):
        one.step(driver.act(one.observe()))
        state = one.state()
        if state.off_road or state.contacts:
            return False
    return True


@settings(max_examples=25, deadline=None)
@given(
    st.floats(12.0, 45.0),
    st.floats(-1.5, 1.5),
    st.sampled_from([1.0, 0.5]),
    st.sampled_from([7.0, 13.0]),
    st.sampled_from(ACTIONS),
    st.sampled_from([0.0, 0.2, 0.75]),
)
def test_a_rehearsal_ends_as_the_drive_does(
    ahead: float, offset: float, friction: float, speed: float, action: str, reaction_s: float
) -> None:
    one, cruise = world(stage(ahead, offset, friction, speed)), Cruise()
    for _ in range(10):
        one.step(cruise.act(one.observe()))
    if not is_available(action, one.observe()):
        return
    before = one.snapshot()
    told = one.is_passed(action, Variation(reaction_s), HORIZON_S)
    assert one.snapshot() == before
    assert told == driven(one, action, reaction_s)


def at_a_light(ahead: float, red_from_s: float) -> Scene:
    light = actor("light", "cone", ahead=ahead, offset=-4.0, trigger=Trigger(value=red_from_s))
    told = Demand(kind="red_light", text="A red light.")
    return scene(light.model_copy(update={"state": "red"})).model_copy(update={"demand": told})


@settings(max_examples=25, deadline=None)
@given(
    st.floats(8.0, 40.0),
    st.floats(0.0, 4.0),
    st.sampled_from(ACTIONS),
    st.sampled_from([0.0, 0.2, 0.75]),
)
def test_a_rehearsal_runs_a_red_light_as_the_drive_does(
    ahead: float, red_from_s: float, action: str, reaction_s: float
) -> None:
    staged = at_a_light(ahead, red_from_s)
    line, course = staged.stop_line, Course.of(staged, CATALOGUE)
    assert line is not None
    one, driver = world(staged), action_driver(action, reaction_s)
    if not is_available(action, one.observe()):
        return
    told = one.is_passed(action, Variation(reaction_s), HORIZON_S)
    states = [one.state()]
    for _ in range(round(HORIZON_S / one.dt)):
        one.step(driver.act(one.observe()))
        states.append(one.state())
    harmed = any(state.contacts or state.off_road for state in states)
    assert told == (not harmed and not runs_red(states, line, course))


@pytest.mark.parametrize("factor", [0.95, 1.05])
def test_a_rehearsal_at_another_speed_is_a_drive_at_that_speed(factor: float) -> None:
    for ahead in (14.0, 16.0, 18.0, 20.0, 22.0, 24.0):
        usual = world(scene(actor("box", "cardboard_box", ahead=ahead), speed=12.0))
        other = world(scene(actor("box", "cardboard_box", ahead=ahead), speed=12.0 * factor))
        told = usual.is_passed("emergency_brake", Variation(0.2, speed=factor), HORIZON_S)
        assert told == driven(other, "emergency_brake", 0.2)


def test_less_grip_and_later_reactions_need_more_room() -> None:
    def least(variation: Variation) -> float:
        return next(
            ahead
            for ahead in range(8, 80)
            if world(scene(actor("box", "cardboard_box", ahead=ahead), speed=12.0)).is_passed(
                "emergency_brake", variation, HORIZON_S
            )
        )

    usual = least(Variation(0.2))
    assert usual < least(Variation(0.8))
    assert usual < least(Variation(0.2, friction=0.5))
    assert usual < least(Variation(0.2, speed=1.2))


@pytest.mark.parametrize("action", ACTIONS)
def test_a_driver_who_reacts_late_first_keeps_lane_and_speed(action: str) -> None:
    one = world(scene())
    late, cruise = action_driver(action, 0.5), Cruise()
    now = one.observe()
    for step in range(10):
        moment = replace(now, time=0.05 * step)
        assert late.act(moment) == cruise.act(moment)


@pytest.mark.parametrize("action", ["", "fly", "STOP"])
def test_an_action_that_does_not_exist_is_refused(action: str) -> None:
    with pytest.raises(UnknownComponent, match="keep_speed"):
        world(scene()).is_passed(action, Variation(0.0), HORIZON_S)
