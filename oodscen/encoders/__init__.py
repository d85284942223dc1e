"""Text encoders: what turns scenarios into vectors.

`MiniLM` is the paper's encoder, `OnnxMiniLM` the same by ONNX Runtime, `all_minilm` whichever of the two is quicker here,
`SentenceTransformerEncoder` any other model of that library, and `CachedEncoder` wraps either so that no text is encoded twice. `oodscen.testing.HashEncoder` needs no
dependency at all.
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
    """Return all-MiniLM-L6-v2: through ONNX Runtime where the extra `onnx` is installed, else through torch.

    The two differ by about 1e-6; the encoder's `name` says which it is.
    """
    parts = ("onnxruntime", "onnx", "tokenizers")
    return OnnxMiniLM() if all(find_spec(part) for part in parts) else MiniLM()
