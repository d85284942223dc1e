from ._dynamic_simulator import DynamicSimulator as DynamicSimulator
from ._dynamic_simulator import RestorableSimulator as RestorableSimulator
from ._mirror_simulator import MirrorSimulator as MirrorSimulator
from ._motion.world import KinematicWorld as KinematicWorld
from ._roads.corridor import Corridor as Corridor
from ._staged_scene import StagedScene as StagedScene
