"""Random streams: repeatable, and independent of what else is drawn."""

import subprocess
import sys

from hypothesis import given
from hypothesis import strategies as st

from oodscen._seeding import stream

KEYS = st.lists(st.text(max_size=5) | st.integers(0, 9), max_size=3)


@given(st.integers(0, 10**9), KEYS)
def test_the_same_key_gives_the_same_stream(seed, keys):
    first, again = (stream(seed, *keys).integers(2**60, size=4).tolist() for _ in "ab")
    assert first == again


@given(st.integers(0, 10**9), st.text(max_size=5), st.text(max_size=5))
def test_other_keys_and_seeds_give_other_streams(seed, one, other):
    draw = stream(seed, "actor", one).integers(2**60)
    assert draw != stream(seed + 1, "actor", one).integers(2**60)
    if one != other:
        assert draw != stream(seed, "actor", other).integers(2**60)


def test_a_fresh_process_draws_the_same():
    code = "from oodscen._seeding import stream; print(stream(7, 'actor', 'deer').integers(2**60))"
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout
    assert int(printed) == stream(7, "actor", "deer").integers(2**60)
