from ._env import SceneEnv as SceneEnv
from ._policies import PolicyDriver as PolicyDriver
