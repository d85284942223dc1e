"""Kernels: functions that numba compiles if it is installed, and that plain Python runs otherwise.

Both give the same bits: kernels use only plain arithmetic (see `oodscen.numerics._exact`), are
compiled without permission to reorder it, and index arrays by single elements, never by rows.

Nothing is compiled, and numba is not imported, before the first call. The result is cached on disk
(beside the sources, or in numba's own cache if they are read-only), so that only the first call
after an installation waits; a line on stderr says so. Processes that need the same kernel at once wait
for the first of them to compile it.
"""

import hashlib
import importlib
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from enum import EnumType
from functools import cache
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any, Generic, Protocol, TypeVar, TypeVarTuple, get_args

import numpy as np

from oodscen._io import flock

Args = TypeVarTuple("Args")
R = TypeVar("R")
Function = TypeVar("Function", bound=Callable[..., object])

_STRICT = {"fastmath": False, "error_model": "numpy"}
_PATIENCE_S = 120.0
"""Longest wait, in seconds, for another process that compiles the same kernel."""
_PACKAGE = "oodscen"
"""The package whose functions and constants may change between versions."""

_parts: list[Callable[..., object]] = []
"""All functions that kernels may call."""
_inlined: set[int] = set()
"""Ids of those that numba inlines."""
_registered: set[int] = set()
"""Ids of those that numba knows already."""


class Numbers(Protocol):
    """A float64 array as seen by kernels: indexed to single elements, by a number or a tuple of numbers."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Lengths of the axes."""
        ...

    def __getitem__(self, index: Any, /) -> float: ...

    def __setitem__(self, index: Any, value: float, /) -> None: ...


class Integers(Protocol):
    """An int64 array as seen by kernels."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Lengths of the axes."""
        ...

    def __getitem__(self, index: Any, /) -> int: ...


@cache
def is_compiled() -> bool:
    """Return whether kernels are compiled here, i.e. numba is installed and works."""
    try:
        importlib.import_module("numba")
    except Exception:  # A broken numba fails in many ways.
        return False
    return True


def part(function: Function) -> Function:
    """Make a function callable from kernels; it stays an ordinary function elsewhere."""
    _parts.append(function)
    return function


def inlined(function: Function) -> Function:
    """Inline a function into every kernel that calls it, for code that runs once per pixel."""
    _inlined.add(id(function))
    return part(function)


def seen(array: Any) -> Any:
    """Return an array as kernels take it: itself, or a view that plain Python indexes quickly."""
    return array if is_compiled() else memoryview(array)


class Kernel(Generic[*Args, R]):
    """A decorator for functions that are compiled on their first call.

    Arguments are numbers, tuples, and arrays as `seen` returns them.
    """

    def __init__(self, function: Callable[[*Args], R]) -> None:
        self.plain = function
        """The original function: the same bits, but slow."""
        self.__doc__ = function.__doc__
        self._name = function.__qualname__
        # Lets pickle find the function: numba names its files after what a kernel refers to.
        function.__qualname__ += ".plain"
        self._run: Callable[[*Args], R] | None = None
        _parts.append(function)

    def __call__(self, *args: *Args) -> R:
        """Run the kernel, compiled on its first call."""
        if self._run is None:
            return self._first_run(*args)
        return self._run(*args)

    def _first_run(self, *args: *Args) -> R:
        if not is_compiled():
            self._run = self.plain
            return self.plain(*args)
        from numba.core import event

        compiled = _compiled(self.plain, self._name)
        with (
            _compile_lock(compiled, self._name),
            event.install_listener("numba:compile", _announcer()),
        ):
            result: R = compiled(*args)
        self._run = compiled
        return result


@contextmanager
def _compile_lock(compiled: Any, name: str) -> Iterator[None]:
    """Hold a lock file beside a kernel's cache, or go on without it if another process holds it too long.

    There is no lock where numba caches or compiles nothing.
    """
    folder = compiled.stats.cache_path if hasattr(compiled, "stats") else None
    if folder is None:
        yield
        return
    descriptor = None
    with suppress(OSError):
        descriptor = flock.acquire(Path(folder, f"{name}.lock"), _PATIENCE_S)
    try:
        yield
    finally:
        if descriptor is not None:
            flock.release(descriptor)


def _compiled(function: Callable[[*Args], R], name: str) -> Any:
    import numba
    from numba.extending import register_jitable

    for callee in _parts:
        if id(callee) not in _registered:
            inline = "always" if id(callee) in _inlined else "never"
            register_jitable(inline=inline, **_STRICT)(callee)
            _registered.add(id(callee))

    def entry(*args):  # type: ignore[no-untyped-def]
        return function(*args)

    # numba keys its cache by this source file and name: with the digest in the name, the cache of another version
    # is never unpickled.
    entry.__name__, entry.__qualname__ = name, f"{name}.{_digest(function)[:16]}"
    entry.__module__ = function.__module__
    try:
        return numba.njit(cache=True, nogil=True, **_STRICT)(entry)
    except RuntimeError:
        return numba.njit(nogil=True, **_STRICT)(entry)


def _digest(function: Callable[..., object]) -> str:
    """Return a hash of the sources of all functions that a kernel reaches and of its constants.

    numba freezes both at compile time.
    """
    pending, reached = [function], {function}
    files: set[str] = set()
    constants: set[str] = set()
    registered = {id(callee) for callee in _parts}
    while pending:
        caller = pending.pop()
        files.add(caller.__code__.co_filename)
        for annotation in caller.__annotations__.values():
            constants.update(_layouts(annotation))
        for name in _names(caller.__code__):
            value = caller.__globals__.get(name)
            if isinstance(value, Kernel):
                value = value.plain
            if isinstance(value, ModuleType):
                if value.__name__.startswith(_PACKAGE):
                    files.add(str(value.__file__))
            elif isinstance(value, FunctionType):
                is_ours = id(value) in registered or value.__module__.startswith(_PACKAGE)
                if is_ours and value not in reached:
                    reached.add(value)
                    pending.append(value)
            elif isinstance(value, EnumType):
                constants.add(f"{name}={list(value)!r}")
            elif isinstance(value, (bool, int, float, str, tuple, np.generic)):
                constants.add(f"{name}={value!r}")
    digest = hashlib.sha256()
    for file in sorted(files):
        if Path(file).is_file():
            digest.update(Path(file).read_bytes())
    digest.update(repr(sorted(constants)).encode())
    return digest.hexdigest()


def _layouts(annotation: Any) -> Iterator[str]:
    """Yield the full names and the fields of the named tuples in an annotation, those within others included."""
    if hasattr(annotation, "_fields"):
        yield f"{annotation.__module__}.{annotation.__qualname__}={annotation._fields!r}"
        for field in annotation.__annotations__.values():
            yield from _layouts(field)
    for argument in get_args(annotation):
        yield from _layouts(argument)


def _names(code: CodeType) -> set[str]:
    """Return every global name that a function may use, including those of nested functions."""
    names = set(code.co_names)
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            names |= _names(constant)
    return names


@cache
def _announcer() -> Any:
    """Return a listener that reports in a terminal, once per process, that something is being compiled."""
    from numba.core.event import Event, Listener

    class Announcer(Listener):  # type: ignore[misc]
        is_new = True

        def on_start(self, event: Event) -> None:
            if self.is_new and sys.stderr is not None and sys.stderr.isatty():
                self.is_new = False
                print(
                    "oodscen: compiling kernels; this takes some seconds, and only the first time",
                    file=sys.stderr,
                    flush=True,
                )

        def on_end(self, event: Event) -> None:
            pass

    return Announcer()
