"""OpenDRIVE documents that CARLA 0.9 reads in full, and that other readers read as before."""

import math
import re

import numpy as np
from lxml import etree

_ROAD = re.compile(r"""(<road\s(?:[^>]*?\s)?length=(["']))([^"']*)""")
_HEADER = re.compile(r"<header\b([^>]*?)(/?)>", re.DOTALL)
_LONGEST_M = 4096.0
"""Length of the longest road that is changed, m: up to there, the step of 32-bit floats is at most 0.2 mm."""
_REFERENCE = "<geoReference><![CDATA[+proj=tmerc +lat_0=0 +lon_0=0]]></geoReference>"


def decoded(data: bytes) -> str:
    """Return an OpenDRIVE document as text: in UTF-8 as it is, in another encoding without its declaration."""
    try:
        return data.decode()
    except UnicodeDecodeError:
        parser = etree.XMLParser(resolve_entities=False, no_network=True)
        return etree.tostring(etree.fromstring(data, parser), encoding="unicode")


def for_carla(text: str) -> str:
    """Return an OpenDRIVE document that CARLA reads in full; calling it again changes nothing.

    CARLA looks for the `outline` of a crosswalk in its object, where OpenDRIVE 1.4 had it, and not in
    `outlines`. It looks for the end of a lane that leads nowhere at the road's length as a 32-bit
    float, and `get_topology()` lacks the lane if that is not within the road. It also warns of every
    map without a geographic reference.
    """
    text = re.sub(r"\s*</?outlines\s*>", "", text)
    text = _ROAD.sub(_with_reachable_end, text)
    if "<geoReference" not in text:
        text = _HEADER.sub(_with_reference, text, count=1)
    return text


def _with_reachable_end(road: "re.Match[str]") -> str:
    """Return the beginning of a road whose end a 32-bit float can reach; at most 0.2 mm longer."""
    before, _, text = road.groups()
    try:
        length = float(text)
    except ValueError:
        return road[0]
    if not 0.0 < length < _LONGEST_M:
        return road[0]
    end = np.float32(length)
    if float(end) < length:
        return road[0]
    step = float(np.nextafter(end, np.float32(math.inf))) - float(end)
    return f"{before}{float(end) + 0.25 * step!r}"


def _with_reference(header: "re.Match[str]") -> str:
    attributes, slash = header.groups()
    end = "</header>" if slash else ""
    return f"<header{attributes}>{_REFERENCE}{end}"
