"""Scenes as Gymnasium environments: importing this package registers `oodscen/Scene-v0`.

It needs the extra `gymnasium`; without it nothing is registered, and every name raises `MissingExtra`.
"""

from importlib.util import find_spec

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

if find_spec("gymnasium") is not None:
    import gymnasium

    if "oodscen/Scene-v0" not in gymnasium.registry:
        gymnasium.register("oodscen/Scene-v0", "oodscen.gymnasium._env:SceneEnv")
