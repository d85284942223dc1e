"""The traffic lights and signs of a map's file."""

from collections.abc import Sequence
from dataclasses import replace

from oodscen.driving._roads.corridor import Corridor, RoadSignal
from oodscen.numerics._exact import cos, sin
from oodscen_pybullet._meshes import asset_ids, asset_mesh
from oodscen_pybullet._meshes.builder import Lamp, Mesh, Point
from oodscen_pybullet._scenery.furniture import LIMITS, speed_sign
from oodscen_pybullet._scenery.placing import Heading, Site

INSTEAD_M = 4.0
"""A scene's own signal replaces the map's signals within this distance, m."""
_ALONG = 0.7
"""Cosine between a light and the ego's road above which the light applies to the road."""

_SIGNS = {
    "206": "stop_sign",
    "205": "yield_sign",
    "274": "speed_limit_sign",
    "267": "no_entry_sign",
    "220": "one_way_sign",
    "101": "warning_sign",
}
"""OpenDRIVE's German sign types and the asset that shows each."""


def stand_signals(site: Site, without: frozenset[str]) -> list[Lamp]:
    """Add the map's signals: green for the ego's road, red for crossing roads.

    Args:
        site: Receives the signals.
        without: Ids of signals to omit.

    Returns:
        The lit lamps, in world coordinates.
    """
    shining: list[Lamp] = []
    for signal in site.ground.corridor.signals:
        if signal.id in without:
            continue
        mesh = _mesh_of(site, signal)
        if mesh is None:
            continue
        c, s = -cos(signal.yaw), -sin(signal.yaw)
        at = (signal.x, signal.y, site.terrain.surface(signal.x, signal.y))
        site.add(mesh, at, (c, s))
        shining += [_moved(lamp, at, (c, s)) for lamp in mesh.lamps]
    return shining


def _mesh_of(site: Site, signal: RoadSignal) -> Mesh | None:
    asset = asset_of(signal)
    if asset is None or asset not in asset_ids():
        return None
    if asset == "speed_limit_sign":
        limit = limit_of(signal)
        if limit is None:
            return None
        if limit != 30:
            return speed_sign(limit)
    return asset_mesh(asset, state_of(site, signal) if signal.kind == "traffic_light" else "")


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
