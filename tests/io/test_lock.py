"""One writer at a time, and no lock outlives its process."""

import errno
import json
import os
import signal
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from oodscen._io.lock import lock_file, locked
from oodscen.errors import InUse, StudyError

HOLDER = """
import os, sys
from pathlib import Path
from oodscen._io.lock import locked

with locked(Path(sys.argv[1]), "study"):
    print("held", flush=True)
    sys.stdin.readline()
"""


def holding(path):
    process = subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout.readline() == "held\n"
    return process


def test_a_file_of_somebody_else_where_the_lock_would_be_is_left_alone(tmp_path):
    lock_file(tmp_path).write_text("a diary")
    with pytest.raises(StudyError, match="not a lock file"), locked(tmp_path, "study"):
        pass
    assert lock_file(tmp_path).read_text() == "a diary"


@pytest.mark.parametrize("kind", ["folder", "file", "link"])
def test_another_process_is_named_and_nothing_changes(tmp_path, kind):
    place = tmp_path / "place"
    place.mkdir() if kind == "folder" else place.write_text("mine")
    if kind == "link":
        (tmp_path / "link").symlink_to(place)
    with holding(tmp_path / "link" if kind == "link" else place) as process:
        before = [(p, p.stat().st_mtime_ns) for p in [tmp_path, *sorted(tmp_path.rglob("*"))]]
        with pytest.raises(InUse) as caught, locked(place, "study"):
            pytest.fail("locked twice")
        assert f"process {process.pid} on " in caught.value.holder
        assert caught.value.since.endswith("UTC")
        assert "\n" not in str(caught.value)
        after = [(p, p.stat().st_mtime_ns) for p in [tmp_path, *sorted(tmp_path.rglob("*"))]]
        assert after == before
        process.communicate("\n")
    with locked(place, "study"):
        pass
    assert not lock_file(place).exists()


def test_what_a_killed_process_leaves_locks_nothing(tmp_path):
    with holding(tmp_path) as process:
        os.kill(process.pid, signal.SIGKILL)
    assert json.loads(lock_file(tmp_path).read_text())["pid"] == process.pid
    with locked(tmp_path, "study"):
        assert json.loads(lock_file(tmp_path).read_text())["pid"] == os.getpid()


def test_the_same_thread_may_lock_again_and_another_may_not(tmp_path):
    refused = []

    def other():
        try:
            with locked(tmp_path, "study"):
                pass
        except InUse as error:
            refused.append(error)

    with locked(tmp_path, "study"):
        with locked(tmp_path / "." / "", "study"):
            pass
        thread = threading.Thread(target=other)
        thread.start()
        thread.join()
    assert len(refused) == 1
    other()
    assert len(refused) == 1


def test_who_waits_while_others_come_and_go_gets_the_lock(tmp_path):
    def take(_):
        with locked(tmp_path / "file", "study", wait_s=60):
            pass

    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    try:
        with ThreadPoolExecutor(6) as threads:
            assert len(list(threads.map(take, range(3_000)))) == 3_000
    finally:
        sys.setswitchinterval(interval)
    assert not list(tmp_path.iterdir())


def test_it_is_held_until_the_last_lets_go_in_whatever_order(tmp_path):
    one, other = locked(tmp_path, "study"), locked(tmp_path, "study")
    one.__enter__()
    other.__enter__()
    one.__exit__(None, None, None)
    assert lock_file(tmp_path).exists()
    thread = threading.Thread(target=other.__exit__, args=(None, None, None))
    thread.start()
    thread.join()
    assert not lock_file(tmp_path).exists()
    with holding(tmp_path) as process:
        process.communicate("\n")


def test_a_place_that_cannot_be_locked_is_a_typed_error(tmp_path):
    lock_file(tmp_path).mkdir()
    with pytest.raises(StudyError, match="cannot lock"), locked(tmp_path, "study"):
        pass


@pytest.mark.parametrize("left", [None, '{"pid": 1, "host": "h", "command": "c", "since": "s"}'])
@pytest.mark.parametrize("fault", ["write", "lock"])
def test_a_lock_that_could_not_be_written_leaves_no_file(fault, left, tmp_path, monkeypatch):
    def full(*given, **named):
        raise OSError(errno.ENOSPC, "No space left on device")

    file = lock_file(tmp_path)
    if left is not None:
        file.write_text(left)
    with monkeypatch.context() as patch:
        if fault == "write":
            patch.setattr(Path, "write_text", full)
        else:
            patch.setattr("fcntl.flock", full)
        refused = pytest.raises(StudyError, match=r"cannot lock .*: No space left")
        with refused, locked(tmp_path, "study"):
            pass
    # Whose lock a file of another process is cannot be told without a lock.
    assert file.exists() == (fault == "lock" and left is not None)
    with locked(tmp_path, "study"):
        assert json.loads(file.read_text())["pid"] == os.getpid()
    assert not file.exists()


def test_a_secret_in_the_command_is_not_written(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["/bin/oodscen", "run", "http://me:secret@host/v1"])
    with locked(tmp_path, "study"):
        said = json.loads(lock_file(tmp_path).read_text())
    assert said["command"].startswith("oodscen run")
    assert "secret" not in said["command"]


def test_the_holder_is_called_by_the_name_of_its_program(tmp_path, monkeypatch):
    for program in ("/usr/bin/oodscen", "/site-packages/oodscen/__main__.py"):
        monkeypatch.setattr("sys.argv", [program, "run", "out"])
        with locked(tmp_path, "study"):
            assert json.loads(lock_file(tmp_path).read_text())["command"] == "oodscen run out"


FORKER = """
import os, sys
from pathlib import Path
from oodscen._io.lock import locked

with locked(Path(sys.argv[1]), "study"):
    if os.fork():
        if sys.argv[2] == "dies":
            os._exit(0)
        os.wait()
        print(os.listdir(sys.argv[1]), flush=True)
    elif sys.argv[2] == "dies":
        print("forked", flush=True)
        sys.stdin.readline()
"""


def forking(path: Path, parent: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", FORKER, str(path), parent],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


def test_a_forked_process_holds_no_lock_of_its_parent_that_died(tmp_path):
    parent = forking(tmp_path, "dies")
    assert parent.stdout.readline() == "forked\n"
    parent.wait()
    with locked(tmp_path, "study"):
        pass
    parent.communicate("\n")


def test_a_forked_process_that_leaves_the_block_leaves_the_lock(tmp_path):
    said, _ = forking(tmp_path, "lives").communicate()
    assert said == f"['{lock_file(tmp_path).name}']\n"


def test_threads_may_fork_while_a_lock_is_held(tmp_path):
    program = """
import os, sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from oodscen._io.lock import locked

def fork(_):
    child = os.fork()
    if not child:
        os._exit(0)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])

with locked(Path(sys.argv[1]), "study"), ThreadPoolExecutor(4) as threads:
    print(sum(threads.map(fork, range(40))))
"""
    done = subprocess.run(
        [sys.executable, "-c", program, str(tmp_path)], capture_output=True, text=True, check=True
    )
    assert done.stdout == "0\n"
