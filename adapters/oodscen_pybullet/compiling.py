"""How kernels are compiled: strict arithmetic, kept on disk, plain Python where numba is missing."""

import contextlib
import sys
from collections.abc import Callable, Iterator
from typing import Any, TypeVar, cast

try:
    import numba
except Exception:  # a broken numba fails in many ways; the other camera needs none
    numba = None

Kernel = TypeVar("Kernel", bound=Callable[..., Any])

_announced = False


def is_compiled() -> bool:
    """Tell whether kernels are compiled here."""
    return numba is not None


def kernel(function: Kernel) -> Kernel:
    """Compile a function: strict arithmetic, without the interpreter's lock, kept on disk.

    Where numba finds no folder to write to, every process compiles anew; where numba is missing, the
    function stays as it is.
    """
    if numba is None:
        return function
    options = {"fastmath": False, "error_model": "numpy", "nogil": True}
    try:
        compiled = numba.njit(cache=True, **options)(function)
    except RuntimeError:
        compiled = numba.njit(**options)(function)
    return cast(Kernel, compiled)


def inlined(function: Kernel) -> Kernel:
    """Compile a function into every kernel that calls it; for others it stays what it is."""
    if numba is None:
        return function
    from numba.extending import register_jitable

    return cast(Kernel, register_jitable(inline="always", error_model="numpy")(function))


@contextlib.contextmanager
def announcing() -> Iterator[None]:
    """Say so on standard error, once in a process, if kernels are compiled meanwhile."""
    if _announced or numba is None:
        yield
        return
    from numba.core import event

    class _Listener(event.Listener):  # type: ignore[misc]  # numba is not typed
        def on_start(self, event: Any) -> None:
            global _announced
            module = str(event.data["dispatcher"].py_func.__module__)
            if not _announced and module.startswith("oodscen"):
                _announced = True
                print(
                    "oodscen: compiling the rasteriser; this takes about a minute and happens once",
                    file=sys.stderr,
                    flush=True,
                )

        def on_end(self, event: Any) -> None:
            return

    with event.install_listener("numba:compile", _Listener()):
        yield
