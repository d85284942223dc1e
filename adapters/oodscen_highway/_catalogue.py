"""The catalogue: bodies that the flat rasteriser draws, moved by highway-env; loads without it."""

from functools import lru_cache

from oodscen import make_catalogue
from oodscen.data import Catalogue
from oodscen.driving import DynamicSimulator

_DRIVEN = frozenset(
    {
        "stand",
        "follow_lane",
        "wrong_way",
        "cut_in",
        "cut_out",
        "hard_brake",
        "stall",
        "halt",
        "stop_and_go",
        "reverse",
        "run_red",
        "roll_away",
        "cross_road",
        "walk_along",
        "bolt",
        "dart",
    }
)
"""Behaviours that highway-env's controllers can drive: along a lane, into another one, or straight on."""
_MISSING_TRAITS = frozenset(
    {"hill", "junction", "tunnel", "bridge", "downhill", "narrow", "exit", "rail_crossing"}
)
"""Traits of roads that highway-env cannot have."""


@lru_cache(maxsize=1)
def load_catalogue() -> Catalogue:
    """Return the flat simulator's bodies and weather, with the behaviours and roads of highway-env.

    Roads are nearly level, with slopes of at most 1 %, and of one width, without junctions: highway-env knows no
    heights and no taper, and gets the ego's road only.
    """
    behaviours = tuple(kind for kind in DynamicSimulator.BEHAVIOURS if kind.id in _DRIVEN)
    maps = tuple(road for road in DynamicSimulator.MAPS if not _MISSING_TRAITS & set(road.traits))
    own_fields = {"simulator": "highway", "behaviours": behaviours, "maps": maps}
    return make_catalogue("flat").model_copy(update=own_fields)
