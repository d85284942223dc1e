"""Checks that a scene shows what it claims, judged from the moments shown to a model."""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from oodscen.data._catalogue import FLAT_M, Catalogue
from oodscen.data._scene import Scene
from oodscen.driving._motion.boxes import Box, gap, radius
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._sight.visibility import Eye, Solid, is_noticeable
from oodscen.errors import Issue
from oodscen.protocols import Camera

AFLOAT_M = 0.3
"""Maximum height of a body's underside above the road, m."""
SUNK_M = 0.1
"""Maximum depth of a body's underside below the road, m."""
CAMERA = Camera()
"""The dash camera, in which the hazard must be visible."""

_WHEN = {"first": "at the start", "middle": "half-way", "last": "at the decision"}
_AIRBORNE = frozenset({"fall", "blown"})
"""Behaviours that leave the ground."""


class Body(NamedTuple):
    """One body of a scene at one moment."""

    id: str
    asset: str
    solid: Solid

    def __str__(self) -> str:
        x, y, z, yaw = self.solid.x, self.solid.y, self.solid.z, self.solid.yaw
        place = f"x={x:.1f} y={y:.1f} z={z:.1f} yaw={math.degrees(yaw):.0f} deg"
        return f"{self.id!r} ({self.asset}) at {place}"

    @property
    def box(self) -> Box:
        """The body's footprint."""
        one = self.solid
        return Box(one.x, one.y, one.yaw, one.length, one.width)


Moments = Mapping[str, Sequence[Body]]
"""All bodies at `first`, `middle` and `last`, the ego first."""


def bodies(scene: Scene, catalogue: Catalogue, poses: NDArray[np.float64]) -> tuple[Body, ...]:
    """Return all bodies at the given poses, the ego first.

    Args:
        scene: The scene of the actors.
        catalogue: Source of their sizes.
        poses: [n, 4], x, y, z and yaw.
    """
    return tuple(
        Body(name, asset.id, Solid(x, y, z, yaw, asset.length, asset.width, asset.height))
        for (name, asset, _), (x, y, z, yaw) in zip(
            catalogue.bodies(scene), poses.tolist(), strict=True
        )
    )


def truth_issues(
    scene: Scene, corridor: Corridor, moments: Moments, *, camera: Camera = CAMERA
) -> list[Issue]:
    """Return issues that would make a person doubt what a scene is said to show.

    In at least one moment the hazard must be visible, or the weather must clearly differ from the ordinary
    weather; no body may float, sink or stand inside another.

    Args:
        scene: The scene of the moments.
        corridor: The scene's road.
        moments: All bodies at the key moments.
        camera: The camera that shows them.
    """
    issues = floating(scene, corridor, moments) + overlapping(scene, moments)
    if scene.is_twin:
        return issues
    hazard = scene.hazard
    if hazard.weather is not None and not is_noticeable(scene.weather, hazard.weather):
        message = "the weather hardly differs from the ordinary: nobody would notice it"
        issues.append(Issue("hazard.weather", message))
    if hazard.actors and not seen(scene, corridor, moments, camera):
        issues.append(_unseen(scene, corridor, moments, camera))
    return issues


def seen(
    scene: Scene, corridor: Corridor, moments: Moments, camera: Camera = CAMERA
) -> dict[str, str]:
    """Return the recognisable unusual actors, each with the first moment at which it can be recognised."""
    found: dict[str, str] = {}
    for moment, cast in moments.items():
        eye = Eye(camera, cast[0].solid)
        for row, body in enumerate(cast):
            if body.id in scene.hazard.actors and body.id not in found:
                others = [one.solid for i, one in enumerate(cast) if i not in (0, row)]
                sight = eye.see(body.solid, others, corridor)
                if sight.fault(scene.weather, camera) is None:
                    found[body.id] = moment
    return found


def floating(scene: Scene, corridor: Corridor, moments: Moments) -> list[Issue]:
    """Return issues for bodies above or below the ground, unless they are carried or fly."""
    exempt = {
        actor.id
        for actor in scene.actors
        if actor.behaviour.other is not None or actor.behaviour.name in _AIRBORNE
    }
    rows = {actor.id: row for row, actor in enumerate(scene.actors)}
    issues: dict[str, Issue] = {}
    for moment, cast in moments.items():
        for body in cast[1:]:
            if body.id in exempt or body.id in issues:
                continue
            s, t = corridor.locate(body.solid.x, body.solid.y)
            height = body.solid.z - corridor.point(s, t)[2]
            if not -SUNK_M <= height <= AFLOAT_M:
                what = "floats above" if height > 0.0 else "sinks below"
                message = f"{body} {what} the road by {abs(height):.2f} m {_WHEN[moment]}"
                issues[body.id] = Issue(f"actors[{rows[body.id]}].placement", message)
    return list(issues.values())


def overlapping(scene: Scene, moments: Moments) -> list[Issue]:
    """Return issues for actors inside one another at a moment, unless one belongs to the other."""
    owners = {"ego": None} | {actor.id: actor.behaviour.other for actor in scene.actors}
    issues: dict[tuple[str, str], Issue] = {}
    for moment, cast in moments.items():
        for row, body in enumerate(cast):
            for other in cast[:row]:
                pair = (other.id, body.id)
                if pair in issues or owners[body.id] == other.id or owners[other.id] == body.id:
                    continue
                if touch(body, other):
                    field = "placement" if moment == "first" else "behaviour"
                    message = f"{body} overlaps {other} {_WHEN[moment]}"
                    issues[pair] = Issue(f"actors[{row - 1}].{field}", message)
    return list(issues.values())


def touch(a: Body, b: Body, *, is_tall: bool = True) -> bool:
    """Return whether two bodies touch.

    Args:
        a: The first body.
        b: The second body.
        is_tall: Ignore bodies that lie flat on the road, since others may stand on them.
    """
    if is_tall and min(a.solid.height, b.solid.height) < FLAT_M:
        return False
    if a.solid.z > b.solid.z + b.solid.height or b.solid.z > a.solid.z + a.solid.height:
        return False
    one, other = a.box, b.box
    reach = radius(one.length, one.width) + radius(other.length, other.width)
    dx, dy = one.x - other.x, one.y - other.y
    return dx * dx + dy * dy <= reach * reach and gap(one, other) <= 0.0


def _unseen(scene: Scene, corridor: Corridor, moments: Moments, camera: Camera) -> Issue:
    """Return an issue with the reason why an unusual actor is never visible, for the moment that comes closest."""
    best: tuple[float, str, list[str]] | None = None
    for row, actor in enumerate(scene.actors, start=1):
        if actor.id not in scene.hazard.actors:
            continue
        largest, reasons = 0.0, []
        for moment, cast in moments.items():
            others = [one.solid for i, one in enumerate(cast) if i not in (0, row)]
            sight = Eye(camera, cast[0].solid).see(cast[row].solid, others, corridor)
            largest = max(largest, sight.area_px)
            reasons.append(f"{_WHEN[moment]} {sight.fault(scene.weather, camera)}")
        if best is None or largest > best[0]:
            last = list(moments.values())[-1][row]
            best = (largest, f"actors[{row - 1}]", [str(last), *reasons])
    assert best is not None, "asked only where there are unusual actors"
    _, path, (who, *reasons) = best
    return Issue(path, f"{who} cannot be seen in any frame: {'; '.join(reasons)}")
