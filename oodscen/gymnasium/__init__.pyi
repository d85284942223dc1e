from ._env import SceneEnv as SceneEnv
from ._policies import DriverPolicy as DriverPolicy
from ._policies import PolicyDriver as PolicyDriver
from ._reward import Reward as Reward
