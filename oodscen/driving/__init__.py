"""Driving without a simulator: roads, the kinematic world, behaviours and the discrete actions."""

from oodscen.driving.actions import ACTION_DRIVERS, Cruise, action_driver, is_available
from oodscen.driving.behaviours import BEHAVIOURS
from oodscen.driving.boxes import Box, gap
from oodscen.driving.corridor import Corridor, LaneStrip
from oodscen.driving.maps.shipped import SHIPPED_MAPS
from oodscen.driving.mirror import MirrorSimulator
from oodscen.driving.placement import check_scene, staging_issues
from oodscen.driving.roads import find_map, load_corridor
from oodscen.driving.triggers import is_due
from oodscen.driving.world import KinematicWorld, WorldSnapshot

__all__ = [
    "ACTION_DRIVERS",
    "BEHAVIOURS",
    "SHIPPED_MAPS",
    "Box",
    "Corridor",
    "Cruise",
    "KinematicWorld",
    "LaneStrip",
    "MirrorSimulator",
    "WorldSnapshot",
    "action_driver",
    "check_scene",
    "find_map",
    "gap",
    "is_available",
    "is_due",
    "load_corridor",
    "staging_issues",
]
