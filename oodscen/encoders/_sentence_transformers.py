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
from oodscen._io.files import file_sha256
from oodscen.encoders._check import check_embeddings
from oodscen.errors import EncoderError, MissingExtra

_WEIGHTS = ("*.safetensors", "pytorch_model*.bin")
_SETTINGS = ("*.json", "*.txt", "*.model")
"""The tokenizer's files and the configuration, which determine the values as the weights do."""


class SentenceTransformerEncoder(Brief):
    """A sentence-transformers model, from a local folder or from the Hugging Face hub.

    The model is loaded when the first text is encoded.

    Args:
        model_name_or_path: A folder that holds a model, or a model's name on the hub.
        revision: Commit or tag of a hub model; without it, the name does not determine the values.
        device: `cpu`, `cuda`, ...; by default the CPU, whose values are reproducible. A GPU changes
            the values by up to about 3e-5, so its device is part of the name.
        batch_size: Texts per forward pass. With 1 a text's vector does not depend on the texts
            encoded with it; larger batches are faster and change the last bits (about 2e-7), so the
            size is part of the name.
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
        self._dimension: int | None = None
        self._lock = threading.Lock()

    def __getstate__(self) -> dict[str, Any]:
        """Pickle what the model is loaded from, not the model."""
        return {**vars(self), "_model": None, "_lock": None}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state, _lock=threading.Lock())

    @property
    def name(self) -> str:
        """The folder's name with the hash of its model, or the hub's name with the revision.

        A device other than the CPU and a batch of several texts follow: `all-mpnet@1f2e3d4c5b6a+cuda+batch64`.
        """
        if self._name is None:
            device = "" if self._device == "cpu" else f"+{self._device}"
            batch = "" if self._batch_size == 1 else f"+batch{self._batch_size}"
            self._name = f"{self._model_name()}{device}{batch}"
        return self._name

    def _model_name(self) -> str:
        if self._is_local:
            folder = Path(self._source)
            return f"{folder.name}@{_sha256(folder)[:12]}"
        return f"{self._source}@{self._revision}" if self._revision else self._source

    @property
    def cacheable(self) -> bool:
        """True if the name determines the values, so that vectors can be cached on disk under it."""
        return self._is_local or self._revision is not None

    @property
    def dimension(self) -> int:
        """Length of a vector; loads the model."""
        if self._dimension is None:
            # Not asked for by a method: its name depends on the library's version, and it may not know.
            self._dimension = int(self._embed(["a"]).shape[1])
        return self._dimension

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
        return check_embeddings(self._embed(list(texts)), len(texts), self)

    def _embed(self, texts: list[str]) -> NDArray[np.float32]:
        """Return the model's embeddings of at least one text."""
        model = self._load()
        try:
            with self._lock:
                return np.asarray(self._forward(model, texts), np.float32)
        except Exception as error:
            raise EncoderError(
                f"{self._source} could not encode {len(texts)} texts: {error}"
            ) from error

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


def _sha256(folder: Path) -> str:
    """Return the hash of a model's weights, tokenizer and settings, wherever the folder stands."""
    weights = sorted(file for pattern in _WEIGHTS for file in folder.rglob(pattern))
    if not weights:
        raise EncoderError(f"{folder} holds no weights ({' or '.join(_WEIGHTS)})")
    settings = sorted(file for pattern in _SETTINGS for file in folder.rglob(pattern))
    total = hashlib.sha256()
    for file in (*weights, *settings):
        total.update(str(file.relative_to(folder)).encode())
        total.update(file_sha256(file))
    return total.hexdigest()
