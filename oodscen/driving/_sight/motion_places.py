"""The check that motions made to order stay on the map."""

from collections.abc import Iterable

from oodscen.data._designs.motion import Motion
from oodscen.data._scene import Actor, Scene
from oodscen.driving._roads.corridor import Corridor, neighbour_strip
from oodscen.errors import Issue
from oodscen.numerics._exact import PI, sincos

BESIDE_M = 60.0
"""Distance from the road up to which a body may move, m: there is land beside every road."""


def motion_places(
    scene: Scene, actors: Iterable[tuple[str, Actor]], corridor: Corridor, ego_lane: int
) -> list[Issue]:
    """Return an issue for every motion that takes an actor off the map, with the path of the key.

    Motions in the frame of another body are not checked: its way is not known before it is driven. The actors come
    with their paths, ordinary counterparts included.
    """
    numbers = {motion.id: number for number, motion in enumerate(scene.motions)}
    issues: dict[str, Issue] = {}
    for _, actor in actors:
        number = numbers.get(actor.behaviour.name)
        if number is None or scene.motions[number].frame in ("other", "ego"):
            continue
        motion = scene.motions[number]
        for key, (s, t) in enumerate(_places(motion, actor, corridor, ego_lane)):
            part = f"keys[{key}]" if motion.keys else motion.course
            path = f"motions[{number}].{part}"
            right, left = corridor.extent(min(max(s, 0.0), corridor.length))
            is_off = not 0.0 <= s <= corridor.length
            if is_off or not right - BESIDE_M <= t <= left + BESIDE_M:
                pose = motion.poses()[key]
                message = (
                    f"{pose.ahead:.4g} m ahead and {pose.left:.4g} m to the left of where "
                    f"{actor.id!r} starts is beyond the map"
                )
                issues.setdefault(path, Issue(path, message))
    return list(issues.values())


def _places(
    motion: Motion, actor: Actor, corridor: Corridor, ego_lane: int
) -> list[tuple[float, float]]:
    """Return s and t of an actor at every key, m."""
    place = actor.placement
    lane = neighbour_strip(corridor, ego_lane, place.lane)
    s = corridor.start + place.ahead_m
    t = corridor.centre(lane, s) + place.offset_m
    if motion.frame == "lane":
        return [(s + pose.ahead, t + pose.left) for pose in motion.poses()]
    x, y, _, road = corridor.point(s, t)
    turn = place.heading_deg * PI / 180.0 + (PI if corridor.strips[lane].direction < 0 else 0.0)
    sine, cosine = sincos(road + turn)
    return [
        corridor.locate(
            x + pose.ahead * cosine - pose.left * sine, y + pose.ahead * sine + pose.left * cosine
        )
        for pose in motion.poses()
    ]
