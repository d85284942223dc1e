"""The traffic lights and signs of a map's file."""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from oodscen.driving._roads.corridor import Corridor, RoadSignal
from oodscen.numerics._exact import cos, sin
from oodscen_pybullet._meshes import asset_ids, asset_mesh
from oodscen_pybullet._meshes.builder import Lamp, Mesh, Point
from oodscen_pybullet._meshes.tags import Tag, on_posts
from oodscen_pybullet._scenery.furniture import LIMITS, speed_sign
from oodscen_pybullet._scenery.placing import Heading, Site

INSTEAD_M = 4.0
"""A scene's own signal replaces the map's signals within this distance, m."""
_ALONG = 0.7
"""Cosine between a light and the ego's road above which the light applies to the road."""

_LEANS = (
    ((1.0, 0.0, 0.0), (0.0, 0.8, 0.6), (0.0, -0.6, 0.8)),
    ((0.96, 0.0, 0.28), (0.0, 1.0, 0.0), (-0.28, 0.0, 0.96)),
)
"""Turns of a bent post about its x and y axes: by 37 and 16 degrees."""
_SIGNS = {
    "206": "stop_sign",
    "205": "yield_sign",
    "274": "speed_limit_sign",
    "267": "no_entry_sign",
    "220": "one_way_sign",
    "101": "warning_sign",
}
"""OpenDRIVE's German sign types and the asset that shows each."""


def stand_signals(site: Site, without: frozenset[str], *, is_between: bool = False) -> list[Lamp]:
    """Add the map's signals: green for the ego's road, red for crossing roads, or as the scene has them.

    Args:
        site: Receives the signals.
        without: Ids of signals to omit.
        is_between: Whether flashing lamps are between two flashes.

    Returns:
        The lit lamps, in world coordinates.
    """
    shining: list[Lamp] = []
    for signal in site.ground.corridor.signals:
        if signal.id in without:
            continue
        mesh, fault = _mesh_of(site, signal, is_between=is_between), _fault_of(site, signal)
        if mesh is None or fault == "missing":
            continue
        mesh, (c, s) = displaced(mesh, (-cos(signal.yaw), -sin(signal.yaw)), fault)
        at = (signal.x, signal.y, site.terrain.surface(signal.x, signal.y))
        site.add(mesh, at, (c, s))
        shining += [_moved(lamp, at, (c, s)) for lamp in mesh.lamps]
    return shining


def _fault_of(site: Site, signal: RoadSignal) -> str | None:
    if site.state is None:
        return None
    return site.state.signals if signal.kind == "traffic_light" else site.state.signs


def displaced(mesh: Mesh, heading: Heading, fault: str | None) -> tuple[Mesh, Heading]:
    """Return a signal's mesh and heading: leaning if it is bent, a quarter turned if it is turned away."""
    c, s = heading
    if fault == "turned":
        return mesh, (-s, c)
    return (_leaning(mesh) if fault == "bent" else mesh), heading


@lru_cache(maxsize=32)
def _leaning(mesh: Mesh) -> Mesh:
    """Return a mesh that leans to its right and a little back, as after a knock."""
    lean, back = np.array(_LEANS[0]), np.array(_LEANS[1])
    turn = back @ lean

    def rotated(point: Point) -> Point:
        x, y, z = (turn @ np.array(point)).tolist()
        return (x, y, z)

    return replace(
        mesh,
        vertices=mesh.vertices @ turn.T,
        normals=mesh.normals @ turn.T,
        lamps=tuple(
            replace(lamp, position=rotated(lamp.position), facing=rotated(lamp.facing))
            for lamp in mesh.lamps
        ),
    )


def _mesh_of(site: Site, signal: RoadSignal, *, is_between: bool) -> Mesh | None:
    asset = asset_of(signal)
    if asset is None or asset not in asset_ids():
        return None
    if asset == "speed_limit_sign":
        limit = limit_of(signal)
        if limit is None:
            return None
        return limit_sign(limit)
    if signal.kind != "traffic_light":
        return on_posts(asset_mesh(asset), Tag.TRAFFIC_SIGNS)
    fault = _fault_of(site, signal)
    if fault in ("off", "flashing", "all_on"):
        light = asset_mesh(asset, fault, frame=int(is_between))
    else:
        light = asset_mesh(asset, state_of(site, signal))
    return on_posts(light, Tag.TRAFFIC_LIGHT)


def limit_sign(limit: int) -> Mesh:
    """Return a speed limit sign; the limit is in km/h."""
    if limit != 30:
        return speed_sign(limit)
    return on_posts(asset_mesh("speed_limit_sign"), Tag.TRAFFIC_SIGNS)


def limit_of(signal: RoadSignal) -> int | None:
    """Return the limit on a speed limit sign, km/h, or `None` if no face shows it."""
    try:
        limit = round(float(signal.value))
    except (ValueError, OverflowError):
        return None
    return limit if limit in LIMITS else None


def replaced(corridor: Corridor, places: Sequence[tuple[float, float]]) -> frozenset[str]:
    """Return the ids of the map's signals that a scene's own signals replace.

    Args:
        corridor: The corridor with the map's signals.
        places: x and y of the scene's own signals, m.
    """
    reach = INSTEAD_M * INSTEAD_M
    return frozenset(
        signal.id
        for signal in corridor.signals
        if any((signal.x - x) ** 2 + (signal.y - y) ** 2 <= reach for x, y in places)
    )


def asset_of(signal: RoadSignal) -> str | None:
    """Return the asset that shows a signal, or `None` if there is none."""
    if signal.kind == "traffic_light":
        return "traffic_light"
    return _SIGNS.get(signal.type)


def state_of(site: Site, signal: RoadSignal) -> str:
    """Return "green" for lights on the ego's road, otherwise "red"."""
    road = site.ground.corridor
    place = min(max(signal.s, 0.0), road.length)
    index = int(place / road.step + 0.5)
    along = cos(signal.yaw) * float(road.cos[index]) + sin(signal.yaw) * float(road.sin[index])
    return "green" if abs(along) > _ALONG else "red"


def _moved(lamp: Lamp, at: Point, heading: Heading) -> Lamp:
    (x, y, z), (fx, fy, fz), (c, s) = lamp.position, lamp.facing, heading
    return replace(
        lamp,
        position=(at[0] + c * x - s * y, at[1] + s * x + c * y, at[2] + z),
        facing=(c * fx - s * fy, s * fx + c * fy, fz),
    )
