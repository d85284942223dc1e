"""Processes of one's own: each call's fate is its own, and nobody outlives whom they work for."""

import operator
import os
import pickle
import signal
import subprocess
import sys
import time
from concurrent.futures import BrokenExecutor
from contextlib import suppress
from functools import partial
from pathlib import Path

import pytest

from oodscen._parallel.processes import Processes, children, ending_children, run_apart
from oodscen._registry import make_simulator
from oodscen.errors import RunStopped, UnknownComponent, UsageError
from tests.forks import ended_fork

PATIENCE_S = 60.0


@pytest.fixture(scope="module")
def pool():
    with Processes(2) as processes:
        yield processes


def test_calls_run_in_other_processes_and_come_back(pool):
    found = [pool.submit(operator.mul, number, 7) for number in range(20)]
    assert [future.result() for future in found] == [7 * number for number in range(20)]
    pids = {pool.submit(os.getpid).result() for _ in range(4)}
    assert os.getpid() not in pids
    assert pool.submit(int, "ff", base=16).result() == 255


def test_errors_come_back_as_they_are(pool):
    with pytest.raises(UnknownComponent) as caught:
        pool.submit(make_simulator, "pybulet").result()
    assert "pybullet" in caught.value.matches
    with pytest.raises(ZeroDivisionError) as divided:
        pool.submit(operator.truediv, 1, 0).result()
    assert "In a worker process" in divided.value.__notes__[0]
    with pytest.raises(RuntimeError, match="Stubborn"):
        pool.submit(exec, STUBBORN).result()
    with pytest.raises((AttributeError, pickle.PicklingError)):
        pool.submit(lambda: 1).result()


def test_a_call_that_runs_apart_may_have_processes_of_its_own():
    inside = """
from oodscen._parallel.processes import Processes
with Processes(1) as pool:
    assert pool.submit(int, "ff", base=16).result() == 255
"""
    run_apart(exec, inside, {})
    with Processes(1) as pool, pytest.raises(UsageError):
        pool.submit(exec, inside, {}).result()
    with pytest.raises(BrokenExecutor, match="exit code 0"):
        run_apart(os._exit, 0)


STUBBORN = """
class Stubborn(Exception):
    def __init__(self, one, two):
        super().__init__(one)
raise Stubborn(1, 2)
"""


def test_a_call_that_kills_its_process_costs_no_other(pool):
    died = pool.submit(os._exit, 7)
    assert pool.submit(operator.add, 1, 2).result() == 3
    with pytest.raises(BrokenExecutor, match="exit code 7"):
        died.result()
    killed = pool.submit(exec, "import os; os.kill(os.getpid(), 9)")
    with pytest.raises(BrokenExecutor, match="SIGKILL"):
        killed.result()
    cancelled = pool.submit(exec, "import asyncio; raise asyncio.CancelledError('late')")
    with pytest.raises(BrokenExecutor, match="it raised CancelledError: late"):
        cancelled.result()
    ended = pool.submit(exec, "import os, time; os.kill(os.getpid(), 15); time.sleep(60)")
    with pytest.raises(BrokenExecutor, match="exit code 143"):
        ended.result()
    assert pool.submit(operator.add, 1, 2).result() == 3


BUSY = "import signal; tell(); signal.pause()"
PARENT = """
import subprocess
child = subprocess.Popen(["sleep", "600"])
tell()
child.wait()
"""
DEAF = """
while True:
    try:
        tell()
        while True:
            pass
    except BaseException:
        tell = int
"""


@pytest.fixture
def begun(tmp_path):
    """Make a FIFO by which a call says that it is under way."""
    path = tmp_path / "begun"
    os.mkfifo(path)
    return path


def telling(begun, code):
    return f"tell = lambda: open({str(begun)!r}, 'w').close()\n{code}"


def test_an_interruption_ends_what_is_under_way_and_drops_the_rest(begun):
    with suppress(KeyboardInterrupt), Processes(1) as pool:
        pid = pool.submit(os.getpid).result()
        first, *rest = (pool.submit(exec, telling(begun, BUSY)) for _ in range(3))
        begun.read_text()
        raise KeyboardInterrupt
    assert isinstance(first.exception(), BrokenExecutor)
    assert all(future.cancelled() for future in rest)
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


IN_A_CALLBACK = """
import ctypes, time
from pathlib import Path

def wait(tell=tell, sleep=time.sleep):
    tell()
    sleep(600)

try:
    ctypes.CFUNCTYPE(None)(wait)()
    time.sleep(600)
finally:
    Path({left!r}).touch()
"""


def test_an_interruption_that_a_callback_drops_comes_again(begun, tmp_path, capfd):
    left = tmp_path / "left"
    with suppress(KeyboardInterrupt), Processes(1) as pool:
        pool.submit(exec, telling(begun, IN_A_CALLBACK.format(left=str(left))))
        begun.read_text()
        raise KeyboardInterrupt
    assert left.exists()
    assert capfd.readouterr().err == ""


def test_a_fork_of_a_worker_ends_at_a_signal(pool):
    assert pool.submit(ended_fork).result() == -signal.SIGTERM


LEAVING_ONE = """
import subprocess
child = subprocess.Popen(["sleep", "600"])
open({pid!r}, "w").write(str(child.pid))
{then}
"""


@pytest.mark.parametrize("then", ["pass", "import os; os._exit(3)", "raise KeyboardInterrupt"])
def test_what_a_call_has_started_ends_with_its_process(tmp_path, then):
    pid = tmp_path / "pid"
    with Processes(1) as pool:
        call = pool.submit(exec, LEAVING_ONE.format(pid=str(pid), then=then))
        assert (call.exception() is None) == (then == "pass")
        assert pool.submit(operator.add, 1, 2).result() == 3
    assert is_gone(int(pid.read_text()))


def is_gone(pid):
    """Wait until a process of no parent is gone, or reaped by nobody."""
    state = Path(f"/proc/{pid}/stat")
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        try:
            if state.read_text().rpartition(")")[2].split()[0] == "Z":
                return True
        except OSError:
            return True
        time.sleep(0.01)
    return False


def test_a_fork_that_comes_back_answers_nothing(pool):
    assert pool.submit(exec, "import os; os.fork()").exception() is None
    assert [pool.submit(operator.add, 1, n).result() for n in range(9)] == [*range(1, 10)]


def test_what_a_call_prints_is_no_result(capfd):
    with Processes(1) as pool:
        assert (
            pool.submit(exec, "import os; print('a', flush=True); os.write(1, b'b')").result()
            is None
        )
    assert capfd.readouterr() == ("", "a\nb")


def test_a_call_that_takes_too_long_is_ended():
    with Processes(1, limit_s=0.5) as pool:
        endless = pool.submit(exec, "import signal; signal.pause()")
        with pytest.raises(BrokenExecutor, match=r"longer than 0\.5 s"):
            endless.result()
        assert pool.submit(operator.add, 1, 2).result() == 3


def test_every_process_is_prepared_outside_the_limit_of_its_calls(tmp_path):
    prepare = partial(
        exec, f"import time; time.sleep(0.6); open({str(tmp_path / 'log')!r}, 'a').write('.')"
    )
    with Processes(2, limit_s=0.5, prepare=prepare) as pool:
        sums = [pool.submit(operator.add, 1, n) for n in range(6)]
        assert [one.result() for one in sums] == [*range(1, 7)]
        with pytest.raises(BrokenExecutor, match="exit code 3"):
            pool.submit(os._exit, 3).result()
        assert pool.submit(operator.add, 1, 2).result() == 3
    assert (tmp_path / "log").read_text() in ("..", "...")


def test_a_preparation_that_fails_fails_every_call_alike():
    with Processes(1, prepare=partial(operator.truediv, 1, 0)) as pool:
        for _ in range(2):
            with pytest.raises(ZeroDivisionError):
                pool.submit(operator.add, 1, 2).result()
    with (
        Processes(1, prepare=partial(time.sleep, 60), prepare_limit_s=0.5) as pool,
        pytest.raises(BrokenExecutor, match=r"longer than 0\.5 s"),
    ):
        pool.submit(operator.add, 1, 2).result()


def test_an_interruption_that_a_call_raises_itself_is_its_own(pool):
    with pytest.raises(BrokenExecutor, match="it raised KeyboardInterrupt"):
        pool.submit(exec, "raise KeyboardInterrupt").result()
    assert pool.submit(operator.add, 1, 2).result() == 3


KILLED = """
import os, signal
from pathlib import Path
from oodscen._parallel.processes import Processes, children, ending_children, run_apart

with Processes(2) as pool:
    pool.submit(os.getpid).result()
    pool.submit(exec, {code!r})
    Path({begun!r}).read_text()
    os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.parametrize("code", [BUSY, DEAF, PARENT], ids=["busy", "deaf", "parent"])
def test_nobody_outlives_a_parent_that_is_killed(begun, code):
    """The output of the parent ends when the last of its processes has left."""
    script = KILLED.format(code=telling(begun, code), begun=str(begun))
    done = subprocess.run(
        [sys.executable, "-c", script], stdout=subprocess.PIPE, timeout=PATIENCE_S
    )
    assert done.returncode == -signal.SIGKILL


def test_a_process_that_does_not_start_stops_the_run(monkeypatch):
    monkeypatch.setattr("oodscen._parallel.processes._START", "raise SystemExit(3)")
    with Processes(1) as pool, pytest.raises(RunStopped, match="exit code 3"):
        pool.submit(os.getpid).result()


def test_processes_of_processes_are_refused(pool):
    with pytest.raises(UsageError, match="__main__"):
        pool.submit(Processes, 1).result()


def test_children_that_are_left_are_ended_and_earlier_ones_are_not():
    with subprocess.Popen(["sleep", "60"]) as earlier:
        with ending_children():
            later = subprocess.Popen(["sleep", "60"], start_new_session=True)
            assert {earlier.pid, later.pid} <= children()
        later.wait()
        assert later.pid not in children()
        assert earlier.poll() is None
        earlier.kill()


def test_a_worker_that_nobody_listens_to_leaves_without_a_word():
    code = """
import os, pickle, signal, time
from oodscen._parallel.processes import serve

class Gone:
    calls = [pickle.dumps(os.getpid)]
    def send(self, message): pass
    def recv_bytes(self):
        return self.calls.pop() if self.calls else time.sleep(60)
    def send_bytes(self, answer):
        raise BrokenPipeError

serve(Gone())
os.kill(os.getpid(), signal.SIGTERM)
print("left", flush=True)
"""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, start_new_session=True
    )
    assert (done.stdout, done.stderr) == ("left\n", "")
