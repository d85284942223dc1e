"""Signals, crosswalks, stop lines, tunnels and bridges along a road."""

from lxml import etree

from oodscen.driving._roads.document import Document, children, label
from oodscen.driving._roads.network import Patch, Signal, Stretch
from oodscen.numerics._exact import cos, sin

_MAX_THINGS = 5_000
"""Maximum number of one kind along one road."""
_MAX_CORNERS = 200


def read_signals(document: Document, road: etree._Element, path: str) -> tuple[Signal, ...]:
    """Read a road's traffic lights and signs."""
    number = document.number
    elements = children(road, "signals", "signal")
    signals = []
    for element in document.limited(elements, _MAX_THINGS, f"{path}/signals", "signals"):
        here = f"{path}/signals/signal[{label(element)}]"
        signals.append(
            Signal(
                id=element.get("id", "")[:64],
                name=element.get("name", "")[:200],
                s=number(element, "s", here),
                t=number(element, "t", here),
                height=number(element, "zOffset", here, default=0.0),
                orientation=element.get("orientation", "none")[:8],
                turn=number(element, "hOffset", here, default=0.0, limit=100.0),
                type=element.get("type", "")[:64],
                subtype=element.get("subtype", "")[:64],
                country=element.get("country", "")[:64],
                value=element.get("value", "")[:64],
                is_dynamic=element.get("dynamic") == "yes",
            )
        )
    return tuple(signals)


def read_patches(document: Document, road: etree._Element, path: str) -> tuple[Patch, ...]:
    """Read a road's crosswalks and stop lines."""
    elements = children(road, "objects", "object")
    patches = []
    for element in document.limited(elements, _MAX_THINGS, f"{path}/objects", "objects"):
        words = "".join(element.get(key, "")[:80] for key in ("type", "subtype", "name")).lower()
        plain = words.replace(" ", "").replace("_", "").replace("-", "")
        if "crosswalk" not in plain and "stopline" not in plain:
            continue
        corners = _corners(document, element, f"{path}/objects/object[{label(element)}]")
        if len(corners) >= 3:
            patches.append(Patch("crosswalk" if "crosswalk" in plain else "stop_line", corners))
    return tuple(patches)


def _corners(
    document: Document, element: etree._Element, here: str
) -> tuple[tuple[float, float], ...]:
    """Return an object's outline, or its bounding box, in the road's coordinates."""
    number = document.number
    outlines = [*children(element, "outline"), *children(element, "outlines", "outline")][:1]
    road = [
        (one, f"{here}/cornerRoad") for line in outlines for one in children(line, "cornerRoad")
    ]
    if len(road) >= 3:
        return tuple(
            (number(one, "s", where), number(one, "t", where)) for one, where in road[:_MAX_CORNERS]
        )
    s, t = number(element, "s", here), number(element, "t", here)
    heading = number(element, "hdg", here, default=0.0, limit=100.0)
    local = [one for line in outlines for one in children(line, "cornerLocal")][:_MAX_CORNERS]
    if len(local) >= 3:
        places = [
            (number(one, "u", f"{here}/cornerLocal"), number(one, "v", f"{here}/cornerLocal"))
            for one in local
        ]
    else:
        length = number(element, "length", here, default=0.0, limit=1e3)
        width = number(element, "width", here, default=0.0, limit=1e3)
        if min(length, width) <= 0.0:
            return ()
        u, v = 0.5 * length, 0.5 * width
        places = [(-u, -v), (u, -v), (u, v), (-u, v)]
    along, across = cos(heading), sin(heading)
    return tuple((s + u * along - v * across, t + u * across + v * along) for u, v in places)


def read_stretches(document: Document, road: etree._Element, path: str) -> tuple[Stretch, ...]:
    """Read a road's tunnels and bridges."""
    stretches = []
    for kind in ("tunnel", "bridge"):
        elements = children(road, "objects", kind)
        for element in document.limited(elements, _MAX_THINGS, f"{path}/objects", f"{kind}s"):
            here = f"{path}/objects/{kind}[{label(element)}]"
            start = document.number(element, "s", here)
            length = document.number(element, "length", here)
            if length <= 0.0:
                document.add(f"{here}@length", "must be above 0")
            stretches.append(
                Stretch("tunnel" if kind == "tunnel" else "bridge", start, start + length)
            )
    return tuple(stretches)
