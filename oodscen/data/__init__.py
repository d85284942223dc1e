"""Immutable values passed between stages: scenarios, scenes, episodes, verdicts, claims and catalogues."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
