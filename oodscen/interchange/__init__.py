"""Scenes in the formats of other tools: OpenSCENARIO XML and OpenDRIVE out and in, and verdicts on played runs."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
