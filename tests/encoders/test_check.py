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


def test_an_encoder_may_return_the_same_array_every_time():
    kept = np.ones((1, 4), np.float32)

    class Buffer:
        name, dimension = "buffer", 4

        def encode(self, texts):
            kept[:] = len(texts[0])
            return kept

    first, second = (encode(Buffer(), [text]) for text in ("a", "bb"))
    assert (first[0, 0], second[0, 0]) == (1.0, 2.0)
