"""A pool of fresh worker processes that end with their parent."""

import atexit
import importlib.util
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from functools import partial
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from types import FrameType, TracebackType
from typing import Any, ParamSpec, TypeVar

from oodscen._parallel.interrupts import in_this_process, raise_until_handled, unreported
from oodscen.errors import OodscenError, RunStopped, UsageError

Parameters = ParamSpec("Parameters")
Result = TypeVar("Result")

GRACE_S = 2.0
"""Seconds that a process has to clean up after being told to leave."""

_START = (
    "import sys; from multiprocessing.connection import Connection; "
    "connection = Connection(int(sys.argv[1])); sys.path[:] = connection.recv(); "
    "from oodscen._parallel.processes import serve; serve(connection)"
)

_is_worker = False
_is_abandoned = False
"""True in a worker whose owner is gone."""


def is_worker() -> bool:
    """Return whether this process is a worker."""
    return _is_worker


def is_importable(name: str) -> bool:
    """Return whether worker processes can import a component by name; they cannot import scripts and notebooks."""
    return not name.startswith("__main__:")


def is_script(name: str) -> bool:
    """Return whether the module of `module:attr` is the running script, which then needs a main guard."""
    module, colon, _ = name.partition(":")
    script = getattr(sys.modules["__main__"], "__file__", None)
    if not colon or script is None:
        return False
    try:
        spec = importlib.util.find_spec(module)
    except (ImportError, ValueError):
        return False
    return spec is not None and spec.origin == os.path.abspath(script)


def children() -> set[int]:
    """Return the ids of this process's children; none if the system does not list them."""
    found: set[int] = set()
    for tasks in Path("/proc/self/task").glob("*/children"):
        with suppress(OSError):  # The thread has ended.
            found.update(map(int, tasks.read_text().split()))
    tracker = sys.modules.get("multiprocessing.resource_tracker")
    # The standard library's own helper, which ends by itself.
    return found - {getattr(getattr(tracker, "_resource_tracker", None), "_pid", None)}


@contextmanager
def ending_children() -> Iterator[None]:
    """Kill the child processes that were started meanwhile and are left at the end."""
    before = children()
    try:
        yield
    finally:
        for child in children() - before:
            with suppress(OSError):
                os.kill(child, signal.SIGKILL)
                os.waitpid(child, 0)


class Processes(ThreadPoolExecutor):
    """Runs each call in a fresh interpreter, which is then reused for later calls.

    The standard library's worker processes import the running script, which therefore needs a main guard, and
    they outlive a parent that is killed. These workers import only the called function's module. When the pool is
    closed or this process ends, idle workers leave at once; a running call gets a `KeyboardInterrupt` and
    `GRACE_S` seconds.

    A call whose process dies raises `BrokenProcessPool`. Other calls go on, and the next call gets a
    new process. Processes that a call starts end with the worker, unless they are sessions of their own.

    Args:
        count: Maximum number of processes; one is started whenever a call finds none idle.
        limit_s: Seconds after which a call that still runs is killed with its process; `None` for no limit.
        prepare: Called once in every process, before its first call; where it fails, the call fails.
        prepare_limit_s: The time limit of `prepare`, which does not count towards the first call's.

    Raises:
        UsageError: Inside a worker process, if a module that it imports creates a pool.
    """

    def __init__(
        self,
        count: int,
        *,
        limit_s: float | None = None,
        prepare: Callable[[], object] | None = None,
        prepare_limit_s: float | None = None,
    ) -> None:
        if _is_worker:
            raise UsageError(
                "a module that a worker process imports starts work with processes; put that work "
                "under: if __name__ == '__main__':"
            )
        super().__init__(count)
        self._limit_s = limit_s
        self._preparation = None if prepare is None else pickle.dumps(prepare)
        self._prepare_limit_s = prepare_limit_s
        self._all: list[_Process] = []
        self._idle: list[_Process] = []
        self._starting = threading.Lock()
        self._is_closed = False

    def submit(
        self,
        function: Callable[Parameters, Result],
        /,
        *arguments: Parameters.args,
        **named: Parameters.kwargs,
    ) -> Future[Result]:
        """Run a function of an importable module; the arguments and the result are pickled.

        The future raises whatever the function raises, `BrokenProcessPool` if the process dies, and `RunStopped`
        if no process can be started.
        """
        return super().submit(self._call, partial(function, *arguments, **named))

    def _call(self, task: Callable[[], Result]) -> Result:
        data = pickle.dumps(task)
        try:
            process = self._idle.pop()
        except IndexError:
            process = self._start()
        is_result, answer = process.call(data, self._limit_s)
        self._idle.append(process)
        if not is_result:
            raise answer
        result: Result = answer
        return result

    def _start(self) -> "_Process":
        with self._starting:
            if self._is_closed:
                raise BrokenProcessPool("the processes are closed")
            process = _Process()
            self._all.append(process)
        process.greet()
        if self._preparation is not None:
            is_prepared, answer = process.call(self._preparation, self._prepare_limit_s)
            if not is_prepared:
                process.join(0.0)
                raise answer
        return process

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Stop the processes after the submitted calls, or at once with `cancel_futures`."""
        try:
            if not cancel_futures:
                super().shutdown()
        finally:
            super().shutdown(False, cancel_futures=True)
            with self._starting:
                self._is_closed = True
            for process in self._all:
                process.terminate()
            deadline = time.monotonic() + GRACE_S
            for process in self._all:
                process.join(deadline)
            super().shutdown(wait)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.shutdown(cancel_futures=kind is not None)


def run_apart(
    function: Callable[Parameters, Result],
    /,
    *arguments: Parameters.args,
    **named: Parameters.kwargs,
) -> Result:
    """Return what a function gives in a fresh process, which may have pools of its own.

    Raises:
        BrokenProcessPool: If that process ends itself.
    """
    with Processes(1) as pool:
        return pool.submit(_as_owner, partial(function, *arguments, **named)).result()


def _as_owner(task: Callable[[], Result]) -> Result:
    """Run a task in this worker, which may start workers for it."""
    global _is_worker
    _is_worker = False
    return task()


class _Process:
    """One worker interpreter, from its owner's side."""

    def __init__(self) -> None:
        self._has_left = False
        self._connection, theirs = Pipe()
        # Ctrl-C in the terminal is for the owner to handle. The child inherits the signal mask.
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            with theirs:
                self._process = subprocess.Popen(
                    [sys.executable, "-P", "-c", _START, str(theirs.fileno())],
                    pass_fds=[theirs.fileno()],
                    stdin=subprocess.DEVNULL,
                    stdout=_errors(),
                    process_group=0,
                )
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)

    def greet(self) -> None:
        """Send the module search path and wait until the process is ready.

        Raises:
            RunStopped: If it does not start.
        """
        try:
            self._connection.send(sys.path)
            self._connection.recv()
        except (EOFError, OSError):
            raise RunStopped(
                f"a worker process does not start ({self._end()}); what it printed says why"
            ) from None

    def call(self, task: bytes, limit_s: float | None) -> tuple[bool, Any]:
        """Run a task; return whether it succeeded, and its result or error.

        Raises:
            BrokenProcessPool: If the process dies, or is killed at the time limit.
        """
        try:
            self._connection.send_bytes(task)
            if not self._connection.poll(limit_s):
                self.join(0.0)
                raise BrokenProcessPool(f"it took longer than {limit_s:g} s")
            data = self._connection.recv_bytes()
        except (EOFError, OSError):
            raise BrokenProcessPool(f"its process died ({self._end()})") from None
        answer: tuple[bool, Any] = pickle.loads(data)
        return answer

    def terminate(self) -> None:
        """Ask the process to leave."""
        self._process.terminate()

    def join(self, deadline: float) -> None:
        """Wait until the process has left; kill it after the deadline, and what it has left behind in any case."""
        if self._has_left:
            return
        try:
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(max(0.0, deadline - time.monotonic()))
        finally:
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()
            self._has_left = True

    def _end(self) -> str:
        """Return how the process ended."""
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(GRACE_S)
        code = self._process.returncode
        self.join(0.0)
        if code is None:
            return "it no longer listens"
        return f"exit code {code}" if code >= 0 else signal.Signals(-code).name


def _errors() -> int:
    """Return where a worker prints: the standard output belongs to the command's own results."""
    try:
        os.fstat(2)
    except OSError:
        return subprocess.DEVNULL
    return 2


def serve(connection: Connection) -> None:
    """Answer calls inside a worker process until it is told to leave or its owner is gone."""
    global _is_worker, _is_abandoned
    _is_worker = True
    atexit.register(_end_group)  # The first to be registered is the last to run.
    calls: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    try:
        signal.signal(signal.SIGTERM, in_this_process(_leave, {signal.SIGTERM: signal.SIG_DFL}))
        threading.Thread(target=_listen, args=(connection, calls), daemon=True).start()
        connection.send(None)
        process = os.getpid()
        with unreported(KeyboardInterrupt):
            while True:
                answer = _answer(calls.get())
                if os.getpid() != process:
                    os._exit(1)  # The child of a call that has forked.
                connection.send_bytes(answer)
    except KeyboardInterrupt:
        # As a shell reports it: the call itself may have sent the signal.
        sys.exit(128 + signal.SIGTERM)
    except OSError:  # Nobody takes the answer.
        _is_abandoned = True
    finally:
        # An interruption of what is only shutting down would be no more than a report on standard error.
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        signal.setitimer(signal.ITIMER_REAL, 0.0)


def _end_group() -> None:
    """End what calls have started and left behind, where there is no owner left to do it; a fork leaves it alone."""
    if _is_abandoned and os.getpid() == os.getpgrp():
        os.killpg(0, signal.SIGKILL)


def _leave(number: int, frame: FrameType | None) -> None:
    """Interrupt the running call, once."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    raise_until_handled(KeyboardInterrupt)


def _listen(connection: Connection, calls: "queue.SimpleQueue[bytes]") -> None:
    """Receive calls; leave when the owner is gone, even during a call."""
    with suppress(EOFError, OSError):
        while True:
            calls.put(connection.recv_bytes())
    # A dying owner closes its end before it stops being the parent.
    global _is_abandoned
    _is_abandoned = True
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(GRACE_S)
    os.killpg(0, signal.SIGKILL)


def _answer(call: bytes) -> bytes:
    """Run a call; return the pickled pair of success and result, or failure and error."""
    try:
        task: Callable[[], Any] = pickle.loads(call)
        return pickle.dumps((True, task()))
    except KeyboardInterrupt:
        if signal.getsignal(signal.SIGTERM) is signal.SIG_IGN:  # The process was told to leave.
            raise
        return _portable(BrokenProcessPool("it raised KeyboardInterrupt"))
    except SystemExit:
        raise
    except Exception as error:
        if not isinstance(error, OodscenError):
            trace = "".join(traceback.format_exception(error))
            error.add_note(f"In a worker process:\n{trace}")
        return _portable(error)
    except BaseException as error:
        # Such as a cancelled task, which would end the process without a word.
        return _portable(BrokenProcessPool(f"it raised {type(error).__name__}: {error}"))


def _portable(error: Exception) -> bytes:
    """Pickle an error, or a summary of it if it cannot be pickled."""
    try:
        data = pickle.dumps((False, error))
        pickle.loads(data)
    except Exception:
        data = pickle.dumps((False, RuntimeError(f"{type(error).__name__}: {error}")))
    return data
