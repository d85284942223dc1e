"""Text encoders, which turn scenarios into vectors.

`oodscen.make_encoder` creates one by name: `minilm` is the paper's encoder, in ONNX Runtime if that
is installed; `sentence-transformers:NAME` loads any other model of that library; `hash` has no
dependencies. With `cache=True` no text is encoded twice.
"""
