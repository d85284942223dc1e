"""Fits the offline head of rarity and writes it beside `oodscen.metrics._rarity.head`.

Usage: python -m tools.rarity.train RATINGS [--check]

RATINGS is a folder with lines of `text`, `origin` and `log10_km` (rated blindly by a strong model) in
`ratings*.jsonl`; none of its texts is written. A strong model wrote and rated three files for this purpose: `pairs.tsv`
and `registers.tsv` hold pairs of a rare and an ordinary text about the same things, the latter in many registers;
`incidents.tsv` holds single texts from a lane change to a death. The estimate of each of them, and of a sample of this
library's own texts, is drawn to its estimate inside a line of `frames.txt`, which adds polite words, length or places;
`[a|b]` in a line is a choice. Texts of the controls are left out.
With `--check` nothing is written; either way the losses from one origin to another are printed.
"""

import argparse
import collections
import json
import random
import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import spotrf, spotri

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
FRAMED = 450
"""Framed texts beside those written for the head."""
MORE_DRAWS = 2
"""Draws of frames that change stems alone."""
SAMENESS = 2.0
"""Weight of the difference between a text and the same text in a frame, which shall be zero."""
_CONSTANT = 100.0
"""Prior variance of the constant: so wide that the texts alone set it."""
_PARTS = ("handwritten", "counterparts", "people", "sights", "manoeuvres", "conditions")
"""Parts of the baseline that were written by hand, by different authors."""
_HANDS = {"pairs 2": "pairs 1", "incidents": "registers"}
"""Origins by the hand of another origin."""
MISS = 0.04
"""Share of texts outside the interval on each side. The widest, to a hundredth, at which the mean coverage of origins left
out stays at or below 93 %: hands that wrote both ordinary and rare texts are covered less than that mean."""


class Rated(NamedTuple):
    """Texts with decimal logarithms of kilometres, and their origins, coarse and fine."""

    texts: list[str]
    values: np.ndarray
    coarse: np.ndarray
    fine: np.ndarray
    twin: np.ndarray

    @property
    def hand(self) -> np.ndarray:
        """Who wrote each text: origins of one writer are left out together."""
        return np.array([_HANDS.get(one, one) for one in self.fine])


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
    for name in ("pairs", "registers", "incidents"):
        lines = (WRITTEN / f"{name}.tsv").read_text(encoding="utf-8").splitlines()
        for number, line in enumerate(lines):
            fields = line.split("\t")
            told, figures = fields[1::2], [float(one) for one in fields[::2]]
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


def framed(data: Rated, draws: int = 1, seed: int = 0) -> tuple[np.ndarray, list[str]]:
    """Return places of texts, and these texts in frames drawn at random."""
    frames = (WRITTEN / "frames.txt").read_text(encoding="utf-8").splitlines()
    ours = np.flatnonzero(np.isin(data.coarse, ["baseline", "author"]))
    sample = np.random.default_rng(1).permutation(ours)[:FRAMED]
    places = np.tile(np.r_[np.flatnonzero(is_written(data)), sample], draws)
    chance = random.Random(seed)
    told = [
        _filled(frames[number % len(frames)], chance).replace("{}", data.texts[place])
        for number, place in enumerate(places)
    ]
    return places, told


def _filled(frame: str, chance: random.Random) -> str:
    return re.sub(r"\[([^\]]*)\]", lambda found: chance.choice(found[1].split("|")), frame)


class Fit:
    """The kernel ridge regression of one kind of head, in the space of its features.

    Args:
        rows: Embeddings and stems of the texts, [n, D].
        points: Inducing points, [m, D].
        data: The texts.
        same: Places of texts, and rows of the same texts in frames: both shall get the same estimate.
    """

    def __init__(
        self,
        rows: np.ndarray,
        points: np.ndarray,
        data: Rated,
        same: Sequence[tuple[np.ndarray, np.ndarray]],
    ) -> None:
        self.points, self.data = points.astype(np.float32), data
        inner = kernel(points.astype(np.float64), points.astype(np.float64), GAMMA)
        self.half = np.linalg.cholesky(np.linalg.inv(inner + 1e-4 * np.eye(len(points))))
        self.half = self.half.astype(np.float32)
        self.features = self._features(rows)
        self.scale = self._weights() / RIDGE
        needed = self.features.T @ (self.features * self.scale[:, None])
        for places, other in same:
            apart = self._features(other) - self.features[places]
            needed += SAMENESS / RIDGE * (apart.T @ apart)
        needed[np.diag_indices_from(needed)] += 1.0
        self.inverse = _inverted(needed)
        self.theta = self.inverse @ (self.features.T @ (self.scale * data.values))

    def _features(self, rows: np.ndarray) -> np.ndarray:
        rows = rows.astype(np.float32)
        spread = kernel(rows, self.points, GAMMA).astype(np.float32) @ self.half
        constant = np.full((len(rows), 1), _CONSTANT**0.5)
        return np.hstack([LINEAR * rows, spread, constant]).astype(np.float32)

    def _weights(self) -> np.ndarray:
        """Return the weights of texts: a large origin counts less per text, those written for the head more."""
        count = collections.Counter(self.data.coarse)
        found = np.array([count[one] ** -0.5 for one in self.data.coarse], np.float32)
        return found / found.mean() * np.where(is_written(self.data), np.float32(WRITTEN_WEIGHT), 1)

    def without(self, labels: np.ndarray) -> np.ndarray:
        """Return estimates of every group of texts by a fit to the ratings of all others.

        With the hat matrix H a block b that is left out has the residual inv(I - H_bb) (y - H y)_b.
        """
        found = np.empty(len(self.features))
        residual = self.data.values - self.features @ self.theta
        for label in dict.fromkeys(labels):
            out = np.flatnonzero(labels == label)
            own = self.features[out]
            hat = own @ self.inverse @ own.T * self.scale[out]
            apart = np.linalg.solve(np.eye(len(out)) - hat.astype(np.float64), residual[out])
            found[out] = self.data.values[out] - apart
        return found

    def arrays(self) -> dict[str, np.ndarray]:
        """Return the arrays of the head that is fitted to all texts."""
        width = self.points.shape[1]
        return {
            "beta": LINEAR * self.theta[:width],
            "alpha": self.half @ self.theta[width:-1],
            "constant": np.float64(self.theta[-1] * _CONSTANT**0.5),
            "gamma": np.float64(GAMMA),
        }


def _inverted(matrix: np.ndarray) -> np.ndarray:
    """Return the inverse of a symmetric positive definite matrix of single precision."""
    factor, fault = spotrf(matrix, lower=True, overwrite_a=True)
    lower, fault_too = spotri(factor, lower=True, overwrite_c=True)
    assert fault == fault_too == 0
    return np.asarray(np.tril(lower) + np.tril(lower, -1).T)


def offsets(best: np.ndarray, data: Rated) -> tuple[np.ndarray, np.ndarray]:
    """Return edges of thirds of the estimate, and conformal offsets [3, 2].

    Every hand counts alike, and the parts of the baseline, all of them ordinary, count as one.
    """
    edges = np.quantile(best, [1 / 3, 2 / 3])
    third = np.searchsorted(edges, best)
    hands = ["baseline" if one.startswith("baseline") else one for one in data.hand]
    count = collections.Counter(hands)
    weights = np.array([1.0 / count[one] for one in hands])
    found = []
    for number in range(3):
        own = third == number
        order = np.argsort(gaps := (data.values - best)[own])
        reached = np.cumsum(weights[own][order]) / weights[own].sum()
        found.append([float(np.interp(at, reached, gaps[order])) for at in (MISS, 1.0 - MISS)])
    return edges, np.array(found)


def losses(kind: str, fit: Fit, data: Rated) -> dict[str, float]:
    """Print rank correlation, bias and error of every origin left out; return its coverage by others' intervals."""
    best, by_hand = fit.without(data.fine), fit.without(data.hand)
    shares = {}
    for name in dict.fromkeys(data.fine):
        own = data.fine == name
        gap = best[own] - data.values[own]
        rank = np.corrcoef(_ranks(best[own]), _ranks(data.values[own]))[0, 1]
        others = ~own
        weigh = data._replace(texts=[], values=data.values[others], fine=data.fine[others])
        edges, moved = offsets(by_hand[others], weigh)
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


class Rows(NamedTuple):
    """Rows of the texts and of texts in frames, with embeddings and with stems alone."""

    vectors: np.ndarray
    words: np.ndarray
    same: list[tuple[np.ndarray, np.ndarray, np.ndarray]]
    """Places of texts, and the embeddings and stems of these texts in frames."""

    def full(self) -> np.ndarray:
        """Return embeddings and stems side by side."""
        return np.hstack([self.vectors, self.words])

    def pairs(self, is_full: bool) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return places and rows of texts in frames."""
        return [
            (places, np.hstack([vectors, words]) if is_full else words)
            for places, vectors, words in self.same
        ]


def rows_of(data: Rated, words: Words, encoder: Encoder) -> Rows:
    """Encode the texts; more draws of frames change stems alone, whose changes are the larger ones."""
    vectors = unit(encode(encoder, data.texts))
    places, told = framed(data)
    same = [(places, unit(encode(encoder, told)), words.rows(told))]
    places, told = framed(data, MORE_DRAWS, seed=7)
    same.append((places, vectors[places], words.rows(told)))
    return Rows(vectors, words.rows(data.texts), same)


def left_out_coverage(folder: Path, encoder: Encoder) -> dict[str, float]:
    """Return the coverage of every origin by a fit and intervals from all others; prints the losses."""
    data = rated(folder)
    cached = CachedEncoder(encoder, cache_folder() / "rarity")
    found = rows_of(data, Words(*vocabulary(data)), cached)
    cached.save()
    rows = found.full()
    fit = Fit(rows, rows[is_written(data)], data, found.pairs(is_full=True))
    return losses("minilm", fit, data)


def main() -> None:
    """Fit, print the losses, and write the head."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("ratings", type=Path)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--cache", type=Path, default=cache_folder() / "rarity")
    asked = parser.parse_args()
    data = rated(asked.ratings)
    encoder = CachedEncoder(all_minilm(), asked.cache)
    kept, idf = vocabulary(data)
    found = rows_of(data, Words(kept, idf), encoder)
    encoder.save()
    vectors, words = found.vectors, found.words
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
        rows = found.full() if is_full else words
        points = inducing_points(arrays, is_full)
        fit = Fit(rows, points, data, found.pairs(is_full))
        losses(kind, fit, data)
        edges, moved = offsets(fit.without(data.hand), data)
        near = kernel(np.delete(rows, chosen, axis=0), points, GAMMA).max(axis=1)
        values = fit.arrays() | {
            "edges": edges,
            "offsets": moved,
            "nearest": np.quantile(near, 0.005),
        }
        arrays |= {f"{kind}.{name}": np.asarray(value) for name, value in values.items()}
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
