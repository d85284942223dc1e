"""Claims: the content of a text, piece by piece, and whether a scene holds to it."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
