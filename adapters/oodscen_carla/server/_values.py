"""Checks the arguments of remote calls: every value comes from outside."""

import math
from typing import Any, NamedTuple

Vector = tuple[float, float, float]

FARTHEST = 1e6
"""Maximum absolute value of coordinates, angles and speeds."""
MAX_TEXT = 1024
"""Maximum length of names and attributes."""
MAX_ATTRIBUTES = 64


class CallError(Exception):
    """A call that is refused; the client reads the text as the message of a `RuntimeError`."""


class Transform(NamedTuple):
    """A place and an attitude in CARLA's left-handed axes: x forward, y right, z up."""

    location: Vector
    """x, y, z, m."""
    rotation: Vector
    """Pitch, yaw, roll, degrees."""


class Description(NamedTuple):
    """The blueprint and the attributes with which an actor is spawned."""

    uid: int
    type_id: str
    attributes: tuple[tuple[str, int, str], ...]
    """Name, type code and value of each."""


class WorldSettings(NamedTuple):
    """`carla.WorldSettings` in the order of the wire."""

    is_synchronous: bool = False
    """True if only clients advance the world."""
    is_not_rendering: bool = False
    fixed_step_s: float | None = None
    """Duration of a tick, s; `None` or 0 for the server's own."""
    has_substeps: bool = True
    longest_substep_s: float = 0.01
    substeps: int = 10
    culling_distance_m: float = 0.0
    has_deterministic_ragdolls: bool = False
    tile_distance_m: float = 3000.0
    active_distance_m: float = 2000.0
    spectator_as_ego: bool = True

    def wire(self) -> list[Any]:
        """Return the settings as clients read them."""
        fixed = self.fixed_step_s
        return [*self[:2], [False] if fixed is None else [True, fixed], *self[3:]]


def number(value: Any, name: str = "a number") -> float:
    """Return a finite number."""
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        try:
            if math.isfinite(value) and abs(value) <= FARTHEST:
                return float(value)
        except OverflowError:
            pass
    raise CallError(f"{name} must be a number within ±1e6, not {str(value)[:40]!r}")


def whole(value: Any, name: str = "an id") -> int:
    """Return a whole number of 32 bits."""
    if type(value) is int and 0 <= value < 1 << 32:
        return value
    raise CallError(f"{name} must be a whole number of 32 bits, not {str(value)[:40]!r}")


def flag(value: Any, name: str = "a flag") -> bool:
    """Return a truth value."""
    if isinstance(value, bool):
        return value
    raise CallError(f"{name} must be true or false, not {str(value)[:40]!r}")


def text(value: Any, name: str = "a text", longest: int = MAX_TEXT) -> str:
    """Return a text."""
    if isinstance(value, str) and len(value) <= longest:
        return value
    raise CallError(f"{name} must be a text of at most {longest} characters")


def items(value: Any, name: str, length: int | None = None, longest: int = 100_000) -> list[Any]:
    """Return a list, of exactly `length` values if that is given."""
    if isinstance(value, list) and len(value) <= longest and length in (None, len(value)):
        return value
    expected = f"at most {longest:,}" if length is None else str(length)
    actual = f", not {len(value):,}" if isinstance(value, list) else ""
    raise CallError(f"{name} must be a list of {expected} values{actual}")


def vector(value: Any, name: str = "a vector") -> Vector:
    """Return three finite numbers."""
    x, y, z = items(value, name, 3)
    return number(x, name), number(y, name), number(z, name)


def transform(value: Any) -> Transform:
    """Return a place and an attitude."""
    location, rotation = items(value, "a transform", 2)
    return Transform(vector(location, "a location"), vector(rotation, "a rotation"))


def optional(value: Any, name: str) -> Any:
    """Return the value of CARLA's optional, `[False]` or `[True, value]`; `None` if there is none."""
    parts = items(value, name, longest=2)
    if parts and flag(parts[0], name):
        return items(parts, name, 2)[1]
    return None


def description(value: Any) -> Description:
    """Return the description of an actor to spawn."""
    uid, type_id, attribute_values = items(value, "an actor's description", 3)
    attributes = []
    for attribute in items(attribute_values, "the attributes", longest=MAX_ATTRIBUTES):
        name, kind, content = items(attribute, "an attribute", 3)
        attributes.append((text(name, "an attribute"), whole(kind), text(content, "an attribute")))
    return Description(whole(uid), text(type_id, "a blueprint"), tuple(attributes))


def world_settings(value: Any) -> WorldSettings:
    """Return the settings of a world."""
    values = items(value, "the settings", len(WorldSettings._fields))
    synchronous, blank, fixed, substepping, longest, substeps, culling, ragdolls, *rest = values
    tiles, active, as_ego = rest
    step = optional(fixed, "fixed_delta_seconds")
    if step is not None and not 0.0 <= number(step) <= 10.0:
        raise CallError("fixed_delta_seconds must be at most 10 s")
    return WorldSettings(
        is_synchronous=flag(synchronous),
        is_not_rendering=flag(blank),
        fixed_step_s=None if step is None else float(step),
        has_substeps=flag(substepping),
        longest_substep_s=_finite(longest),
        substeps=whole(substeps, "max_substeps"),
        culling_distance_m=_finite(culling),
        has_deterministic_ragdolls=flag(ragdolls),
        tile_distance_m=_finite(tiles),
        active_distance_m=_finite(active),
        spectator_as_ego=flag(as_ego),
    )


def _finite(value: Any) -> float:
    """Return a number as it came, if it is finite."""
    if isinstance(value, (int, float)) and math.isfinite(value):
        return value
    raise CallError("the settings must be numbers")
