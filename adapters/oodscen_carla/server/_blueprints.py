"""The blueprint library: CARLA's blueprints by name and size, and those of the drawing simulator."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from oodscen.data import Asset, Catalogue
from oodscen_carla._blueprints import nearest, own_id
from oodscen_carla.server._values import Vector

BOOL, INT, FLOAT, STRING, COLOUR = 1, 2, 3, 4, 5
"""Codes of attribute types: `carla.ActorAttributeType`."""

Attribute = tuple[str, int, str, bool]
"""Name, type code, default and whether a client may change it."""

PICTURE: tuple[Attribute, ...] = (
    ("image_size_x", INT, "800", True),
    ("image_size_y", INT, "600", True),
    ("fov", FLOAT, "90.0", True),
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
    *("gamma", "iso", "shutter_speed", "fstop", "bloom_intensity", "lens_flare_intensity"),
    *("motion_blur_intensity", "chromatic_aberration_intensity", "exposure_compensation"),
)
_TAGS = {
    "pedestrian": 12, "vehicle": 14, "cyclist": 19, "vegetation": 9, "signal": 7, "animal": 21,
    "object": 20, "work_zone": 20,
}  # fmt: skip
_TAG_OF_WORD = {"truck": 15, "lorry": 15, "bus": 16, "tram": 17, "motorcycle": 18, "bicycle": 19}
_BASE_TYPES = {14: "car", 15: "truck", 16: "bus", 18: "motorcycle", 19: "bicycle"}
"""`base_type` of vehicles by semantic tag; scripts choose their traffic by it."""
_NO_TRAFFIC = (
    *("overturned", "wreck", "burn", "trailer"),
    *("tractor", "excavator", "forklift", "road_roller"),
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
            [name, kind, value, [value] if kind == COLOUR else [], is_free, False]
            for name, kind, value, is_free in self.attributes
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
        words = {asset.id, *asset.tags}
        return next(
            (tag for word, tag in _TAG_OF_WORD.items() if any(word in one for one in words)), 14
        )
    return _TAGS.get(asset.category, 20)


def _body_attributes(name: str, asset: Asset) -> tuple[Attribute, ...]:
    role: Attribute = ("role_name", STRING, "default", True)
    state: Attribute = ("state", STRING, "", True)
    if name.startswith("walker."):
        moves: tuple[Attribute, ...] = (
            ("speed", FLOAT, "1.4", True),
            ("is_invincible", BOOL, "false", True),
        )
        return role, *moves
    if not name.startswith("vehicle."):
        return role, state
    kind = "" if _is_no_traffic(asset) else _BASE_TYPES.get(_tag(asset), "")
    wheels = "2" if kind in ("motorcycle", "bicycle") else "4"
    return (
        role,
        state,
        ("number_of_wheels", INT, wheels, False),
        ("base_type", STRING, kind, False),
        ("special_type", STRING, "", False),
        ("generation", INT, "1", False),
        ("has_lights", BOOL, "true", False),
        ("sticky_control", BOOL, "true", True),
        ("color", COLOUR, "128,128,128", True),
    )


def _is_no_traffic(asset: Asset) -> bool:
    """Return whether a vehicle is none of the traffic: a wreck, a trailer, a machine."""
    words = {asset.id, *asset.tags}
    return any(one in word for word in words for one in _NO_TRAFFIC)


def _sensor_attributes(name: str) -> tuple[Attribute, ...]:
    role: Attribute = ("role_name", STRING, "default", True)
    if name == FRICTION_TRIGGER:
        sizes = ("friction", "extent_x", "extent_y", "extent_z")
        return role, *((size, FLOAT, "1.0", True) for size in sizes)
    if not name.startswith("sensor."):
        return (role,)
    every: Attribute = ("sensor_tick", FLOAT, "0.0", True)
    if name not in CAMERAS:
        return role, every
    lens = _LENS if name != "sensor.camera.rgb" else (*_LENS, *_EFFECTS)
    extra = [("enable_postprocess_effects", BOOL, "true", True)] if lens is not _LENS else []
    return role, every, *PICTURE, *((one, FLOAT, "0.0", True) for one in lens), *extra
