"""Driving without a simulator: roads, the kinematic world, behaviours and the discrete actions."""

from oodscen.driving.corridor import Corridor, LaneStrip
from oodscen.driving.maps.shipped import SHIPPED_MAPS
from oodscen.driving.roads import find_map, load_corridor

__all__ = ["SHIPPED_MAPS", "Corridor", "LaneStrip", "find_map", "load_corridor"]
