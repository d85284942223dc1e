import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._episode import ActionOutcome
from oodscen.data._scene import Actor, Behaviour, Placement, Trigger
from oodscen.data._weather import Weather
from oodscen.report import _phrasing as words

NUMBERS = st.floats(-150, 300)


@pytest.mark.parametrize(
    ("weather", "expected"),
    [
        (Weather(), "day; dry"),
        (Weather(sun_elevation_deg=-20, fog_visual_range_m=45), "night; thick fog, sight 45 m"),
        (
            Weather(precipitation="snow", precipitation_mm_h=12, friction=0.35),
            "day; heavy snow, 12 mm/h; slippery road, friction 0.35",
        ),
        (Weather(cloud_cover=0.9, sun_elevation_deg=8), "low sun; overcast"),
    ],
)
def test_weather(weather: Weather, expected: str) -> None:
    assert words.weather(weather) == expected


def test_places() -> None:
    assert words.place(Placement(ahead_m=40)) == "40 m ahead, in the ego’s lane"
    assert (
        words.place(Placement(ahead_m=-25, lane=-2, offset_m=-1, heading_deg=180))
        == "25 m behind, 2 lanes to the right, 1 m right of its centre, facing against its lane"
    )


@given(st.floats(1.6, 30.0), st.integers(-2, 2), st.sampled_from([-1, 1]))
def test_what_lies_off_a_lane_is_in_none(off: float, lane: int, side: int) -> None:
    place = words.place(Placement(ahead_m=20, lane=lane, offset_m=side * off))
    assert "in the ego’s lane" not in place
    assert f"{'left' if side > 0 else 'right'} of the centre of the" in place


@given(NUMBERS, st.integers(-6, 6), st.floats(-25, 25), st.floats(-180, 180))
def test_places_never_show_a_hyphen_for_minus(
    ahead: float, lane: int, offset: float, heading: float
) -> None:
    place = Placement(ahead_m=ahead, lane=lane, offset_m=offset, heading_deg=heading)
    assert "-" not in words.place(place)


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (12.345, "12.3"),
        (999.4, "999"),
        (999.7, "1000"),
        (-1500.0, "−1500"),
        (-0.0, "0"),
        (0.0125, "0.0125"),
        (-0.0001234, "−0.0001"),
        (-1e-5, "0"),
        (1e22, "10000000000000000000000"),
    ],
)
def test_quantities_have_three_digits_and_no_exponent(value: float, expected: str) -> None:
    assert words.amount(value) == expected


@given(st.floats(-1e6, 1e6))
def test_quantities_are_close_to_what_is_shown(value: float) -> None:
    shown = words.amount(value)
    assert "e" not in shown
    assert "-" not in shown
    number = float(shown.replace("−", "-"))
    assert abs(number - value) <= max(0.000051, min(0.00501 * abs(value), 0.5))


def test_behaviours() -> None:
    assert words.behaviour(Behaviour()) == "stands still"
    trigger = Trigger(kind="distance", value=30)
    assert (
        words.behaviour(Behaviour(name="cut_in", parameters={"lanes": -1}, trigger=trigger))
        == "changes lane (lanes −1 lanes to the left), once the ego is within 30 m of it"
    )
    assert words.behaviour(Behaviour(name="moon_walk")) == "moon walk, from the start"


def test_outcomes() -> None:
    names = {"a": "cow", "b": "cow"}
    assert words.outcome(ActionOutcome(safe=False, contacts=("a", "b")), names) == "hits cow ×2"
    assert words.outcome(ActionOutcome(safe=False, contacts=("x-1",)), names) == "hits x 1"
    assert words.outcome(ActionOutcome(safe=False, off_road=True), names) == "leaves the road"
    assert words.outcome(ActionOutcome(safe=True, margin_m=2.04), names) == "gap 2.0 m"
    assert words.outcome(ActionOutcome(safe=True), names) == "nothing near"


def test_actors_and_times() -> None:
    actor = Actor(id="p", asset="police_car", placement=Placement(ahead_m=1), state="beacon")
    assert words.actor_name(actor) == "police car (beacon on)"
    assert [words.duration(t) for t in (0.25, 42, 131.4, 7300)] == [
        "0.3 s",
        "42 s",
        "2 min 11 s",
        "2 h 1 min",
    ]
