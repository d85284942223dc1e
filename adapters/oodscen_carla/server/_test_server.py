"""A server in a process of its own, for tests of code that speaks to CARLA."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Self

from oodscen.data import Scene
from oodscen.errors import SimulatorError
from oodscen_carla.server._faults import Fault, FaultKind

_END_S = 10.0
"""Time that the process has to end by itself, s."""


class CarlaTestServer:
    """Serves CARLA 0.9.16's protocol on 127.0.0.1 while the context is active.

    The process is a new one, because the official client holds the GIL while it
    waits. Pictures are the flat simulator's unless another is named; they are quick and plain.
    """

    def __init__(
        self,
        scenes: Sequence[Scene] = (),
        *,
        simulator: str = "flat",
        seed: int = 0,
        port: int = 0,
    ) -> None:
        """Start nothing yet.

        Args:
            scenes: Scenes that clients load by their ids; the first is open from the start.
            simulator: Name of the simulator that draws the pictures.
            seed: Seed of motion, scenery and paints.
            port: Port for calls, the next one is for streams; 0 chooses free ones.
        """
        self._scenes = scenes
        self._arguments = ["--simulator", simulator, "--seed", str(seed), "--port", str(port)]
        self._process: subprocess.Popen[str] | None = None
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self.port = 0
        """Port for calls, once the server runs."""

    @property
    def address(self) -> str:
        """Host and port."""
        return f"127.0.0.1:{self.port}"

    @property
    def pid(self) -> int:
        """Id of the server's process."""
        return self._running().pid

    @property
    def is_alive(self) -> bool:
        """Return whether the process runs."""
        return self._process is not None and self._process.poll() is None

    def __enter__(self) -> Self:
        """Start the process and wait until it serves.

        Raises:
            SimulatorError: If it does not.
        """
        self._folder = tempfile.TemporaryDirectory(prefix="oodscen-carla-")
        scenes = Path(self._folder.name) / "scenes.jsonl"
        scenes.write_text(
            "".join(f"{scene.to_json()}\n" for scene in self._scenes), encoding="utf-8"
        )
        command = [sys.executable, "-m", "oodscen_carla.server", "--scenes", str(scenes)]
        # A process that is killed leaves its files; here they go with the folder.
        self._process = subprocess.Popen(
            [*command, *self._arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "TMPDIR": self._folder.name},
        )
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line.strip().isdigit():
            process = self._process
            self.__exit__()
            raise SimulatorError(f"the server ended at once, with exit code {process.returncode}")
        self.port = int(line)
        return self

    def __exit__(self, *error: object) -> None:
        process = self._running()
        assert process.stdin is not None
        assert process.stdout is not None
        with suppress(BrokenPipeError):
            process.stdin.close()
        try:
            process.wait(_END_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        process.stdout.close()
        self._process = None
        if self._folder is not None:
            self._folder.cleanup()

    def fault(
        self, kind: FaultKind, call: str = "tick_cue", *, after: int = 0, times: int = 1
    ) -> None:
        """Ask for a fault; it is set when this returns.

        Args:
            kind: `refuse` answers a call with an error, `hang` never answers it, `die` ends the
                server's process. `late` sends the pictures of a tick after its answer, `drop` loses
                them.
            call: The remote procedure, as the client's library names it.
            after: Number of calls that pass first.
            times: Number of calls that are struck.

        Raises:
            ValueError: If there is no such fault.
            SimulatorError: If the server does not set it.
        """
        fault = Fault(kind, call, after, times)
        process = self._running()
        assert process.stdin is not None
        assert process.stdout is not None
        answer = ""
        with suppress(BrokenPipeError):
            print(fault.to_json(), file=process.stdin, flush=True)
            answer = process.stdout.readline().strip()
        if answer != "set":
            raise SimulatorError(f"the server did not set the fault: {answer or 'it has ended'}")

    def kill(self) -> None:
        """End the process as a crash would."""
        self._running().kill()
        self._running().wait()

    def _running(self) -> subprocess.Popen[str]:
        if self._process is None:
            raise SimulatorError("the server runs inside its context only")
        return self._process
