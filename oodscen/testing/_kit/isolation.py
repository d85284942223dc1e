"""Checks that a simulator does not depend on its process or on earlier scenes, and leaks nothing."""

import gc
import hashlib
import importlib
import os
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import BrokenExecutor
from contextlib import contextmanager
from operator import attrgetter
from typing import NamedTuple

from oodscen._parallel.processes import Processes, children, is_importable
from oodscen._registry import make_simulator
from oodscen.data._scene import Scene
from oodscen.errors import UsageError
from oodscen.protocols import Camera, Simulator
from oodscen.testing._kit.findings import Finding, NotApplicable
from oodscen.testing._kit.probe import Factory, Probe
from oodscen.testing._kit.samples import SMALL, run_bytes

LEAK_BYTES = 8 * 2**20
"""Maximum growth of resident memory over all watched resets that does not count as a leak."""
LEAK_FILES = 2
"""Maximum growth of the number of open files that does not count as a leak."""
CLOSING_S = 2.0
"""Seconds in which threads and processes of a closed simulator must end."""

NEEDS_GUARD = (
    "the module of the simulator checks it when it is imported, also in the fresh process of the part "
    "'process': put that call under: if __name__ == '__main__':"
)
"""The finding about a script without a main guard."""

BLOCKS = 5
"""Number of blocks into which the resets of the search for leaks are divided."""
_SEED = 3


def check_process(probe: Probe) -> None:
    """Check that the scenes' runs repeat in a fresh process."""
    camera = None if probe.states_only else probe.camera()
    probe.findings.recorded += process_faults(probe.simulator, probe.source, probe.scenes, camera)


def process_faults(
    simulator: Simulator,
    source: Factory | str,
    scenes: Sequence[Scene],
    camera: Camera | None = SMALL,
) -> list[Finding]:
    """Repeat scenes in a fresh process, backwards, and return a finding for each with another result.

    Args:
        simulator: An open simulator.
        source: Makes another one.
        scenes: The scenes to run.
        camera: The camera of the frames; without one, only states are compared.

    Raises:
        NotApplicable: If a fresh process cannot import the simulator.
    """
    if not _can_be_sent(source):
        raise NotApplicable(
            f"a fresh process cannot import {source!r}; give a class of a module of its own, or its "
            "name as module:attr"
        )
    if _is_being_imported(source):
        return [Finding("", NEEDS_GUARD)]
    digests = [run_digest(simulator, scene, camera) for scene in scenes]
    backwards = tuple(reversed(scenes))
    try:
        with Processes(1) as pool:
            repeated = pool.submit(run_digests, source, backwards, camera).result()[::-1]
    except (BrokenExecutor, UsageError) as error:
        return [Finding("", f"the simulator does not work in a fresh process: {error}")]
    return [
        Finding(f"scene {scene.id}", "another result in a fresh process")
        for scene, digest, again in zip(scenes, digests, repeated, strict=True)
        if again != digest
    ]


def run_digest(simulator: Simulator, scene: Scene, camera: Camera | None = SMALL) -> str:
    """Return the SHA-256 of a short run: all states, and the frames at its beginning and end."""
    digest = hashlib.sha256()
    for part in run_bytes(simulator, scene, camera, seed=_SEED):
        digest.update(part)
    return digest.hexdigest()


def run_digests(
    source: Factory | str, scenes: Sequence[Scene], camera: Camera | None = SMALL
) -> list[str]:
    """Open a simulator and return the digest of each scene's run, in order."""
    with make_simulator(source) if isinstance(source, str) else source() as simulator:
        return [run_digest(simulator, scene, camera) for scene in scenes]


def check_leaks(probe: Probe) -> None:
    """Check that resets leak no memory, files, threads or processes, and that `close` ends all threads and processes."""
    _check_resets(probe)
    _check_close(probe)


class _Usage(NamedTuple):
    """Memory, files, threads and processes that this process holds."""

    resident_bytes: int
    files: int
    threads: int
    processes: int

    @classmethod
    def now(cls) -> "_Usage":
        return cls(resident_bytes(), open_files(), threading.active_count(), len(children()))


def _check_resets(probe: Probe) -> None:
    """Load two scenes in turn many times and compare what this process holds.

    The first fifth of the resets warms up caches. After that the minima of the fifths are compared, which a passing
    peak does not affect.
    """
    with _settled_heap():
        _, first, *_, last = [_least_usage(probe) for _ in range(BLOCKS)]
    leave, expect = f"{probe.resets} resets leave", probe.findings.expect
    grown_bytes = last.resident_bytes - first.resident_bytes
    expect(grown_bytes <= LEAK_BYTES, "", f"{leave} {grown_bytes / 2**20:.1f} MiB of memory behind")
    for noun, limit, more in (
        ("open files", LEAK_FILES, last.files - first.files),
        ("threads", 0, last.threads - first.threads),
        ("processes", 0, last.processes - first.processes),
    ):
        expect(more <= limit, "", f"{leave} {more} {noun} behind")


@contextmanager
def _settled_heap() -> Iterator[None]:
    """Keep objects from before out of the search for garbage: they are not the simulator's leaks, and many.

    What the caller froze stays frozen.
    """
    was_frozen = gc.get_freeze_count() > 0
    if not was_frozen:
        gc.collect()
        gc.freeze()
    try:
        yield
    finally:
        if not was_frozen:
            gc.unfreeze()


def _least_usage(probe: Probe) -> _Usage:
    """Make a fifth of the resets and return the minima of what this process held meanwhile."""
    simulator, scenes, camera = probe.simulator, probe.scenes[:2], probe.camera()
    usages = []
    for index in range(probe.resets // BLOCKS):
        simulator.reset(scenes[index % len(scenes)], index % 3)
        if index % 8 == 0:
            simulator.render(camera)
        if index % 8 == 7 or index < 2:
            gc.collect()
            usages.append(_Usage.now())
    return _Usage(*map(min, zip(*usages, strict=True)))


def _check_close(probe: Probe) -> None:
    """Check that a simulator that was used and closed leaves no thread or process behind."""
    threads_before, processes_before = set(threading.enumerate()), children()
    simulator = probe.factory()
    try:
        simulator.reset(probe.scenes[0], _SEED)
    finally:
        simulator.close()
    deadline = time.monotonic() + CLOSING_S
    while True:
        threads = {thread for thread in threading.enumerate() if thread.is_alive()} - threads_before
        processes = children() - processes_before
        if not threads | processes or time.monotonic() > deadline:
            break
        time.sleep(0.02)
    names = ", ".join(sorted(thread.name for thread in threads))
    probe.findings.expect(not threads, "", f"close leaves threads behind: {names}")
    probe.findings.expect(not processes, "", f"close leaves {len(processes)} processes behind")


def resident_bytes() -> int:
    """Return this process's resident memory in bytes; 0 if the system does not report it."""
    try:
        with open("/proc/self/statm", "rb") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except OSError:
        return 0


def open_files() -> int:
    """Return the number of this process's open files; 0 if the system does not report it."""
    try:
        return len(os.listdir("/proc/self/fd"))
    except OSError:
        return 0


def _is_being_imported(source: Factory | str) -> bool:
    """Return whether the simulator's module is being imported; no other thread can then use it."""
    name = source.partition(":")[0] if isinstance(source, str) else source.__module__
    spec = getattr(sys.modules.get(name), "__spec__", None)
    return bool(getattr(spec, "_initializing", False))


def _can_be_sent(source: Factory | str) -> bool:
    """Return whether a fresh process can make the same simulator."""
    if isinstance(source, str):
        return is_importable(source)
    try:
        module = importlib.import_module(source.__module__)
        found = attrgetter(source.__qualname__)(module)
    except (ImportError, AttributeError):
        return False
    return bool(found == source) and module.__name__ != "__main__"
