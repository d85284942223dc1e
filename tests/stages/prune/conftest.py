"""One diverse tree of the built-in author, and the two catalogues that ship."""

import pytest

from oodscen import Pruner, RedTeamer, ScenarioTree, TreeGrower
from oodscen._registry import make_catalogue
from oodscen.author._builtin import BuiltinAuthor

NAMES = ("pybullet", "carla-0.9.16")


@pytest.fixture(scope="session")
def author() -> BuiltinAuthor:
    return BuiltinAuthor(seed=0)


@pytest.fixture(scope="session")
def diverse(author: BuiltinAuthor) -> ScenarioTree:
    return RedTeamer(author, iterations=60).run(TreeGrower(author).run())


@pytest.fixture(scope="session")
def catalogues():
    return {name: make_catalogue(name) for name in NAMES}


@pytest.fixture(scope="session")
def judged(author, diverse, catalogues):
    return {name: list(Pruner(author, one).decisions(diverse)) for name, one in catalogues.items()}
