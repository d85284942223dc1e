"""Sockets and threads: remote calls on one port, streams of sensors on the next."""

import os
import socket
import struct
import sys
import threading
import time
import traceback
from collections.abc import Callable
from typing import Any

import msgpack

from oodscen.errors import UsageError
from oodscen_carla.server._calls import Calls, refused
from oodscen_carla.server._cameras import CameraRenderer
from oodscen_carla.server._faults import Faults
from oodscen_carla.server._messages import MemoryPool, MessageReader, ProtocolError
from oodscen_carla.server._sensors import SensorSender
from oodscen_carla.server._sockets import end, limit_sends
from oodscen_carla.server._streams import WORLD_STREAM, Streams
from oodscen_carla.server._world import World

MAX_CLIENTS = 64
_BACKLOG = 64
"""Number of connections that may wait to be accepted."""
AWAIT_S = 1.0
"""Maximum time that a tick waits for a stream whose token was just asked for, s."""
_ATTEMPTS = 50
"""Number of free ports that are tried until the next one is free, too."""
_RETRY_S = 0.05
"""Time after a connection that could not be accepted until the next one is, s."""
FREE_RUN_S = 0.05
"""Time between the ticks of the asynchronous mode, s."""


class Listener:
    """Serves a world until it is closed; every connection has a thread of its own."""

    def __init__(
        self,
        world: World,
        renderer: CameraRenderer,
        *,
        host: str = "127.0.0.1",
        port: int = 0,
        faults: Faults | None = None,
        log: Callable[[str], None] | None = None,
    ) -> None:
        """Open the ports; see `start`.

        Args:
            world: Is driven by the clients.
            renderer: Takes the pictures.
            host: The address to listen on; the default is reached from this machine only.
            port: Port for calls; the next one is for streams. 0 chooses free ones.
            faults: Faults to produce.
            log: Called with a line for every refused connection or call.

        Raises:
            UsageError: If the ports are taken.
        """
        self._world = world
        self._lock = threading.RLock()
        self._heard = threading.Condition(self._lock)
        self._faults = faults or Faults()
        self._log = log or (lambda line: None)
        self._streams = Streams(self._heard)
        self._sender = SensorSender(world, renderer, self._streams)
        self._calls = Calls(world, self._streams, self._tick, self._log)
        self._pool = MemoryPool()
        self._clients: set[socket.socket] = set()
        self._is_closed = False
        self._late: list[Callable[[], None]] = []
        self._fault: str | None = None
        self._sockets = _listening(host, port)
        self.port: int = self._sockets[0].getsockname()[1]
        self._streams.port = self._sockets[1].getsockname()[1]

    def start(self) -> None:
        """Begin to serve, in threads that end with the process."""
        calls, streams = self._sockets
        _start_thread(self._accept, calls, self._serve_calls)
        _start_thread(self._accept, streams, self._serve_stream)
        _start_thread(self._run_free)

    def close(self) -> None:
        """Wait until the tick or call at work has ended, then end all connections; no other follows."""
        self._is_closed = True
        for listening in self._sockets:
            end(listening)
        with self._lock:
            for client in self._clients:
                end(client)
            self._streams.close()
            self._heard.notify_all()

    def _tick(self) -> int:
        """Advance the world by one tick and send what the sensors measure.

        The state comes after the pictures, and the answer to the call after both: a client that
        has its answer therefore waits for no picture.
        """
        world = self._world
        self._heard.wait_for(self._streams.are_expected_heard, AWAIT_S)
        self._streams.forget_expected()
        if self._is_closed:
            return world.frame
        world.advance()
        fault, self._fault = self._fault, None
        if fault == "late":
            self._sender.observe(world.step)
            self._late.append(self._sender.sense)
        else:
            if fault != "drop":
                self._sender.sense()
            self._sender.observe(world.step)
        return world.frame

    def _run_free(self) -> None:
        while not self._is_closed:
            time.sleep(FREE_RUN_S)
            with self._lock:
                if self._clients and not self._world.is_synchronous:
                    try:
                        self._tick()
                    except Exception:  # The clock of all clients goes on.
                        traceback.print_exc(file=sys.stderr)

    def _accept(self, listening: socket.socket, serve: Callable[[socket.socket], None]) -> None:
        while not self._is_closed:
            try:
                connection, _ = listening.accept()
                connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                _start_thread(serve, connection)
            except (
                OSError,
                RuntimeError,
            ):  # Too many files or threads are open, or the peer has gone.
                time.sleep(_RETRY_S)

    def _serve_calls(self, connection: socket.socket) -> None:
        with self._lock:
            if self._is_closed:
                return end(connection)
            if len(self._clients) >= MAX_CLIENTS:
                self._log(f"refused a connection: {MAX_CLIENTS} are open")
                return end(connection)
            self._clients.add(connection)
        limit_sends(connection)
        reader = MessageReader(self._pool)
        try:
            while data := connection.recv(1 << 16):
                for message in reader.feed(data):
                    self._handle(connection, message)
        except ProtocolError as error:
            self._log(f"ended a connection: {error}")
        except OSError:
            pass
        finally:
            reader.close()
            end(connection)
            with self._lock:
                self._clients.discard(connection)
                if not self._clients and not self._is_closed:
                    for number in self._world.leave():
                        self._streams.drop(number)
        return None

    def _handle(self, connection: socket.socket, message: list[Any]) -> None:
        """Answer one call."""
        method, arguments = message[-2:]
        fault = self._faults.strike(method)
        if fault == "die":
            os._exit(70)
        if fault == "hang":
            return
        with self._lock:
            if self._is_closed:
                return
            self._streams.host = connection.getsockname()[0]
            self._fault = fault
            if fault == "refuse":
                answer: Any = refused(method, arguments, f"{method} was refused on demand")
            else:
                answer = self._answer(method, arguments)
            packed = msgpack.packb([1, message[1], None, answer]) if message[0] == 0 else b""
            late, self._late = self._late, []
        if packed:
            connection.sendall(packed)
        for send in late:
            with self._lock:
                if not self._is_closed:
                    send()

    def _answer(self, method: str, arguments: list[Any]) -> Any:
        try:
            return self._calls.answer(method, arguments)
        except Exception as error:
            traceback.print_exc(file=sys.stderr)
            message = f"the server failed in {method}: {type(error).__name__}"
            return refused(method, arguments, message)

    def _serve_stream(self, connection: socket.socket) -> None:
        limit_sends(connection)
        try:
            request = connection.recv(4, socket.MSG_WAITALL)
            if len(request) == 4:
                number = struct.unpack("<I", request)[0]
                with self._lock:
                    if self._is_closed or not self._streams.add(number, connection):
                        return
                    if number == WORLD_STREAM:
                        # Until two states have the new step, `apply_settings` ticks: a step of 0 here
                        # would let chance decide how often.
                        self._sender.observe(self._world.step)
                while connection.recv(4096):
                    pass
        except OSError:
            pass
        finally:
            with self._lock:
                self._streams.remove(connection)
            end(connection)


def _listening(host: str, port: int) -> tuple[socket.socket, socket.socket]:
    """Return two listening sockets, on a port and the next.

    Raises:
        UsageError: If one of them cannot be had.
    """
    fault: Exception | None = None
    for _ in range(1 if port else _ATTEMPTS):
        first, second = socket.socket(), socket.socket()
        try:
            _bind(first, host, port)
            _bind(second, host, first.getsockname()[1] + 1)
            first.listen(_BACKLOG)
            second.listen(_BACKLOG)
            return first, second
        except (OSError, OverflowError, TypeError, ValueError) as error:
            first.close()
            second.close()
            fault = error
            if isinstance(error, socket.gaierror | TypeError | ValueError):
                break  # The host is at fault, on every port.
    ports = f"ports {port} and {port + 1}" if port else "two free ports"
    raise UsageError(f"cannot listen on {host}, {ports}: {fault}")


def _bind(listening: socket.socket, host: str, port: int) -> None:
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    listening.bind((host, port))


def _start_thread(target: Callable[..., None], *arguments: Any) -> None:
    threading.Thread(target=target, args=arguments, daemon=True).start()
