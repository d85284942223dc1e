"""Parts about looks: every asset in every state, and the extremes of the weather, show when rendered."""

from dataclasses import replace

import numpy as np

from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._scene import Scene
from oodscen.data._weather import CLEAR_AIR_M, Weather
from oodscen.driving._sight.outlines import area, clipped
from oodscen.driving._sight.scene_checks import bodies
from oodscen.driving._sight.visibility import Eye
from oodscen.errors import OodscenError
from oodscen.protocols import Frame
from oodscen.testing._kit.findings import NotApplicable
from oodscen.testing._kit.probe import Probe, clear_day
from oodscen.testing._kit.shapes import MARGIN_PX, colour_count, depths, share_inside
from oodscen.testing._truth import FOGGY_M, OVERCAST, fog_fault

LEAST_SHARE = 0.02
"""Minimum share of its box's silhouette that an asset must fill: ladders and wires are thin."""
INSIDE = 0.7
"""Minimum share of its pixels within that silhouette: mirrors and drawbars stand out."""

SMOKE = "smoke"
"""Tag of assets with smoke, which rises and drifts out of their box."""

_NEAREST_M = 6.0
"""Least distance at which an asset is rendered, m."""
_FOG_M = 60.0
"""Visual range that is measured, if the catalogue offers it, m."""


def check_appearance(probe: Probe) -> None:
    """Render every asset in every state and find those that do not show.

    Each must fill some of its box's silhouette with its id, at a depth within the box, and
    nothing else may have an id. Only what smokes may reach beyond its box.
    """
    for asset in probe.catalogue.assets:
        for state in asset.states or ("",):
            subject = f"asset {asset.id} {state}".rstrip()
            with probe.findings.trying(subject):
                for fault in _appearance_faults(probe, asset, state):
                    probe.findings.add(subject, fault)


def _appearance_faults(probe: Probe, asset: Asset, state: str) -> list[str]:
    """Return how the picture of an asset differs from its box."""
    size_m = max(asset.length, asset.width, 1.2 * asset.height)
    ahead_m = max(_NEAREST_M, 0.5 * asset.length + 3.0 + 0.9 * size_m)
    actor = probe.still(asset, ahead=ahead_m).model_copy(update={"state": state})
    scene, camera = probe.scene(actor), probe.camera(240, 180)
    if probe.is_top:
        camera = replace(camera, x=ahead_m, z=asset.height + max(8.0, 1.2 * size_m))
    first = probe.simulator.reset(scene, 0)
    frame = probe.simulator.render(camera)
    cast = bodies(scene, probe.catalogue, first.poses)
    eye = Eye(camera, cast[0].solid)
    outline = eye.silhouette(cast[1].solid)
    silhouette = area(clipped(outline, camera.width, camera.height))
    mask = frame.ids == 2
    pixels = int(mask.sum())
    if pixels < max(4.0, LEAST_SHARE * silhouette):
        return [f"fills {pixels} pixels of about {silhouette:.0f}, {ahead_m:.0f} m ahead"]
    faults = []
    if int(frame.ids.max(initial=0)) > 2:
        faults.append("other ids than the ego's and its own are in the frame")
    if SMOKE not in asset.tags and share_inside(mask, outline, MARGIN_PX) < INSIDE:
        faults.append("is drawn beside its box")
    low, high = depths(eye, cast[1].solid)
    depth = float(np.median(frame.depth[mask]))
    if not low - 1.0 <= depth <= high + 1.0:
        faults.append(f"has a depth of {depth:.1f} m, not {low:.1f} to {high:.1f} m")
    return faults


def check_weather(probe: Probe) -> None:
    """Render the extremes of the catalogue's weather, which must look unlike a clear day; measure its fog."""
    weathers = extremes(probe.catalogue)
    if not weathers:
        raise NotApplicable("the catalogue offers one weather only")
    vehicles = [asset for asset in probe.catalogue.assets if asset.category == "vehicle"]
    actor = probe.still((vehicles or probe.catalogue.assets)[0], ahead=18.0)
    clear = _frame(probe, probe.scene(actor))
    for name, weather in weathers.items():
        try:
            frame = _frame(probe, probe.scene(actor, weather=weather))
        except OodscenError as error:
            probe.findings.add(name, str(error))
            continue
        if colour_count(frame.rgb) < 4:
            probe.findings.add(name, "the frame is blank")
        change = np.abs(frame.rgb.astype(np.int16) - clear.rgb.astype(np.int16)).mean()
        if weather.friction == 1.0 and change < 1.0:
            probe.findings.add(name, "looks like a clear day")
        share = float((frame.ids != clear.ids).mean())
        if share > 0.001:
            probe.findings.add(name, f"changes the ids of {share:.1%} of the pixels")
    _check_fog(probe)


def _check_fog(probe: Probe) -> None:
    """Measure the visual range of a fog, from the contrast of two pictures."""
    visual_range_m = max(_FOG_M, probe.catalogue.weather.min_fog_visual_range_m)
    if visual_range_m > FOGGY_M or probe.is_top:
        return
    camera = probe.camera(320, 240)

    def render(visual_range_m: float) -> Frame:
        changes = {"fog_visual_range_m": visual_range_m, "cloud_cover": OVERCAST}
        probe.simulator.reset(probe.scene(weather=probe.clear.model_copy(update=changes)), 0)
        return probe.simulator.render(camera)

    fault = fog_fault(visual_range_m, camera, render)
    probe.findings.expect(not fault, "fog", fault)


def extremes(catalogue: Catalogue) -> dict[str, Weather]:
    """Return the weather at the limits of the catalogue's range."""
    limits, clear = catalogue.weather, clear_day(catalogue)
    changes: dict[str, dict[str, object]] = {}
    if limits.sun_is_drawn and limits.min_sun_elevation_deg < 45.0:
        changes["lowest sun"] = {"sun_elevation_deg": limits.min_sun_elevation_deg}
    if limits.min_fog_visual_range_m < CLEAR_AIR_M:
        changes["thickest fog"] = {"fog_visual_range_m": limits.min_fog_visual_range_m}
    for kind in limits.precipitation:
        if kind != "none":
            most = limits.max_precipitation_mm_h
            changes[f"heaviest {kind}"] = {"precipitation": kind, "precipitation_mm_h": most}
    if limits.min_friction < 1.0:
        changes["least friction"] = {"friction": limits.min_friction}
    return {name: clear.model_copy(update=change) for name, change in changes.items()}


def _frame(probe: Probe, scene: Scene) -> Frame:
    probe.simulator.reset(scene, 0)
    return probe.simulator.render(probe.camera(240, 180))
