"""The choice of the runtime of all-MiniLM-L6-v2."""

from importlib.util import find_spec

from oodscen.encoders._minilm import MiniLM
from oodscen.encoders._onnx import OnnxMiniLM


def all_minilm() -> MiniLM:
    """Return all-MiniLM-L6-v2, in ONNX Runtime if the extra `onnx` is installed, else in torch.

    The two differ by about 1e-6; the encoder's `name` says which one it is.
    """
    has_onnx = all(find_spec(package) for package in ("onnxruntime", "onnx", "tokenizers"))
    return OnnxMiniLM() if has_onnx else MiniLM()
