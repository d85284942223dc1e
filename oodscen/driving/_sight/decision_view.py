"""The look of a hazard at the decision by geometry: boxes, road and air, without rendering."""

from collections.abc import Iterable, Sequence

from oodscen.data._scene import Scene
from oodscen.data._sighting import Sighting, apparent_size
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._sight.scene_checks import PlacedBody
from oodscen.driving._sight.visibility import Eye, area, clipped, visual_range
from oodscen.protocols import Camera

SCALE_PX = 480.0
"""Rows of the picture in which sizes are stated."""


def groups(scene: Scene, cast: Sequence[PlacedBody]) -> list[list[int]]:
    """Return the rows of the unusual actors, those of the same asset together."""
    found: dict[str, list[int]] = {}
    for row, body in enumerate(cast):
        if row and body.id in scene.hazard.actors:
            found.setdefault(body.asset, []).append(row)
    return list(found.values())


def best(found: Iterable[Sighting]) -> Sighting | None:
    """Return the look that has the fewest faults, then the largest one; `None` if there is none."""
    return min(found, key=lambda sighting: (len(sighting.faults), -sighting.size_px), default=None)


def drawn(
    scene: Scene, cast: Sequence[PlacedBody], corridor: Corridor, camera: Camera
) -> Sighting | None:
    """Return the look of the hazard by the outlines of boxes at the decision; the ego is the first of `cast`."""
    eye = Eye(camera, cast[0].solid)
    reach = visual_range(scene.weather)
    scale = SCALE_PX / camera.height
    found = []
    for rows in groups(scene, cast):
        total, parts = 0.0, []
        for row in rows:
            body = cast[row].solid
            others = [placed_body.solid for i, placed_body in enumerate(cast) if i not in (0, row)]
            sight = eye.see(body, others, corridor)
            shown = clipped(eye.silhouette(body), camera.width, camera.height)
            free = 1.0 - sight.hidden if sight.distance <= reach else 0.0
            height = max(v for _, v in shown) - min(v for _, v in shown) if area(shown) else 0.0
            total += free * sight.area_px
            parts.append((free * height, sight, cast[row]))
        height, sight, who = max(parts, key=lambda part: part[0])
        found.append(
            Sighting(
                actor=who.id,
                distance_m=round(sight.distance, 1),
                height_px=round(scale * height, 1),
                size_px=round(scale * apparent_size(height, total), 1),
                hidden=round(sight.hidden, 3),
            )
        )
    return best(found)
