"""The frozen values that cross a stage: scenarios, scenes, episodes, verdicts, claims, catalogues."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
