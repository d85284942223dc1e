"""Driving without a simulator: roads, the kinematic world, behaviours, discrete actions and drivers."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
