"""Text encoders, which turn scenarios into vectors.

`MiniLM` is the paper's encoder, `OnnxMiniLM` runs it in ONNX Runtime, and `all_minilm` returns the
faster of the two that is installed. `SentenceTransformerEncoder` loads any other model of that
library. `CachedEncoder` wraps an encoder so that no text is encoded twice.
`oodscen.testing.HashEncoder` has no dependencies.
"""

from importlib.util import find_spec

from oodscen.encoders._cached import CachedEncoder
from oodscen.encoders._check import check_embeddings, encode
from oodscen.encoders._minilm import MiniLM
from oodscen.encoders._onnx import OnnxMiniLM
from oodscen.encoders._sentence_transformers import SentenceTransformerEncoder

__all__ = [
    "CachedEncoder",
    "MiniLM",
    "OnnxMiniLM",
    "SentenceTransformerEncoder",
    "all_minilm",
    "check_embeddings",
    "encode",
]


def all_minilm() -> MiniLM:
    """Return all-MiniLM-L6-v2, in ONNX Runtime if the extra `onnx` is installed, else in torch.

    The two differ by about 1e-6; the encoder's `name` tells which one it is.
    """
    parts = ("onnxruntime", "onnx", "tokenizers")
    return OnnxMiniLM() if all(find_spec(part) for part in parts) else MiniLM()
