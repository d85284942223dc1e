"""Claims: the statements of a text, one by one, and checks of a scene against them."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
