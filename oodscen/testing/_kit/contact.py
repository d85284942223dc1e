"""Checks that a simulator's gaps are those between the boxes of its catalogue."""

import math
from collections.abc import Sequence

import numpy as np

from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import Scene
from oodscen.driving._motion.boxes import Footprint, gap
from oodscen.driving._trace import Course
from oodscen.protocols import State

NEAR_M = 20.0
"""Distance up to which a gap must be finite, m."""
TOLERANCE_M = 0.05
"""Tolerance between a simulator's gap and that of the boxes, m."""


def gap_fault(states: Sequence[State], scene: Scene, catalogue: Catalogue) -> str:
    """Return a message about the first gap that is not that between two boxes, or an empty string.

    Time to collision, post-encroachment time and the scene checks use the catalogue's boxes. A gap to
    anything else would therefore call safe what they call a collision.
    """
    course = Course.of(scene, catalogue)
    road, sizes = course.corridor, course.sizes
    for state in states:
        rows = state.poses.tolist()
        boxes = [
            Footprint(x, y, yaw, *size)
            for (x, y, _, yaw), size in zip(rows, sizes[:, :2].tolist(), strict=True)
        ]
        for row in range(1, len(rows)):
            level, reported = gap(boxes[0], boxes[row]), float(state.gaps[row])
            if course.passable[row] or (level > NEAR_M and math.isinf(reported)):
                continue
            ground = float(np.interp(road.locate(*rows[row][:2])[0], road.s, road.z))
            above = max(0.0, rows[row][2] - ground - float(sizes[0, 2]))
            expected = math.hypot(level, above)
            if not abs(reported - expected) <= TOLERANCE_M:
                return (
                    f"the gap to {state.ids[row]!r} is {reported:.2f} m, between the boxes "
                    f"{expected:.2f} m"
                )
    return ""
