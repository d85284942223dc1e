import os
import pwd
import subprocess
import sys
import threading

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen._io.lock import locked
from oodscen.encoders._cached import CachedEncoder, cache_folder
from oodscen.testing._encoder import HashEncoder

TEXTS = ["a car waits", "a deer jumps", "a van turns left", "a car waits"]


class Counting(HashEncoder):
    def __init__(self, dimension: int = 16, name: str = "counting") -> None:
        super().__init__(dimension)
        self.name = name
        self.seen: list[str] = []

    def encode(self, texts):
        self.seen += texts
        return super().encode(texts)


@given(st.lists(st.lists(st.text(max_size=8), max_size=6), max_size=5))
def test_it_returns_what_the_encoder_returns_and_asks_once(batches):
    inner = Counting()
    cached = CachedEncoder(inner)
    for batch in batches:
        assert np.array_equal(cached.encode(batch), HashEncoder(16).encode(batch))
    assert len(inner.seen) == len(set(inner.seen))


def test_the_rows_are_the_callers_own():
    cached = CachedEncoder(Counting())
    cached.encode(TEXTS)[:] = 0.0
    assert np.array_equal(cached.encode(TEXTS), HashEncoder(16).encode(TEXTS))


def test_vectors_are_kept_between_processes(tmp_path):
    CachedEncoder(Counting(), tmp_path).encode(TEXTS)
    later = Counting()
    found = CachedEncoder(later, tmp_path).encode(TEXTS)
    assert not later.seen
    assert np.array_equal(found, HashEncoder(16).encode(TEXTS))
    assert [file.suffix for file in tmp_path.iterdir()] == [".npz"]


def test_encoders_of_similar_names_do_not_share_a_file(tmp_path):
    names = ["a/b", "a b", "a-b"]
    assert len({CachedEncoder(Counting(name=name), tmp_path).path for name in names}) == 3


@pytest.mark.parametrize("cut", [0, 1, 31, 32, 33, 200, -1])
def test_a_truncated_file_is_computed_again(tmp_path, cut):
    path = _filled(tmp_path)
    path.write_bytes(path.read_bytes()[:cut])
    _is_rebuilt(tmp_path)


@pytest.mark.parametrize("place", [0, 40, 300, -20])
def test_an_altered_file_is_computed_again(tmp_path, place):
    path = _filled(tmp_path)
    content = bytearray(path.read_bytes())
    content[place] ^= 1
    path.write_bytes(bytes(content))
    _is_rebuilt(tmp_path)


def test_a_pipe_in_its_place_is_not_waited_for(tmp_path):
    path = _filled(tmp_path)
    path.unlink()
    os.mkfifo(path)
    code = (
        "import pathlib, sys; from oodscen.encoders._cached import CachedEncoder\n"
        "from oodscen.testing._encoder import HashEncoder\n"
        "class Named(HashEncoder):\n  name = 'counting'\n"
        "print(len(CachedEncoder(Named(16), pathlib.Path(sys.argv[1])).encode(['a car waits'])))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path)],
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    assert done.stdout == "1\n"


def test_another_encoders_file_is_not_used(tmp_path):
    other = CachedEncoder(Counting(name="other"), tmp_path)
    other.encode(TEXTS)
    other.path.rename(CachedEncoder(Counting(), tmp_path).path)
    _is_rebuilt(tmp_path)


def test_a_file_of_another_dimension_is_not_used(tmp_path):
    CachedEncoder(Counting(8), tmp_path).encode(TEXTS)
    _is_rebuilt(tmp_path)


def test_what_two_writers_save_is_joined(tmp_path):
    first, second = CachedEncoder(Counting(), tmp_path), CachedEncoder(Counting(), tmp_path)
    first.encode(["one"])
    second.encode(["one"])
    first.encode(["two"])
    second.encode(["three"])
    later = Counting()
    CachedEncoder(later, tmp_path).encode(["one", "two", "three"])
    assert not later.seen


SAVING = """
import sys
from pathlib import Path
from oodscen.encoders._cached import CachedEncoder
from oodscen.testing._encoder import HashEncoder

for number in range(5):
    cached = CachedEncoder(HashEncoder(16), sys.argv[1])
    cached.encode([f"{sys.argv[2]} {number} {i}" for i in range(20)])
"""


def test_nothing_is_lost_of_what_several_processes_save_at_once(tmp_path):
    orders = [[sys.executable, "-c", SAVING, str(tmp_path), name] for name in "abc"]
    assert [process.wait() for process in map(subprocess.Popen, orders)] == [0, 0, 0]
    later = Counting(name=HashEncoder(16).name)
    texts = [f"{name} {number} {i}" for name in "abc" for number in range(5) for i in range(20)]
    CachedEncoder(later, tmp_path).encode(texts)
    assert not later.seen
    assert len(os.listdir(tmp_path)) == 1


def test_a_process_that_halts_while_it_saves_holds_up_nobody_for_ever(tmp_path, monkeypatch):
    monkeypatch.setattr("oodscen.encoders._cached._WAIT_S", 0.0)
    cached = CachedEncoder(Counting(), tmp_path)
    holder = threading.Thread(target=lambda: _hold(cached.path, held, done))
    held, done = threading.Event(), threading.Event()
    holder.start()
    held.wait()
    assert np.array_equal(cached.encode(TEXTS), HashEncoder(16).encode(TEXTS))
    done.set()
    holder.join()
    assert not list(tmp_path.iterdir())


def _hold(path, held, done):
    with locked(path, "cache"):
        held.set()
        done.wait()


def test_a_folder_that_cannot_be_written_is_no_failure(tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("")
    found = CachedEncoder(Counting(), blocked).encode(TEXTS)
    assert np.array_equal(found, HashEncoder(16).encode(TEXTS))


def test_many_threads_get_the_right_rows():
    cached = CachedEncoder(Counting())
    wrong = []

    def ask(start: int) -> None:
        texts = [f"text {i}" for i in range(start, start + 40)]
        if not np.array_equal(cached.encode(texts), HashEncoder(16).encode(texts)):
            wrong.append(start)

    threads = [threading.Thread(target=ask, args=(start,)) for start in range(0, 80, 10)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_the_cache_folder_follows_the_environment(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_folder() == tmp_path / "oodscen"
    monkeypatch.delenv("XDG_CACHE_HOME")
    assert cache_folder().parts[-2:] == (".cache", "oodscen")


def test_who_has_no_home_has_a_folder_of_the_process(monkeypatch):
    def nobody(uid):
        raise KeyError(uid)

    for name in ("XDG_CACHE_HOME", "HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(pwd, "getpwuid", nobody)
    folder = cache_folder()
    assert folder == cache_folder()
    assert folder.stat().st_mode & 0o777 == 0o700


def _filled(folder):
    cached = CachedEncoder(Counting(), folder)
    cached.encode(TEXTS)
    return cached.path


def _is_rebuilt(folder):
    for expected in (3, 0):
        inner = Counting()
        found = CachedEncoder(inner, folder).encode(TEXTS)
        assert len(inner.seen) == expected
        assert np.array_equal(found, HashEncoder(16).encode(TEXTS))
