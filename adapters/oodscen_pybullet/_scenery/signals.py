"""The traffic lights and signs of a map's file."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from oodscen.driving._roads.corridor import Corridor, RoadSignal
from oodscen.numerics._exact import cos, sin
from oodscen_pybullet._meshes import asset_mesh
from oodscen_pybullet._meshes.mesh import Lamp, Mesh
from oodscen_pybullet._meshes.tags import Tag, on_posts
from oodscen_pybullet._scenery.furniture import LIMITS, speed_sign
from oodscen_pybullet._scenery.placing import Site
from oodscen_pybullet._types import Heading

_REPLACED_M = 4.0
"""A scene's own signal replaces the map's signals within this distance, m."""
_CLEARANCE_M = 4.0
"""Height of its lower edge from which a signal above a carriageway hangs there, m."""
_ALONG = 0.7
"""Cosine between a light and the ego's road above which the light applies to the road."""
_FAULTY_STATES = frozenset({"off", "flashing", "all_on"})
"""Faults that are states of a traffic light."""
_LEAN = np.array([(0.96, -0.168, 0.224), (0.0, 0.8, 0.6), (-0.28, -0.576, 0.768)])
"""Turn of a bent post, to its right and a little back: by 37 degrees about its x axis, then by 16 about y."""
_SIGNS = {
    "206": "stop_sign",
    "205": "yield_sign",
    "274": "speed_limit_sign",
    "267": "no_entry_sign",
    "220": "one_way_sign",
    "101": "warning_sign",
}
"""OpenDRIVE's German sign types and the asset that shows each."""


def stand_signals(site: Site, omitted: frozenset[str], *, is_dark_phase: bool) -> list[Lamp]:
    """Add the map's signals: green for the ego's road, red for crossing roads, or as the scene has them.

    Args:
        site: Receives the signals.
        omitted: Ids of signals to omit.
        is_dark_phase: Whether flashing lamps are between two flashes.

    Returns:
        The lit lamps, in world coordinates.
    """
    lamps: list[Lamp] = []
    for signal in site.ground.corridor.signals:
        fault = _fault_of(site, signal)
        if signal.id in omitted or fault == "missing":
            continue
        mesh = _mesh_of(site, signal, fault, is_dark_phase=is_dark_phase)
        if mesh is None:
            continue
        z = site.terrain.surface(signal.x, signal.y)
        if _hangs(site, signal):
            mesh, z = _without_posts(mesh), z + signal.height
        mesh, heading = displace(mesh, (-cos(signal.yaw), -sin(signal.yaw)), fault)
        at = (signal.x, signal.y, z)
        site.add(mesh, at, heading)
        lamps += [lamp.placed(at, heading) for lamp in mesh.lamps]
    return lamps


def _fault_of(site: Site, signal: RoadSignal) -> str | None:
    """Return the fault that the scene gives to signals of this kind, if any."""
    if site.state is None:
        return None
    return site.state.signals if signal.kind == "traffic_light" else site.state.signs


def _hangs(site: Site, signal: RoadSignal) -> bool:
    """Return whether a signal is above a carriageway, so high that vehicles pass below it."""
    if signal.height < _CLEARANCE_M:
        return False
    return bool(site.ground.near(np.array([signal.x]), np.array([signal.y])).asphalt[0] < 0.0)


def _without_posts(mesh: Mesh) -> Mesh:
    """Return a signal without its posts, whose lower edge is its origin."""
    is_kept = mesh.classes != Tag.POLES
    triangles = mesh.triangles[is_kept]
    edge = float(mesh.vertices[triangles, 2].min())
    head = replace(mesh, triangles=triangles, tags=mesh.classes[is_kept])
    return head.moved(np.eye(3), about=(0.0, 0.0, edge))


def displace(mesh: Mesh, heading: Heading, fault: str | None) -> tuple[Mesh, Heading]:
    """Return a signal's mesh and heading: leaning if it is bent, a quarter turned if it is turned away."""
    c, s = heading
    if fault == "turned":
        return mesh, (-s, c)
    return (mesh.moved(_LEAN) if fault == "bent" else mesh), heading


def _mesh_of(
    site: Site, signal: RoadSignal, fault: str | None, *, is_dark_phase: bool
) -> Mesh | None:
    """Return what shows a signal, `None` if no asset does."""
    if signal.kind == "traffic_light":
        is_along = abs(site.ground.corridor.alignment(signal.s, signal.yaw)) > _ALONG
        ordinary = "green" if is_along else "red"
        state = fault if fault in _FAULTY_STATES else ordinary
        light = asset_mesh("traffic_light", state, frame=int(is_dark_phase))
        return on_posts(light, Tag.TRAFFIC_LIGHT)
    asset = _SIGNS.get(signal.type)
    if asset == "speed_limit_sign":
        limit = limit_of(signal)
        return None if limit is None else limit_sign(limit)
    return None if asset is None else on_posts(asset_mesh(asset), Tag.TRAFFIC_SIGNS)


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


def replaced_signals(
    corridor: Corridor, positions: Sequence[tuple[float, float]]
) -> frozenset[str]:
    """Return the ids of the map's signals that a scene's own signals replace.

    Args:
        corridor: The corridor with the map's signals.
        positions: x and y of the scene's own signals, m.
    """
    return frozenset(
        signal.id
        for signal in corridor.signals
        if any(
            (signal.x - x) ** 2 + (signal.y - y) ** 2 <= _REPLACED_M * _REPLACED_M
            for x, y in positions
        )
    )
