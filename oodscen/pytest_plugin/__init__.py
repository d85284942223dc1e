"""Type of the fixture `drive` that `pytest --oodscen OUT` gives to tests; docs/ci.md shows their use."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
