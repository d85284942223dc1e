"""The catalogue: SUMO's drivers, and bodies that they can meet on the road; loads without SUMO."""

from functools import lru_cache

from oodscen import make_catalogue
from oodscen.data import Catalogue
from oodscen.driving import DynamicSimulator

DRIVEN = frozenset(
    {"follow_lane", "cut_in", "cut_out", "hard_brake", "stall", "halt", "stop_and_go"}
)
"""Behaviours of SUMO's drivers."""
GUIDED = frozenset(
    {
        "stand",
        "wrong_way",
        "reverse",
        "run_red",
        "roll_away",
        "cross_road",
        "hesitate",
        "walk_along",
        "bolt",
        "dart",
        "wander",
    }
)
"""Behaviours without regard for others: the library guides these bodies through SUMO's traffic."""
_MISSING_TRAITS = frozenset({"junction", "narrow", "exit", "rail_crossing"})
"""Traits of roads that are left out."""


@lru_cache(maxsize=1)
def load_catalogue() -> Catalogue:
    """Return the flat simulator's bodies and weather, with SUMO's behaviours, on roads without junctions and gaps."""
    names = DRIVEN | GUIDED
    behaviours = tuple(kind for kind in DynamicSimulator.BEHAVIOURS if kind.id in names)
    maps = tuple(road for road in DynamicSimulator.MAPS if not _MISSING_TRAITS & set(road.traits))
    own_fields = {"simulator": "sumo", "behaviours": behaviours, "maps": maps}
    return make_catalogue("flat").model_copy(update=own_fields)
