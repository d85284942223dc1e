"""OpenDRIVE as CARLA 0.9 reads it, without a change for other readers."""

import math
import re

import numpy as np

_ROAD = re.compile(r"""(<road\s(?:[^>]*?\s)?length=(["']))([^"']*)""")
_HEADER = re.compile(r"<header\b([^>]*?)(/?)>", re.DOTALL)
_REFERENCE = "<geoReference><![CDATA[+proj=tmerc +lat_0=0 +lon_0=0]]></geoReference>"


def for_carla(text: str) -> str:
    """Return an OpenDRIVE document that CARLA reads in full; calling it again changes nothing.

    CARLA looks for the `outline` of a crosswalk in its object, where OpenDRIVE 1.4 had it, and not in
    `outlines`. It looks for the end of a lane that leads nowhere at the road's length as a 32-bit
    float, and `get_topology()` lacks the lane if that is not within the road. It also warns of every
    map without a geographic reference.
    """
    text = re.sub(r"\s*</?outlines\s*>", "", text)
    text = _ROAD.sub(_reachable, text)
    if "<geoReference" not in text:
        text = _HEADER.sub(_referenced, text, count=1)
    return text


def _reachable(road: "re.Match[str]") -> str:
    """Return the beginning of a road whose end a 32-bit float can reach; at most 0.2 mm longer."""
    before, _, given = road.groups()
    try:
        length = float(given)
    except ValueError:
        return road[0]
    # CARLA's greatest roads are a few kilometres; the step of the floats there is 0.2 mm.
    if not 0.0 < length < 4096.0:
        return road[0]
    end = np.float32(length)
    if float(end) < length:
        return road[0]
    step = float(np.nextafter(end, np.float32(math.inf))) - float(end)
    return f"{before}{float(end) + 0.25 * step!r}"


def _referenced(header: "re.Match[str]") -> str:
    attributes, slash = header.groups()
    end = "</header>" if slash else ""
    return f"<header{attributes}>{_REFERENCE}{end}"
