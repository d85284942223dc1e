"""The look of a hazard in the frame at the decision, and the floor below which a viewer cannot name it."""

import math
from typing import ClassVar

from oodscen.data._base import Data

LEAST_SIZE_PX = 24.0
"""Least size of a hazard at the decision, pixels of a picture with 480 rows."""
LEAST_CONTRAST = 0.04
"""Least contrast of a hazard against its surroundings."""
LEAST_SIGNAL = 1.2
"""Least product of a hazard's contrast and the root of its visible pixels: the smaller, the more contrast it needs."""
LEAST_BRIGHTNESS = 0.08
"""Least brightness of a hazard at night."""
TO_NAME = "to name the hazard: "
"""Beginning of a re-staging whose reason is the floor."""
MOST_HIDDEN = 0.8
"""Greatest share of a hazard behind other things."""


def apparent_size(height: float, area: float) -> float:
    """Return the size in a picture of something with a height and an area, pixels.

    Upright things are as large as they are high. What lies flat or is low and wide counts as a square of its
    area, but no more than twice its height, since a thin line shows no shape.
    """
    return max(height, min(math.sqrt(area), 2.0 * height))


class Sighting(Data):
    """The look of a scene's hazard in the frame at the decision.

    Unusual actors of the same asset, such as a flock, count as one thing. Of several things the one that is
    easiest to name is measured.
    """

    noun: ClassVar[str] = "sighting"

    actor: str
    """Id of the actor; of a group, that of the member that shows most. The height is its own; area, share behind other
    things, contrast and brightness are those of the group."""
    distance_m: float
    """Distance from the camera to the middle of its box, m."""
    height_px: float
    """Height of the actor's visible pixels, scaled to a picture with 480 rows."""
    size_px: float
    """The measure of its size: the actor's height less the share of it that is hidden, or for what is low and wide the
    side of a square of the area, but no more than twice that height; see `apparent_size`."""
    area_px: float | None = None
    """Number of its visible pixels, scaled to a picture with 480 rows; `None` without segmentation."""
    hidden: float = 0.0
    """Share of it behind other things, 0 to 1."""
    contrast: float | None = None
    """Root mean square difference of its pixels from its surroundings' mean colour, 0 to 1; `None` without
    segmentation, and where the weather is part of the hazard."""
    brightness: float | None = None
    """Mean of the brightest tenth of its pixels, 0 to 1; `None` by day, and as for the contrast."""

    @property
    def faults(self) -> tuple[str, ...]:
        """Reasons why a viewer cannot name it: `outside`, `hidden`, `small`, `faint` or `dark`."""
        if self.size_px <= 0.0:
            return ("hidden",) if self.hidden > MOST_HIDDEN else ("outside",)
        found = {
            "small": self.size_px < LEAST_SIZE_PX,
            "hidden": self.hidden > MOST_HIDDEN,
            "faint": self._is_faint,
            "dark": self.brightness is not None and self.brightness < LEAST_BRIGHTNESS,
        }
        return tuple(name for name, holds in found.items() if holds)

    @property
    def _is_faint(self) -> bool:
        if self.contrast is None:
            return False
        signal = math.inf if self.area_px is None else self.contrast * math.sqrt(self.area_px)
        return self.contrast < LEAST_CONTRAST or signal < LEAST_SIGNAL
