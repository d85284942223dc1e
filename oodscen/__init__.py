"""Tests for automated driving on what nobody trained for.

A language model grows a tree of out-of-distribution (OOD) driving scenarios; each path becomes texts, each text a
scene, each scene a simulated episode on which models and driving stacks are judged. Importing the package loads
nothing; each name below is imported when it is first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
