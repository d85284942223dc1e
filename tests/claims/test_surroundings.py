"""Claims about weather, light, road and the ego, each at the border of its test."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.claims._surroundings import judge_surroundings
from oodscen.data._claim import VALUES, Claim
from oodscen.data._scene import Ego, Scene
from oodscen.data._weather import Weather
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.testing._scenes import example_scene

MAPS = {road.id: road for road in SHIPPED_MAPS}


def rain(mm_h: float) -> Weather:
    return Weather(precipitation="rain", precipitation_mm_h=mm_h)


def snow(mm_h: float) -> Weather:
    return Weather(precipitation="snow", precipitation_mm_h=mm_h)


def judged(kind: str, value: str, scene: Scene, road=None, yaw=(0.0,)):
    trace = {"yaw": np.array(yaw)[:, None]}
    return judge_surroundings(Claim(kind=kind, value=value), scene, road, trace)


def in_weather(kind: str, value: str, weather: Weather) -> bool | None:
    scene = example_scene().model_copy(update={"weather": weather})
    return judged(kind, value, scene).holds


def sun(degrees: float) -> Weather:
    return Weather(sun_elevation_deg=degrees)


def sight(metres: float) -> Weather:
    return Weather(fog_visual_range_m=metres)


def grip(friction: float) -> Weather:
    return Weather(friction=friction)


def clouds(cover: float) -> Weather:
    return Weather(cloud_cover=cover)


BORDERS = [
    ("weather", "clear", clouds(0.5), clouds(0.51)),
    ("weather", "clear", sight(5001.0), sight(5000.0)),
    ("weather", "clear", Weather(), snow(0.1)),
    ("weather", "cloudy", clouds(0.5), clouds(0.49)),
    ("weather", "dry", Weather(), rain(0.1)),
    ("weather", "dry", grip(0.1), snow(0.1)),
    ("weather", "rain", rain(0.1), snow(5.0)),
    ("weather", "light_rain", rain(2.5), rain(2.6)),
    ("weather", "light_rain", rain(0.1), snow(0.1)),
    ("weather", "heavy_rain", rain(7.6), rain(7.5)),
    ("weather", "heavy_rain", rain(50.0), snow(50.0)),
    ("weather", "snow", snow(0.1), rain(5.0)),
    ("weather", "light_snow", snow(2.0), snow(2.1)),
    ("weather", "light_snow", snow(0.1), rain(0.1)),
    ("weather", "heavy_snow", snow(4.0), snow(3.9)),
    ("weather", "heavy_snow", snow(50.0), rain(50.0)),
    ("weather", "fog", sight(1000.0), sight(1001.0)),
    ("weather", "thick_fog", sight(200.0), sight(201.0)),
    ("weather", "mist", sight(5000.0), sight(5001.0)),
    ("weather", "wet_road", grip(0.85), grip(0.86)),
    ("weather", "wet_road", rain(0.1), Weather()),
    ("weather", "slippery_road", grip(0.55), grip(0.56)),
    ("time", "day", sun(0.1), sun(0.0)),
    ("time", "night", sun(-3.1), sun(-3.0)),
    ("time", "twilight", sun(6.0), sun(6.1)),
    ("time", "twilight", sun(-9.0), sun(-9.1)),
    ("time", "low_sun", sun(15.0), sun(15.1)),
    ("time", "low_sun", sun(0.1), sun(0.0)),
]


@pytest.mark.parametrize(("kind", "value", "within", "beyond"), BORDERS)
def test_a_claim_about_weather_or_light_ends_at_its_border(kind, value, within, beyond):
    assert in_weather(kind, value, within) is True
    assert in_weather(kind, value, beyond) is False


def test_every_claim_about_weather_and_light_has_a_border():
    tested = {(kind, value) for kind, value, *_ in BORDERS}
    assert tested == {(kind, value) for kind in ("weather", "time") for value in VALUES[kind]}


ROADS_AND_SIGHT = ("fog", "thick_fog", "mist", "wet_road", "slippery_road", "cloudy", "clear")


@pytest.mark.parametrize("other", ROADS_AND_SIGHT)
def test_a_dry_day_may_have_any_road_sight_and_sky(other):
    fields = itertools.product((0.2, 0.6, 1.0), (100.0, 20_000.0), (0.0, 1.0))
    weathers = [
        Weather(friction=friction, fog_visual_range_m=metres, cloud_cover=cover)
        for friction, metres, cover in fields
    ]
    assert any(
        in_weather("weather", "dry", weather) and in_weather("weather", other, weather)
        for weather in weathers
    )


@given(st.floats(-350.0, 350.0).filter(lambda degrees: abs(abs(degrees) - 50.0) > 0.01))
def test_a_turn_is_to_the_side_to_which_the_heading_changes(degrees):
    yaw = np.radians(np.linspace(0.0, degrees, 50))
    folded = (yaw + math.pi) % math.tau - math.pi
    left, right = (
        judged("ego", value, example_scene(), yaw=folded) for value in ("turns_left", "turns_right")
    )
    assert left.holds == (degrees > 50.0)
    assert right.holds == (degrees < -50.0)
    side = "left" if degrees > 0 else "right"
    assert left.found == right.found
    if abs(degrees) > 1.0:
        assert left.found.endswith(f" degrees to the {side}")


@pytest.mark.parametrize(
    ("road", "lane", "holding"),
    [
        ("urban_three_lane", 0, {"right_lane"}),
        ("urban_three_lane", 1, {"middle_lane"}),
        ("urban_three_lane", 2, {"left_lane"}),
        ("t_junction", 0, {"left_lane", "right_lane"}),
    ],
)
def test_the_lane_of_the_ego_is_counted_from_the_right(road, lane, holding):
    scene = example_scene().model_copy(update={"ego": Ego(speed=10.0, lane=lane)})
    values = ("left_lane", "middle_lane", "right_lane")
    assert {value for value in values if judged("ego", value, scene, MAPS[road]).holds} == holding
    assert {judged("ego", value, scene).holds for value in values} == {None}


@pytest.mark.parametrize(
    ("claimed", "own", "holds"),
    [("20", 26.0, True), ("20", 26.5, False), ("20", 13.5, False), ("100", 119.5, True),
     ("100", 120.5, False), ("100", 79.5, False)],
)  # fmt: skip
def test_the_speed_of_the_ego_may_differ_by_six_kmh_or_a_fifth(claimed, own, holds):
    scene = example_scene().model_copy(update={"ego": Ego(speed=own / 3.6)})
    assert judged("ego_speed", claimed, scene).holds is holds


def test_of_a_road_without_traits_nothing_is_decided():
    assert judged("road", "tunnel", example_scene()).holds is None
    assert judged("road", "tunnel", example_scene(), MAPS["tunnel"]).holds is True
    assert judged("road", "tunnel", example_scene(), MAPS["bridge"]).holds is False
