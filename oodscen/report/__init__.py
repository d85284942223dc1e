"""The report of a study: one self-contained page that can be mailed, archived and read on a phone."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
