"""Checks that everything in a catalogue is visible when rendered."""

import numpy as np

from oodscen.data._catalogue import Asset, Catalogue, RoadMap
from oodscen.data._scene import Actor, Placement, Scene, Weather
from oodscen.driving._sight.scene_checks import bodies
from oodscen.driving._sight.visibility import Eye, area, clipped
from oodscen.errors import OodscenError
from oodscen.protocols import Camera, Frame, Simulator
from oodscen.testing._samples import sample_scene

LEAST_SHARE = 0.02
"""Minimum share of its box's silhouette that an asset must fill: ladders and wires are thin."""

_CAMERA = Camera(width=240, height=180)
_NEAREST_M = 6.0


def appearance_faults(simulator: Simulator) -> list[str]:
    """Render every asset in every state and return those that do not show.

    Each must fill some of its box's silhouette with its id, at a depth within the box, and
    nothing else may have an id.
    """
    catalogue = simulator.catalogue()
    road = max(catalogue.maps, key=lambda road: (len(road.traits) == 0, road.lanes, road.length_m))
    faults = []
    for asset in catalogue.assets:
        for state in asset.states or ("",):
            what = f"asset {asset.id} {state}".rstrip()
            try:
                faults += [f"{what}: {fault}" for fault in _shown(simulator, road, asset, state)]
            except OodscenError as error:
                faults.append(f"{what}: {error}")
    return faults


def _shown(simulator: Simulator, road: RoadMap, asset: Asset, state: str) -> list[str]:
    size = max(asset.length, asset.width, 1.2 * asset.height)
    away = max(_NEAREST_M, 0.5 * asset.length + 3.0 + 0.9 * size)
    actor = Actor(id="a", asset=asset.id, placement=Placement(ahead_m=away), state=state)
    scene = sample_scene(road, (actor,))
    first = simulator.reset(scene, 0)
    frame = simulator.render(_CAMERA)
    cast = bodies(scene, simulator.catalogue(), first.poses)
    eye = Eye(_CAMERA, cast[0].solid)
    silhouette = area(clipped(eye.silhouette(cast[1].solid), _CAMERA.width, _CAMERA.height))
    mask = frame.ids == 2
    pixels = int(mask.sum())
    if pixels < max(4.0, LEAST_SHARE * silhouette):
        return [f"fills {pixels} pixels of about {silhouette:.0f}, {away:.0f} m ahead"]
    faults = []
    if int(frame.ids.max(initial=0)) > 2:
        faults.append("other ids than the ego's and its own are in the frame")
    depths = [eye.to_camera(corner)[2] for corner in cast[1].solid.corners()]
    depth = float(np.median(frame.depth[mask]))
    if not min(depths) - 1.0 <= depth <= max(depths) + 1.0:
        faults.append(f"has a depth of {depth:.1f} m, not {min(depths):.1f} to {max(depths):.1f} m")
    return faults


def weather_faults(simulator: Simulator) -> list[str]:
    """Render the extremes of the catalogue's weather and return those that look like a clear day."""
    catalogue = simulator.catalogue()
    road = catalogue.maps[0]
    car = next((one for one in catalogue.assets if one.category == "vehicle"), catalogue.assets[0])
    actor = Actor(id="a", asset=car.id, placement=Placement(ahead_m=18.0))
    clear = _frame(simulator, sample_scene(road, (actor,)))
    faults = []
    for name, weather in extremes(catalogue).items():
        try:
            frame = _frame(simulator, sample_scene(road, (actor,), weather=weather))
        except OodscenError as error:
            faults.append(f"weather {name}: {error}")
            continue
        if len(np.unique(frame.rgb.reshape(-1, 3), axis=0)) < 4:
            faults.append(f"weather {name}: the frame is blank")
        change = np.abs(frame.rgb.astype(np.int16) - clear.rgb.astype(np.int16)).mean()
        if weather.friction == 1.0 and change < 1.0:
            faults.append(f"weather {name}: looks like a clear day")
        if not np.array_equal(frame.ids, clear.ids):
            agree = float((frame.ids == clear.ids).mean())
            if agree < 0.999:
                faults.append(f"weather {name}: changes the ids of {1.0 - agree:.1%} of the pixels")
    return faults


def extremes(catalogue: Catalogue) -> dict[str, Weather]:
    """Return the weather at the limits of the catalogue's range."""
    limits = catalogue.weather
    found = {}
    if limits.min_sun_elevation_deg < 45.0:
        found["lowest sun"] = Weather(sun_elevation_deg=limits.min_sun_elevation_deg)
    if limits.min_fog_visual_range_m < 10_000.0:
        found["thickest fog"] = Weather(fog_visual_range_m=limits.min_fog_visual_range_m)
    for kind in limits.precipitation:
        if kind != "none":
            most = limits.max_precipitation_mm_h
            found[f"heaviest {kind}"] = Weather(precipitation=kind, precipitation_mm_h=most)
    if limits.min_friction < 1.0:
        found["least friction"] = Weather(friction=limits.min_friction)
    return found


def _frame(simulator: Simulator, scene: Scene) -> Frame:
    simulator.reset(scene, 0)
    return simulator.render(_CAMERA)
