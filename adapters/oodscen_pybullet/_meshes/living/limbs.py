"""Arms and legs: joints from the positions of hands and feet, and the motion of feet in a stride."""

import math

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._types import Point

_LEAST_M = 1e-6
"""Length that stands for none where it is divided by, m."""


def joint(start: Point, end: Point, one: float, two: float, bend: Point) -> tuple[Point, Point]:
    """Return the joint between two bones, and the end, moved within reach if necessary.

    Args:
        start: Hip or shoulder.
        end: Desired position of the foot or hand.
        one: Length of the bone at the start.
        two: Length of the bone at the end.
        bend: Direction in which the joint points.
    """
    way = tuple(b - a for a, b in zip(start, end, strict=True))
    length = math.sqrt(sum(v * v for v in way)) or _LEAST_M
    reach = min(length, 0.999 * (one + two))
    unit = tuple(v / length for v in way)
    along = (one * one - two * two + reach * reach) / (2 * reach)
    out = math.sqrt(max(0.0, one * one - along * along))
    lean = sum(b * u for b, u in zip(bend, unit, strict=True))
    across = [b - lean * u for b, u in zip(bend, unit, strict=True)]
    size = math.sqrt(sum(v * v for v in across)) or _LEAST_M
    middle = [s + u * along + v / size * out for s, u, v in zip(start, unit, across, strict=True)]
    last = [s + u * reach for s, u in zip(start, unit, strict=True)]
    return (middle[0], middle[1], middle[2]), (last[0], last[1], last[2])


def limb(
    mesh: MeshBuilder,
    points: tuple[Point, Point, Point],
    radii: tuple[float, float, float],
    colours: tuple[str, str],
) -> None:
    """Add two round, tapered bones."""
    start, middle, end = points
    mesh.cylinder(start, middle, radii[0], colours[0], sides=6, end_radius=radii[1])
    mesh.cylinder(middle, end, radii[1], colours[1], sides=6, end_radius=radii[2])


def stride(phase: float, half: float, lift: float, stance: float) -> tuple[float, float]:
    """Return a foot's position ahead of the hip and its height above the ground, m.

    Args:
        phase: Completed fraction of the stride; at 0 the foot touches down.
        half: Largest distance ahead of and behind the hip while on the ground, m.
        lift: Height of the swing, m.
        stance: Fraction of the stride during which the foot is on the ground.
    """
    phase -= math.floor(phase)
    if phase < stance:
        return half * (1.0 - 2.0 * phase / stance), 0.0
    swing = (phase - stance) / (1.0 - stance)
    return half * (2.0 * swing - 1.0), lift * 4.0 * swing * (1.0 - swing)
