import numpy as np
import pytest

from oodscen.encoders._check import check_embeddings, encode
from oodscen.errors import EncoderError
from oodscen.testing._encoder import HashEncoder

ENCODER = HashEncoder(4)


def test_what_the_protocol_promises_passes():
    vectors = np.asfortranarray(np.ones((3, 4), np.float32))
    assert check_embeddings(vectors, 3, ENCODER).flags.c_contiguous


@pytest.mark.parametrize(
    "vectors",
    [
        [[0.0] * 4] * 3,
        None,
        np.ones((2, 4), np.float32),
        np.ones((3, 5), np.float32),
        np.ones(12, np.float32),
        np.ones((3, 4), np.float64),
        np.full((3, 4), np.nan, np.float32),
        np.full((3, 4), np.inf, np.float32),
    ],
)
def test_anything_else_is_refused(vectors):
    with pytest.raises(EncoderError):
        check_embeddings(vectors, 3, ENCODER)


def test_a_dimension_of_numpy_is_one():
    encoder = HashEncoder(4)
    encoder.dimension = np.int64(4)
    assert encode(encoder, ["a", "b"]).shape == (2, 4)


def test_what_an_encoder_does_with_its_list_changes_nothing():
    class Emptying(HashEncoder):
        def encode(self, texts):
            found = super().encode(texts)[: self.rows]
            texts.clear()
            return found

    encoder, given = Emptying(4), ["a", "b", "c"]
    encoder.rows = 3
    assert (encode(encoder, given) == encode(HashEncoder(4), given)).all()
    assert given == ["a", "b", "c"]
    encoder.rows = 2
    with pytest.raises(EncoderError, match=r"shape \(2, 4\) for 3 texts, not \(3, 4\)"):
        encode(encoder, given)


def test_an_encoder_may_return_the_same_array_every_time():
    kept = np.ones((1, 4), np.float32)

    class Buffer:
        name, dimension = "buffer", 4

        def encode(self, texts):
            kept[:] = len(texts[0])
            return kept

    first, second = (encode(Buffer(), [text]) for text in ("a", "bb"))
    assert (first[0, 0], second[0, 0]) == (1.0, 2.0)
