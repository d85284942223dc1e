"""The built-in author: text answers from a knowledge base of hazards, without any model."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
