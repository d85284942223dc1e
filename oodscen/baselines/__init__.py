"""Baselines: texts of ordinary driving, the reference for OOD-ness.

`load_baseline()` is the bundled corpus; `load_baseline(file)` reads your own.
`load_controls(split)` returns texts for testing a measure.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
