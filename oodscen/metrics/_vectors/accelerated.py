"""Nearest-neighbour search in torch, on a GPU if there is one.

`nearest` returns what `oodscen.encoders._similarity.nearest` returns, to the last few bits.
Sums are taken in float32 (never TF32) and in another order, so two references whose cosines agree
to 1e-6 may swap places. torch is imported only when a device is requested.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from oodscen.encoders._similarity import Nearest, Rows, Vectors
from oodscen.errors import MissingExtra, UsageError

_ROWS = 8192
"""Queries of a block of cosines."""
_COLUMNS = 8192
"""References of a block of cosines."""


def chosen_device(name: str) -> str:
    """Return `cpu`, or the torch device that `name` asks for; `auto` is CUDA if available.

    Raises:
        MissingExtra: If torch is not installed and a device was requested by name.
        UsageError: If torch has no such device here.
    """
    if name == "cpu":
        return name
    try:
        import torch
    except ImportError:
        if name == "auto":
            return "cpu"
        raise MissingExtra(f"the device {name}", "encoder", "torch") from None
    if name == "auto":
        return "cuda" if torch.cuda.is_available() else "cpu"
    try:
        torch.zeros(1, device=name).cpu()
    except (RuntimeError, AssertionError, ImportError) as error:
        reason = str(error).splitlines()[0]
        raise UsageError(f"torch cannot use the device {name!r} here: {reason}") from None
    return name


def nearest(queries: Vectors, references: Rows, device: str) -> Nearest:
    """Return the nearest reference of each query, both [., d] rows of unit length or zero, on a torch device.

    References are read once, in blocks.
    """
    import torch

    n = len(queries)
    best = torch.full((n,), -float("inf"), device=device)
    index = torch.zeros(n, dtype=torch.int64, device=device)
    with _in_float32(device):
        for first in range(0, len(references), _COLUMNS):
            block = _to_device(references[first : first + _COLUMNS], device)
            for row in range(0, n, _ROWS):
                rows = slice(row, min(row + _ROWS, n))
                cosine, column = (_to_device(queries[rows], device) @ block.T).max(dim=1)
                better = cosine > best[rows]
                best[rows] = torch.where(better, cosine, best[rows])
                index[rows] = torch.where(better, column + first, index[rows])
    cosines = np.clip(best.cpu().numpy().astype(np.float64), -1.0, 1.0)
    return Nearest(cosines, index.cpu().numpy())


@contextmanager
def _in_float32(device: str) -> Iterator[None]:
    """Multiply in float32, whatever the caller allows torch elsewhere."""
    import torch

    matmul = torch.backends.cuda.matmul
    # From 2.9 on, reading the old name fails once somebody has set the new one.
    is_new = hasattr(matmul, "fp32_precision")
    name, exact = ("fp32_precision", "ieee") if is_new else ("allow_tf32", False)
    before = getattr(matmul, name)
    setattr(matmul, name, exact)
    try:
        with torch.autocast(torch.device(device).type, enabled=False):
            yield
    finally:
        setattr(matmul, name, before)


def _to_device(rows: Vectors, device: str) -> Any:
    import torch

    # torch.from_numpy warns about read-only arrays such as memory maps, so those are copied.
    return torch.from_numpy(np.array(rows, np.float32)).to(device)
