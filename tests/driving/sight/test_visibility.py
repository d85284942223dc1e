"""What can be seen, judged without a picture, agrees with pictures."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from oodscen.data._weather import Weather
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._sight.visibility import LEAST_AREA_PX, Eye, UprightBox
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.protocols import Camera
from oodscen.testing._flat import FlatSimulator
from tests.driving.staging import actor, scene

CAMERA = Camera()
EGO = UprightBox(0, 0, 0, 0, 4.5, 1.85, 1.5)


def car(x, y=0.0, yaw=0.0, height=1.5):
    return UprightBox(x, y, 0.0, yaw, 4.3, 1.8, height)


@pytest.mark.parametrize(
    ("ahead", "aside", "heading", "turn"),
    [(12, 0, 20, 0), (30, 3, -60, 0), (60, -2, 90, 0), (-15, 1, 20, 180), (2, 9, 0, 75)],
)
def test_the_silhouette_is_what_the_camera_shows(ahead, aside, heading, turn):
    camera = replace(CAMERA, yaw_deg=turn)
    staged = scene(actor("a", "van", ahead=ahead, offset=aside, heading=heading), map="highway")
    with FlatSimulator() as simulator:
        state = simulator.reset(staged, 0)
        frame = simulator.render(camera)
        size = simulator.catalogue().asset("van")
    bodies = [
        UprightBox(*map(float, pose), *dimensions)
        for pose, dimensions in zip(
            state.poses, ((4.5, 1.85, 1.5), (size.length, size.width, size.height)), strict=True
        )
    ]
    sight = Eye(camera, bodies[0]).see(bodies[1], ())
    pixels = int((frame.ids == 2).sum())
    assert sight.area_px == pytest.approx(pixels, rel=0.05, abs=10)
    assert sight.fault(Weather(), camera) is None


def test_what_is_outside_behind_or_small_is_not_seen():
    eye = Eye(CAMERA, EGO)
    for body, word in (
        (car(-20.0), "behind"),
        (car(10.0, 30.0), "outside"),
        (UprightBox(150.0, 0.0, 0.0, 0.0, 0.3, 0.3, 0.3), "square pixels"),
    ):
        assert word in (eye.see(body, ()).fault(Weather(), CAMERA) or "")


def test_fog_hides_what_is_beyond_the_visual_range():
    sight = Eye(CAMERA, EGO).see(car(60.0), ())
    assert "visual range" in (sight.fault(Weather(fog_visual_range_m=40.0), CAMERA) or "")
    assert sight.fault(Weather(fog_visual_range_m=90.0), CAMERA) is None


def test_a_larger_body_hides_a_smaller_one_behind_it():
    eye = Eye(CAMERA, EGO)
    bus = UprightBox(20.0, 0.0, 0.0, math.pi / 2, 12.0, 2.5, 3.1)
    child = UprightBox(30.0, 0.0, 0.0, 0.0, 0.4, 0.4, 1.2)
    assert eye.see(child, (bus,)).hidden == 1.0
    assert "hidden" in (eye.see(child, (bus,)).fault(Weather(), CAMERA) or "")
    assert eye.see(bus, (child,)).hidden == 0.0
    assert eye.see(child, ()).hidden == 0.0


def test_a_flat_road_hides_nothing():
    corridor = load_corridor(SHIPPED_MAPS[0])
    x, y, z, yaw = corridor.point(corridor.start, 0.0)
    eye = Eye(CAMERA, UprightBox(x, y, z, yaw, 4.5, 1.85, 1.5))
    other = corridor.point(corridor.start + 40.0, 0.0)
    assert eye.see(UprightBox(*other, 4.3, 1.8, 1.5), (), corridor).hidden == 0.0


@pytest.mark.parametrize(("on_m", "hidden"), [(0.0, False), (60.0, True)])
def test_a_crest_hides_what_lies_beyond_it(on_m, hidden):
    corridor = load_corridor(next(one for one in SHIPPED_MAPS if one.id == "rural_hill"))
    crest = corridor.s[corridor.z.argmax()]
    eye = Eye(CAMERA, UprightBox(*corridor.point(crest - 50.0, -1.5), 4.5, 1.85, 1.5))
    box = UprightBox(*corridor.point(crest + on_m, -1.5), 1.0, 1.0, 0.5)
    assert eye.see(box, (), corridor).hidden == (1.0 if hidden else 0.0)
    assert eye.see(box, ()).hidden == 0.0


def test_sight_lines_meet_the_picture():
    eye = Eye(CAMERA, EGO)
    across, below, depth = eye.to_camera((30.0, 2.0, 1.0))
    u = 0.5 * CAMERA.width + eye.focal * across / depth
    v = 0.5 * CAMERA.height + eye.focal * below / depth
    ray = eye._ray(u, v)
    np.testing.assert_allclose(
        [a + depth * b for a, b in zip(eye.place, ray, strict=True)], (30.0, 2.0, 1.0), atol=1e-9
    )


@given(
    st.builds(car, st.floats(6, 40), st.floats(-12, 12), st.floats(-3, 3)),
    st.builds(
        UprightBox,
        x=st.floats(3, 45),
        y=st.floats(-12, 12),
        z=st.just(0.0),
        yaw=st.just(0.0),
        length=st.floats(0.2, 3),
        width=st.floats(2, 20),
        height=st.just(3.0),
    ),
)
@example(UprightBox(14, 0, 0, 0, 0.6, 0.6, 1.7), UprightBox(11, 9.5, 0, 0, 0.5, 20, 3))
def test_a_wall_hides_as_much_as_the_pieces_that_it_is_made_of(body, wall):
    width = wall.width / 40
    right = wall.y - 0.5 * (wall.width - width)
    pieces = [replace(wall, y=right + row * width, width=width) for row in range(40)]
    eye = Eye(CAMERA, EGO)
    assert eye.see(body, [wall]).hidden == pytest.approx(eye.see(body, pieces).hidden, abs=0.03)


@given(
    st.builds(
        UprightBox,
        x=st.floats(6, 40),
        y=st.floats(-4, 4),
        z=st.floats(0, 1),
        yaw=st.floats(-3.2, 3.2),
        length=st.floats(2, 14),
        width=st.floats(0.04, 0.3),
        height=st.floats(0.02, 0.3),
    )
)
@example(UprightBox(6.05, 2.308, 0, -2.2933, 9.72, 0.205, 0.033))
def test_nothing_hides_a_body_that_is_alone(thin):
    sight = Eye(CAMERA, EGO).see(thin, ())
    assert sight.hidden == 0.0 or sight.area_px < LEAST_AREA_PX
