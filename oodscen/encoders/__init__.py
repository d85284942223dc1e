"""Text encoders, which turn scenarios into vectors.

`oodscen.make_encoder` creates one by name: `minilm` is the paper's encoder, in ONNX Runtime if that
is installed; `sentence-transformers:NAME` loads any other model of that library; `hash` has no
dependencies. `CachedEncoder` wraps an encoder so that no text is encoded twice.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
