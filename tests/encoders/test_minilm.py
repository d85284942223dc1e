import shutil
import sys

import numpy as np
import pytest

from oodscen.encoders import _minilm as minilm
from oodscen.encoders._minilm import MiniLM
from oodscen.errors import EncoderError, MissingExtra
from oodscen.protocols import Encoder

TEXTS = [
    "A silver sedan waits at the red light.",
    "A silver car stands at a red traffic light.",
    "A deer jumps onto the road.",
    "Ego is driving on a two-lane road at night, following a white van at a steady distance.",
]


@pytest.fixture(scope="session")
def encoder():
    return MiniLM()


def test_name_and_dimension_are_known_without_the_model():
    fresh = MiniLM(folder="/nowhere")
    assert fresh.name == "all-MiniLM-L6-v2@53aa51172d14"
    assert fresh.dimension == 384
    assert fresh.encode([]).shape == (0, 384)
    assert isinstance(fresh, Encoder)


def test_rows_are_unit_float32_in_order(encoder):
    vectors = encoder.encode(TEXTS)
    assert vectors.shape == (4, 384)
    assert vectors.dtype == np.float32
    assert vectors.flags.c_contiguous
    np.testing.assert_allclose(np.linalg.norm(vectors, axis=1), 1.0, atol=1e-6)
    assert vectors[0] @ vectors[1] > vectors[0] @ vectors[3] > vectors[0] @ vectors[2]


def test_neighbours_change_no_bit(encoder):
    many = [*TEXTS, *(f"Car number {i} waits at the light." for i in range(9))]
    together = encoder.encode(many)
    backwards = encoder.encode(many[::-1])[::-1]
    assert np.array_equal(together, backwards)
    for text, row in zip(TEXTS, together, strict=False):
        assert np.array_equal(encoder.encode([text])[0], row)


def test_it_agrees_with_the_library_itself(encoder):
    model = encoder._load()
    expected = model.encode(TEXTS, batch_size=1, normalize_embeddings=True, show_progress_bar=False)
    np.testing.assert_allclose(encoder.encode(TEXTS), expected, atol=1e-6)


def test_other_weights_are_refused(tmp_path):
    (tmp_path / "model.safetensors").write_bytes(b"not the weights")
    with pytest.raises(EncoderError, match="SHA-256"):
        MiniLM(tmp_path).encode(["text"])


def test_another_tokenizer_is_refused(tmp_path):
    source = minilm.packaged_folder()
    (tmp_path / "model.safetensors").symlink_to(source / "model.safetensors")
    shutil.copy(source / "tokenizer_config.json", tmp_path / "tokenizer.json")
    with pytest.raises(EncoderError, match=r"tokenizer\.json"):
        MiniLM(tmp_path).encode(["text"])


def test_missing_weights_name_the_extra(monkeypatch):
    monkeypatch.setattr(minilm, "_PACKAGE", "no_such_package_of_weights")
    with pytest.raises(MissingExtra) as caught:
        MiniLM().encode(["text"])
    assert caught.value.extra == "encoder"


def test_missing_library_names_the_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "sentence_transformers", None)
    with pytest.raises(MissingExtra) as caught:
        MiniLM().encode(["text"])
    assert caught.value.pip == "pip install 'oodscen[encoder]'"
