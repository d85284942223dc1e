"""Importing costs little: heavy packages are loaded by what needs them, when it needs them."""

import subprocess
import sys

import pytest

HEAVY = ("torch", "litellm", "numba", "pybullet", "cv2", "sentence_transformers", "matplotlib")
COMMON = ("pydantic", "numpy", "jinja2")

# The modules of `oodscen.inspect` are imported by inspect_ai alone, which need not be there.
EVERYTHING = """
import importlib, pkgutil
from contextlib import suppress
from oodscen.errors import MissingExtra
for found in pkgutil.walk_packages(oodscen.__path__, "oodscen."):
    if not found.name.startswith("oodscen.inspect."):
        with suppress(MissingExtra):
            importlib.import_module(found.name)
"""


@pytest.mark.parametrize(
    ("code", "unwanted"),
    [
        ("", (*HEAVY, *COMMON)),
        ("import oodscen.pytest_plugin._hooks", (*HEAVY, *COMMON)),
        (EVERYTHING, HEAVY),
    ],
    ids=["oodscen", "plugin of pytest", "every module"],
)
def test_importing_loads_nothing_heavy(code, unwanted):
    script = f"import sys, oodscen\n{code}\nprint([m for m in {unwanted} if m in sys.modules])"
    command = [sys.executable, "-W", "error", "-c", script]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.strip()) == (0, "[]"), done.stderr
