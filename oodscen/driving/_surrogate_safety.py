"""Surrogate safety measures of footprints: time to collision, time headway and post-encroachment time.

Everything is NumPy over arrays of bodies and uses only + - * / and square roots, so that the last
bit does not depend on the machine.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from oodscen.numerics._exact import Floats

TTC_LIMIT_S = 60.0
"""Time beyond which a collision counts as none, s."""
LEAST_SPEED_MPS = 0.1
"""Speed of the ego below which there is no time headway, m/s."""
_STILL_MPS = 1e-9
"""Closing speed below which bodies keep their distance along an axis, m/s."""
_MOST_PAIRS = 1_000_000
"""Footprints of the ego and of actors that are compared at once; more would need much memory."""


class Footprints(NamedTuple):
    """Oriented boxes on the ground; all arrays have, or broadcast to, one shape."""

    x: Floats
    y: Floats
    cos: Floats
    """Cosine of the heading."""
    sin: Floats
    half_length: Floats
    half_width: Floats

    def at(self, *index: Any) -> "Footprints":
        """Return the footprints at an index into all arrays."""
        return Footprints(*(array[index] for array in self))


def time_to_collision(a: Footprints, b: Footprints, vx: Floats, vy: Floats) -> Floats:
    """Return the time until two footprints touch if both keep their velocity and heading, s.

    The footprints are oriented boxes. Two convex shapes that move without turning touch when their
    projections overlap on every edge normal (separating axes in time: Eberly, "Intersection of Convex
    Objects: The Method of Separating Axes", 2008). Time to collision: Hayward, "Near-miss determination
    through use of a scale of danger", 1972.

    Args:
        a: The first body's boxes.
        b: The second body's boxes.
        vx: World x velocity of `b` minus that of `a`, m/s.
        vy: World y velocity of `b` minus that of `a`, m/s.

    Returns:
        Seconds; 0 if they overlap, infinity if they do not touch within `TTC_LIMIT_S`.
    """
    dx, dy = b.x - a.x, b.y - a.y
    enter = np.zeros(np.broadcast_shapes(dx.shape, vx.shape))
    leave = np.full(enter.shape, np.inf)
    for ux, uy, reach in _axes(a, b):
        place, speed = dx * ux + dy * uy, vx * ux + vy * uy
        is_still = np.abs(speed) < _STILL_MPS
        divisor = np.where(is_still, 1.0, speed)
        from_below, from_above = (-reach - place) / divisor, (reach - place) / divisor
        is_apart = np.abs(place) > reach
        always_or_never = np.where(is_apart, np.inf, -np.inf)
        first = np.where(is_still, always_or_never, np.minimum(from_below, from_above))
        last = np.where(is_still, np.inf, np.maximum(from_below, from_above))
        enter, leave = np.maximum(enter, first), np.minimum(leave, last)
    return np.where((enter <= leave) & (enter <= TTC_LIMIT_S), enter, np.inf)


def overlap(a: Footprints, b: Footprints) -> NDArray[np.bool_]:
    """Return which boxes overlap or touch."""
    dx, dy = b.x - a.x, b.y - a.y
    touches = [np.abs(dx * ux + dy * uy) <= reach for ux, uy, reach in _axes(a, b)]
    return np.asarray(np.all(touches, axis=0))


def _axes(a: Footprints, b: Footprints) -> Iterator[tuple[Floats, Floats, Floats]]:
    """Yield every edge normal of two boxes, and the distance of the centres along it at which the boxes touch, m."""
    cos = np.abs(a.cos * b.cos + a.sin * b.sin)
    sin = np.abs(a.cos * b.sin - a.sin * b.cos)
    for one, other in ((a, b), (b, a)):
        along = one.half_length + other.half_length * cos + other.half_width * sin
        across = one.half_width + other.half_length * sin + other.half_width * cos
        yield one.cos, one.sin, along
        yield -one.sin, one.cos, across


def post_encroachment(ego: Footprints, others: Footprints, time: Floats) -> Floats:
    """Return every actor's post-encroachment time relative to the ego, s, accurate to one step.

    The conflict area is the ground that both footprints sweep. At each place in it, the time is that
    between one body leaving and the other arriving (Allen, Shin and Cooper, "Analysis of traffic
    conflicts and collisions", 1978). The minimum over the area is returned: 0 if they met, infinity
    if their paths share no ground.

    Args:
        ego: The ego's footprints, arrays [steps].
        others: The actors' footprints, arrays [steps, actors].
        time: Time of each step, [steps], s.
    """
    steps, count = others.x.shape
    times = np.full(count, np.inf)
    if not count or not steps:
        return times
    reach = np.sqrt(ego.half_length[0] ** 2 + ego.half_width[0] ** 2) + np.sqrt(
        others.half_length[0] ** 2 + others.half_width[0] ** 2
    )
    block = max(1, _MOST_PAIRS // others.x.size)
    for first in range(0, steps, block):
        dx = others.x[None, :, :] - ego.x[first : first + block, None, None]
        dy = others.y[None, :, :] - ego.y[first : first + block, None, None]
        row, actor_step, actor = np.nonzero(dx * dx + dy * dy <= reach * reach)
        ego_step = first + row
        shares_ground = overlap(ego.at(ego_step), others.at(actor_step, actor))
        apart = np.abs(time[ego_step] - time[actor_step])[shares_ground]
        np.minimum.at(times, actor[shares_ground], apart)
    return times


def time_headway(
    ahead: Floats, ego_speed: Floats, lengths: Floats, aside: Floats, widths: Floats
) -> Floats:
    """Return the ego's time headway to the rear of each actor in its path, s.

    Source: Vogel, "A comparison of headway and time to collision as safety indicators", 2003; the
    gap is measured from front to rear.

    Args:
        ahead: Distance from the ego's centre to the actor's along the road, m.
        ego_speed: The ego's speed, m/s.
        lengths: Sum of both half extents along the road, m.
        aside: Distance from the ego's centre to the actor's across the road, m.
        widths: Sum of both half extents across the road, m.
    """
    gap = np.maximum(ahead - lengths, 0.0)
    is_ahead = (ahead > 0.0) & (np.abs(aside) < widths) & (ego_speed > LEAST_SPEED_MPS)
    return np.where(is_ahead, gap / np.where(is_ahead, ego_speed, 1.0), np.inf)
