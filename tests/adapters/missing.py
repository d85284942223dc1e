"""A run without an adapter's package, in another process."""

import subprocess
import sys

CODE = """
import importlib, sys
adapter, name, hidden = sys.argv[1:]
sys.modules[hidden] = None
from oodscen.errors import MissingExtra
from oodscen.testing._kit.samples import sample_scene
with getattr(importlib.import_module(adapter), name)() as simulator:
    scene = sample_scene(simulator.catalogue().maps[0], ())
    try:
        simulator.reset(scene, 0)
    except MissingExtra as error:
        print(error.extra, error.module)
"""


def told_without(module: str, simulator: str) -> list[str]:
    """Return the extra and the module that a run without a module asks for.

    Args:
        module: The module that is not there.
        simulator: The adapter's package and class, `package:Class`.
    """
    words = [sys.executable, "-c", CODE, *simulator.split(":"), module]
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout.split()
