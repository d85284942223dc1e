"""Settings of the whole suite: no network, no chance, no clock, one thread per process."""

import gc
import os
import sys
from collections.abc import Generator, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import settings

from oodscen._words import redaction

if TYPE_CHECKING:
    from oodscen.protocols import Encoder

os.environ["OODSCEN_OFFLINE"] = "1"
os.environ.setdefault("HF_HUB_OFFLINE", "1")
# Test processes share the cores; encoders that each take all of them wait for each other.
os.environ.setdefault("OMP_NUM_THREADS", "1")

# Processes that tests start would else compile every module of the package anew.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# Tests make much and leave little of it behind: a search for garbage after every 700 objects finds next to none.
gc.set_threshold(20_000, 20, 100)

settings.register_profile("suite", max_examples=50, derandomize=True, deadline=None, database=None)
settings.register_profile("thorough", max_examples=5_000, deadline=None)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "suite"))


def _shared(factory: pytest.TempPathFactory) -> Path:
    """Return the folder that the processes of a parallel run have in common."""
    base = factory.getbasetemp()
    return base.parent if "PYTEST_XDIST_WORKER" in os.environ else base


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Do without the search for garbage while tests are collected: what is loaded then stays."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()


@pytest.fixture(scope="session", autouse=True)
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Keep cached embeddings out of the user's folder; return where they are kept.

    The processes of a parallel run share one folder, so that a text is encoded once.
    """
    folder = _shared(tmp_path_factory) / "cache"
    folder.mkdir(exist_ok=True)
    os.environ["XDG_CACHE_HOME"] = str(folder)
    return folder


@pytest.fixture(scope="session")
def quick(cache: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the finished study of `tests.pipeline.quick.QUICK`, which no test may change."""
    from tests.pipeline.quick import QUICK, finished

    return finished(QUICK, _shared(tmp_path_factory) / "quick")


@pytest.fixture(scope="session")
def minilm(cache: Path, tmp_path_factory: pytest.TempPathFactory) -> "Encoder":
    """Return all-MiniLM-L6-v2, which the first process that asks for it exports."""
    from oodscen._io.lock import locked
    from oodscen.encoders._all_minilm import all_minilm

    with locked(_shared(tmp_path_factory) / "minilm.run", "encoder", wait_s=600):
        encoder = all_minilm()
        encoder.encode(["A deer jumps onto the road."])
    return encoder


@pytest.fixture(scope="session")
def small(cache: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the finished study of `tests.pipeline.quick.SMALL`, which no test may change."""
    from tests.pipeline.quick import SMALL, finished

    return finished(SMALL, _shared(tmp_path_factory) / "small")


@pytest.fixture(autouse=True)
def _forgotten_keys() -> Iterator[None]:
    """Forget the keys that a test used: each that is known makes every later search for keys slower."""
    known = set(redaction._told)
    yield
    redaction._told.clear()
    redaction._told.update(known)


@pytest.fixture(scope="module", autouse=True)
def _settled_heap() -> None:
    """Leave what earlier modules keep out of the search for garbage, which else grows with the suite."""
    gc.collect()
    gc.freeze()


def pytest_unconfigure() -> None:
    """Give back what was left out: extension modules report what is not freed at the end as leaked."""
    gc.unfreeze()
