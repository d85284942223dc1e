"""Entities: the bodies of a scene as scenario objects with boxes, axles and categories."""

from typing import Literal, NamedTuple

from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._scene import Scene
from oodscen.interchange._writing.elements import Element, Value, child

Kind = Literal["Vehicle", "Pedestrian", "MiscObject"]

_EGO_AXLE_M = 1.35
"""Distance from the ego's rear axle to its centre, m: half its wheelbase."""
AXLE_SHARE = 0.3
"""Distance from another vehicle's rear axle to its centre, as a share of its length."""
_VEHICLES = (
    (("trailer", "caravan"), "trailer"),
    (("bus", "coach"), "bus"),
    (("motorcycle", "motorbike", "moped"), "motorbike"),
    (("truck", "lorry", "tanker", "mixer", "crane"), "truck"),
    (("van", "ambulance"), "van"),
)
"""Categories of vehicles by words of their assets, the first match wins; others are cars."""
_OBJECTS = {"work_zone": "barrier", "vegetation": "vegetation", "signal": "pole"}
"""Categories of objects by the asset's category; others are obstacles."""
MASS_KG = {"Vehicle": 1500.0, "Pedestrian": 75.0, "MiscObject": 50.0}
"""Masses by kind, which the standard asks for; only the props of a scene have their own."""


class Entity(NamedTuple):
    """One body as OpenSCENARIO describes it."""

    name: str
    asset: Asset
    state: str
    kind: Kind
    category: str
    ahead_m: float
    """Distance from the reference point (a vehicle's rear axle) to the centre of the box, m."""
    mass_kg: float


def entities(scene: Scene, catalogue: Catalogue) -> list[Entity]:
    """Return all entities of a scene, the ego first."""
    masses = {prop.id: prop.mass_kg for prop in scene.made}
    return [
        _entity(name, asset, state, masses.get(asset.id))
        for name, asset, state in catalogue.bodies(scene)
    ]


def _entity(name: str, asset: Asset, state: str, mass_kg: float | None) -> Entity:
    kind, category = classified(asset)
    ahead_m = 0.0
    if name == "ego":
        ahead_m = _EGO_AXLE_M
    elif kind == "Vehicle" and category != "trailer":
        ahead_m = round(AXLE_SHARE * asset.length, 3)
    mass_kg = MASS_KG[kind] if mass_kg is None else mass_kg
    return Entity(name, asset, state, kind, category, ahead_m, mass_kg)


def classified(asset: Asset) -> tuple[Kind, str]:
    """Return the kind of scenario object and its category for an asset."""
    words = set(" ".join([asset.id, asset.description, *asset.tags]).replace("_", " ").split())
    if asset.category == "vehicle":
        categories = (category for names, category in _VEHICLES if words.intersection(names))
        return "Vehicle", next(categories, "car")
    if asset.category == "cyclist":
        return "Vehicle", "bicycle"
    if asset.category == "animal":
        return "Pedestrian", "animal"
    if asset.category == "pedestrian":
        return "Pedestrian", "wheelchair" if "wheelchair" in words else "pedestrian"
    return "MiscObject", _OBJECTS.get(asset.category, "obstacle")


def write_entity(parent: Element, entity: Entity) -> Element:
    """Append a scenario object and return its properties, which are empty.

    A vehicle's reference point is the middle of its rear axle.
    """
    attributes: dict[str, Value] = {"mass": entity.mass_kg}
    body = write_body(parent, entity, entity.asset.id, attributes, entity.ahead_m)
    if entity.kind == "Vehicle":
        wheelbase = 2.0 * (entity.ahead_m or AXLE_SHARE * entity.asset.length)
        write_chassis(body, entity.asset, front_m=wheelbase, rear_m=0.0)
    return child(body, "Properties")


def write_body(
    parent: Element, entity: Entity, name: str, attributes: dict[str, Value], ahead_m: float
) -> Element:
    """Append a scenario object with its box, whose centre lies ahead of its reference point, and return the body."""
    size = entity.asset
    holder = child(parent, "ScenarioObject", name=entity.name)
    category = f"{entity.kind[0].lower()}{entity.kind[1:]}Category"
    body = child(holder, entity.kind, name=name, **{category: entity.category}, **attributes)
    box = child(body, "BoundingBox")
    child(box, "Center", x=ahead_m, y=0.0, z=0.5 * size.height)
    child(box, "Dimensions", width=size.width, length=size.length, height=size.height)
    return body


def write_chassis(body: Element, asset: Asset, *, front_m: float, rear_m: float) -> None:
    """Append a vehicle's performance and its axles, by their places ahead of the reference point, m."""
    child(body, "Performance", maxSpeed=70.0, maxAcceleration=12.0, maxDeceleration=12.0)
    axles = child(body, "Axles")
    for tag, steering, x in (("FrontAxle", 0.6, front_m), ("RearAxle", 0.0, rear_m)):
        child(
            axles,
            tag,
            maxSteering=steering,
            wheelDiameter=0.6,
            trackWidth=max(0.3, asset.width - 0.2),
            positionX=x,
            positionZ=0.3,
        )
