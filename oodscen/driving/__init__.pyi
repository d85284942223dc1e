from ._drivers.r157 import R157Driver as R157Driver
from ._drivers.rss import RSSDriver as RSSDriver
from ._kinematic_simulator import KinematicSimulator as KinematicSimulator
from ._motion.actions import action_driver as action_driver
from ._motion.world import KinematicWorld as KinematicWorld
from ._roads.building import load_corridor as load_corridor
from ._sight.placement import check_scene as check_scene
