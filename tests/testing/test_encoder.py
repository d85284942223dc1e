import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen import make_encoder
from oodscen.errors import UsageError
from oodscen.protocols import Encoder
from oodscen.testing._encoder import HashEncoder


@given(st.lists(st.text(max_size=30), max_size=8), st.integers(1, 64))
def test_one_row_a_text_of_unit_length_or_zero(texts, dimension):
    vectors = HashEncoder(dimension).encode(texts)
    assert vectors.shape == (len(texts), dimension)
    assert vectors.dtype == np.float32
    lengths = np.linalg.norm(vectors, axis=1)
    assert np.all((np.abs(lengths - 1.0) < 1e-5) | (lengths == 0.0))


@given(st.permutations(["a", "red", "car", "waits", "here"]))
def test_word_order_and_case_play_no_part(words):
    encoder = HashEncoder()
    rows = encoder.encode([" ".join(words).upper(), "a red car waits here!"])
    assert np.array_equal(rows[0], rows[1])


def test_texts_that_share_words_are_near():
    rows = HashEncoder().encode(["a red car waits", "a red car turns", "deer jump over fences"])
    assert rows[0] @ rows[1] > rows[0] @ rows[2]


def test_it_is_an_encoder_with_a_name():
    assert isinstance(HashEncoder(), Encoder)
    assert HashEncoder().name == "hash-256"


@given(st.integers(1, 4096))
def test_its_name_may_carry_the_dimension(dimension):
    assert make_encoder(f"hash:{dimension}").name == HashEncoder(dimension).name


@given(st.text(min_size=1).filter(lambda text: not text.isdecimal()) | st.integers(max_value=0))
def test_another_dimension_is_told_in_words(dimension):
    with pytest.raises(UsageError, match=r"^the dimension of the hash encoder must be a whole"):
        make_encoder(f"hash:{dimension}")


def test_another_process_gives_the_same_bytes():
    program = (
        "from oodscen.testing._encoder import HashEncoder as H; import sys;"
        "sys.stdout.write(H(32).encode(['a car waits']).tobytes().hex())"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
    assert run.stdout.decode() == HashEncoder(32).encode(["a car waits"]).tobytes().hex()
