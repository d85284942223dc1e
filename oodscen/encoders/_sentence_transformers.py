"""An encoder for any model that the package sentence-transformers can load."""

import hashlib
import importlib
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from oodscen._display import Brief
from oodscen._files import file_sha256
from oodscen.encoders._check import check_embeddings
from oodscen.errors import EncoderError, MissingExtra

_WEIGHTS = ("*.safetensors", "pytorch_model*.bin")


class SentenceTransformerEncoder(Brief):
    """A sentence-transformers model, from a local folder or from the Hugging Face hub.

    The model is loaded when the first text is encoded.

    Args:
        model_name_or_path: A folder that holds a model, or a model's name on the hub.
        revision: Commit or tag of a hub model; without it, the name does not determine the values.
        device: `cpu`, `cuda`, ...; by default the CPU, whose values are reproducible.
        batch_size: Texts per forward pass. With 1 a text's vector does not depend on the texts
            encoded with it; larger batches are faster and change the last bits (about 2e-7).
    """

    _repr_fields: ClassVar[tuple[str, ...]] = ("_source", "_device")

    def __init__(
        self,
        model_name_or_path: str | Path,
        *,
        revision: str | None = None,
        device: str = "cpu",
        batch_size: int = 1,
    ) -> None:
        self._source = str(model_name_or_path)
        self._revision = revision
        self._device = device
        self._batch_size = batch_size
        self._model: Any = None
        self._name: str | None = None
        self._lock = threading.Lock()

    def __getstate__(self) -> dict[str, Any]:
        """Pickle what the model is loaded from, not the model."""
        return {**vars(self), "_model": None, "_lock": None}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state, _lock=threading.Lock())

    @property
    def name(self) -> str:
        """The folder's name with the hash of its weights, or the hub's name with the revision."""
        if self._name is None:
            if self._is_local:
                folder = Path(self._source)
                self._name = f"{folder.name}@{_weights_sha256(folder)[:12]}"
            else:
                self._name = f"{self._source}@{self._revision}" if self._revision else self._source
        return self._name

    @property
    def cacheable(self) -> bool:
        """True if the name determines the values, so that vectors can be cached on disk under it."""
        return self._is_local or self._revision is not None

    @property
    def dimension(self) -> int:
        """Length of a vector; loads the model."""
        return int(self._load().get_embedding_dimension())

    def encode(self, texts: Sequence[str]) -> NDArray[np.float32]:
        """Return one row of unit length per text, in order.

        Returns:
            [n, d] float32, C-contiguous; [0, d] for no texts.

        Raises:
            MissingExtra: If sentence-transformers is not installed.
            EncoderError: If the model cannot be loaded or fails.
        """
        if not texts:
            return np.zeros((0, self.dimension), np.float32)
        model = self._load()
        try:
            with self._lock:
                vectors = self._forward(model, list(texts))
        except Exception as error:
            raise EncoderError(
                f"{self._source} could not encode {len(texts)} texts: {error}"
            ) from error
        return check_embeddings(np.asarray(vectors, np.float32), len(texts), self)

    @property
    def _is_local(self) -> bool:
        return Path(self._source).is_dir()

    def _forward(self, model: Any, texts: list[str]) -> Any:
        """Return the model's embeddings; subclasses may batch the texts differently."""
        return model.encode(
            texts,
            batch_size=self._batch_size,
            show_progress_bar=False,
            convert_to_numpy=True,
            normalize_embeddings=True,
        )

    def _load(self) -> Any:
        with self._lock:
            if self._model is None:
                self._model = self._read()
            return self._model

    def _read(self) -> Any:
        try:
            import sentence_transformers
        except ImportError as error:
            raise MissingExtra(
                "a sentence-transformers encoder", "encoder", error.name or "sentence_transformers"
            ) from None
        try:
            with _quiet_loading():
                model = sentence_transformers.SentenceTransformer(
                    self._source,
                    revision=self._revision,
                    device=self._device,
                    local_files_only=self._is_local,
                )
        except Exception as error:
            raise EncoderError(f"cannot load the encoder {self._source}: {error}") from error
        return model.eval()


@contextmanager
def _quiet_loading() -> Iterator[None]:
    logging: Any = importlib.import_module("transformers.utils.logging")
    shown = logging.is_progress_bar_enabled()
    logging.disable_progress_bar()
    try:
        yield
    finally:
        if shown:
            logging.enable_progress_bar()


def _weights_sha256(folder: Path) -> str:
    files = sorted(file for pattern in _WEIGHTS for file in folder.rglob(pattern))
    if not files:
        raise EncoderError(f"{folder} holds no weights ({' or '.join(_WEIGHTS)})")
    total = hashlib.sha256()
    for file in files:
        total.update(file_sha256(file))
    return total.hexdigest()
