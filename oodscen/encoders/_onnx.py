"""all-MiniLM-L6-v2 in ONNX Runtime: several times as fast on a CPU, and without torch once exported.

The model is exported from the verified weights when the first text is encoded, compared with torch text by
text, and kept in the user's cache folder with its SHA-256; a file that is truncated or altered is exported
again. Needs the extra `onnx`; the export also needs `encoder`.
"""

import hashlib
import json
import logging
import os
import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from oodscen._io.files import replace, temporary_folder
from oodscen._numbers import whole_number
from oodscen.encoders._cached import cache_folder
from oodscen.encoders._minilm import (
    COLUMNS,
    ROWS,
    MiniLM,
    forward_passes,
    packaged_folder,
    verify_model,
)
from oodscen.errors import EncoderError, MissingExtra

_log = logging.getLogger(__name__)
_LONGEST = 256
"""Word pieces of a text that the model reads."""
_FORMAT = 1
"""Version of the files in the cache folder."""
_LEAST_COSINE = 0.9999
"""Least cosine to torch's vector with which an export is used."""
_FATAL = 3
"""Level of ONNX Runtime's log below which it is silent."""
_OPSET = 17
_LEAST_ATTENTION = 1e-9
"""Least sum of a text's attention by which its words' sum is divided."""
_SAMPLES = (
    "A deer jumps onto the road.",
    "Bus on its side, windows out, people climbing free, rain.",
    "Q: Why does the ego car stop? A: Because the light is red.",
    "Ego is driving on a two-lane residential road in clear weather, following a white van at a distance.",
    "Fog.",
    "The traffic lights at the junction have failed in the rush hour, an officer waves the cars through one "
    "by one, and a cyclist who has not seen her crosses from the left in front of a lorry that brakes.",
    "0.5 s to collision, 80 km/h, \u00fc\u00f1\u00ee\u00e7\u00f8d\u00e9 \U0001f697",
    "word " * 300,
)
"""Texts of many lengths with which an export is compared with torch."""


class OnnxMiniLM(MiniLM):
    """Runs `MiniLM` in ONNX Runtime; the name differs because the values differ from torch's by about 1e-6.

    As with `MiniLM`, a text's vector does not depend on the texts encoded with it.

    Args:
        folder: Another copy of the same model.
        int8: Use 8-bit weights: smaller, but less accurate. The deviation from torch is measured after the
            export, logged, and available as `error`.
        threads: Number of threads that share the texts out; by default one per core.

    Raises:
        UsageError: If `threads` is below 1.
    """

    def __init__(
        self, folder: str | Path | None = None, *, int8: bool = False, threads: int | None = None
    ) -> None:
        super().__init__(folder)
        self._int8 = int8
        self._threads = (
            os.cpu_count() or 1 if threads is None else whole_number("threads", threads, 1)
        )
        self._error: float | None = None

    @property
    def name(self) -> str:
        """The model's name with its weights' hash, and the runtime that computes it."""
        return f"{super().name}+onnx{'-int8' if self._int8 else ''}"

    @property
    def error(self) -> float:
        """1 minus the smallest cosine to torch's vector over sample texts, measured at the export."""
        self._load()
        assert self._error is not None
        return self._error

    def _read(self) -> Any:
        folder = self._folder or packaged_folder()
        verify_model(folder)
        _require_runtime()
        tokenizer = _load_tokenizer(folder)
        file = cache_folder() / "onnx" / f"{self.name}.onnx"
        export = _load_export(file)
        if export is None:
            content = _export(super()._read, self._int8)
            model = _open_session(content), tokenizer
            self._error = self._error_of(model)
            _save_export(file, content, self._error)
        else:
            content, self._error = export
            model = _open_session(content), tokenizer
        if self._int8:
            _log.warning("%s: cosine to torch's vectors down to %.4f", self.name, 1.0 - self._error)
        return model

    def _error_of(self, model: Any) -> float:
        """Return 1 minus the smallest cosine to torch over sample texts.

        Raises:
            EncoderError: If the export deviates too much from torch.
        """
        vectors = self._forward(model, list(_SAMPLES))
        torch_vectors = MiniLM(self._folder).encode(_SAMPLES)
        least = float(np.einsum("ij,ij->i", vectors, torch_vectors).min())
        if not self._int8 and not least >= _LEAST_COSINE:
            raise EncoderError(
                f"the exported model gives other vectors than torch (cosine {least:.5f}); use MiniLM, and report "
                "the versions of torch, onnx and onnxruntime"
            )
        return 1.0 - least

    def _forward(self, model: Any, texts: list[str]) -> NDArray[np.float32]:
        session, tokenizer = model
        tokens = [encoding.ids for encoding in tokenizer.encode_batch(texts)]
        vectors = np.empty((len(texts), self.dimension), np.float32)

        def run(columns: int, indices: list[int]) -> None:
            ids = np.zeros((ROWS, columns), np.int64)
            mask = np.zeros((ROWS, columns), np.int64)
            for row in range(ROWS):
                pieces = tokens[indices[row % len(indices)]]
                ids[row, : len(pieces)] = pieces
                mask[row, : len(pieces)] = 1
            (rows,) = session.run(None, {"input_ids": ids, "attention_mask": mask})
            vectors[indices] = rows[: len(indices)]

        passes = forward_passes([len(pieces) for pieces in tokens], _LONGEST)
        with ThreadPoolExecutor(self._threads) as pool:
            list(pool.map(run, *zip(*passes, strict=True)))
        return vectors


def _require_runtime() -> None:
    """Import what every use of the model needs, before the first export takes its seconds.

    Raises:
        MissingExtra: If ONNX Runtime or the tokenizers are not installed.
    """
    # ONNX Runtime reports to its maker otherwise, also through proxies; it reads this when it is imported.
    os.environ.setdefault("ORT_DISABLE_TELEMETRY", "1")
    try:
        import onnxruntime  # noqa: F401  (only whether it is there)
        import tokenizers  # noqa: F401  (only whether they are there)
    except ImportError as error:
        raise MissingExtra(
            "the encoder through ONNX Runtime", "onnx", error.name or "onnxruntime"
        ) from None


def _load_tokenizer(folder: Path) -> Any:
    from tokenizers import Tokenizer

    tokenizer = Tokenizer.from_file(str(folder / "tokenizer.json"))
    tokenizer.no_padding()
    tokenizer.enable_truncation(_LONGEST)
    return tokenizer


def _open_session(content: bytes) -> Any:
    """Return the session that runs an exported model in one thread; `_forward` shares the passes out instead."""
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = 1
    options.log_severity_level = _FATAL
    return onnxruntime.InferenceSession(content, options, providers=["CPUExecutionProvider"])


def _sentence_model(model: Any) -> Any:
    """Return a sentence model as one module: the words' vectors, their mean, its scaling to unit length."""
    import torch

    class Pooled(torch.nn.Module):
        def __init__(self) -> None:
            super().__init__()
            self.words = model[0].auto_model

        def forward(self, input_ids: Any, attention_mask: Any) -> Any:
            kinds = torch.zeros_like(input_ids)
            hidden = self.words(
                input_ids=input_ids, attention_mask=attention_mask, token_type_ids=kinds
            ).last_hidden_state
            weight = attention_mask.unsqueeze(-1).to(hidden.dtype)
            mean = (hidden * weight).sum(1) / weight.sum(1).clamp(min=_LEAST_ATTENTION)
            return torch.nn.functional.normalize(mean, dim=1)

    return Pooled().eval()


def _export(load: Callable[[], Any], int8: bool) -> bytes:
    """Return the sentence model in the format of ONNX, including pooling and scaling.

    Raises:
        MissingExtra: If a package that the export needs is not installed.
        EncoderError: If the export fails.
    """
    import torch

    sample = torch.ones((2, COLUMNS), dtype=torch.int64)
    names = ["input_ids", "attention_mask"]
    axes = {name: {0: "texts", 1: "pieces"} for name in names}
    with temporary_folder() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        file = Path(folder) / "model.onnx"
        try:
            torch.onnx.export(
                _sentence_model(load().eval()),
                (sample, sample),
                str(file),
                input_names=names,
                output_names=["vectors"],
                dynamic_axes={**axes, "vectors": {0: "texts"}},
                opset_version=_OPSET,
                dynamo=False,
            )
            if int8:
                from onnxruntime.quantization import QuantType, quantize_dynamic

                small = Path(folder) / "int8.onnx"
                quantize_dynamic(str(file), str(small), weight_type=QuantType.QInt8)
                file = small
        except ImportError as error:
            raise MissingExtra("the export to ONNX", "onnx", error.name or "onnx") from None
        except Exception as error:
            raise EncoderError(f"torch could not export the model to ONNX: {error}") from error
        return file.read_bytes()


def _load_export(file: Path) -> tuple[bytes, float] | None:
    """Return the model exported earlier and its error; `None` if any part is invalid."""
    try:
        content = file.read_bytes()
        record = json.loads(file.with_suffix(".json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    error = record.get("error") if isinstance(record, dict) else None
    if not isinstance(error, float) or record != _record(content, error):
        _log.warning("%s is damaged or of another version; it is exported again", file)
        return None
    return content, error


def _save_export(file: Path, content: bytes, error: float) -> None:
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        replace(file, content)
        replace(file.with_suffix(".json"), json.dumps(_record(content, error)).encode())
    except OSError as fault:
        _log.warning("cannot keep the exported model in %s: %s", file.parent, fault)


def _record(content: bytes, error: float) -> dict[str, Any]:
    """Return the record beside an exported model, by which damage to either is recognised."""
    return {"format": _FORMAT, "sha256": hashlib.sha256(content).hexdigest(), "error": error}
