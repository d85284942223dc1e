"""The data behind the report's pictures of the metrics: further scores, curves over the size, a map.

`picture_data` computes them while the texts are available, so that drawing a report needs neither an encoder
nor the baseline.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from oodscen._seeding import stream
from oodscen.data._scenario import Scenario
from oodscen.metrics._diversity import mean_nearest, mean_pairwise
from oodscen.metrics._metrics import Metrics
from oodscen.metrics._oodness import Measure
from oodscen.metrics._vectors.axes import principal_axes
from oodscen.metrics._vectors.similarity import Vectors
from oodscen.statistics._auroc import auroc_interval

BEST: Final[Measure] = "events"
"""The detector that separates the controls best; see `docs/metrics.md`."""

_SHOWN = 400
_SIZES = 9
_REPEATS = 8


def picture_data(metrics: Metrics, sets: Mapping[str, Sequence[str | Scenario]]) -> dict[str, Any]:
    """Return the data for the report's pictures of the metrics.

    Args:
        metrics: Metrics with a baseline of texts.
        sets: Sets of texts by name, at least one text each.

    Returns:
        JSON-able: `oodness` of the controls and of held-out baseline texts; `detector` (name, scores of the
        ordinary controls, per set its scores and its AUROC against them); `curves` of both diversities
        over the size, per set and for the baseline; `map`, points on the first two principal axes of the
        baseline, for at most 400 texts of each.
    """
    vectors = {name: metrics.vectors(texts) for name, texts in sets.items()}
    whole = metrics.baseline_vectors
    known = {"baseline": whole, **vectors}
    control = np.array(metrics.control_scores(BEST))
    detector: dict[str, Any] = {"name": BEST, "control": _rounded(control), "sets": {}}
    for name, texts in sets.items():
        values = np.array(metrics.oodness(texts, BEST).per_text)
        paths = [item.leaf for item in texts if isinstance(item, Scenario)]
        clusters = paths if len(paths) == len(texts) else None
        found = auroc_interval(control, values, clusters, seed=metrics.seed)
        detector["sets"][name] = {
            "mean": float(values.mean()),
            "per_text": _rounded(values),
            "auroc": found.model_dump(mode="json"),
        }
    held_out = np.array(metrics.held_out_scores())
    return {
        "oodness": {
            "control": _rounded(np.array(metrics.control_scores())),
            "held_out": _rounded(_some(held_out, metrics.seed, "held-out")),
        },
        "detector": detector,
        "curves": {
            name: _curve(rows, metrics.seed, name) for name, rows in known.items() if len(rows) > 1
        },
        "map": _map(known, metrics.seed),
    }


def _curve(rows: Vectors, seed: int, name: str) -> dict[str, list[float]]:
    most = min(len(rows), 1000)
    sizes = np.unique(np.geomspace(2, most, _SIZES).round().astype(int)).tolist()
    draws = stream(seed, "size-curve", name)
    nearest, pairwise = [], []
    for size in sizes:
        repeats = 1 if size == len(rows) else _REPEATS
        parts = [rows[draws.permutation(len(rows))[:size]] for _ in range(repeats)]
        nearest.append(-float(np.mean([mean_nearest(part) for part in parts])))
        pairwise.append(-float(np.mean([mean_pairwise(part) for part in parts])))
    return {
        "sizes": sizes,
        "nearest": [round(value, 4) for value in nearest],
        "pairwise": [round(value, 4) for value in pairwise],
    }


def _map(known: Mapping[str, Vectors], seed: int) -> dict[str, Any]:
    mean, axes, share = principal_axes(known["baseline"])
    points = {}
    for name, rows in known.items():
        placed = (_some(rows, seed, "map", name) - mean) @ axes.T
        points[name] = [[round(float(x), 3), round(float(y), 3)] for x, y in placed]
    return {"share": [round(float(value), 4) for value in share], "points": points}


def _some(rows: np.ndarray, seed: int, *keys: str) -> np.ndarray:
    if len(rows) <= _SHOWN:
        return rows
    return rows[np.sort(stream(seed, "pictures", *keys).permutation(len(rows))[:_SHOWN])]


def _rounded(values: np.ndarray) -> list[float]:
    return [round(float(value), 4) for value in values]
