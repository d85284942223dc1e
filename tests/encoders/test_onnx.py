import os
import shutil
import sys

import numpy as np
import pytest

from oodscen.encoders._all_minilm import all_minilm
from oodscen.encoders._cached import cache_folder
from oodscen.encoders._minilm import MiniLM
from oodscen.encoders._onnx import OnnxMiniLM
from oodscen.errors import MissingExtra, UsageError
from oodscen.protocols import Encoder
from tests.needs import needs

pytestmark = needs("onnxruntime", "onnx")

TEXTS = [
    "A silver sedan waits at the red light.",
    "A deer jumps onto the road.",
    "Ego is driving on a two-lane road at night, following a white van at a steady distance.",
    "Fog.",
    "long " * 400,
]


@pytest.fixture(scope="module")
def folder(minilm, cache, tmp_path_factory):
    """Return a cache of this module's own, with the export of the whole session."""
    return shutil.copytree(
        cache / "oodscen" / "onnx", tmp_path_factory.mktemp("cache") / "oodscen" / "onnx"
    ).parents[1]


@pytest.fixture(autouse=True)
def own_cache(monkeypatch, folder):
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder))


@pytest.fixture(scope="module")
def encoder():
    return OnnxMiniLM(threads=1)


def test_the_default_is_the_quicker_one():
    assert isinstance(all_minilm(), OnnxMiniLM)


def test_it_agrees_with_torch(encoder):
    ours, torchs = encoder.encode(TEXTS), MiniLM().encode(TEXTS)
    assert ours.shape == (5, 384)
    assert ours.dtype == np.float32
    assert np.einsum("ij,ij->i", ours, torchs).min() >= 0.9999
    assert 0.0 <= abs(encoder.error) < 1e-4
    assert encoder.name == "all-MiniLM-L6-v2@53aa51172d14+onnx"
    assert isinstance(encoder, Encoder)


def test_neighbours_change_no_bit(encoder):
    many = [*TEXTS, *(f"Car number {i} waits at the light." for i in range(9))]
    together = encoder.encode(many)
    assert np.array_equal(together, encoder.encode(many[::-1])[::-1])
    for text, row in zip(TEXTS, together, strict=False):
        assert np.array_equal(encoder.encode([text])[0], row)


@pytest.mark.parametrize("damage", ["altered", "no record"])
def test_a_damaged_export_is_made_again(encoder, damage, monkeypatch):
    expected = encoder.encode(TEXTS[:1])
    file = cache_folder() / "onnx" / f"{encoder.name}.onnx"
    content = file.read_bytes()
    exports = []
    # An export takes seconds, as does its comparison with torch; those before the damage were real.
    monkeypatch.setattr(OnnxMiniLM, "_error_of", lambda self, model: 0.0)
    monkeypatch.setattr(
        "oodscen.encoders._onnx._export", lambda load, int8: exports.append(int8) or content
    )
    if damage == "altered":
        file.write_bytes(content[:-1] + bytes([content[-1] ^ 1]))
    else:
        file.with_suffix(".json").write_text("{")
    assert np.array_equal(OnnxMiniLM(threads=1).encode(TEXTS[:1]), expected)
    assert exports == [False]
    assert file.read_bytes() == content
    assert np.array_equal(OnnxMiniLM(threads=1).encode(TEXTS[:1]), expected)
    assert exports == [False]


def test_eight_bits_say_how_far_off_they_are(caplog):
    small = OnnxMiniLM(int8=True, threads=1)
    assert small.name.endswith("+onnx-int8")
    assert 0.0 < small.error < 0.2
    assert "cosine to torch" in caplog.text


def test_the_runtime_is_told_not_to_report_to_its_maker(encoder, monkeypatch):
    monkeypatch.delenv("ORT_DISABLE_TELEMETRY", raising=False)
    type(encoder)().encode(["A red light."])
    assert os.environ["ORT_DISABLE_TELEMETRY"] == "1"


def test_a_missing_runtime_names_the_extra_before_anything_is_exported(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(
        "oodscen.encoders._onnx._export", lambda load, int8: pytest.fail("is exported")
    )
    monkeypatch.setitem(sys.modules, "onnxruntime", None)
    with pytest.raises(MissingExtra) as caught:
        OnnxMiniLM().encode(["text"])
    assert caught.value.extra == "onnx"


def test_a_number_of_threads_is_one_or_more():
    with pytest.raises(UsageError, match="threads"):
        OnnxMiniLM(threads=0)
