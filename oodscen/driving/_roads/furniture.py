"""Signals, crosswalks, stop lines, tunnels and bridges along a road."""

from typing import Literal

from oodscen.driving._roads.document import XmlNode
from oodscen.driving._roads.network import Patch, Signal, Stretch
from oodscen.numerics._exact import cos, sin

_MAX_THINGS = 5_000
"""Maximum number of one kind along one road."""
_MAX_CORNERS = 200


def read_signals(road: XmlNode) -> tuple[Signal, ...]:
    """Read a road's traffic lights and signs."""
    nodes = road.all("signals", "signal", by="id")
    return tuple(
        Signal(
            id=node.get("id", longest=64),
            name=node.get("name", longest=200),
            s=node.number("s"),
            t=node.number("t"),
            height=node.number("zOffset", default=0.0),
            orientation=node.get("orientation", "none", longest=8),
            turn=node.number("hOffset", default=0.0, limit=100.0),
            type=node.get("type", longest=64),
            country=node.get("country", longest=64),
            value=node.get("value", longest=64),
            is_dynamic=node.get("dynamic") == "yes",
        )
        for node in road.limited(nodes, _MAX_THINGS, "signals", "/signals")
    )


def read_patches(road: XmlNode) -> tuple[Patch, ...]:
    """Read a road's crosswalks and stop lines."""
    nodes = road.all("objects", "object", by="id")
    patches = []
    for node in road.limited(nodes, _MAX_THINGS, "objects", "/objects"):
        words = "".join(node.get(key, longest=80) for key in ("type", "subtype", "name")).lower()
        plain = words.replace(" ", "").replace("_", "").replace("-", "")
        if "crosswalk" not in plain and "stopline" not in plain:
            continue
        corners = _corners(node)
        if len(corners) >= 3:
            patches.append(Patch("crosswalk" if "crosswalk" in plain else "stop_line", corners))
    return tuple(patches)


def _corners(node: XmlNode) -> tuple[tuple[float, float], ...]:
    """Return an object's outline, or its bounding box, in the road's coordinates."""
    outlines = [*node.all("outline"), *node.all("outlines", "outline")][:1]
    road, local = (
        [corner.at(f"{node.path}/{name}") for outline in outlines for corner in outline.all(name)]
        for name in ("cornerRoad", "cornerLocal")
    )
    if len(road) >= 3:
        return tuple((corner.number("s"), corner.number("t")) for corner in road[:_MAX_CORNERS])
    s, t = node.number("s"), node.number("t")
    heading = node.number("hdg", default=0.0, limit=100.0)
    if len(local) >= 3:
        places = [(corner.number("u"), corner.number("v")) for corner in local[:_MAX_CORNERS]]
    else:
        length = node.number("length", default=0.0, limit=1e3)
        width = node.number("width", default=0.0, limit=1e3)
        if min(length, width) <= 0.0:
            return ()
        u, v = 0.5 * length, 0.5 * width
        places = [(-u, -v), (u, -v), (u, v), (-u, v)]
    along, across = cos(heading), sin(heading)
    return tuple((s + u * along - v * across, t + u * across + v * along) for u, v in places)


def read_stretches(road: XmlNode) -> tuple[Stretch, ...]:
    """Read a road's tunnels and bridges."""
    stretches = []
    kinds: tuple[Literal["tunnel", "bridge"], ...] = ("tunnel", "bridge")
    for kind in kinds:
        nodes = road.all("objects", kind, by="id")
        for node in road.limited(nodes, _MAX_THINGS, f"{kind}s", "/objects"):
            start, length = node.number("s"), node.number("length")
            if length <= 0.0:
                node.fault("must be above 0", "@length")
            stretches.append(Stretch(kind, start, start + length))
    return tuple(stretches)
