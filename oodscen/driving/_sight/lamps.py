"""The rules by which road users have their lamps on: head and tail lamps, brake lamps."""

from oodscen.data._scene import Scene
from oodscen.driving._motion.behaviours.table import having

BRAKING = -1.0
"""Acceleration below which brake lamps are on, m/s^2."""
STANDING = 0.05
"""Speed below which a body counts as standing, m/s."""
_HOLDS_BRAKE = frozenset(having(lambda row: row.holds_brake))


def has_lamps_on(scene: Scene, actor_id: str) -> bool:
    """Return whether an actor or the ego has its lamps on: it drives, and visibility is reduced.

    Unlit actors never have lamps on, and neither do standing ones in the state "off", even at night.
    """
    weather = scene.weather
    is_bright = (
        weather.sun_elevation_deg > 3.0
        and weather.fog_visual_range_m > 1000.0
        and weather.precipitation == "none"
    )
    if is_bright:
        return False
    if actor_id == "ego":
        return True
    behaviours = {actor.id: (actor.behaviour.name, actor.state) for actor in scene.actors}
    name, state = behaviours.get(actor_id, ("stand", ""))
    return state != "unlit" and (name != "stand" or state not in ("", "off"))


def waits_in_traffic(scene: Scene, actor_id: str) -> bool:
    """Return whether an actor keeps its foot on the brake while it stands."""
    return any(
        actor.id == actor_id and actor.behaviour.name in _HOLDS_BRAKE for actor in scene.actors
    )


def is_braking(speed: float, acceleration: float, *, waits: bool) -> bool:
    """Return whether an actor has its brake lamps on; `waits` is what `waits_in_traffic` returns for it."""
    return acceleration < BRAKING or (waits and abs(speed) < STANDING)
