"""The place of road users within their lane: a little to one side of its middle."""

import numpy as np

from oodscen.data._scene import Actor
from oodscen.driving._motion.behaviours.table import DRIVES_IN_LANE

OFF_CENTRE_M = 0.3
"""Most that a road user drives beside the middle of its lane, m."""


def off_centre(actor: Actor, rng: np.random.Generator) -> Actor:
    """Move a road user that drives in the very middle of its lane a little to one side; return any other actor as it is.

    Exactly one number is drawn in every case.
    """
    offset = round(float(rng.uniform(-OFF_CENTRE_M, OFF_CENTRE_M)), 2)
    behaviour, placement = actor.behaviour, actor.placement
    if placement.offset_m or behaviour.other or behaviour.name not in DRIVES_IN_LANE:
        return actor
    moved = placement.model_copy(update={"offset_m": offset})
    return actor.model_copy(update={"placement": moved})
