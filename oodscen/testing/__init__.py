"""Doubles without dependencies, and the checks that third-party adapters run on themselves."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
