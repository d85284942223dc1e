"""The stages in data-flow order: grow, red-team, prune, describe, augment, simulate, evaluate."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
