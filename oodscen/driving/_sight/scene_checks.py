"""Checks that a scene shows what it claims, judged from the moments shown to a model."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from oodscen.data._catalogue import Catalogue
from oodscen.data._designs.prop import FLAT_M
from oodscen.data._scene import Scene
from oodscen.driving._motion.behaviours.table import having
from oodscen.driving._motion.boxes import Footprint, gap, radius
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._sight.visibility import Eye, UprightBox
from oodscen.driving._sight.weather import is_noticeable
from oodscen.errors import Issue, SceneError
from oodscen.protocols import Camera

AFLOAT_M = 0.3
"""Maximum height of a body's underside above the road, m."""
SUNK_M = 0.1
"""Maximum depth of a body's underside below the road, m."""
CAMERA = Camera()
"""The dash camera, in which the hazard must be visible."""

_AIRBORNE = frozenset(having(lambda row: row.leaves_ground))
_NEAREST_M = 6.0
"""Least distance from the ego at which to look for a place where a hidden body would be seen, m."""
_SHARES = (0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2)
"""Shares of a hidden body's distance, and of its offset, at which to look for it."""
_MOST_OVERLAPS = 100
"""Maximum number of overlaps of a scene that are reported."""
_WHEN = {"first": "at the start", "middle": "half-way", "last": "at the decision"}


class PlacedBody(NamedTuple):
    """One body of a scene at one moment."""

    id: str
    asset: str
    solid: UprightBox

    def __str__(self) -> str:
        return f"{self.id!r} ({self.asset})"

    def at(self, scene: Scene, corridor: Corridor) -> str:
        """Return the body with its place as a placement relative to the ego's lane."""
        s, t = corridor.locate(self.solid.x, self.solid.y)
        turn = math.degrees(math.remainder(self.solid.yaw - corridor.heading(s), math.tau))
        return (
            f"{self} at ahead_m {s - corridor.start:.1f}, offset_m "
            f"{_aside(scene, corridor, s, t) + 0.0:.1f} from the ego's lane, heading {turn + 0.0:.0f} deg against the road"
        )

    @property
    def box(self) -> Footprint:
        """The body's footprint."""
        solid = self.solid
        return Footprint(solid.x, solid.y, solid.yaw, solid.length, solid.width)


Moments = Mapping[str, Sequence[PlacedBody]]
"""All bodies at `first`, `middle` and `last`, the ego first."""


def bodies(
    scene: Scene, catalogue: Catalogue, poses: NDArray[np.float64]
) -> tuple[PlacedBody, ...]:
    """Return all bodies at poses, [n, 4], the ego first.

    Raises:
        SceneError: If the catalogue lacks the asset of an actor.
    """
    try:
        kinds = catalogue.bodies(scene)
    except KeyError as error:
        raise SceneError(
            scene.id, [Issue("actors", f"the catalogue has no asset {error}")]
        ) from None
    return tuple(
        PlacedBody(
            name, asset.id, UprightBox(x, y, z, yaw, asset.length, asset.width, asset.height)
        )
        for (name, asset, _), (x, y, z, yaw) in zip(kinds, poses.tolist(), strict=True)
    )


def truth_issues(
    scene: Scene, corridor: Corridor, moments: Moments, *, camera: Camera = CAMERA
) -> list[Issue]:
    """Return issues that would make a person doubt that a scene shows its hazard.

    In at least one moment the hazard must be visible, or the weather must clearly differ from the ordinary
    weather; no body may float, sink or stand inside another.
    """
    issues = floating_issues(scene, corridor, moments) + overlap_issues(scene, corridor, moments)
    if scene.is_ordinary:
        return issues
    hazard = scene.hazard
    if hazard.weather is not None and not is_noticeable(scene.weather, hazard.weather):
        message = "the weather hardly differs from the ordinary: nobody would notice it"
        issues.append(Issue("hazard.weather", message))
    if hazard.actors and not first_seen(scene, corridor, moments, camera):
        issues.append(_unseen(scene, corridor, moments, camera))
    return issues


def first_seen(
    scene: Scene, corridor: Corridor, moments: Moments, camera: Camera = CAMERA
) -> dict[str, str]:
    """Return the recognisable unusual actors, each with the first moment at which it can be recognised."""
    first: dict[str, str] = {}
    for moment, cast in moments.items():
        eye = Eye(camera, cast[0].solid)
        for row, body in enumerate(cast):
            if body.id in scene.hazard.actors and body.id not in first:
                others = [other.solid for other in _others(scene, cast, row)]
                sight = eye.see(body.solid, others, corridor)
                if sight.fault(scene.weather, camera) is None:
                    first[body.id] = moment
    return first


def floating_issues(scene: Scene, corridor: Corridor, moments: Moments) -> list[Issue]:
    """Return issues for bodies above or below the ground, unless they are carried or fly."""
    airborne = _AIRBORNE | {motion.id for motion in scene.motions}
    exempt = {
        actor.id
        for actor in scene.actors
        if actor.behaviour.other is not None or actor.behaviour.name in airborne
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
                fault = "floats above" if height > 0.0 else "sinks below"
                message = f"{body.at(scene, corridor)} {fault} the road by {abs(height):.2f} m {_WHEN[moment]}"
                issues[body.id] = Issue(f"actors[{rows[body.id]}].placement", message)
    return list(issues.values())


def overlap_issues(scene: Scene, corridor: Corridor, moments: Moments) -> list[Issue]:
    """Return issues for actors inside one another at a moment, unless one belongs to the other.

    Of more than `_MOST_OVERLAPS` the first are returned.
    """
    owners = {"ego": None} | {actor.id: actor.behaviour.other for actor in scene.actors}
    issues: dict[tuple[str, str], Issue] = {}
    for moment, cast in moments.items():
        for row, body in enumerate(cast):
            for other in cast[:row]:
                pair = (other.id, body.id)
                if pair in issues or owners[body.id] == other.id or owners[other.id] == body.id:
                    continue
                if touch(body, other):
                    if len(issues) == _MOST_OVERLAPS:
                        return list(issues.values())
                    field = "placement" if moment == "first" else "behaviour"
                    message = (
                        f"{body.at(scene, corridor)} overlaps {other.at(scene, corridor)} "
                        f"{_WHEN[moment]}"
                    )
                    issues[pair] = Issue(f"actors[{row - 1}].{field}", message)
    return list(issues.values())


def touch(a: PlacedBody, b: PlacedBody, *, ignores_flat: bool = True) -> bool:
    """Return whether two bodies touch; with `ignores_flat`, one that lies flat on the road touches nothing."""
    if ignores_flat and min(a.solid.height, b.solid.height) < FLAT_M:
        return False
    if a.solid.z > b.solid.z + b.solid.height or b.solid.z > a.solid.z + a.solid.height:
        return False
    footprint, other = a.box, b.box
    reach = radius(footprint.length, footprint.width) + radius(other.length, other.width)
    dx, dy = footprint.x - other.x, footprint.y - other.y
    return dx * dx + dy * dy <= reach * reach and gap(footprint, other) <= 0.0


def _unseen(scene: Scene, corridor: Corridor, moments: Moments, camera: Camera) -> Issue:
    """Return why the unusual actor that comes closest to being visible is never seen."""
    best: tuple[float, int] | None = None
    reasons: dict[int, list[str]] = {}
    for row, actor in enumerate(scene.actors, start=1):
        if actor.id not in scene.hazard.actors:
            continue
        largest = 0.0
        for moment, cast in moments.items():
            eye, body, others = (
                Eye(camera, cast[0].solid),
                cast[row].solid,
                _others(scene, cast, row),
            )
            sight = eye.see(body, [other.solid for other in others], corridor)
            largest = max(largest, sight.area_px)
            fault = sight.fault(scene.weather, camera)
            is_hidden = fault is not None and fault.endswith("hidden")
            by = _hider(eye, body, others, corridor) if is_hidden else ""
            reasons.setdefault(row, []).append(f"{_WHEN[moment]} {fault}{by}")
        if best is None or largest > best[0]:
            best = largest, row
    assert best is not None, "called only for scenes with unusual actors"
    row, cast = best[1], list(moments.values())[-1]
    actor_words, reason = cast[row].at(scene, corridor), "; ".join(reasons[row])
    hint = _nearer(scene, corridor, cast, row, camera)
    return Issue(f"actors[{row - 1}]", f"{actor_words} cannot be seen in any frame: {reason}{hint}")


def _others(scene: Scene, cast: Sequence[PlacedBody], row: int) -> list[PlacedBody]:
    """Return the bodies that may hide a body; its carrier is hollow and hides nothing."""
    carrier = scene.actors[row - 1].behaviour.other
    return [body for i, body in enumerate(cast) if i not in (0, row) and body.id != carrier]


def _hider(eye: Eye, body: UprightBox, others: Sequence[PlacedBody], corridor: Corridor) -> str:
    """Return the words for the thing that hides most of a body."""
    shares = [(eye.see(body, [other.solid]).hidden, f" by {other}") for other in others]
    shares.append((eye.see(body, (), corridor).hidden, " by the crest of the road"))
    return max(shares, key=lambda share: share[0])[1]


def _nearer(
    scene: Scene, corridor: Corridor, cast: Sequence[PlacedBody], row: int, camera: Camera
) -> str:
    """Return the words for the nearest place at which a body would be seen at the decision."""
    ego, body = cast[0].solid, cast[row].solid
    eye, others = Eye(camera, ego), [other.solid for other in _others(scene, cast, row)]
    s, t = corridor.locate(body.x, body.y)
    ego_s, _ = corridor.locate(ego.x, ego.y)

    def is_seen(at: float, beside: float) -> bool:
        x, y, z, heading = corridor.point(at, beside)
        moved = replace(body, x=x, y=y, z=z, yaw=heading + body.yaw - corridor.heading(s))
        return eye.see(moved, others, corridor).fault(scene.weather, camera) is None

    away = s - ego_s
    hint = f"; at the decision it is {away:.0f} m ahead of the ego and would be seen "
    for share in _SHARES:
        if share * away > _NEAREST_M and is_seen(ego_s + share * away, t):
            return f"{hint}{share * away:.0f} m ahead of it at the same offset"
    aside = _aside(scene, corridor, s, t)
    for share in _SHARES:
        if away > _NEAREST_M and is_seen(s, t + (share - 1.0) * aside):
            return f"{hint}there at offset_m {share * aside:.1f} from the ego's lane"
    return ""


def _aside(scene: Scene, corridor: Corridor, s: float, t: float) -> float:
    """Return the distance of a point from the middle of the ego's lane, m, left positive."""
    lane = corridor.ego_lanes[min(scene.ego.lane, len(corridor.ego_lanes) - 1)]
    return t - corridor.centre(lane, s)
