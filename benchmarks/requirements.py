"""Measure how often a requirement is called met that is not, by size of board and method.

Boards are simulated at the edge: every model misses the bar by nothing, so every "meets" is false. Scenes
of a path are alike (beta-binomial), from not at all to all or none; the worst of these counts.

    python benchmarks/requirements.py [--boards 2000]
"""

import argparse
import json
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from oodscen.statistics._bar_test import p_below_many

Floats = NDArray[np.float64]

PATHS = (5, 10, 20, 40, 72)
MODELS = (1, 3, 10)
BARS = (0.8, 0.9, 0.95)
"""Shares of right answers: `notice>=0.8`, `safe>=0.9`, `needless<=0.05`."""
LIKENESS = (0.0, 0.1, 0.3, 0.6, 1.0)
"""Intraclass correlations."""
PER_PATH = 10
ALPHA = 0.05
REPLICATES = 999


def boards(rng: np.random.Generator, paths: int, bar: float, icc: float, sets: int) -> Floats:
    """Return the gaps of models whose true share is the bar: [paths, sets]."""
    if icc >= 1:
        share = (rng.random((paths, sets)) < bar).astype(float)
    elif icc <= 0:
        share = np.full((paths, sets), bar)
    else:
        spread = (1 - icc) / icc
        share = rng.beta(bar * spread, (1 - bar) * spread, (paths, sets))
    return rng.binomial(PER_PATH, share) / PER_PATH - bar


def bound(gaps: Floats, bar: float, rng: np.random.Generator) -> Floats:
    """Return the p-values of the shipped test."""
    return p_below_many(gaps, -bar, draws=4_000, seed=int(rng.integers(2**31)))


def percentile(gaps: Floats, bar: float, rng: np.random.Generator) -> Floats:
    """Return the p-values of the percentile cluster bootstrap."""
    paths = len(gaps)
    weights = rng.multinomial(paths, np.full(paths, 1 / paths), REPLICATES).astype(float)
    return (1 + (weights @ gaps <= 0).sum(axis=0)) / (1 + REPLICATES)


def cluster_t(gaps: Floats, bar: float, rng: np.random.Generator) -> Floats:
    """Return the p-values of t over paths, which CR2 is with paths of equal size."""
    return np.asarray(student.sf(_t(gaps), len(gaps) - 1))


def wild(gaps: Floats, bar: float, rng: np.random.Generator) -> Floats:
    """Return the p-values of the wild cluster bootstrap-t with Webb's weights, the null imposed."""
    paths, seen = len(gaps), _t(gaps)
    webb = np.sqrt(np.array([0.5, 1.0, 1.5]))
    count = np.zeros(gaps.shape[1])
    for start in range(0, REPLICATES, 111):
        size = min(111, REPLICATES - start)
        flips = rng.choice(np.concatenate([webb, -webb]), (size, paths))
        mean = flips @ gaps / paths
        left = np.maximum(np.square(flips) @ np.square(gaps) - paths * mean**2, 1e-12)
        count += (mean / np.sqrt(left / (paths - 1) / paths) >= seen - 1e-9).sum(axis=0)
    return (1 + count) / (1 + REPLICATES)


def _t(gaps: Floats) -> Floats:
    spread = np.maximum(gaps.std(axis=0, ddof=1), 1e-9)
    found: Floats = gaps.mean(axis=0) / spread * np.sqrt(len(gaps))
    return found


METHODS: dict[str, Callable[[Floats, float, np.random.Generator], Floats]] = {
    "bound (shipped)": bound,
    "percentile bootstrap": percentile,
    "cluster t (CR2)": cluster_t,
    "wild bootstrap-t": wild,
}


def main() -> None:
    """Print the share of boards with a false "meets", the worst over bars and likeness."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--boards", type=int, default=2_000)
    count = parser.parse_args().boards
    rng = np.random.default_rng(0)
    worst: dict[str, dict[tuple[int, int], tuple[float, float, float]]] = {m: {} for m in METHODS}
    for paths in PATHS:
        for bar in BARS:
            for icc in LIKENESS:
                gaps = boards(rng, paths, bar, icc, count * max(MODELS))
                for method, test in METHODS.items():
                    p = test(gaps, bar, rng).reshape(count, -1)
                    for models in MODELS:
                        false = float((p[:, :models].min(axis=1) <= ALPHA / models).mean())
                        key = (paths, models)
                        worst[method][key] = max(
                            worst[method].get(key, (0.0, 0.0, 0.0)), (false, bar, icc)
                        )
    holds = True
    print(
        f"boards with a false meets, of {count} of each size: worst over bars {BARS} and ICC {LIKENESS}"
    )
    print("method".ljust(24), *(f"{p}x{m}".rjust(7) for p in PATHS for m in MODELS))
    for method, rates in worst.items():
        print(method.ljust(24), *(f"{rates[p, m][0]:7.1%}" for p in PATHS for m in MODELS))
    # A rate of 5 % is measured with an error; three standard errors are allowed for it.
    most = ALPHA + 3 * (ALPHA * (1 - ALPHA) / count) ** 0.5
    top = max(rate for rate, _, _ in worst["bound (shipped)"].values())
    holds = top <= most
    print(json.dumps({"name": "false meets, shipped test, worst board", "value": round(top, 4),
                      "unit": "share", "target": f"<= 0.05 (+3 SE: {most:.4f})", "holds": holds}))  # fmt: skip
    raise SystemExit(not holds)


if __name__ == "__main__":
    main()
