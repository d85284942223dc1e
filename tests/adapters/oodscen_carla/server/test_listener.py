"""Raw bytes on the real sockets: nothing ends the server or stays behind in it."""

import re
import resource
import socket
import struct
import subprocess
import sys
import time
from pathlib import Path

import msgpack
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from oodscen_carla.server import CarlaTestServer
from oodscen_carla.server._measurements import WORLD

from oodscen.errors import SimulatorError
from oodscen.testing import example_scene


class RawClient:
    """Speaks msgpack-rpc without CARLA's library."""

    def __init__(self, port: int) -> None:
        self.socket = socket.create_connection(("127.0.0.1", port), 20)
        self.unpacker = msgpack.Unpacker(raw=False)

    def __enter__(self) -> "RawClient":
        return self

    def __exit__(self, *error: object) -> None:
        self.socket.close()

    def ask(self, method: str, *arguments: object) -> object:
        self.socket.sendall(msgpack.packb([0, 7, method, [[False], *arguments]]))
        while data := self.socket.recv(1 << 16):
            self.unpacker.feed(data)
            for kind, number, error, answer in self.unpacker:
                assert (kind, number, error) == (1, 7, None)
                return answer
        raise ConnectionError("the server ended the connection")


def open_things(pid: int) -> tuple[int, int]:
    """Return the number of open files and of threads of a process."""
    return tuple(len(list(Path(f"/proc/{pid}/{kind}").iterdir())) for kind in ("fd", "task"))


@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60, deadline=None
)
@given(data=st.binary(max_size=300), cut=st.booleans())
def test_random_bytes_never_end_the_server(server, data, cut):
    for port in (server.port, server.port + 1):
        with socket.create_connection(("127.0.0.1", port), 20) as raw:
            raw.sendall(data)
            if cut:
                raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    with RawClient(server.port) as client:
        assert client.ask("version") == [[1, "0.9.16"]]


@pytest.mark.parametrize("start", [b"GET / HTTP/1.1\r\n", b"\x94\x00\x01\xa1x\xdb\xff\xff\xff\xff"])
def test_what_is_no_call_ends_the_connection(server, start):
    with socket.create_connection(("127.0.0.1", server.port), 20) as raw:
        raw.sendall(start)
        assert raw.recv(9) == b""


def test_a_flood_of_connections_leaves_nothing_behind(server):
    with RawClient(server.port) as client:
        client.ask("version")
        before = open_things(server.pid)
        raws = [socket.create_connection(("127.0.0.1", server.port), 20) for _ in range(100)]
        for raw in raws:
            raw.close()
        for _ in range(200):
            client.ask("tick_cue")
            if open_things(server.pid) <= before:
                break
        assert open_things(server.pid)[0] <= before[0] + 1


def test_too_many_open_files_do_not_make_the_server_deaf():
    with CarlaTestServer() as server:
        limits = resource.prlimit(server.pid, resource.RLIMIT_NOFILE)
        resource.prlimit(
            server.pid, resource.RLIMIT_NOFILE, (open_things(server.pid)[0], limits[1])
        )
        for port in (server.port, server.port + 1):
            with socket.create_connection(("127.0.0.1", port), 20):
                time.sleep(0.2)
        resource.prlimit(server.pid, resource.RLIMIT_NOFILE, limits)
        with RawClient(server.port) as client:
            assert client.ask("version") == [[1, "0.9.16"]]


def test_after_its_context_a_server_takes_no_fault():
    with CarlaTestServer() as server:
        pass
    assert not server.is_alive
    with pytest.raises(SimulatorError, match="inside its context only"):
        server.fault("drop")


def test_the_worlds_state_is_streamed_to_whoever_asks(server):
    with (
        RawClient(server.port) as client,
        socket.create_connection(("127.0.0.1", server.port + 1), 20) as stream,
    ):
        ((_, (_, (token,))),) = client.ask("get_episode_info")
        stream.sendall(token[:4])
        (length,) = struct.unpack("<I", stream.recv(4, socket.MSG_WAITALL))
        state = stream.recv(length, socket.MSG_WAITALL)
        assert struct.unpack("<Q", state[:8]) == (WORLD,)


def test_a_server_that_cannot_start_says_so():
    with pytest.raises(SimulatorError, match="exit code"), CarlaTestServer(simulator="nothing"):
        pass


def test_names_may_hold_separators_of_lines():
    scene = example_scene().model_copy(update={"scenario_id": "a\u2028b\x85c"})
    with CarlaTestServer([scene]) as server:
        assert server.is_alive


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("no scene", r"line 3:\s.*is no JSON"),
        (example_scene().to_json().replace('"schema_version":1', '"schema_version":0'), "line 3"),
    ],
)
def test_a_line_that_is_no_scene_is_named(tmp_path, line, told):
    (tmp_path / "scenes.jsonl").write_text(f"{example_scene().to_json()}\n\n{line}\n")
    order = [sys.executable, "-m", "oodscen_carla.server", "--simulator", "flat", "--scenes"]
    result = subprocess.run([*order, tmp_path / "scenes.jsonl"], capture_output=True, text=True)
    assert result.returncode == 2
    assert re.search(told, result.stderr)
    assert "Traceback" not in result.stderr


@pytest.mark.parametrize(
    "line", ["", "no fault", "[]", "{}", '{"kind": "explode"}', '{"kind": "die", "after": "x"}']
)
def test_a_line_that_is_no_fault_is_refused_and_the_server_goes_on(server, line):
    process = server._process
    print(line, file=process.stdin, flush=True)
    assert process.stdout.readline().startswith("refused: ")
    server.fault("refuse", "no_such_call")


def test_it_dies_on_demand_and_its_end_is_seen():
    with CarlaTestServer() as server:
        server.fault("die", "get_map_info")
        with RawClient(server.port) as client:
            assert client.ask("version") == [[1, "0.9.16"]]
            with pytest.raises(ConnectionError):
                client.ask("get_map_info")
        server.kill()
        assert not server.is_alive
        with pytest.raises(SimulatorError, match="it has ended"):
            server.fault("refuse")


def test_it_refuses_and_hangs_on_demand(server):
    server.fault("refuse", "version", after=1)
    server.fault("hang", "get_map_info")
    with RawClient(server.port) as client:
        assert client.ask("version") == [[1, "0.9.16"]]
        assert client.ask("version") == [[0, ["version was refused on demand"]]]
        client.socket.settimeout(0.2)
        with pytest.raises(TimeoutError):
            client.ask("get_map_info")
        client.socket.settimeout(20)
        assert client.ask("version") == [[1, "0.9.16"]]
    with pytest.raises(ValueError, match="no fault"):
        server.fault("explode")


def test_a_batch_that_is_refused_on_demand_answers_every_command(server):
    server.fault("refuse", "apply_batch")
    with RawClient(server.port) as client:
        answers = client.ask("apply_batch", [[[1, [999]]], [[1, [998]]]], False)
    assert answers == [[[0, ["apply_batch was refused on demand"]]]] * 2
