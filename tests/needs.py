"""A mark for tests of optional packages."""

from importlib.util import find_spec

import pytest


def needs(*modules: str) -> pytest.MarkDecorator:
    """Skip tests where a package is not installed.

    Unlike `pytest.importorskip`, this does not load the package in processes that run none of the tests.
    """
    missing = [module for module in modules if find_spec(module) is None]
    return pytest.mark.skipif(bool(missing), reason=f"could not find {', '.join(missing)}")
