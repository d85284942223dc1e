from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._scene import Behaviour
from oodscen.data._weather import Weather
from oodscen.driving._sight.lamps import BRAKING, has_lamps_on, is_braking, waits_in_traffic
from oodscen.testing import example_scene

BOX = example_scene().actors[0]
NIGHT = Weather(sun_elevation_deg=-20.0)


def scene(behaviour: str, state: str = "", weather: Weather | None = None):
    actor = BOX.model_copy(update={"behaviour": Behaviour(name=behaviour), "state": state})
    update = {"actors": (actor,), "weather": weather or Weather()}
    return example_scene().model_copy(update=update)


def test_who_drives_has_lamps_on_when_it_is_hard_to_see():
    hard = (
        NIGHT,
        Weather(fog_visual_range_m=300.0),
        Weather(precipitation="rain", precipitation_mm_h=1.0),
    )
    assert not has_lamps_on(scene("follow_lane"), BOX.id)
    for weather in hard:
        assert has_lamps_on(scene("follow_lane", weather=weather), BOX.id)
        assert not has_lamps_on(scene("follow_lane", "unlit", weather), BOX.id)
        assert not has_lamps_on(scene("stand", "off", weather), BOX.id)
        assert has_lamps_on(scene("stand", "hazard", weather), BOX.id)
        assert not has_lamps_on(scene("follow_lane", weather=weather), "nobody")
        assert has_lamps_on(scene("stand", weather=weather), "ego")
    assert not has_lamps_on(scene("follow_lane"), "ego")


@given(st.floats(0, 40), st.floats(-9, 3))
def test_brake_lamps_follow_the_braking_or_a_foot_on_the_brake(speed, acceleration):
    assert is_braking(speed, acceleration, waits=False) == (acceleration < BRAKING)
    assert is_braking(speed, acceleration, waits=True) >= is_braking(
        speed, acceleration, waits=False
    )
    assert is_braking(0.0, acceleration, waits=True)


def test_drivers_wait_on_the_brake_and_parked_cars_do_not():
    assert waits_in_traffic(scene("follow_lane"), BOX.id)
    assert not waits_in_traffic(scene("stand"), BOX.id)
    assert not waits_in_traffic(scene("follow_lane"), "nobody")
