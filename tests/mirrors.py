"""Roads and scenes as in a mirror: left and right exchanged."""

import re
from typing import Any

from lxml import etree

from oodscen.data._scene import Scene
from oodscen.driving._motion.behaviours.table import BUILT_IN

_SIDEWAYS = (
    *("y", "hdg", "curvature", "curvStart", "curvEnd", "t", "v", "hOffset", "aV", "bV", "cV", "dV"),
)
"""Attributes of OpenDRIVE whose sign is a side."""
_SIDES = ("lanes", "lateral", "spin_deg")
"""Parameters of behaviours whose sign is a side."""
SWAPPED = {"left": "right", "right": "left"}


def swapped(text: str) -> str:
    """Return a text with the words left and right exchanged, also within longer words."""
    return re.sub("left|right", lambda word: SWAPPED[word[0]], text)


def mirrored_map(text: bytes) -> bytes:
    """Return an OpenDRIVE file with y and -y exchanged: its traffic keeps to the other side."""
    tree = etree.fromstring(text)
    for one in tree.iter(etree.Element):
        negated = [name for name in _SIDEWAYS if name in one.attrib]
        if one.tag in ("laneOffset", "poly3"):
            negated += "abcd"
        elif one.tag == "laneLink":
            negated += ["from", "to"]
        elif one.tag == "lane" or (
            one.tag in ("predecessor", "successor") and one.getparent().getparent().tag == "lane"
        ):
            negated.append("id")
        elif one.tag == "road":
            one.set("rule", "RHT" if one.get("rule") == "LHT" else "LHT")
        elif one.tag in SWAPPED:
            one.tag = SWAPPED[one.tag]
        for name in negated:
            value = one.get(name)
            one.set(name, value[1:] if value.startswith("-") else f"-{value}")
    return etree.tostring(tree).replace(b'"-0"', b'"0"')


def mirrored(scene: Scene, lanes: int, **changes: Any) -> Scene:
    """Return a scene on a mirrored road with so many lanes in the ego's direction."""
    data = scene.model_dump()
    data["ego"]["lane"] = lanes - 1 - scene.ego.lane
    ordinary = [actor for actor in data["hazard"]["actors"].values() if actor is not None]
    for actor in [*data["actors"], *ordinary]:
        placement, behaviour = actor["placement"], actor["behaviour"]
        for name in ("lane", "offset_m", "heading_deg"):
            placement[name] = -placement[name]
        kinds = BUILT_IN[behaviour["name"]].kind.parameters if behaviour["name"] in BUILT_IN else {}
        for name in _SIDES:
            if name in kinds:
                value = behaviour["parameters"].get(name, kinds[name].default)
                behaviour["parameters"][name] = -value
    for motion in data.get("motions", ()):
        for key in motion.get("keys") or ():
            for name in ("left", "yaw", "roll"):
                key[name] = -key[name]
        if motion.get("circle"):
            motion["circle"]["clockwise"] = not motion["circle"]["clockwise"]
    return Scene.model_validate({**data, **changes})
