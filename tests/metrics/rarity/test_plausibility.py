"""What cannot be, and more than one event."""

import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.metrics._rarity.plausibility import is_impossible, names_event, parts


@pytest.mark.parametrize(
    "text",
    [
        "A car flies over the rooftops towards us.",
        "A truck vanishes into thin air in front of the ego.",
        "Gravity reverses and the cars drift upwards.",
        "The traffic light walks away from its junction.",
        "A pedestrian walks through the wall of the tunnel.",
        "The truck ahead turns into a swan.",
        "The moon falls onto the motorway.",
        "A centaur gallops in the bus lane.",
        "The road becomes lava ahead.",
        "A bus overtakes at 2,000 km/h.",
        "A car drives at 900 mph past us.",
        "a flying car passes",
        "Two hovering trucks queue at the light.",
        "Woolly mammoths cross the road.",
        "A dragon sits on the gantry.",
        "Time suddenly stands still on the bridge.",
        "A bus passes straight through a brick wall.",
    ],
)
def test_impossible_things_acts_and_speeds(text):
    assert is_impossible(text)


@pytest.mark.parametrize(
    "text",
    [
        "A pedestrian in a ghost costume crosses.",
        "A plastic bag floats like a ghost over the lane.",
        "A car flies off the ramp and lands in the ditch.",
        "The van ahead turns into a side street.",
        "A truck disappears into the fog.",
        "A drone flies over the road.",
        "Flying car parts hit the windscreen.",
        "Flying debris hits the car.",
        "Gulls flying past cars at the quay.",
        "A car drives at 130 km/h.",
        "The man walks through the wall opening.",
        "The setting sun falls on a red signal.",
        "A mammoth crane blocks both lanes.",
        "A white ghost bike is chained to the lamp post.",
        "The car crosses the ghost island of the junction.",
        "A trailer with a dragon boat on it sways.",
        "The lane narrows at painted dragon’s teeth.",
        "An alien-looking concept car overtakes.",
        "A man walks through a wall of smoke.",
        "A car drives through the wall of a shop.",
        "By the time traffic stops, the van is in the ditch.",
        "Every time she stops, the dog runs off.",
        "The traffic light jumps from red to green.",
        "A flying bus shelter roof hits the tram.",
        "Faded ghost lane markings lead ego towards the barrier.",
        "Ghost braking of the car ahead surprises ego.",
        "A dragon dance parades down the street.",
        "A komodo dragon walks over the road.",
        "A truck with a dinosaur skeleton blocks the lane.",
        "A hacked message board warns of zombies ahead.",
        "The pickup ahead turns into a horse farm.",
    ],
)
def test_unusual_things_are_possible(text):
    assert not is_impossible(text)


UNITS = {
    1.0: (
        "km/h",
        "km / h",
        "kmh",
        "kph",
        "kmph",
        "km per hour",
        "km an hour",
        "kilometres per hour",
    ),
    1.609: ("mph", "miles per hour", "miles an hour", "mi/h"),
    1.852: ("knots", "kts"),
    3.6: ("m/s", "metres per second", "m per second"),
    1.097: ("feet per second", "ft/s", "foot per second"),
}


@given(
    st.sampled_from([(kmh, unit) for kmh, units in UNITS.items() for unit in units]),
    st.integers(1, 5_000),
    st.sampled_from(["", ",", "'", "\u202f", " "]),
    st.sampled_from(["", ".5", ",25"]),
    st.sampled_from(["", " ", "\u00a0", "-"]),
)
def test_speeds_are_read_in_every_unit(measured, value, separator, fraction, blank):
    kmh, unit = measured
    text = f"A car at {f'{value:,}'.replace(',', separator)}{fraction}{blank}{unit} passes."
    if not 499 < value * kmh < 501:
        assert is_impossible(text) == (value * kmh > 500)


@pytest.mark.parametrize(
    ("slow", "fast", "unit"),
    [
        (500, 501, "km/h"),
        (310, 311, "mph"),
        (269, 270, "knots"),
        (138, 139, "m/s"),
        (455, 456, "ft/s"),
    ],
)
def test_the_greatest_speed_is_the_same_in_every_unit(slow, fast, unit):
    assert not is_impossible(f"A car drives at {slow} {unit}.")
    assert is_impossible(f"A car drives at {fast} {unit}.")


@pytest.mark.parametrize(
    ("text", "is_fast"),
    [
        ("A car drives at 1.200 km/h.", True),
        ("A van rolls at 1.200 m/s.", False),
        ("A van rolls at 0.500 m/s.", False),
        ("The tram 2, 600 m away, waits.", False),
        ("A tyre bursts on the A9, 130 km/h fast.", False),
        ("On the A9 130 km/h are allowed.", False),
        ("On the A9 900 km/h are driven.", True),
        ("A car at ~900 km/h passes.", True),
        ("A bus at " + "9" * 9_000 + " km/h.", True),
        ("A camera at 600 fps.", False),
        ("After 500 metres a second car waits.", False),
    ],
)
def test_a_point_parts_groups_of_digits_only_in_fast_units(text, is_fast):
    assert is_impossible(text) == is_fast


def test_a_text_of_blanks_takes_no_longer_than_one_of_words():
    start = time.process_time()
    assert len(parts("A car waits here, then" + " " * 19_900 + "one of them goes on.")) == 2
    assert len(parts("A car waits" + " " * 19_900 + "and goes on.")) == 1
    assert time.process_time() - start < 1.0


@given(st.text())
def test_any_text_is_read(text):
    assert is_impossible(text) in (True, False)
    assert all(len(part.split()) > 2 for part in parts(text))


@pytest.mark.parametrize(
    ("part", "is_event"),
    [
        ("A deer jumps on the road.", True),
        ("The bridge collapses.", True),
        ("The deer jumps on the road.", False),
        ("A red light.", False),
        ("A car waits at the red light.", False),
        ("The rider faints.", True),
        ("Horses ran loose.", True),
        ("Faint lane markings lie under the snow.", False),
        ("The lines are faintly visible.", False),
        ("The car waits with its ignition off.", False),
        ("Collapsible bollards close the lane.", False),
    ],
)
def test_a_new_thing_that_does_something_sudden_is_an_event(part, is_event):
    assert names_event(part) == is_event
