"""Tunnels: what is in them, and where they end."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet import PyBulletSimulator
from oodscen_pybullet._lighting.shelter import Portal, Shelter
from oodscen_pybullet._rendering.view import CameraView

from oodscen.data._scene import Actor, Scene
from oodscen.driving._roads.building import load_corridor
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.protocols import Camera

ROAD = load_corridor(next(road for road in SHIPPED_MAPS if road.id == "tunnel"))
TUNNEL = ROAD.structures[0]
SHELTER = Shelter(ROAD)


def view(s: float, *, turned: bool = False) -> CameraView:
    x, y, z, yaw = ROAD.point(s, -1.8)
    camera = Camera(160, 120)
    return CameraView.of(camera, (x, y, z, yaw + (np.pi if turned else 0.0)))


@given(st.floats(-40, 240), st.floats(-6, 6), st.floats(0.0, 5.0))
def test_what_is_between_the_portals_is_sheltered(ahead: float, aside: float, up: float) -> None:
    x, y, z, _ = ROAD.point(TUNNEL.start + ahead, aside)
    right, left = ROAD.extent(TUNNEL.start + ahead)
    inside = 0.1 < ahead < TUNNEL.end - TUNNEL.start - 0.1 and right < aside < left
    near = min(abs(ahead), abs(TUNNEL.start + ahead - TUNNEL.end), abs(aside - left)) < 0.7
    near = near or abs(aside - right) < 0.7
    assert near or SHELTER.covers(np.array([(x, y, z + up)]))[0] == inside
    assert not SHELTER.covers(np.array([(x, y, z + 7.0)]))[0]


@given(st.floats(-150, 350), st.booleans())
def test_the_portal_ahead_is_that_of_the_way_one_looks(ahead: float, turned: bool) -> None:
    at = TUNNEL.start + ahead
    one = view(at, turned=turned)
    eye = ROAD.locate(*one.eye[:2])[0]
    portal = SHELTER.portal(one)
    if min(abs(eye - TUNNEL.start), abs(eye - TUNNEL.end)) < 0.1:
        return
    inside = TUNNEL.start < eye < TUNNEL.end
    ends = [TUNNEL.start, TUNNEL.end]
    left = [end for end in ends if (end < eye if turned else end > eye)]
    if not left:
        assert portal is None
        return
    assert portal is not None
    assert portal.is_inside == inside
    expected = min(abs(end - eye) for end in left)
    middle = np.zeros(1, np.float32)
    assert float(portal.depths(middle, middle)[0]) == pytest.approx(expected, rel=0.02, abs=0.05)


def test_rays_away_from_the_portal_never_meet_it() -> None:
    portal = Portal(is_inside=False, adaptation=0.0, distance=5.0, normal=(1.0, 0.0, 0.0))
    slopes = np.array([-1.0, 0.5, 1.0], np.float32)
    assert portal.depths(slopes, slopes).tolist() == [np.inf, 10.0, 5.0]


def test_maps_without_tunnels_shelter_nothing() -> None:
    other = Shelter(load_corridor(SHIPPED_MAPS[0]))
    assert not other.covers(np.zeros((3, 3))).any()
    assert other.portal(view(100.0)) is None


def test_it_is_dry_in_tunnels(
    simulator: PyBulletSimulator,
    camera: Camera,
    make_scene: Callable[..., Scene],
    make_actor: Callable[..., Actor],
) -> None:
    frames = {}
    inside = (*ROAD.point(TUNNEL.start + 60.0, -1.8),)
    for name, weather in (
        ("dry", {"cloud_cover": 1.0}),
        ("rain", {"precipitation": "rain", "precipitation_mm_h": 30.0}),
        ("snow", {"precipitation": "snow", "precipitation_mm_h": 8.0}),
    ):
        for where in ("outside", "inside"):
            simulator.reset(make_scene(make_actor("cone", 30.0), road="tunnel", **weather), 0)
            if where == "inside":
                poses = simulator.world.poses().copy()
                poses[0] = inside
                simulator.place(poses, simulator.world.speeds())
            frames[name, where] = simulator.render(camera).rgb.astype(int)
    for name in ("rain", "snow"):
        apart = abs(frames[name, "inside"] - frames["dry", "inside"]).max(axis=2)
        assert (apart > 3).mean() < 0.01
        apart = abs(frames[name, "outside"] - frames["dry", "outside"]).max(axis=2)
        assert (apart > 3).mean() > 0.5
