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

from oodscen._files import replace, temporary_folder
from oodscen.encoders._cached import cache_folder
from oodscen.encoders._minilm import COLUMNS, ROWS, MiniLM, packaged, passes, verified
from oodscen.errors import EncoderError, MissingExtra

_log = logging.getLogger(__name__)
_LONGEST = 256
"""Pieces of a text that the model reads."""
_FORMAT = 1
"""Version of the files that are kept."""
_LEAST_COSINE = 0.9999
"""Least cosine to torch's vector with which an export is used."""
_FATAL = 3
"""Level of ONNX Runtime's log below which it is silent."""
_OPSET = 17
_NO_WORDS = 1e-9
"""Least sum of a text's attention by which its words are averaged."""
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
    """

    def __init__(
        self, folder: str | Path | None = None, *, int8: bool = False, threads: int = 0
    ) -> None:
        super().__init__(folder)
        self._int8 = int8
        self._threads = threads
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
        folder = self._folder or packaged()
        verified(folder)
        # ONNX Runtime reports to its maker otherwise, also through proxies; it reads this when it is imported.
        os.environ.setdefault("ORT_DISABLE_TELEMETRY", "1")
        try:
            import onnxruntime
            from tokenizers import Tokenizer
        except ImportError as error:
            raise MissingExtra(
                "the encoder through ONNX Runtime", "onnx", error.name or "onnxruntime"
            ) from None
        tokenizer = Tokenizer.from_file(str(folder / "tokenizer.json"))
        tokenizer.no_padding()
        tokenizer.enable_truncation(_LONGEST)
        options = onnxruntime.SessionOptions()
        # A pass is small: `_forward` shares the passes out instead.
        options.intra_op_num_threads = 1
        options.log_severity_level = _FATAL

        def opened(content: bytes) -> tuple[Any, Any]:
            providers = ["CPUExecutionProvider"]
            return onnxruntime.InferenceSession(content, options, providers=providers), tokenizer

        file = cache_folder() / "onnx" / f"{self.name}.onnx"
        kept = _kept(file)
        if kept is None:
            content = _exported(super()._read, self._int8)
            model = opened(content)
            self._error = self._compared(model)
            _keep(file, content, self._error)
        else:
            content, self._error = kept
            model = opened(content)
        if self._int8:
            _log.warning("%s: cosine to torch's vectors down to %.4f", self.name, 1.0 - self._error)
        return model

    def _compared(self, model: Any) -> float:
        """Return 1 minus the smallest cosine to torch over sample texts.

        Raises:
            EncoderError: If the export deviates too much from torch.
        """
        ours = self._forward(model, list(_SAMPLES))
        theirs = MiniLM(self._folder).encode(_SAMPLES)
        least = float(np.einsum("ij,ij->i", ours, theirs).min())
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

        def fill(one: tuple[int, list[int]]) -> None:
            columns, places = one
            ids = np.zeros((ROWS, columns), np.int64)
            mask = np.zeros((ROWS, columns), np.int64)
            for row in range(ROWS):
                own = tokens[places[row % len(places)]]
                ids[row, : len(own)] = own
                mask[row, : len(own)] = 1
            (found,) = session.run(None, {"input_ids": ids, "attention_mask": mask})
            vectors[places] = found[: len(places)]

        with ThreadPoolExecutor(self._threads or os.cpu_count() or 1) as pool:
            list(pool.map(fill, passes([len(row) for row in tokens], _LONGEST)))
        return vectors


def _pooled(model: Any) -> Any:
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
            mean = (hidden * weight).sum(1) / weight.sum(1).clamp(min=_NO_WORDS)
            return torch.nn.functional.normalize(mean, dim=1)

    return Pooled().eval()


def _exported(load: Callable[[], Any], int8: bool) -> bytes:
    """Return the exported sentence model, including pooling and scaling."""
    import torch

    sample = torch.ones((2, COLUMNS), dtype=torch.int64)
    names = ["input_ids", "attention_mask"]
    free = {name: {0: "texts", 1: "pieces"} for name in names}
    with temporary_folder() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        file = Path(folder) / "model.onnx"
        try:
            torch.onnx.export(
                _pooled(load().eval()),
                (sample, sample),
                str(file),
                input_names=names,
                output_names=["vectors"],
                dynamic_axes={**free, "vectors": {0: "texts"}},
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


def _kept(file: Path) -> tuple[bytes, float] | None:
    """Return the model exported earlier and its error; `None` if any part is invalid."""
    try:
        content = file.read_bytes()
        about = json.loads(file.with_suffix(".json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    error = about.get("error") if isinstance(about, dict) else None
    if not isinstance(error, float) or about != _about(content, error):
        _log.warning("%s is damaged or of another version; it is exported again", file)
        return None
    return content, error


def _about(content: bytes, error: float) -> dict[str, Any]:
    return {"format": _FORMAT, "sha256": hashlib.sha256(content).hexdigest(), "error": error}


def _keep(file: Path, content: bytes, error: float) -> None:
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        replace(file, content)
        replace(file.with_suffix(".json"), json.dumps(_about(content, error)).encode())
    except OSError as fault:
        _log.warning("cannot keep the exported model in %s: %s", file.parent, fault)
