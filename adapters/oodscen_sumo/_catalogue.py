"""The catalogue: SUMO's drivers, and bodies that they can meet on the road; loads without SUMO."""

from functools import lru_cache

from oodscen import make_catalogue
from oodscen.data import Catalogue
from oodscen.driving import DynamicSimulator

DRIVEN = frozenset("follow_lane cut_in cut_out hard_brake stall halt stop_and_go".split())
"""Behaviours of SUMO's drivers."""
GUIDED = frozenset(
    "stand wrong_way reverse run_red roll_away cross_road hesitate walk_along bolt dart wander".split()
)
"""Behaviours without regard for others: the library guides these bodies through SUMO's traffic."""


@lru_cache(maxsize=1)
def load_catalogue() -> Catalogue:
    """Return the flat simulator's bodies and weather, with SUMO's behaviours, on roads without junctions and gaps."""
    kinds = tuple(kind for kind in DynamicSimulator.BEHAVIOURS if kind.id in DRIVEN | GUIDED)
    others = {"junction", "narrow", "exit", "rail_crossing"}
    roads = tuple(road for road in DynamicSimulator.MAPS if not others & set(road.traits))
    mine = {"simulator": "sumo", "behaviours": kinds, "maps": roads}
    return make_catalogue("flat").model_copy(update=mine)
