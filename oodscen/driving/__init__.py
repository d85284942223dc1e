"""Driving without a simulator: roads, the kinematic world, behaviours and discrete actions."""

from oodscen.driving._kinematic_simulator import MirrorSimulator
from oodscen.driving._motion.actions import ACTION_DRIVERS, Cruise, action_driver, is_available
from oodscen.driving._motion.behaviours import BEHAVIOURS
from oodscen.driving._motion.boxes import Box, gap
from oodscen.driving._motion.triggers import is_due
from oodscen.driving._motion.world import KinematicWorld, WorldSnapshot
from oodscen.driving._roads.building import find_map, load_corridor
from oodscen.driving._roads.corridor import Corridor, LaneStrip
from oodscen.driving._roads.opendrive import read_network
from oodscen.driving._sight.placement import check_scene, staging_issues
from oodscen.driving.maps._shipped import SHIPPED_MAPS

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
    "read_network",
    "staging_issues",
]
