"""Every measure that does not follow from the poses is found."""

import math
from dataclasses import replace

import numpy as np
import pytest

from oodscen.errors import SpawnError
from oodscen.testing._check import examine_parts
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE
from oodscen.testing._new.adapter import MySimulator

CATALOGUE = FLAT_CATALOGUE.model_copy(
    update={
        "assets": tuple(map(FLAT_CATALOGUE.asset, ("car", "cyclist", "adult"))),
        "maps": tuple(map(FLAT_CATALOGUE.map, ("residential_two_lane", "rural_curve"))),
    }
)


class Few(FlatSimulator):
    """Has few assets and maps, so that the check is quick."""

    def catalogue(self):
        return CATALOGUE


def publishing(alter) -> type:
    """Return a simulator whose states are altered."""

    class Altered(Few):
        def _publish(self):
            state = super()._publish()
            return replace(state, **alter(state))

    return Altered


def observing(**offsets: float) -> type:
    """Return a simulator that adds offsets to members of its observation."""

    class Altered(Few):
        def observe(self):
            observation = super().observe()
            changes = {
                name: offset
                if getattr(observation, name) is None
                else getattr(observation, name) + offset
                for name, offset in offsets.items()
            }
            return replace(observation, **changes)

    return Altered


def lines(simulator: type) -> list[str]:
    result, _ = examine_parts(simulator, parts=("measures",))
    return result.lines()


@pytest.mark.parametrize("simulator", [Few, MySimulator])
def test_sound_measures_pass(simulator) -> None:
    assert lines(simulator) == []


OFFSETS = {
    "speed": 0.1,
    "offset_m": -0.1,
    "heading_error": 0.1,
    "curvature": 0.01,
    "lane_left_m": 0.5,
    "lane_right_m": 0.5,
    "roadside_m": 0.5,
    "friction": -0.1,
    "visual_range_m": -5.0,
    "curve_speed": -100.0,
    "wheelbase": 1.0,
}


def test_every_wrong_member_of_the_observation_is_found() -> None:
    found = lines(observing(**OFFSETS))
    for name in OFFSETS:
        assert any(f"observation: {name} is" in line for line in found), name


@pytest.mark.parametrize("value", [None, "dry", math.nan])
@pytest.mark.parametrize("name", sorted({*OFFSETS} - {"lane_left_m", "lane_right_m"}))
def test_a_member_of_the_observation_that_is_no_number_is_named(name, value) -> None:
    class Altered(Few):
        def observe(self):
            return replace(super().observe(), **{name: value})

    found = lines(Altered)
    assert found
    assert all(f"observe() returned {name}: {value!r}, not a number" in line for line in found)


@pytest.mark.parametrize("wrong", [1.0, math.nan])
@pytest.mark.parametrize("row", [0, -1])
def test_a_wrong_place_or_acceleration_is_told_of_its_body(row, wrong) -> None:
    def altered(array):
        array = array.copy()
        array[row] += wrong
        return array

    fields = {"places": "places: s of", "accelerations": "accelerations: "}
    found = lines(
        publishing(lambda state: {field: altered(getattr(state, field)) for field in fields})
    )
    assert all(any(words in line for words in fields.values()) for line in found)
    assert all(("nan" in line) == math.isnan(wrong) for line in found)
    for words in fields.values():
        told = [line for line in found if words in line]
        assert told
        assert any("'ego'" in line for line in told) or row


@pytest.mark.parametrize(
    ("alter", "words"),
    [
        (lambda state: {"speeds": 1.5 * state.speeds, "accelerations": None}, "speeds: "),
        (lambda state: {"off_road": True}, "off_road is True on the road at 0.00 s"),
        (lambda state: {"off_road": False}, "off_road is False beside the road"),
        (
            lambda state: {"poses": state.poses + np.array([0.0, 0.0, 1.0, 0.0])},
            "'ego' is 1.00 m above the road",
        ),
        (
            lambda state: {"poses": state.poses - np.array([0.0, 0.0, 1.0, 0.0])},
            "'ego' is 1.00 m below the road",
        ),
        (
            lambda state: {"poses": state.poses + np.array([0.0, 0.0, 0.0, 0.6])},
            "from its direction of travel",
        ),
    ],
)
def test_a_state_that_contradicts_its_poses_is_found(alter, words) -> None:
    assert any(words in line for line in lines(publishing(alter)))


def test_members_may_be_unknown() -> None:
    assert lines(publishing(lambda state: {"places": None, "accelerations": None})) == []


@pytest.mark.parametrize(
    ("alter", "words"),
    [
        (lambda state: {"poses": None}, "poses is None"),
        (lambda state: {"poses": state.poses * math.nan}, "not finite"),
    ],
)
def test_a_malformed_state_is_told_once(alter, words) -> None:
    (line,) = lines(publishing(alter))
    assert line.endswith(words)


def test_members_that_are_unknown_at_first_are_checked_later() -> None:
    def alter(state):
        fields = ("places", "accelerations")
        return {name: getattr(state, name) + 9.0 if state.step > 2 else None for name in fields}

    found = lines(publishing(alter))
    assert any("places: " in line for line in found)
    assert any("accelerations: " in line for line in found)


@pytest.mark.parametrize("factor", [0.0, -1.0])
def test_an_ego_that_does_not_turn_where_it_steers_is_found(factor) -> None:
    class Wrong(Few):
        def step(self, control):
            return super().step(replace(control, steering=factor * control.steering))

    assert any("does not turn left when it steers left" in line for line in lines(Wrong))


@pytest.mark.parametrize(
    ("error", "is_found"),
    [(SpawnError("s0", "car", (0.0, 0.0, 0.0, 0.0), "no room"), False), (KeyError("car"), True)],
)
def test_a_full_road_may_be_refused_but_only_in_words(error, is_found) -> None:
    class Picky(Few):
        def reset(self, scene, seed):
            if len(scene.actors) > 1:
                raise error
            return super().reset(scene, seed)

    assert bool(lines(Picky)) == is_found
