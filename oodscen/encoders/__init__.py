"""Text encoders: what turns scenarios into vectors.

`MiniLM` is the paper's encoder, `OnnxMiniLM` the same by ONNX Runtime, `SentenceTransformerEncoder` any other model of that library, and
`CachedEncoder` wraps either so that no text is encoded twice. `oodscen.testing.HashEncoder` needs no
dependency at all.
"""

from oodscen.encoders.cached import CachedEncoder
from oodscen.encoders.check import check_embeddings, encode
from oodscen.encoders.minilm import MiniLM
from oodscen.encoders.onnx import OnnxMiniLM
from oodscen.encoders.sentence_transformers import SentenceTransformerEncoder

__all__ = [
    "CachedEncoder",
    "MiniLM",
    "OnnxMiniLM",
    "SentenceTransformerEncoder",
    "check_embeddings",
    "encode",
]
