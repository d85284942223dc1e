"""Assets and weather of the catalogue for what an OpenSCENARIO file describes."""

import math
import re

from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._scene import CLEAR_AIR_M, PRECIPITATIONS, Precipitation, Weather
from oodscen.interchange._reading.tree import Element
from oodscen.interchange._writing.entities import classified
from oodscen.interchange._writing.environment import OKTAS

_CLOUDS = {
    "free": 0.0,
    "skyOff": 0.0,
    "cloudy": 0.5,
    "overcast": 1.0,
    "rainy": 1.0,
    **{name: eighths / 8.0 for eighths, name in enumerate(OKTAS)},
    "nineOktas": 1.0,
}
"""Cloud cover by the cloud states of version 1.0 and 1.1, and by the oktas of later ones."""
_UNSEEN = {"skyOff", "nineOktas"}
"""States of which a cloud cover is not all that they say."""
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


def nearest_asset(entity: Element, catalogue: Catalogue) -> Asset | None:
    """Return the asset nearest to a scenario object, or `None` after recording that it has none."""
    body = next(
        (
            child
            for child in entity.children()
            if child.name in ("Vehicle", "Pedestrian", "MiscObject")
        ),
        None,
    )
    if body is None:
        entity.leave_out("is not a vehicle, pedestrian or object")
        return None
    body.touched()
    named = next((asset for asset in catalogue.assets if asset.id == body.get("name")), None)
    if named is not None:
        return named
    said = f"{body.name[0].lower()}{body.name[1:]}Category"
    if body.name == "Pedestrian":
        category = body.word(said, "pedestrian", "animal", "wheelchair")
    else:
        category = body.get(said)
    alike = [asset for asset in catalogue.assets if classified(asset) == (body.name, category)]
    kin = alike or [asset for asset in catalogue.assets if classified(asset)[0] == body.name]
    if not kin:
        body.leave_out(f"the catalogue has nothing like a {category or body.name}")
        return None
    if not alike:
        body.note(f"the catalogue has no {category}; another {body.name} stands for it")
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


def weather(root: Element) -> Weather:
    """Return the weather of the first environment of a file, or ordinary weather."""
    environment = next(root.within("Environment"), None)
    if environment is None:
        return Weather()
    sky = environment.first("Weather") or environment
    sun, fog = sky.first("Sun"), sky.first("Fog")
    elevation = 45.0
    if sun is not None:
        elevation = math.degrees(sun.number("elevation"))
    elif (day := environment.first("TimeOfDay")) is not None:
        elevation = _elevation(day)
    kind, amount = _precipitation(sky)
    road = environment.first("RoadCondition")
    friction = road.number("frictionScaleFactor", 1.0) if road is not None else 1.0
    return Weather(
        sun_elevation_deg=round(
            _kept(sun, elevation, -90.0, 90.0, "an elevation in degrees of"), 2
        ),
        fog_visual_range_m=round(_sight(fog), 2),
        precipitation=kind,
        precipitation_mm_h=amount,
        cloud_cover=_clouds(sky),
        friction=round(_kept(road, friction, 0.01, 1.5, "a friction of"), 3),
    )


def _kept(node: Element | None, value: float, low: float, high: float, what: str) -> float:
    return value if node is None else node.bounded(value, low, high, what)


def _sight(fog: Element | None) -> float:
    """Return the visual range; all that is clear air is the same."""
    if fog is None:
        return CLEAR_AIR_M
    sight = min(fog.number("visualRange", CLEAR_AIR_M), CLEAR_AIR_M)
    return fog.bounded(sight, 1.0, CLEAR_AIR_M, "a visual range of")


def _elevation(day: Element) -> float:
    """Return a plausible elevation of the sun at a time of day, degrees."""
    match = re.search(r"T([0-9]{2}):", day.get("dateTime"))
    hour = int(match[1]) if match else 12
    elevation = round(50.0 * math.sin((hour - 6.0) / 12.0 * math.pi), 2)
    day.note(f"the hour is read as {hour}, with the sun at {elevation:g} degrees")
    return elevation


def _clouds(sky: Element) -> float:
    oktas, state = sky.get("fractionalCloudCover"), sky.get("cloudState")
    said = oktas or state
    cover = _CLOUDS.get(said, Weather().cloud_cover)
    if said and (said not in _CLOUDS or said in _UNSEEN):
        sky.note(f"clouds {said[:40]!r} are read as a cover of {cover:g}")
    if oktas and state and _CLOUDS.get(state) != cover:
        sky.note(f"cloudState={state[:40]!r} is left out")
    return cover


def _precipitation(sky: Element) -> tuple[Precipitation, float]:
    falling = sky.first("Precipitation")
    if falling is None:
        return "none", 0.0
    name = falling.get("precipitationType")
    amount = _intensity(falling)
    kind: Precipitation = next(
        (precipitation for precipitation in PRECIPITATIONS if precipitation == name), "none"
    )
    if kind == "none" and name not in ("dry", "none"):
        falling.note(f"precipitation of kind {name[:40]!r} is left out")
    elif kind == "none" and amount > 0.0:
        falling.note(f"{amount:g} mm/h of nothing are left out")
    amount = round(falling.bounded(amount, 0.0, _HEAVIEST_MM_H, "an intensity in mm/h of"), 2)
    return (kind, amount) if kind != "none" and amount > 0.0 else ("none", 0.0)


def _intensity(falling: Element) -> float:
    """Return the precipitation, mm/h."""
    if falling.get("precipitationIntensity"):
        return falling.number("precipitationIntensity")
    amount = falling.number("intensity", 0.0)
    if amount:
        falling.note("an intensity from 0 to 1 is read as up to 50 mm/h")
    return 50.0 * amount
