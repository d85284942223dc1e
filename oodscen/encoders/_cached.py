"""A cache of text vectors, in memory and on disk."""

import atexit
import hashlib
import io
import logging
import os
import re
import threading
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from oodscen._display import Brief
from oodscen._io.files import read_bytes, replace, temporary_folder
from oodscen._io.lock import locked
from oodscen._members import optional
from oodscen.encoders._check import dimension, encode
from oodscen.errors import InUse, StudyError
from oodscen.protocols import Encoder

_log = logging.getLogger(__name__)
_FORMAT = "oodscen-vectors-1"
_WAIT_S = 30.0
"""Time to wait for another process that is saving, s; saving takes far less unless that process is halted."""
_MOST_BYTES = 1 << 40
"""Bytes of a file that are read; a million texts have 1.6 GB."""


def cache_folder() -> Path:
    """Return the user's cache folder for this library: `$XDG_CACHE_HOME/oodscen`.

    A user without a home gets a temporary folder, which is removed when the process ends.
    """
    root = os.environ.get("XDG_CACHE_HOME")
    if root:
        return Path(root) / "oodscen"
    try:
        return Path.home() / ".cache" / "oodscen"
    except RuntimeError:
        return _temporary_cache()


@cache
def _temporary_cache() -> Path:
    folder = temporary_folder()
    atexit.register(folder.cleanup)
    return Path(folder.name)


class CachedEncoder(Brief):
    """Wraps an encoder and encodes each distinct text once.

    Args:
        encoder: The encoder to wrap; its name must determine its values.
        folder: Folder that keeps the vectors between processes, in one file per encoder. It is written whenever a
            twentieth of them is new; call `save` to keep the others too. A file that is truncated, altered or
            from another encoder is ignored and replaced. Several processes may write at once: each waits for the
            others and keeps what they saved. If the folder cannot be written, a warning is logged and nothing
            else changes.
    """

    _repr_fields = ("_encoder", "_folder")

    def __init__(self, encoder: Encoder, folder: str | Path | None = None) -> None:
        self._encoder = encoder
        self._folder = None if folder is None else Path(folder)
        self._lock = threading.RLock()
        self._vectors: dict[bytes, NDArray[np.float32]] = {}
        self._is_loaded = self._folder is None
        self._unsaved = 0

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the encoder and the folder, without the vectors."""
        return type(self), (self._encoder, self._folder)

    @property
    def name(self) -> str:
        """The wrapped encoder's name."""
        return self._encoder.name

    @property
    def dimension(self) -> int:
        """The wrapped encoder's dimension."""
        return dimension(self._encoder)

    @property
    def cacheable(self) -> bool:
        """True if the wrapped encoder declares that its name determines its values."""
        return optional(self._encoder, "cacheable", False) is True

    @property
    def path(self) -> Path | None:
        """The file that holds this encoder's vectors; `None` without a folder."""
        if self._folder is None:
            return None
        readable = re.sub(r"[^A-Za-z0-9.@-]+", "-", self.name)[:80]
        digest = hashlib.sha256(self.name.encode()).hexdigest()
        return self._folder / f"{readable}.{digest[:8]}.npz"

    def encode(self, texts: Sequence[str]) -> NDArray[np.float32]:
        """Return one row per text, in order: [n, d] float32. Thread-safe.

        Raises:
            EncoderError: If the wrapped encoder fails or breaks its contract.
        """
        if not texts:
            return np.zeros((0, self.dimension), np.float32)
        keys = [hashlib.sha256(text.encode("utf-8", "surrogatepass")).digest() for text in texts]
        with self._lock:
            if not self._is_loaded and self.path is not None:
                self._vectors = _read(self.path, self._encoder)
                self._is_loaded = True
            self._encode_missing(dict(zip(keys, texts, strict=True)))
            return np.stack([self._vectors[key] for key in keys])

    def _encode_missing(self, texts: dict[bytes, str]) -> None:
        missing = {key: text for key, text in texts.items() if key not in self._vectors}
        if not missing:
            return
        rows = encode(self._encoder, list(missing.values()))
        self._vectors.update(zip(missing, rows, strict=True))
        self._unsaved += len(missing)
        # Saving rewrites the whole file; waiting until it grew by a twentieth keeps the total cost linear.
        if self._unsaved * 20 >= len(self._vectors):
            self.save()

    def save(self) -> None:
        """Write the unsaved vectors to disk."""
        path = self.path
        with self._lock:
            if path is None or not self._unsaved:
                return
            try:
                path.parent.mkdir(parents=True, exist_ok=True)
                with locked(path, "cache", wait_s=_WAIT_S):
                    self._vectors = _read(path, self._encoder) | self._vectors
                    _write(path, self.name, self._vectors)
            except (OSError, StudyError, InUse) as error:
                _log.warning("cannot keep the vectors of %s in %s: %s", self.name, path, error)
            self._unsaved = 0


def _read(path: Path, encoder: Encoder) -> dict[bytes, NDArray[np.float32]]:
    """Return the vectors that a file holds for this encoder; empty if any part of it is invalid."""
    try:
        content = read_bytes(path, limit=_MOST_BYTES)
    except OSError:
        return {}
    # The digest is checked before parsing, because an altered archive can fail in many ways.
    digest, body = content[:32], content[32:]
    if hashlib.sha256(body).digest() != digest:
        _log.warning("%s is damaged; its vectors are computed again", path)
        return {}
    with np.load(io.BytesIO(body), allow_pickle=False) as data:
        head = (_FORMAT, encoder.name)
        if not {"head", "keys", "vectors"} <= set(data) or tuple(data["head"].tolist()) != head:
            _log.warning("%s is not of %s; it will be replaced", path, encoder.name)
            return {}
        keys, vectors = data["keys"], data["vectors"]
    if vectors.shape != (len(keys), dimension(encoder)) or vectors.dtype != np.float32:
        return {}
    return {key.tobytes(): vector for key, vector in zip(keys, vectors, strict=True)}


def _write(path: Path, name: str, vectors: dict[bytes, NDArray[np.float32]]) -> None:
    body = io.BytesIO()
    keys = np.frombuffer(b"".join(vectors), np.uint8).reshape(-1, 32)
    np.savez(
        body, head=np.array([_FORMAT, name]), keys=keys, vectors=np.stack(list(vectors.values()))
    )
    content = body.getvalue()
    replace(path, hashlib.sha256(content).digest() + content)
