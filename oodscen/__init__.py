"""Tests automated driving on out-of-distribution scenarios.

A language model grows a tree of out-of-distribution (OOD) driving scenarios. Each path of the tree becomes texts,
each text a scene, and each scene a simulated episode on which models and driving stacks are judged. Importing the
package loads nothing else: each name below is imported on first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
