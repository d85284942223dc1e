"""OpenDRIVE as CARLA 0.9 reads it, without a change for other readers."""

import re

_HEADER = re.compile(r"<header\b([^>]*?)(/?)>", re.DOTALL)
_REFERENCE = "<geoReference><![CDATA[+proj=tmerc +lat_0=0 +lon_0=0]]></geoReference>"


def for_carla(text: str) -> str:
    """Return an OpenDRIVE document that CARLA reads in full; calling it again changes nothing.

    CARLA looks for the `outline` of a crosswalk in its object, where OpenDRIVE 1.4 had it, and not in
    `outlines`. It also warns of every map without a geographic reference.
    """
    text = re.sub(r"\s*</?outlines\s*>", "", text)
    if "<geoReference" not in text:
        text = _HEADER.sub(_referenced, text, count=1)
    return text


def _referenced(header: "re.Match[str]") -> str:
    attributes, slash = header.groups()
    end = "</header>" if slash else ""
    return f"<header{attributes}>{_REFERENCE}{end}"
