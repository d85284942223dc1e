"""The look of a hazard in a rendered frame: size, contrast with its surroundings, light and occlusion."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import Scene
from oodscen.data._sighting import Sighting, apparent_size
from oodscen.data._weather import DARK_DEG
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._sight.decision_view import SCALE_PX, best, drawn, groups
from oodscen.driving._sight.scene_checks import PlacedBody, bodies
from oodscen.driving._sight.visibility import Eye
from oodscen.protocols import Camera, Frame, State

_RING = 0.25
"""Width of the surroundings around a hazard, as a share of its size in the picture."""


def sighting(
    scene: Scene, state: State, frame: Frame, catalogue: Catalogue, camera: Camera
) -> Sighting | None:
    """Measure the hazard of a scene in a frame.

    A simulator whose frames hold no instance ids is measured by geometry alone, without contrast and light.

    Returns:
        The look of the unusual actor or group that is easiest to name; `None` if the hazard has no actors.
    """
    if not scene.hazard.actors or scene.is_ordinary:
        return None
    cast = bodies(scene, catalogue, state.poses)
    if frame.unhidden is None and not frame.ids.any():
        return drawn(scene, cast, load_corridor(scene.map, catalogue), camera)
    eye = Eye(camera, cast[0].solid)
    sightings = [_measured(scene, rows, cast, eye, frame) for rows in groups(scene, cast)]
    return best(sightings)


def _measured(
    scene: Scene, rows: Sequence[int], cast: Sequence[PlacedBody], eye: Eye, frame: Frame
) -> Sighting:
    """Measure actors of one asset, given by their rows in the state."""
    heights = {row: _extent(frame.ids == row + 1) for row in rows}
    # Bollards before a refrigerator leave its outline, and nothing that a viewer could name.
    unhidden_heights = {row: heights[row] * _visible_share(frame, row) for row in rows}
    row = max(rows, key=unhidden_heights.__getitem__)
    mask = np.isin(frame.ids, [row + 1 for row in rows])
    scale = SCALE_PX / frame.ids.shape[0]
    area_px = float(np.count_nonzero(mask))
    unhidden_px = 0 if frame.unhidden is None else int(frame.unhidden[list(rows)].sum())
    contrast = brightness = None
    if scene.hazard.weather is None:
        is_dark = scene.weather.sun_elevation_deg < DARK_DEG
        contrast, brightness = _look(frame.rgb, mask, is_dark=is_dark)
    return Sighting(
        actor=cast[row].id,
        distance_m=round(eye.distance(cast[row].solid), 1),
        height_px=round(scale * heights[row], 1),
        size_px=round(scale * apparent_size(unhidden_heights[row], area_px), 1),
        area_px=round(scale * scale * area_px, 1),
        hidden=round(1.0 - min(1.0, area_px / unhidden_px), 3) if unhidden_px else 0.0,
        contrast=contrast,
        brightness=brightness,
    )


def _visible_share(frame: Frame, row: int) -> float:
    """Return the share of a body that nothing hides, by its row in the state."""
    if frame.unhidden is None or not frame.unhidden[row]:
        return 1.0
    return min(1.0, np.count_nonzero(frame.ids == row + 1) / int(frame.unhidden[row]))


def _extent(mask: NDArray[np.bool_]) -> int:
    """Return the number of rows between the highest and the lowest pixel of a mask."""
    filled = np.flatnonzero(mask.any(axis=1))
    return int(filled[-1] - filled[0] + 1) if len(filled) else 0


def _look(
    rgb: NDArray[np.uint8], mask: NDArray[np.bool_], *, is_dark: bool
) -> tuple[float | None, float | None]:
    """Return the contrast of masked pixels with those around them and, in the dark, their brightness."""
    if not mask.any():
        return None, None
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    reach = max(2, round(_RING * max(len(rows), len(columns))))
    window = tuple(
        slice(max(0, int(filled[0]) - reach), int(filled[-1]) + reach + 1)
        for filled in (rows, columns)
    )
    inside, colours = mask[window], rgb[window].astype(np.float64) / 255.0
    hazard, surroundings = colours[inside], colours[~inside]
    contrast = None
    if len(surroundings):
        difference = hazard - surroundings.mean(axis=0)
        contrast = round(float(np.sqrt(np.mean(difference**2))), 4)
    if not is_dark:
        return contrast, None
    brightest = np.sort(hazard.mean(axis=1))[-max(1, len(hazard) // 10) :]
    return contrast, round(float(brightest.mean()), 4)
