"""What a simulator must not depend on or leave behind: its process, and what ran in it before."""

import gc
import hashlib
import importlib
import os
import pickle
import warnings
from collections.abc import Callable, Sequence
from concurrent.futures import BrokenExecutor

from oodscen._processes import Processes, is_importable
from oodscen._registry import make_simulator
from oodscen.data._scene import Scene
from oodscen.protocols import Simulator
from oodscen.testing._samples import SMALL, run_bytes

LEAK_BYTES = 8 * 2**20
"""Growth of the resident memory over all watched resets that is still no leak."""
LEAK_FILES = 2
"""Likewise of open files."""

_BLOCKS = 5
_SEED = 3


def process_faults(
    simulator: Simulator, source: Callable[[], Simulator] | str, scenes: Sequence[Scene]
) -> list[str]:
    """Repeat scenes in a fresh process, in another order, and say which came out otherwise.

    Args:
        simulator: An open one.
        source: Makes another one. What a fresh process cannot import is not checked, with a warning.
        scenes: To run.
    """
    if not _travels(source):
        warnings.warn(
            f"the part 'process' is left out: a fresh process cannot import {source!r}; give a class of "
            "a module of its own, or its name as module:attr",
            stacklevel=2,
        )
        return []
    here = {scene.id: run_digest(simulator, scene) for scene in scenes}
    try:
        with Processes(1) as pool:
            there = pool.submit(run_digests, source, tuple(scenes)[::-1]).result()
    except BrokenExecutor as error:
        return [f"process: the simulator does not work in a fresh process: {error}"]
    return [
        f"scene {name}: another result in a fresh process"
        for name, digest in here.items()
        if there[name] != digest
    ]


def run_digest(simulator: Simulator, scene: Scene) -> str:
    """Return the SHA-256 of a short run: all states, and frames at its beginning and end."""
    digest = hashlib.sha256()
    for part in run_bytes(simulator, scene, seed=_SEED):
        digest.update(part)
    return digest.hexdigest()


def run_digests(source: Callable[[], Simulator] | str, scenes: Sequence[Scene]) -> dict[str, str]:
    """Open a simulator and return the digest of each scene's run, by its id."""
    with make_simulator(source) if isinstance(source, str) else source() as simulator:
        return {scene.id: run_digest(simulator, scene) for scene in scenes}


def leak_faults(simulator: Simulator, scenes: Sequence[Scene], resets: int) -> list[str]:
    """Load scenes many times over and say whether memory or open files grow.

    The first fifth warms caches up; after that the least use of each fifth is compared, which a
    passing peak does not change.

    Args:
        simulator: An open one.
        scenes: Two of them take turns.
        resets: How many.
    """
    gc.collect()
    # What was there before is no leak of the simulator's, and takes long to look through.
    gc.freeze()
    try:
        memory, files = _use(simulator, scenes[:2], resets)
    finally:
        gc.unfreeze()
    faults = []
    if memory[-1] - memory[0] > LEAK_BYTES:
        grown = (memory[-1] - memory[0]) / 2**20
        faults.append(f"leaks: {resets} resets leave {grown:.1f} MiB of memory behind")
    if files[-1] - files[0] > LEAK_FILES:
        faults.append(f"leaks: {resets} resets leave {files[-1] - files[0]} open files behind")
    return faults


def _use(simulator: Simulator, turn: Sequence[Scene], resets: int) -> tuple[list[int], list[int]]:
    """Return the least memory and the number of open files of each fifth but the first."""
    memory: list[int] = []
    files: list[int] = []
    for block in range(_BLOCKS):
        used = []
        for index in range(max(1, resets // _BLOCKS)):
            simulator.reset(turn[index % len(turn)], index % 3)
            if index % 8 == 0:
                simulator.render(SMALL)
            if index % 8 == 7 or index < 2:
                gc.collect()
                used.append(resident_bytes())
        if block > 0:
            memory.append(min(used))
            files.append(open_files())
    return memory, files


def resident_bytes() -> int:
    """Return how much memory this process holds; its peak where the system does not say."""
    try:
        with open("/proc/self/statm", "rb") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except OSError:
        import resource

        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def open_files() -> int:
    """Return how many files this process has open; 0 where the system does not say."""
    try:
        return len(os.listdir("/proc/self/fd"))
    except OSError:
        return 0


def _travels(source: Callable[[], Simulator] | str) -> bool:
    """Tell whether a fresh process can make the same simulator."""
    if isinstance(source, str):
        return is_importable(source)
    try:
        module = importlib.import_module(source.__module__)
        pickle.dumps(source)
    except (ImportError, AttributeError, pickle.PicklingError, TypeError):
        return False
    if module.__name__ == "__main__":
        return False
    return getattr(module, getattr(source, "__qualname__", ""), None) is source
