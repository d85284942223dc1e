import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.author._knowledge.base import Knowledge
from oodscen.author._staging.decision_distances import approach, braking, room, swerving


@given(speed=st.floats(3.0, 30.0), friction=st.floats(0.2, 1.0))
def test_calm_braking_takes_more_room_than_hard_braking(speed: float, friction: float) -> None:
    assert braking(speed, friction) < room(speed, friction) + 3.0
    assert braking(speed, friction) <= braking(speed + 1.0, friction)
    assert braking(speed, 1.0) <= braking(speed, friction)


@given(speed=st.floats(3.0, 30.0), width=st.floats(0.3, 2.5))
def test_what_is_wider_or_less_aside_is_avoided_later(speed: float, width: float) -> None:
    assert swerving(speed, width) <= swerving(speed, width + 0.2)
    assert swerving(speed, width, 0.3) <= swerving(speed, width)
    assert swerving(speed, width) < 3.0 * speed + 4.0


@pytest.mark.parametrize(("speed", "is_better"), [(9.0, False), (25.0, True)])
def test_swerving_round_small_things_beats_braking_at_high_speed(
    speed: float, is_better: bool
) -> None:
    assert (swerving(speed, 0.7, 0.4) < braking(speed)) is is_better


def test_what_stands_still_is_approached_at_the_usual_speed_of_the_road(
    knowledge: Knowledge,
) -> None:
    box = knowledge.by_id["cardboard-box"]
    for (place,) in (knowledge.place_keys["highway"], knowledge.place_keys["residential"]):
        assert approach(box, place).speed == place.speed
    ghost = knowledge.by_id["ghost-driver"]
    (highway,) = knowledge.place_keys["highway"]
    assert ghost.stage is not None
    assert approach(ghost, highway).speed == ghost.stage.speed
