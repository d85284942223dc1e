"""Assets and weather of the catalogue for what an OpenSCENARIO file describes."""

import math
import re

from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._scene import CLEAR_AIR_M, PRECIPITATIONS, Precipitation, Weather
from oodscen.interchange._reading.tree import Node
from oodscen.interchange._writing.entities import classified
from oodscen.interchange._writing.environment import OKTAS

_CLOUDS = {"free": 0.0, "skyOff": 0.0, "cloudy": 0.5, "overcast": 1.0, "rainy": 1.0}
"""Cloud cover by the cloud states of version 1.0 and 1.1."""
_HEAVIEST_MM_H = 100.0
_TYPICAL = {
    "car": "car",
    "van": "van",
    "truck": "truck",
    "bus": "bus",
    "bicycle": "cyclist",
    "pedestrian": "adult",
}
"""Assets for categories, where the catalogue has them and their sizes agree."""
_ALIKE_M = 2.0
"""Difference of length and width together up to which sizes agree, m."""


def nearest_asset(entity: Node, catalogue: Catalogue) -> Asset | None:
    """Return the asset nearest to a scenario object, or `None` after recording that it has none."""
    body = next(
        (one for one in entity.children() if one.name in ("Vehicle", "Pedestrian", "MiscObject")),
        None,
    )
    if body is None:
        entity.leave_out("is not a vehicle, pedestrian or object")
        return None
    named = next((one for one in catalogue.assets if one.id == body.get("name")), None)
    if named is not None:
        return named
    category = body.get(f"{body.name[0].lower()}{body.name[1:]}Category")
    if body.name == "Pedestrian" and category not in ("animal", "wheelchair"):
        category = "pedestrian"
    alike = [one for one in catalogue.assets if classified(one) == (body.name, category)]
    kin = alike or [one for one in catalogue.assets if classified(one)[0] == body.name]
    if not kin:
        body.leave_out(f"the catalogue has nothing like a {category or body.name}")
        return None
    if not alike:
        body.leave_out(f"the catalogue has no {category}; another {body.name} stands for it")
    size = body.first("BoundingBox", "Dimensions")
    words = set(re.findall(r"[a-z]+", f"{body.get('name')} {entity.get('name')}".lower()))
    order = {one.id: index for index, one in enumerate(kin)}

    def unlike(one: Asset) -> tuple[bool, bool, float, int]:
        far = 0.0
        if size is not None:
            far = abs(size.number("length") - one.length) + abs(size.number("width") - one.width)
        same = bool(words.intersection(one.id.split("_")))
        agrees = far < _ALIKE_M or body.name == "Pedestrian"
        is_typical = one.id == _TYPICAL.get(category) and agrees
        return not same, not is_typical, round(far, 1), order[one.id]

    return min(kin, key=unlike)


def weather(root: Node) -> Weather:
    """Return the weather of the first environment of a file, or ordinary weather."""
    environment = next(root.within("Environment"), None)
    sky = environment.first("Weather") if environment is not None else None
    if environment is None or sky is None:
        return Weather()
    sun, fog = sky.first("Sun"), sky.first("Fog")
    elevation = 45.0
    if sun is not None:
        elevation = math.degrees(sun.number("elevation"))
    elif (day := environment.first("TimeOfDay")) is not None:
        elevation = _elevation(day)
    kind, amount = _precipitation(sky)
    road = environment.first("RoadCondition")
    friction = road.number("frictionScaleFactor", 1.0) if road is not None else 1.0
    sight = fog.number("visualRange", CLEAR_AIR_M) if fog is not None else CLEAR_AIR_M
    for left in ("Wind", "DomeImage"):
        if (node := sky.first(left)) is not None:
            node.leave_out("a scene's weather has none")
    return Weather(
        sun_elevation_deg=round(min(max(elevation, -90.0), 90.0), 2),
        fog_visual_range_m=round(min(max(sight, 1.0), CLEAR_AIR_M), 2),
        precipitation=kind,
        precipitation_mm_h=amount,
        cloud_cover=_clouds(sky),
        friction=round(min(max(friction, 0.01), 1.5), 3),
    )


def _elevation(day: Node) -> float:
    """Return a plausible elevation of the sun at a time of day, degrees."""
    found = re.search(r"T(\d\d):", day.get("dateTime"))
    hour = int(found[1]) if found else 12
    return round(50.0 * math.sin((hour - 6.0) / 12.0 * math.pi), 2)


def _clouds(sky: Node) -> float:
    oktas = sky.get("fractionalCloudCover")
    if oktas in OKTAS:
        return OKTAS.index(oktas) / 8.0
    return _CLOUDS.get(sky.get("cloudState"), 0.1)


def _precipitation(sky: Node) -> tuple[Precipitation, float]:
    falling = sky.first("Precipitation")
    if falling is None:
        return "none", 0.0
    name = falling.get("precipitationType")
    kind: Precipitation = next((one for one in PRECIPITATIONS if one == name), "none")
    if kind == "none":
        return "none", 0.0
    if falling.get("precipitationIntensity"):
        amount = falling.number("precipitationIntensity")
    else:
        amount = 50.0 * falling.number("intensity", 0.0)
        falling.leave_out("an intensity from 0 to 1 is read as up to 50 mm/h")
    amount = round(min(amount, _HEAVIEST_MM_H), 2)
    if amount <= 0.0:
        return "none", 0.0
    return kind, amount
