"""The look of a hazard at the decision by geometry: boxes, road and air, without rendering."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from oodscen.data._scene import Scene
from oodscen.data._sighting import Sighting, apparent_size
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._sight.outlines import area, clipped
from oodscen.driving._sight.scene_checks import PlacedBody
from oodscen.driving._sight.visibility import Eye, Sight
from oodscen.driving._sight.weather import visual_range
from oodscen.protocols import Camera

SCALE_PX = 480.0
"""Rows of the picture in which sizes are stated."""


def groups(scene: Scene, cast: Sequence[PlacedBody]) -> list[list[int]]:
    """Return the rows of the unusual actors, those of the same asset together."""
    by_asset: dict[str, list[int]] = {}
    for row, body in enumerate(cast):
        if row and body.id in scene.hazard.actors:
            by_asset.setdefault(body.asset, []).append(row)
    return list(by_asset.values())


def best(sightings: Iterable[Sighting]) -> Sighting | None:
    """Return the look that has the fewest faults, then the largest one; `None` if there is none."""
    return min(
        sightings, key=lambda sighting: (len(sighting.faults), -sighting.size_px), default=None
    )


def drawn(
    scene: Scene, cast: Sequence[PlacedBody], corridor: Corridor, camera: Camera
) -> Sighting | None:
    """Return the look of the hazard by the outlines of boxes at the decision; the ego is the first of `cast`."""
    eye = Eye(camera, cast[0].solid)
    scale = SCALE_PX / camera.height
    sightings = []
    for rows in groups(scene, cast):
        looks = [_look(row, scene, cast, corridor, eye) for row in rows]
        tallest = max(looks, key=lambda look: look.height_px)
        area_px = 0.0
        for look in looks:  # `sum` rounds otherwise from Python 3.12 on.
            area_px += look.area_px
        sightings.append(
            Sighting(
                actor=tallest.actor,
                distance_m=round(tallest.sight.distance, 1),
                height_px=round(scale * tallest.height_px, 1),
                size_px=round(scale * apparent_size(tallest.height_px, area_px), 1),
                hidden=round(tallest.sight.hidden, 3),
            )
        )
    return best(sightings)


class _Look(NamedTuple):
    """The free part of one actor in the picture."""

    actor: str
    sight: Sight
    height_px: float
    """Height of its outline times the share that is not hidden."""
    area_px: float
    """Area of its outline times that share, square pixels."""


def _look(
    row: int, scene: Scene, cast: Sequence[PlacedBody], corridor: Corridor, eye: Eye
) -> _Look:
    """Return the look of the actor in a row; nothing of it is free beyond the visual range."""
    body = cast[row].solid
    others = [other.solid for i, other in enumerate(cast) if i not in (0, row)]
    sight = eye.see(body, others, corridor)
    free = 1.0 - sight.hidden if sight.distance <= visual_range(scene.weather) else 0.0
    outline = clipped(eye.silhouette(body), eye.camera.width, eye.camera.height)
    height_px = 0.0
    if area(outline):
        height_px = max(v for _, v in outline) - min(v for _, v in outline)
    return _Look(cast[row].id, sight, free * height_px, free * sight.area_px)
