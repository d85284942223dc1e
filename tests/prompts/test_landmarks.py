import pytest

from oodscen.driving._roads.building import load_corridor
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.prompts._landmarks import Landmark, landmarks

MAPS = {road.id: road for road in SHIPPED_MAPS}


def found(name: str) -> tuple[Landmark, ...]:
    road = MAPS[name]
    return landmarks(load_corridor(road), road.traits)


@pytest.mark.parametrize(
    ("name", "kinds"),
    [
        ("urban_avenue", []),
        ("rural_hill", ["crest"]),
        ("urban_junction", ["traffic_light", "junction", "traffic_light"]),
        ("t_junction", ["junction"]),
        ("roundabout", ["roundabout"]),
        ("tunnel", ["tunnel"]),
        ("exit_ramp", ["junction"]),
        ("downhill_bend", []),
    ],
)
def test_maps_have_what_their_traits_promise(name: str, kinds: list[str]) -> None:
    marks = found(name)
    assert [mark.kind for mark in marks] == kinds
    assert all(0.0 < mark.ahead_m < 200.0 for mark in marks)


def test_a_bridge_is_found_with_its_length() -> None:
    bridge = next(mark for mark in found("bridge") if mark.kind == "bridge")
    assert bridge.length_m > 100.0


def test_lights_that_face_the_ego_stand_to_its_right() -> None:
    lights = [mark for mark in found("urban_junction") if mark.kind == "traffic_light"]
    assert all(-6.0 < mark.left_m < -1.5 for mark in lights)
