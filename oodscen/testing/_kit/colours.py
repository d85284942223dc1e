"""Checks that the colours of pictures show bodies and the turning of the ego."""

import numpy as np

from oodscen.data._catalogue import Asset
from oodscen.protocols import Camera, Control
from oodscen.testing._kit.probe import Probe
from oodscen.testing._kit.shapes import LEAST_PX

CHANGED = 12
"""Difference of a colour that counts as a change, of 255."""
_TURNED = 1.0
"""Least mean difference of colours between pictures of a straight drive and of one that turns away, of 255."""
CONTRAST = 12.0
"""Least distance between the mean colours of a body and of the road, of 441."""


def check_colours(probe: Probe) -> None:
    """Check that the picture changes where a body is, and that bodies differ from the road."""
    camera = probe.camera(240, 180)
    probe.simulator.reset(probe.scene(), 0)
    empty = probe.simulator.render(camera)
    tried, road_coloured = 0, []
    for index, asset in enumerate(_visible_assets(probe)):
        ahead_m = 12.0 + 0.5 * asset.length
        offset_m = 2.2 if index % 2 else -2.2
        actor = probe.still(asset, ahead=ahead_m, offset=offset_m)
        probe.simulator.reset(probe.scene(actor), 0)
        frame = probe.simulator.render(camera)
        mask = frame.ids == 2
        if mask.sum() < LEAST_PX:
            continue
        tried += 1
        difference = np.abs(frame.rgb.astype(np.int16) - empty.rgb.astype(np.int16)).max(axis=2)
        changed = difference >= CHANGED
        inside, outside = float(changed[mask].mean()), float(changed[~mask].mean())
        if inside < 0.4 or inside < 1.5 * outside:
            probe.findings.add(
                f"asset {asset.id}",
                f"the picture changes in {inside:.0%} of its pixels and {outside:.0%} of the others",
            )
        ground = frame.rgb[_road_pixels(probe, camera)].astype(np.float64)
        colour, road_colour = frame.rgb[mask].mean(axis=0), np.median(ground, axis=(0, 1))
        if float(np.linalg.norm(colour - road_colour)) < CONTRAST:
            road_coloured.append(asset.id)
    if tried >= 2 and len(road_coloured) > 0.5 * tried:
        probe.findings.add(
            "", f"most bodies have the colour of the road: {', '.join(road_coloured[:6])}"
        )


def _visible_assets(probe: Probe) -> list[Asset]:
    """Return up to six assets of different categories that are large enough to see."""
    firsts: dict[str, Asset] = {}
    for asset in probe.catalogue.assets:
        if asset.height > 0.4 and asset.width > 0.3:
            firsts.setdefault(asset.category, asset)
    return list(firsts.values())[:6]


def _road_pixels(probe: Probe, camera: Camera) -> tuple[slice, slice]:
    """Return a patch of the lane right in front of the ego."""
    if probe.is_top:
        top, middle = int(0.60 * camera.height), camera.width // 2
        return slice(top, top + 8), slice(middle - 4, middle + 4)
    rows = slice(int(0.8 * camera.height), int(0.92 * camera.height))
    columns = slice(int(0.42 * camera.width), int(0.58 * camera.width))
    return rows, columns


def check_turning(probe: Probe) -> None:
    """Check that the picture turns with the ego: it is another one than after a straight drive."""
    camera = probe.camera()
    pictures = []
    for steering in (0.0, 0.1):
        probe.simulator.reset(probe.scene(speed=8.0), 0)
        for _ in range(round(2.0 / probe.simulator.dt)):
            probe.simulator.step(Control(0.0, steering))
        pictures.append(probe.simulator.render(camera).rgb.astype(np.int16))
    change = float(np.abs(pictures[1] - pictures[0]).mean())
    probe.findings.expect(
        change > _TURNED, "", "the picture is that of a straight drive while the ego turns away"
    )
