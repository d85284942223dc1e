"""Labels are compared without what all of them share."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen._paper import ATTESTED
from oodscen.encoders._centring import label_rows, unit_rows
from oodscen.errors import EncoderError
from oodscen.testing._encoder import HashEncoder

ENCODER = HashEncoder()
labels = st.lists(
    st.sampled_from(["fog on the road", "a deer on the road", "hail", ""]), max_size=5
)


@given(labels)
def test_rows_are_of_unit_length_or_zero(texts):
    rows, centre = label_rows(ENCODER, texts)
    assert rows.shape == (len(texts), ENCODER.dimension)
    lengths = np.linalg.norm(rows, axis=1)
    assert np.all((np.abs(lengths - 1.0) < 1e-9) | (lengths == 0.0))
    names = unit_rows(ENCODER, [item.name for item in ATTESTED])
    assert np.allclose(centre * (len(texts) + len(names)), rows.sum(axis=0) + names.sum(axis=0))


def test_words_that_all_labels_share_bring_none_together():
    texts = [f"unusual thing on the road: {word}" for word in ("fog", "deer", "hail", "mud", "ice")]
    rows, centre = label_rows(ENCODER, texts)
    raw, centred = rows @ rows.T, (rows - centre) @ (rows - centre).T
    lengths = np.sqrt(np.diag(centred))
    centred = centred / np.outer(lengths, lengths)
    away = ~np.eye(len(texts), dtype=bool)
    assert raw[away].max() > 0.6
    assert centred[away].max() < raw[away].min()


class Shuffled(HashEncoder):
    """Gives the rows in the opposite order."""

    def encode(self, texts):
        return super().encode(texts)[::-1].copy()


def test_rows_that_belong_to_other_texts_are_refused() -> None:
    with pytest.raises(EncoderError, match="another vector than when it is alone"):
        label_rows(Shuffled(64), ["a sofa", "a deer on the road"])
