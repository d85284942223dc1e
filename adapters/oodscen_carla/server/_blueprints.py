"""The blueprint library: CARLA's blueprints by name and size, and those of the drawing simulator."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

from oodscen.data import Asset, Catalogue
from oodscen_carla._blueprints import nearest, own_id
from oodscen_carla.server._values import Vector

BOOL, INT, FLOAT, STRING, COLOUR = 1, 2, 3, 4, 5
"""Codes of attribute types: `carla.ActorAttributeType`."""


class Attribute(NamedTuple):
    """One attribute of a blueprint."""

    name: str
    kind: int
    """Code of its type."""
    default: str
    is_free: bool = True
    """True if a client may change it."""


PICTURE = (
    Attribute("image_size_x", INT, "800"),
    Attribute("image_size_y", INT, "600"),
    Attribute("fov", FLOAT, "90.0"),
)
"""The attributes of a camera's picture."""
CAMERAS = {
    "sensor.camera.rgb": "rgb",
    "sensor.camera.depth": "depth",
    "sensor.camera.semantic_segmentation": "semantic",
    "sensor.camera.instance_segmentation": "instance",
}
"""Kind of picture by blueprint."""
FRICTION_TRIGGER = "static.trigger.friction"
"""Blueprint of the boxes in which clients change the friction."""
OTHERS = (
    "sensor.other.collision",
    "sensor.other.lane_invasion",
    "sensor.other.imu",
    "sensor.other.gnss",
    FRICTION_TRIGGER,
    "controller.ai.walker",
)
"""Blueprints without a body besides the cameras."""
SPECTATOR = "spectator"

_LENS = ("lens_circle_multiplier", "lens_circle_falloff", "lens_k", "lens_kcube")
_EFFECTS = (
    "gamma",
    "iso",
    "shutter_speed",
    "fstop",
    "bloom_intensity",
    "lens_flare_intensity",
    "motion_blur_intensity",
    "chromatic_aberration_intensity",
    "exposure_compensation",
)
_CAR, _TRUCK, _BUS, _TRAM, _MOTORCYCLE, _BICYCLE, _STATIC = 14, 15, 16, 17, 18, 19, 20
"""Semantic tags: `carla.CityObjectLabel`."""
_TAGS = {
    "pedestrian": 12, "vehicle": _CAR, "cyclist": _BICYCLE, "vegetation": 9, "signal": 7, "animal": 21,
    "object": _STATIC, "work_zone": _STATIC,
}  # fmt: skip
_TAG_OF_WORD = {
    "truck": _TRUCK, "lorry": _TRUCK, "bus": _BUS, "tram": _TRAM, "motorcycle": _MOTORCYCLE,
    "bicycle": _BICYCLE,
}  # fmt: skip
_BASE_TYPES = {
    _CAR: "car", _TRUCK: "truck", _BUS: "bus", _MOTORCYCLE: "motorcycle", _BICYCLE: "bicycle"
}  # fmt: skip
"""`base_type` of vehicles by semantic tag; scripts choose their traffic by it."""
_NOT_TRAFFIC = (
    "overturned",
    "wreck",
    "burn",
    "trailer",
    "tractor",
    "excavator",
    "forklift",
    "road_roller",
)
"""Words of vehicles without a `base_type`."""


@dataclass(frozen=True)
class Blueprint:
    """One entry of the library."""

    id: str
    attributes: tuple[Attribute, ...]
    extent: Vector = (0.0, 0.0, 0.0)
    """Half of length, width and height, m."""
    asset: Asset | None = None
    """The asset of the drawing simulator that shows it; `None` for what has no body."""
    tag: int = 0
    """Semantic tag: `carla.CityObjectLabel`."""

    @property
    def is_solid(self) -> bool:
        """Return whether it has a body."""
        return self.asset is not None

    def definition(self, uid: int) -> list[Any]:
        """Return the definition that a client reads."""
        # Scripts draw a colour at random from the recommended ones, so there has to be one.
        attributes = [
            [
                attribute.name,
                attribute.kind,
                attribute.default,
                [attribute.default] if attribute.kind == COLOUR else [],
                attribute.is_free,
                False,
            ]
            for attribute in self.attributes
        ]
        return [uid, self.id, self.id.replace(".", ","), attributes]


class BlueprintLibrary:
    """All blueprints by id: CARLA's own, those of the drawing simulator's assets, and sensors."""

    def __init__(self, carla: Catalogue, drawn: Catalogue) -> None:
        """Choose an asset to draw for each of CARLA's blueprints.

        Args:
            carla: CARLA's catalogue.
            drawn: The catalogue of the simulator that draws the pictures.
        """
        self._all: dict[str, Blueprint] = {}
        for asset in (drawn.ego, *drawn.assets):
            self._add(own_id(asset), asset, asset)
        for asset in (carla.ego, *carla.assets):
            if "@" not in asset.id:
                self._add(asset.id, asset, nearest(asset, (drawn.ego, *drawn.assets)))
        for name in (*CAMERAS, *OTHERS):
            self._all[name] = Blueprint(name, _sensor_attributes(name))

    def _add(self, name: str, size: Asset, asset: Asset) -> None:
        extent = (size.length / 2, size.width / 2, size.height / 2)
        attributes = _body_attributes(name, size)
        self._all[name] = Blueprint(name, attributes, extent, asset, _tag(size))

    def __contains__(self, name: object) -> bool:
        """Return whether a blueprint exists."""
        return name in self._all

    def __getitem__(self, name: str) -> Blueprint:
        """Return a blueprint by its id."""
        return self._all[name]

    @cached_property
    def definitions(self) -> list[Any]:
        """The definitions of all blueprints, sorted by id."""
        return [self._all[name].definition(n) for n, name in enumerate(sorted(self._all), start=1)]


def _tag(asset: Asset) -> int:
    """Return the semantic tag of a body; that of a vehicle goes by the words in its id and tags."""
    if asset.category == "vehicle":
        names = {asset.id, *asset.tags}
        for word, tag in _TAG_OF_WORD.items():
            if any(word in name for name in names):
                return tag
        return _CAR
    return _TAGS.get(asset.category, _STATIC)


def _body_attributes(name: str, asset: Asset) -> tuple[Attribute, ...]:
    role, state = Attribute("role_name", STRING, "default"), Attribute("state", STRING, "")
    if name.startswith("walker."):
        speed = Attribute("speed", FLOAT, "1.4")
        return role, speed, Attribute("is_invincible", BOOL, "false")
    if not name.startswith("vehicle."):
        return role, state
    kind = _BASE_TYPES.get(_tag(asset), "") if _is_traffic(asset) else ""
    wheels = "2" if kind in ("motorcycle", "bicycle") else "4"
    return (
        role,
        state,
        Attribute("number_of_wheels", INT, wheels, is_free=False),
        Attribute("base_type", STRING, kind, is_free=False),
        Attribute("special_type", STRING, "", is_free=False),
        Attribute("generation", INT, "1", is_free=False),
        Attribute("has_lights", BOOL, "true", is_free=False),
        Attribute("sticky_control", BOOL, "true"),
        Attribute("color", COLOUR, "128,128,128"),
    )


def _is_traffic(asset: Asset) -> bool:
    """Return whether a vehicle is traffic, and no wreck, trailer or machine."""
    names = {asset.id, *asset.tags}
    return not any(word in name for name in names for word in _NOT_TRAFFIC)


def _sensor_attributes(name: str) -> tuple[Attribute, ...]:
    role = Attribute("role_name", STRING, "default")
    if name == FRICTION_TRIGGER:
        sizes = ("friction", "extent_x", "extent_y", "extent_z")
        return role, *(Attribute(size, FLOAT, "1.0") for size in sizes)
    if not name.startswith("sensor."):
        return (role,)
    interval = Attribute("sensor_tick", FLOAT, "0.0")
    if name not in CAMERAS:
        return role, interval
    lens = tuple(Attribute(effect, FLOAT, "0.0") for effect in _LENS)
    if name != "sensor.camera.rgb":
        return role, interval, *PICTURE, *lens
    effects = tuple(Attribute(effect, FLOAT, "0.0") for effect in _EFFECTS)
    postprocess = Attribute("enable_postprocess_effects", BOOL, "true")
    return role, interval, *PICTURE, *lens, *effects, postprocess
