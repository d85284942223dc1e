import os
import shutil
from pathlib import Path

import numpy as np
import pytest

from oodscen.encoders import _minilm as minilm
from oodscen.encoders._sentence_transformers import SentenceTransformerEncoder
from oodscen.errors import EncoderError


def test_a_local_folder_is_a_model():
    encoder = SentenceTransformerEncoder(minilm.packaged_folder(), batch_size=2)
    texts = ["a car waits", "a deer jumps onto the road", "a van"]
    assert encoder.dimension == 384
    assert encoder.name.startswith("model@")
    assert encoder.cacheable
    vectors = encoder.encode(texts)
    np.testing.assert_allclose(np.linalg.norm(vectors, axis=1), 1.0, atol=1e-6)
    assert vectors[0] @ vectors[2] > vectors[0] @ vectors[1]
    assert encoder.encode([]).shape == (0, 384)


@pytest.mark.parametrize("dimension", [1, 7])
def test_a_model_of_any_version_of_the_library_has_a_dimension(monkeypatch, dimension):
    class Model:
        def encode(self, texts, **options):
            return np.ones((len(texts), dimension), np.float32)

    encoder = SentenceTransformerEncoder("some/model")
    monkeypatch.setattr(encoder, "_model", Model())
    assert encoder.dimension == dimension
    assert encoder.encode(["a", "b"]).shape == (2, dimension)


def test_a_hub_name_is_cacheable_only_with_its_revision():
    assert not SentenceTransformerEncoder("some/model").cacheable
    pinned = SentenceTransformerEncoder("some/model", revision="abc")
    assert pinned.cacheable
    assert pinned.name == "some/model@abc"


def test_a_folder_without_a_model_is_an_encoder_error(tmp_path):
    encoder = SentenceTransformerEncoder(tmp_path)
    with pytest.raises(EncoderError):
        _ = encoder.name
    with pytest.raises(EncoderError):
        encoder.encode(["text"])


def test_the_name_tells_apart_what_changes_the_values(tmp_path):
    packaged = Path(minilm.packaged_folder())
    linked = shutil.copytree(packaged, tmp_path / packaged.name, copy_function=os.symlink)
    same = SentenceTransformerEncoder(linked).name
    assert same == SentenceTransformerEncoder(packaged).name

    tokenizer = linked / "tokenizer.json"
    content = tokenizer.read_bytes()
    tokenizer.unlink()
    tokenizer.write_bytes(content + b"\n")
    names = {
        same,
        SentenceTransformerEncoder(linked).name,
        SentenceTransformerEncoder(packaged, device="cuda").name,
        SentenceTransformerEncoder(packaged, batch_size=64).name,
        SentenceTransformerEncoder(packaged, device="cuda", batch_size=64).name,
    }
    assert len(names) == 5
    assert same + "+cuda+batch64" in names
