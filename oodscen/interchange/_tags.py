"""Tags of a scene in ASAM OpenLABEL's ontology of scenario tags: operational design domain and behaviour.

The operational design domain follows ISO 34503 (BSI PAS 1883), whose classes the ontology has.
"""

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from oodscen._arguments import checked
from oodscen.data._base import Data
from oodscen.data._catalogue import Asset, BehaviourKind, Catalogue, RoadMap
from oodscen.data._scene import Actor, Scene
from oodscen.data._weather import DUSK_DEG, FOG_M, Precipitation, Weather
from oodscen.driving._motion.behaviours.table import BUILT_IN
from oodscen.driving._roads.building import find_map, load_corridor
from oodscen.driving._roads.corridor import Corridor, ego_strip, neighbour_strip
from oodscen.errors import Issue, SceneError
from oodscen.interchange._writing.entities import classified

ONTOLOGY = "https://openlabel.asam.net/V1-0-0/ontologies/openlabel_ontology_scenario_tags.ttl"

_LOW_DEG = 10.0
"""Sun elevation below which light is low, degrees."""
_BEND_PER_M = 1e-3
"""Curvature above which a road bends, 1/m."""
_SLOPE = 0.02
"""Rise per metre above which a road is not level."""
_ROAD_AHEAD_M = 300.0
"""Length of road ahead of the start that counts, m."""
_KPH = 3.6

_ROADS = {
    "highway": "RoadTypeMotorway",
    "urban": "RoadTypeDistributor",
    "rural": "RoadTypeRadial",
    "residential": "RoadTypeMinor",
}
"""Road types by the traits of a map."""
_LANDMARKS = {
    "roundabout": "JunctionRoundabout",
    "junction": "JunctionIntersection",
    "tunnel": "SpecialStructureTunnel",
    "bridge": "SpecialStructureBridge",
}
"""Junctions and structures by the traits and landmarks of a map."""
_VEHICLES = {
    "car": "VehicleCar",
    "van": "VehicleVan",
    "truck": "VehicleTruck",
    "bus": "VehicleBus",
    "motorbike": "VehicleMotorcycle",
    "bicycle": "VehicleCycle",
}

KNOWN_TAGS: dict[str, tuple[str, ...]] = {
    "scenery": (
        *_ROADS.values(),
        *_LANDMARKS.values(),
        "HorizontalCurves",
        "HorizontalStraights",
        "LongitudinalUpSlope",
        "LongitudinalDownSlope",
        "LongitudinalLevelPlane",
        "TransverseDivided",
        "TransverseUndivided",
        "TransversePavements",
        "TravelDirectionRight",
        "TravelDirectionLeft",
        "LaneTypeTraffic",
        "EdgeShoulderPavedOrGravel",
        "SurfaceConditionWet",
        "SurfaceConditionSnow",
        "TemporaryStructureRoadWorks",
        "FixedStructureVegetation",
    ),
    "environment": (
        "IlluminationDay",
        "DaySunElevation",
        "LowLightAmbient",
        "LowLightNight",
        "IlluminationCloudiness",
        "WeatherRain",
        "WeatherSnow",
        "ParticulatesWater",
    ),
    "dynamic elements": (
        "SubjectVehicleSpeed",
        "RoadUserVehicle",
        *_VEHICLES.values(),
        "VehicleTrailer",
        "VehicleEmergency",
        "RoadUserHuman",
        "HumanPedestrian",
        "HumanCyclist",
        "HumanWheelchairUser",
        "RoadUserAnimal",
    ),
    "behaviour": (
        *dict.fromkeys(tag for row in BUILT_IN.values() for tag in row.tags),
        "MotionLaneChangeLeft",
        "MotionLaneChangeRight",
    ),
}
"""Tags that a scene can have, by the areas of ISO 34503 and, for behaviour, ISO 34504, without those that hold values."""


def scene_tags(scene: Scene, catalogue: Catalogue) -> dict[str, float | None]:
    """Return the tags of a scene, each with its value if it has one, sorted by name.

    Speeds are in km/h, the sun's elevation in degrees, precipitation in mm/h, and visual range in m, as the
    ontology has them.

    Raises:
        UnknownComponent: If the catalogue lacks the scene's map.
        SceneError: If it lacks an asset or a behaviour of the scene.
    """
    road_map = find_map(scene.map, catalogue)
    tags: dict[str, float | None] = dict(_weather_tags(scene.weather))
    road = load_corridor(road_map)
    tags |= dict.fromkeys(_road_tags(road_map, road))
    tags["subjectVehicleSpeedValue"] = round(_KPH * scene.ego.speed, 3)
    tags["SubjectVehicleSpeed"] = None
    catalogue = catalogue.for_scene(scene)
    for index, actor in enumerate(scene.actors):
        try:
            asset, kind = catalogue.asset(actor.asset), catalogue.behaviour(actor.behaviour.name)
        except KeyError as error:
            fault = Issue(f"actors[{index}]", f"the simulator has no {error.args[0]!r}")
            raise SceneError(scene.id, [fault]) from None
        lane = neighbour_strip(road, ego_strip(road, scene.ego.lane), actor.placement.lane)
        direction = road.strips[lane].direction
        tags |= dict.fromkeys((*_body_tags(asset), *_motion_tags(actor, asset, kind, direction)))
    return dict(sorted(tags.items()))


class TagCount(Data):
    """The number of scenes that have one tag."""

    tag: str
    area: str
    """Part of the taxonomy: `scenery`, `environment`, `dynamic elements` or `behaviour`."""
    scenes: int


class TagCoverage(Data):
    """The tags that scenes have, and those that they lack."""

    schema_version: int = 1
    scenes: int
    rows: tuple[TagCount, ...]
    """One row for each tag that a scene can have, by area, the most frequent first."""

    @property
    def holes(self) -> tuple[TagCount, ...]:
        """Tags that no scene has."""
        return tuple(row for row in self.rows if not row.scenes)

    @property
    def has_gaps(self) -> bool:
        """Return whether a tag is on no scene."""
        return bool(self.holes)

    def __str__(self) -> str:
        lines = [f"{self.scenes} scenes"]
        for area in KNOWN_TAGS:
            lines.append(area)
            lines += [
                f"  {row.tag:34}{row.scenes:6}{row.scenes / self.scenes:7.0%}"
                for row in self.rows
                if row.area == area and row.scenes
            ]
            if missing := [row.tag for row in self.holes if row.area == area]:
                lines.append(f"  none: {', '.join(missing)}")
        return "\n".join(lines)


def count_tags(scenes: Iterable[Scene], catalogue: Catalogue) -> TagCoverage:
    """Count the scenes that have each tag of `KNOWN_TAGS`."""
    counts: Counter[str] = Counter()
    total = 0
    for scene in scenes:
        counts.update(scene_tags(scene, catalogue).keys())
        total += 1
    rows = [
        TagCount(tag=tag, area=area, scenes=counts[tag])
        for area, tags in KNOWN_TAGS.items()
        for tag in sorted(tags, key=lambda tag: (-counts[tag], tag))
    ]
    return TagCoverage(scenes=total, rows=tuple(rows))


@checked
def openlabel(scene: Scene, catalogue: Catalogue) -> dict[str, Any]:
    """Return a scene's tags as an ASAM OpenLABEL 1.0 document."""
    tags: dict[str, Any] = {}
    for number, (name, value) in enumerate(scene_tags(scene, catalogue).items()):
        tag: dict[str, Any] = {"ontology_uid": "0", "type": name}
        if value is not None:
            tag["tag_data"] = {"num": [{"type": "value", "val": value}]}
        tags[str(number)] = tag
    for name, text in (("scenarioUniqueReference", scene.id), ("scenarioName", scene.id)):
        data = {"text": [{"type": "value", "val": text}]}
        tags[str(len(tags))] = {"ontology_uid": "0", "type": name, "tag_data": data}
    return {
        "openlabel": {
            "metadata": {
                "schema_version": "1.0.0",
                "annotator": "oodscen",
                "tagged_file": f"{scene.id}.xosc",
            },
            "ontologies": {"0": ONTOLOGY},
            "tags": tags,
        }
    }


_PRECIPITATION: Mapping[Precipitation, tuple[str, str, str]] = {
    "rain": ("WeatherRain", "weatherRainValue", "SurfaceConditionWet"),
    "snow": ("WeatherSnow", "weatherSnowValue", "SurfaceConditionSnow"),
}
"""Tags of precipitation, of its amount and of the road's surface."""


def _weather_tags(weather: Weather) -> Iterator[tuple[str, float | None]]:
    if weather.sun_elevation_deg < DUSK_DEG:
        yield "LowLightNight", None
    elif weather.sun_elevation_deg < _LOW_DEG:
        yield "LowLightAmbient", None
    else:
        yield "IlluminationDay", None
        yield "DaySunElevation", None
        yield "daySunElevationValue", weather.sun_elevation_deg
    yield "IlluminationCloudiness", None
    yield "illuminationCloudinessValue", round(8.0 * weather.cloud_cover)
    if weather.precipitation != "none":
        weather_tag, value_tag, surface_tag = _PRECIPITATION[weather.precipitation]
        yield weather_tag, None
        yield value_tag, weather.precipitation_mm_h
        yield surface_tag, None
    if weather.fog_visual_range_m < FOG_M:
        yield "ParticulatesWater", None
        yield "particulatesWaterValue", weather.fog_visual_range_m


def _road_tags(road_map: RoadMap, road: Corridor) -> Iterator[str]:
    first, last = (int(s / road.step) for s in (road.start, road.start + _ROAD_AHEAD_M))
    ahead = slice(first, last + 1)
    yield from (tag for trait, tag in _ROADS.items() if trait in road_map.traits)
    words = {*road_map.traits, *road_map.landmarks}
    yield from (tag for word, tag in _LANDMARKS.items() if word in words)
    is_bent = bool((abs(road.curvature[ahead]) > _BEND_PER_M).any())
    yield "HorizontalCurves" if is_bent else "HorizontalStraights"
    slopes = np.diff(road.z[ahead]) / road.step
    if slopes.max(initial=0.0) > _SLOPE:
        yield "LongitudinalUpSlope"
    if slopes.min(initial=0.0) < -_SLOPE:
        yield "LongitudinalDownSlope"
    if abs(slopes).max(initial=0.0) <= _SLOPE:
        yield "LongitudinalLevelPlane"
    yield "TransverseDivided" if "divided" in road_map.traits else "TransverseUndivided"
    if any(strip.kind == "sidewalk" for strip in road.strips):
        yield "TransversePavements"
    yield "TravelDirectionLeft" if road.keeps_left else "TravelDirectionRight"
    yield "LaneTypeTraffic"
    if road_map.has_shoulder:
        yield "EdgeShoulderPavedOrGravel"


def _body_tags(asset: Asset) -> Iterator[str]:
    """Yield the kind of road user, temporary structure or plant that an asset is."""
    kind, category = classified(asset)
    if kind == "Vehicle":
        yield "RoadUserVehicle"
        yield _VEHICLES.get(category, "VehicleTrailer")
        if "emergency" in asset.tags:
            yield "VehicleEmergency"
        if category == "bicycle":
            yield from ("RoadUserHuman", "HumanCyclist")
    elif category == "animal":
        yield "RoadUserAnimal"
    elif kind == "Pedestrian":
        yield "RoadUserHuman"
        yield "HumanWheelchairUser" if category == "wheelchair" else "HumanPedestrian"
    elif asset.category == "work_zone":
        yield "TemporaryStructureRoadWorks"
    elif asset.category == "vegetation":
        yield "FixedStructureVegetation"


def _motion_tags(actor: Actor, asset: Asset, kind: BehaviourKind, direction: int) -> Iterator[str]:
    """Yield the motion of an actor; objects that only lie there have none.

    `direction` is that of its lane: +1 with the ego, -1 oncoming.
    """
    if classified(asset)[0] == "MiscObject" and kind.built_in == "stand":
        return
    row = BUILT_IN.get(kind.built_in)
    if row is None:
        return
    yield from row.tags
    if row.plain_action == "lane_change":
        # A scene counts lanes as the ego sees them, the ontology as the actor does.
        default = kind.parameters["lanes"].default if "lanes" in kind.parameters else 0.0
        lanes = direction * actor.behaviour.parameters.get("lanes", default)
        if math.cos(math.radians(actor.placement.heading_deg)) < 0.0:
            lanes = -lanes
        if lanes:
            yield "MotionLaneChangeLeft" if lanes > 0.0 else "MotionLaneChangeRight"
