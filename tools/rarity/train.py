"""Fits the offline head of rarity and writes it beside `oodscen.metrics._rarity.head`.

Usage: python -m tools.rarity.train RATINGS [--check]

RATINGS is a folder with lines of `text`, `origin` and `log10_km` (rated blindly by a strong model) in
`ratings*.jsonl`; none of its texts is written. A strong model wrote and rated three files for this purpose: `pairs.tsv`
and `registers.tsv` hold pairs of a rare and an ordinary text about the same things, the latter in many registers;
`incidents.tsv` holds single texts from a lane change to a death. Every third of them is also fitted with the same
figure inside a line of `frames.txt`, which adds polite words, length or places. Texts of the controls are left out.
With `--check` nothing is written; either way the losses from one origin to another are printed.
"""

import argparse
import collections
import json
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dpotrf, dpotri

from oodscen.baselines import load_controls
from oodscen.baselines._texts import bundled
from oodscen.encoders._all_minilm import all_minilm
from oodscen.encoders._cached import CachedEncoder, cache_folder
from oodscen.encoders._check import encode
from oodscen.encoders._similarity import unit
from oodscen.metrics._rarity.head import Head, inducing_points, kernel
from oodscen.metrics._rarity.words import Words, stems
from oodscen.protocols import Encoder
from oodscen.statistics._auroc import auroc

HEAD = Path(__file__).parents[2] / "oodscen/metrics/_rarity/head.npz"
WRITTEN = Path(__file__).parent
"""Folder of the texts that were written for the head."""
GAMMA, RIDGE, LINEAR, WRITTEN_WEIGHT = 0.5, 0.3, 0.3, 3.0
POINTS = 300
"""Inducing points beside the texts written for the head, drawn from this library's own texts."""
_CONSTANT = 100.0
"""Prior variance of the constant: so wide that the texts alone set it."""
_PARTS = ("handwritten", "counterparts", "people", "sights", "manoeuvres", "conditions")
"""Parts of the baseline that were written by hand, by different authors."""
MISS = 0.05
"""Share of texts outside the interval on each side."""


class Rated(NamedTuple):
    """Texts with decimal logarithms of kilometres, and their origins, coarse and fine."""

    texts: list[str]
    values: np.ndarray
    coarse: np.ndarray
    fine: np.ndarray
    twin: np.ndarray


def rated(folder: Path) -> Rated:
    """Read ratings and the texts written for the head; several draws of a text are averaged."""
    known = {text.text for split in ("tune", "frozen") for text in load_controls(split)}
    parts = {line: name for name in _PARTS for line in bundled(f"{name}.txt").splitlines()}
    draws: dict[str, list[float]] = {}
    origin: dict[str, str] = {}
    for file in sorted(folder.glob("ratings*.jsonl")):
        for line in file.read_text(encoding="utf-8").splitlines():
            one = json.loads(line)
            if one["log10_km"] is None or one["text"] in known:
                continue
            draws.setdefault(one["text"], []).append(one["log10_km"])
            origin.setdefault(one["text"], one["origin"].removesuffix(" (second draw)"))
    texts, values = list(draws), [float(np.mean(found)) for found in draws.values()]
    coarse = [_coarse(origin[text]) for text in texts]
    fine = [
        f"baseline, {parts.get(text, 'grammar')}" if name == "baseline" else name
        for text, name in zip(texts, coarse, strict=True)
    ]
    twin = [origin[text].endswith("twin") for text in texts]
    frames = (WRITTEN / "frames.txt").read_text(encoding="utf-8").splitlines()
    for name in ("pairs", "registers", "incidents"):
        lines = (WRITTEN / f"{name}.tsv").read_text(encoding="utf-8").splitlines()
        for number, line in enumerate(lines):
            fields = line.split("\t")
            told, figures = fields[1::2], [float(one) for one in fields[::2]]
            if number % 3 == 0:
                frame = frames[number // 3 % len(frames)]
                told += [frame.format(one) for one in told]
                figures *= 2
            texts += told
            values += figures
            count = len(told)
            coarse += ["incidents" if name == "incidents" else "pairs"] * count
            fine += [f"pairs {number // 240 + 1}" if name == "pairs" else name] * count
            twin += [False] * count
    return Rated(texts, np.array(values), np.array(coarse), np.array(fine), np.array(twin))


def _coarse(origin: str) -> str:
    for start, name in (
        ("shipped", "baseline"),
        ("strong", "strong model"),
        ("built-in", "author"),
        ("city", "cityflow"),
        ("ood_agentdrive", "agentdrive"),
    ):
        if origin.startswith(start):
            return name
    return "peers"


def vocabulary(data: Rated) -> tuple[list[str], np.ndarray]:
    """Return stems of at least three texts and two origins, and their weights."""
    count: collections.Counter[str] = collections.Counter()
    seen = collections.defaultdict(set)
    for text, origin in zip(data.texts, data.coarse, strict=True):
        for stem in set(stems(text)):
            count[stem] += 1
            seen[stem].add(origin)
    kept = sorted(stem for stem in count if count[stem] >= 3 and len(seen[stem]) >= 2)
    total = 1 + len(data.texts)
    return kept, np.array([np.log(total / (1 + count[stem])) + 1.0 for stem in kept], np.float32)


def is_written(data: Rated) -> np.ndarray:
    """Return which texts were written for the head."""
    return np.isin(data.coarse, ["pairs", "incidents"])


class Fit:
    """The kernel ridge regression of one kind of head, by the inverse of its regularised Gram matrix."""

    def __init__(self, rows: np.ndarray, points: np.ndarray, data: Rated) -> None:
        self.rows, self.points, self.data = rows.astype(np.float64), points.astype(np.float64), data
        inner = kernel(self.points, self.points, GAMMA) + 1e-4 * np.eye(len(points))
        self.inverse = np.linalg.inv(inner)
        self.cross = kernel(self.rows, self.points, GAMMA)
        half = np.linalg.cholesky(self.inverse)
        spread = self.cross @ half
        gram = LINEAR**2 * (self.rows @ self.rows.T) + spread @ spread.T + _CONSTANT
        gram[np.diag_indices_from(gram)] += RIDGE / self.weights()
        self.precision = _inverted(gram)
        self.dual = self.precision @ data.values

    def weights(self) -> np.ndarray:
        """Return the weights of texts: a large origin counts less per text, those written for the head more."""
        count = collections.Counter(self.data.coarse)
        found = np.array([count[one] ** -0.5 for one in self.data.coarse])
        return found / found.mean() * np.where(is_written(self.data), WRITTEN_WEIGHT, 1.0)

    def without(self, labels: np.ndarray) -> np.ndarray:
        """Return estimates of every origin by a fit to all others.

        A Gaussian process leaves a block b out at the residual inv(P_bb) (P y)_b, where P is the inverse of its
        regularised Gram matrix (Rasmussen and Williams, 2006, section 5.4.2, for one text).
        """
        found = np.empty(len(self.rows))
        for label in dict.fromkeys(labels):
            out = np.flatnonzero(labels == label)
            residual = np.linalg.solve(self.precision[np.ix_(out, out)], self.dual[out])
            found[out] = self.data.values[out] - residual
        return found

    def arrays(self) -> dict[str, np.ndarray]:
        """Return the arrays of the head that is fitted to all texts."""
        beta = LINEAR**2 * self.rows.T @ self.dual
        alpha = self.inverse @ (self.cross.T @ self.dual)
        return {
            "beta": beta.astype(np.float32),
            "alpha": alpha.astype(np.float32),
            "constant": np.float64(_CONSTANT * self.dual.sum()),
            "gamma": np.float64(GAMMA),
        }


def _inverted(gram: np.ndarray) -> np.ndarray:
    """Return the inverse of a symmetric positive definite matrix."""
    factor, fault = dpotrf(gram, lower=True, overwrite_a=True)
    lower, fault_too = dpotri(factor, lower=True, overwrite_c=True)
    assert fault == fault_too == 0
    return np.asarray(np.tril(lower) + np.tril(lower, -1).T)


def offsets(best: np.ndarray, data: Rated) -> tuple[np.ndarray, np.ndarray]:
    """Return edges of thirds of the estimate, and conformal offsets [3, 2]; every origin counts alike."""
    edges = np.quantile(best, [1 / 3, 2 / 3])
    third = np.searchsorted(edges, best)
    count = collections.Counter(data.fine)
    weights = np.array([1.0 / count[one] for one in data.fine])
    found = []
    for number in range(3):
        own = third == number
        order = np.argsort(gaps := (data.values - best)[own])
        reached = np.cumsum(weights[own][order]) / weights[own].sum()
        found.append([float(np.interp(at, reached, gaps[order])) for at in (MISS, 1.0 - MISS)])
    return edges, np.array(found)


def losses(kind: str, best: np.ndarray, data: Rated) -> dict[str, float]:
    """Print rank correlation, bias and error of every origin left out; return its coverage by others' intervals."""
    shares = {}
    for name in dict.fromkeys(data.fine):
        own = data.fine == name
        gap = best[own] - data.values[own]
        rank = np.corrcoef(_ranks(best[own]), _ranks(data.values[own]))[0, 1]
        others, weigh = (
            ~own,
            data._replace(texts=[], values=data.values[~own], fine=data.fine[~own]),
        )
        edges, moved = offsets(best[others], weigh)
        inside = moved[np.searchsorted(edges, best[own])]
        covered = np.mean((-gap >= inside[:, 0]) & (-gap <= inside[:, 1]))
        shares[name] = float(covered)
        print(
            f"{kind:7} {name:24} n={own.sum():5} rank {rank:5.2f} bias {gap.mean():+.2f} "
            f"median error {np.median(abs(gap)):.2f} covered by others' interval {covered:.2f}"
        )
    own = data.coarse == "author"
    area = auroc(best[own & data.twin], best[own & ~data.twin])
    print(f"{kind:7} author left out, scenarios against twins: AUROC {area:.3f}")
    print(
        f"{kind:7} covered by others' interval, mean over origins {np.mean([*shares.values()]):.3f}"
    )
    return shares


def _ranks(values: np.ndarray) -> np.ndarray:
    return np.argsort(np.argsort(values, kind="stable"), kind="stable")


def left_out_coverage(folder: Path, encoder: Encoder) -> dict[str, float]:
    """Return the coverage of every origin by a fit and intervals from all others; prints the losses."""
    data = rated(folder)
    kept, idf = vocabulary(data)
    words = Words(kept, idf).rows(data.texts)
    rows = np.hstack(
        [unit(encode(CachedEncoder(encoder, cache_folder() / "rarity"), data.texts)), words]
    )
    points = rows[is_written(data)]
    return losses("minilm", Fit(rows, points, data).without(data.fine), data)


def main() -> None:
    """Fit, print the losses, and write the head."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("ratings", type=Path)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--cache", type=Path, default=cache_folder() / "rarity")
    asked = parser.parse_args()
    data = rated(asked.ratings)
    encoder = CachedEncoder(all_minilm(), asked.cache)
    vectors = unit(encoder.encode(data.texts))
    encoder.save()
    kept, idf = vocabulary(data)
    words = Words(kept, idf).rows(data.texts)
    ours = np.flatnonzero(np.isin(data.coarse, ["baseline", "author"]))
    drawn = np.random.default_rng(0).permutation(ours)[:POINTS]
    chosen = np.sort(np.r_[np.flatnonzero(is_written(data)), drawn])
    scale = np.abs(vectors[chosen]).max(axis=1) / 127.0
    held = [np.flatnonzero(words[row]) for row in chosen]
    arrays: dict[str, np.ndarray] = {
        "vocabulary": np.array(kept),
        "weights": idf,
        "starts": np.cumsum([0, *map(len, held)]),
        "places": np.concatenate(held).astype(np.uint16),
        "vectors": np.round(vectors[chosen] / scale[:, None]).astype(np.int8),
        "scale": scale.astype(np.float32),
    }
    for kind in ("minilm", "words"):
        is_full = kind == "minilm"
        rows = np.hstack([vectors, words]) if is_full else words
        fit = Fit(rows, inducing_points(arrays, is_full), data)
        best = fit.without(data.fine)
        losses(kind, best, data)
        edges, moved = offsets(best, data)
        near = np.quantile(np.delete(fit.cross.max(axis=1), chosen), 0.005)
        found = fit.arrays() | {"edges": edges, "offsets": moved, "nearest": near}
        arrays |= {f"{kind}.{name}": np.asarray(value) for name, value in found.items()}
        tune = [text.text for text in load_controls("tune")]
        head = Head(arrays, kind)
        seen = head.estimate(tune, unit(encoder.encode(tune)) if is_full else None).best
        print(f"{kind:7} tune controls: AUROC {auroc(seen[::2], seen[1::2]):.3f}")
        print(f"{kind:7} interval {moved.round(2).tolist()} by thirds at {edges.round(2)}")
    if not asked.check:
        np.savez_compressed(HEAD, **arrays)
        print(HEAD, f"{HEAD.stat().st_size / 2**10:.0f} KiB")


if __name__ == "__main__":
    main()
