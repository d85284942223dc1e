"""Fits the offline head of rarity and writes it beside `oodscen.metrics._rarity.head`.

Usage: python -m tools.rarity.train RATINGS [--check]

RATINGS is a folder with lines of `text`, `origin` and `log10_km` (rated blindly by a strong model) in
`ratings*.jsonl`; none of its texts is written. Strong models wrote and rated five files for this purpose: `pairs.tsv`
and `registers.tsv` hold pairs of a rare and an ordinary text about the same things, the latter in many registers;
`wordings.tsv` holds such pairs with several wordings of either; `incidents.tsv` holds single texts from a lane change to a death;
`hands.tsv` holds single texts over the whole range by five writers, each with the writer, rated by others.
Two things draw estimates to each other: wordings of one event, also those of the rated author's events, and a text with the same text inside a
line of `frames.txt`, which adds polite words, length or places; `[a|b]` in a line is a choice. Frames are put around the written texts and a
sample of this library's own. Texts of the controls are left out.
With `--check` nothing is written; either way the losses from one origin to another are printed.
"""

import argparse
import collections
import json
import random
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import linprog

from oodscen._io.files import bundled
from oodscen.baselines import load_controls
from oodscen.encoders._all_minilm import all_minilm
from oodscen.encoders._cached import CachedEncoder, cache_folder
from oodscen.encoders._check import encode
from oodscen.encoders._similarity import unit
from oodscen.metrics._rarity.head import Head, inducing_points, interval_ends, kernel
from oodscen.metrics._rarity.words import Words, stems, without_courtesy
from oodscen.protocols import Encoder
from oodscen.statistics._auroc import auroc

HEAD = Path(__file__).parents[2] / "oodscen/metrics/_rarity/head.npz"
WRITTEN = Path(__file__).parent
"""Folder of the texts that were written for the head."""
GAMMA, RIDGE, LINEAR, WRITTEN_WEIGHT = 0.5, 0.3, 0.3, 6.0
HANDS_WEIGHT = 2.0
"""Weight of the texts in `hands.tsv`; with that of the others written for the head, they would move registers apart."""
FRAMED = 450
"""Framed texts beside those written for the head."""
MORE_DRAWS = 2
"""Draws of frames that change stems alone."""
SAMENESS = 6.0
"""Weight of the difference between a text and the same text in a frame, which shall be zero."""
SAME_EVENT = 16.0
"""Weight of the difference between one wording of an event and the mean of its plain ones, which shall be zero."""
_CONSTANT = 100.0
"""Prior variance of the constant: so wide that the texts alone set it."""
_PARTS = ("handwritten", "counterparts", "people", "sights", "manoeuvres", "conditions")
"""Parts of the baseline that were written by hand, by different authors."""
_HANDS = {"pairs 2": "pairs 1", "incidents": "registers", "reports": "registers"}
"""Origins by the hand of another origin."""
REGISTERS = ("paper", "terse", "verbose", "first-person")
FOLDS = 4
"""Parts of the author's events that are left out in turn."""
MISS = 0.05
"""Share of texts outside the interval on each side."""


class Rated(NamedTuple):
    """Texts with decimal logarithms of kilometres, and their origins, coarse and fine."""

    texts: list[str]
    values: np.ndarray
    coarse: np.ndarray
    fine: np.ndarray
    twin: np.ndarray
    event: np.ndarray
    """The event that a text words, empty for most."""
    is_plain: np.ndarray
    """Whether it is the wording that others of the event are compared with."""

    @property
    def hand(self) -> np.ndarray:
        """Who wrote each text: origins of one writer are left out together."""
        return np.array([_HANDS.get(one, one) for one in self.fine])


def rated(folder: Path) -> Rated:
    """Read ratings and the texts written for the head; several draws of a text are averaged."""
    known = {text.text for split in ("tune", "frozen") for text in load_controls(split)}
    parts = {
        line: name
        for name in _PARTS
        for line in bundled(f"{name}.txt", "oodscen.baselines").splitlines()
    }
    draws: dict[str, list[float]] = {}
    origin: dict[str, str] = {}
    of: dict[str, str] = {}
    for file in sorted(folder.glob("ratings*.jsonl")):
        for line in file.read_text(encoding="utf-8").splitlines():
            one = json.loads(line)
            if one["log10_km"] is None or one["text"] in known:
                continue
            draws.setdefault(one["text"], []).append(one["log10_km"])
            origin.setdefault(one["text"], one["origin"].removesuffix(" (second draw)"))
            if one.get("of"):
                of[one["text"]] = re.sub(r"-\d+$", "", one["of"])
    texts, values = list(draws), [float(np.mean(found)) for found in draws.values()]
    coarse = [_coarse(origin[text]) for text in texts]
    fine = [
        f"baseline, {parts.get(text, 'grammar')}" if name == "baseline" else name
        for text, name in zip(texts, coarse, strict=True)
    ]
    twin = [origin[text].endswith("twin") for text in texts]
    event = ["" if is_twin else of.get(text, "") for text, is_twin in zip(texts, twin, strict=True)]
    is_plain = [not origin[text].endswith(REGISTERS) for text in texts]
    for name in ("pairs", "registers", "wordings", "incidents"):
        lines = (WRITTEN / f"{name}.tsv").read_text(encoding="utf-8").splitlines()
        for number, line in enumerate(lines):
            fields = line.split("\t")
            told, figures = fields[1::2], [float(field) for field in fields[::2]]
            texts += told
            values += figures
            count = len(told)
            coarse += ["incidents" if name == "incidents" else "pairs"] * count
            fine += [f"pairs {number // 240 + 1}" if name == "pairs" else name] * count
            twin += [False] * count
            event += [f"{number} {field}" if name == "wordings" else "" for field in fields[::2]]
            is_plain += [True] * count
    for line in (WRITTEN / "hands.tsv").read_text(encoding="utf-8").splitlines():
        hand, value, text = line.split("\t")
        texts.append(text)
        values.append(float(value))
        coarse.append("hands")
        fine.append(hand)
        twin.append(False)
        event.append("")
        is_plain.append(True)
    told = (texts, values, coarse, fine, twin, event, is_plain)
    return Rated(list(map(without_courtesy, texts)), *map(np.array, told[1:]))


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
    return np.isin(data.coarse, ["pairs", "incidents", "hands"])


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
    return places, list(map(without_courtesy, told))


def _filled(frame: str, chance: random.Random) -> str:
    return re.sub(r"\[([^\]]*)\]", lambda found: chance.choice(found[1].split("|")), frame)


class Same(NamedTuple):
    """Differences of rows that shall make no difference."""

    owners: np.ndarray
    """Places of the texts that they belong to."""
    apart: np.ndarray
    weight: float


class Fit:
    """The kernel ridge regression of one kind of head, in the space of its features.

    Args:
        rows: Embeddings and stems of the texts, [n, D].
        points: Inducing points, [m, D].
        data: The texts.
        framed_rows: Places of texts, and rows of the same texts in frames.
    """

    def __init__(
        self,
        rows: np.ndarray,
        points: np.ndarray,
        data: Rated,
        framed_rows: list[tuple[np.ndarray, np.ndarray]],
    ) -> None:
        self.points, self.data = points.astype(np.float32), data
        inner = kernel(points.astype(np.float64), points.astype(np.float64), GAMMA)
        self.half = np.linalg.cholesky(np.linalg.inv(inner + 1e-4 * np.eye(len(points))))
        self.half = self.half.astype(np.float32)
        self.features = self._features(rows)
        self.scale = self._weights() / RIDGE
        self.same = [
            Same(places, self._features(other) - self.features[places], SAMENESS / RIDGE)
            for places, other in framed_rows
        ]
        self.same.append(self._events())
        everything = np.ones(len(rows), bool)
        self.needed, self.wanted = self._part(everything)
        self.needed[np.diag_indices_from(self.needed)] += 1.0
        self.theta = _solved(self.needed, self.wanted)

    def _features(self, rows: np.ndarray) -> np.ndarray:
        rows = rows.astype(np.float32)
        spread = kernel(rows, self.points, GAMMA).astype(np.float32) @ self.half
        constant = np.full((len(rows), 1), _CONSTANT**0.5)
        return np.hstack([LINEAR * rows, spread, constant]).astype(np.float32)

    def _weights(self) -> np.ndarray:
        """Return the weights of texts: a large origin counts less per text, those written for the head more."""
        count = collections.Counter(self.data.coarse)
        found = np.array([count[one] ** -0.5 for one in self.data.coarse], np.float32)
        own = np.where(is_written(self.data), np.float32(WRITTEN_WEIGHT), 1)
        own = np.where(self.data.coarse == "hands", np.float32(HANDS_WEIGHT), own)
        return found / found.mean() * own

    def _events(self) -> Same:
        owners, apart = [], []
        for event in dict.fromkeys(self.data.event[self.data.event != ""]):
            own = self.data.event == event
            if (usual := own & self.data.is_plain).any():
                owners.append(np.flatnonzero(own))
                apart.append(self.features[own] - self.features[usual].mean(axis=0))
        return Same(np.concatenate(owners), np.vstack(apart), SAME_EVENT / RIDGE)

    def _part(self, own: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return what some texts add to the normal equations."""
        rows, scale = self.features[own], self.scale[own]
        needed = rows.T @ (rows * scale[:, None])
        for owners, apart, weight in self.same:
            if (some := own[owners]).any():
                needed += np.float32(weight) * (apart[some].T @ apart[some])
        return needed, rows.T @ (scale * self.data.values[own])

    def without(self, own: np.ndarray) -> np.ndarray:
        """Return estimates of some texts by a fit to all others."""
        needed, wanted = self._part(own)
        return self.features[own] @ _solved(self.needed - needed, self.wanted - wanted)

    def arrays(self) -> dict[str, np.ndarray]:
        """Return the arrays of the head that is fitted to all texts."""
        width = self.points.shape[1]
        return {
            "beta": LINEAR * self.theta[:width],
            "alpha": self.half @ self.theta[width:-1],
            "constant": np.float64(self.theta[-1] * _CONSTANT**0.5),
            "gamma": np.float64(GAMMA),
        }


def _solved(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    return np.asarray(cho_solve(cho_factor(matrix, lower=True), right.astype(matrix.dtype)))


class LeftOut(NamedTuple):
    """Estimates of texts by fits to the others."""

    fine: np.ndarray
    """Each origin by all others."""
    hand: np.ndarray
    """All origins of a hand by all others."""
    event: np.ndarray
    """Each part of the author's events by everything else; missing for other texts."""


def left_out(fit: Fit, data: Rated) -> LeftOut:
    """Return estimates of every text by fits without its origin, its hand, or its event."""
    fine, hand, event = (np.full(len(data.values), np.nan) for _ in range(3))
    for name in dict.fromkeys(data.hand):
        own = data.hand == name
        hand[own] = fit.without(own)
        parts = dict.fromkeys(data.fine[own])
        for part in parts:
            some = data.fine == part
            fine[some] = fit.without(some) if len(parts) > 1 else hand[some]
    events = sorted(set(data.event[(data.event != "") & (data.coarse == "author")]))
    for first in range(FOLDS):
        own = np.isin(data.event, events[first::FOLDS])
        event[own] = fit.without(own)
    return LeftOut(fine, hand, event)


def registers_moved(best: np.ndarray, data: Rated) -> np.ndarray:
    """Return how far each of the author's texts in a register lies from the mean of its event's natural ones, decades."""
    found = []
    for event in dict.fromkeys(data.event[(data.event != "") & (data.coarse == "author")]):
        own = data.event == event
        if (usual := own & data.is_plain).any():
            found.append(np.abs(best[own & ~data.is_plain] - best[usual].mean()))
    return np.concatenate(found)


def interval(best: np.ndarray, values: np.ndarray, origins: np.ndarray) -> np.ndarray:
    """Return lines of constant and slope for the low and the high end, [2, 2], by quantile regression.

    Every hand counts alike, and the parts of the baseline, all of them ordinary, count as one.
    """
    hands = [_HANDS.get(origin, origin).partition(",")[0] for origin in origins]
    count = collections.Counter(hands)
    weights = np.array([1.0 / count[hand] for hand in hands]) * len(best) / len(count)
    rows = np.stack([np.ones_like(best), best], axis=1)
    bounds = np.stack([np.zeros_like(best), weights], axis=1)
    found = [
        linprog(-values, A_eq=rows.T, b_eq=(1.0 - at) * rows.T @ weights, bounds=bounds)
        for at in (MISS, 1.0 - MISS)
    ]
    return np.array([-one.eqlin.marginals for one in found])


def losses(kind: str, found: LeftOut, data: Rated) -> dict[str, float]:
    """Print rank correlation, bias and error of every origin left out; return its coverage by others' intervals."""
    shares = {}
    for name in dict.fromkeys(data.fine):
        own = data.fine == name
        best, values = found.fine[own], data.values[own]
        gap = best - values
        rank = np.corrcoef(_ranks(best), _ranks(values))[0, 1]
        low, high = interval_ends(
            best, *interval(found.hand[~own], data.values[~own], data.fine[~own])
        )
        shares[name] = float(np.mean((low <= values) & (values <= high)))
        print(
            f"{kind:7} {name:24} n={own.sum():5} rank {rank:5.2f} bias {gap.mean():+.2f} "
            f"median error {np.median(abs(gap)):.2f} covered by others' interval {shares[name]:.2f}"
        )
    own = data.coarse == "author"
    area = auroc(found.fine[own & data.twin], found.fine[own & ~data.twin])
    print(f"{kind:7} author left out, scenarios against twins: AUROC {area:.3f}")
    moved = np.median(registers_moved(found.event, data))
    print(f"{kind:7} author's events left out, moved by a register: {moved:.3f}")
    by_hand = collections.defaultdict(list)
    for name, share in shares.items():
        by_hand[_HANDS.get(name, name).partition(",")[0]].append(share)
    mean = np.mean([np.mean(some) for some in by_hand.values()])
    print(
        f"{kind:7} covered by others' interval, mean over origins {np.mean([*shares.values()]):.3f}, over hands {mean:.3f}"
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


def unseen(folder: Path, encoder: Encoder) -> tuple[dict[str, float], float]:
    """Return figures by fits without the texts that they are about; prints the losses.

    Returns:
        The coverage of every origin by intervals from all others, and how far a register moves an event, decades.
    """
    data = rated(folder)
    cached = CachedEncoder(encoder, cache_folder() / "rarity")
    found = rows_of(data, Words(*vocabulary(data)), cached)
    cached.save()
    rows = found.full()
    estimates = left_out(Fit(rows, rows[is_written(data)], data, found.pairs(is_full=True)), data)
    moved = float(np.median(registers_moved(estimates.event, data)))
    return losses("minilm", estimates, data), moved


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
    chosen = np.flatnonzero(is_written(data))
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
        estimates = left_out(fit, data)
        losses(kind, estimates, data)
        low, high = interval(estimates.hand, data.values, data.fine)
        near = kernel(np.delete(rows, chosen, axis=0), points, GAMMA).max(axis=1)
        values = fit.arrays() | {
            "low": low,
            "high": high,
            "nearest": np.quantile(near, 0.005),
        }
        arrays |= {f"{kind}.{name}": np.asarray(value) for name, value in values.items()}
        tune = [without_courtesy(text.text) for text in load_controls("tune")]
        head = Head(arrays, kind)
        seen = head.estimate(tune, unit(encoder.encode(tune)) if is_full else None).best
        print(f"{kind:7} tune controls: AUROC {auroc(seen[::2], seen[1::2]):.3f}")
        print(f"{kind:7} interval: {low.round(2)} to {high.round(2)} as constant and slope")
    if not asked.check:
        np.savez_compressed(HEAD, **arrays)
        print(HEAD, f"{HEAD.stat().st_size / 2**10:.0f} KiB")


if __name__ == "__main__":
    main()
