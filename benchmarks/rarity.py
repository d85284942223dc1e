"""Measures rarity: separation, ranks, coverage, agreement of draws, anchors, speed, and style.

Usage: python benchmarks/rarity.py [--json] [--only PART ...] [--held-out FILE ...] [--recordings FOLDER] [--encoder NAME]
       python benchmarks/rarity.py --prepare FOLDER
       python benchmarks/rarity.py --picture FILE

Parts: controls, held_out, unseen, model, anchors, speed, style. `--held-out` names lines of `text`, `kind` (`ordinary` or
`ood`) and `log10_km` by hands that had no part in the training. `--recordings` holds a model's recorded
answers: `draw1.jsonl`, `draw2.jsonl`, `phrased.jsonl`, `shuffled.jsonl`, each with lines of `text` and
`log10_km`. `--prepare` writes four questions (`draw1.md` ...) about 60 texts and two about the wordings of the published
rates (`anchors1.md`, `anchors2.md`), one for each blind reader, who answers into the file of the same name. `--held-out` and `--recordings` default to `rarity_data`, whose README says who
wrote and answered it. Rated texts are found through the environment variable OODSCEN_CORPORA. Rows without their data are `not run`.
"""

import argparse
import json
import os
import re
import sys
import time
import tracemalloc
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from oodscen import Metrics, make_encoder
from oodscen.baselines import load_controls
from oodscen.metrics._rarity.estimates import POPULATION, estimate_anchors
from oodscen.metrics._rarity.head import estimate, load_head
from oodscen.metrics._rarity.rate_calibration import calibrate, left_out
from oodscen.metrics._rarity.rates import PublishedRate, published_rates
from oodscen.prompts._scenario.estimate_rarity import EstimateRarity
from oodscen.report._charts.sets import Cloud, scatter
from oodscen.statistics._auroc import auroc, auroc_interval

DATA = Path(__file__).parent / "rarity_data"
ANCHOR_DRAWS = ("anchors1", "anchors2")
"""Questions about the published rates."""
PARTS = ("controls", "held_out", "unseen", "model", "anchors", "speed", "style")
ADDED = {
    "length": "{} The drive began in the morning, and it will take another hour.",
    "place names": "Near Ashford, on the way to Canterbury: {}",
    "polite words": "Please kindly note the following, thank you. {}",
    "polite words in no list": "I regret to inform the esteemed reader of this: {}",
}
REGISTERS = ("paper", "terse", "verbose", "first-person")

Row = dict[str, object]


def row(name: str, value: object, unit: str, target: str, holds: bool | None) -> Row:
    shown = round(value, 4) if isinstance(value, float) else value
    return {"name": name, "value": shown, "unit": unit, "target": target, "holds": holds}


def not_run(name: str, target: str) -> Row:
    return row(name, "not run", "", target, False)


class Bench:
    """The metrics and the data of one run."""

    def __init__(self, asked: argparse.Namespace) -> None:
        self.asked = asked
        self.metrics = Metrics(make_encoder(asked.encoder))
        folder = os.environ.get("OODSCEN_CORPORA")
        self.ratings = Path(folder) / "rarity" if folder else None

    def best(self, texts: Sequence[str]) -> np.ndarray:
        """Return the head's estimates, also of texts that `Metrics.rarity` would give no figure."""
        return estimate(self.metrics.encoder.name, texts, self.metrics.vectors)[1].best

    def rows_of(self, *names: str) -> list[dict]:
        """Return the rated lines of files; empty without the corpora."""
        if self.ratings is None:
            return []
        return [
            json.loads(line)
            for name in names
            if (file := self.ratings / name).exists()
            for line in file.read_text(encoding="utf-8").splitlines()
        ]


def controls(bench: Bench) -> list[Row]:
    """Separate ordinary from OOD texts on the frozen pairs."""
    values = bench.best([text.text for text in load_controls("frozen")])
    found = auroc_interval(values[::2], values[1::2], is_paired=True)
    assert found.interval
    bounds = f"{found.value:.3f} [{found.interval.low:.3f}, {found.interval.high:.3f}]"
    return [
        row("AUROC on frozen controls", found.value, "", ">= 0.88", found.value >= 0.88),
        row("  with its interval", bounds, "", "", None),
        row("  rarer than its pair", float((values[1::2] > values[::2]).mean()), "", "", None),
    ]


def held_out(bench: Bench) -> list[Row]:
    """Separate and rank texts of hands that had no part in the training."""
    if not bench.asked.held_out:
        names = ("AUROC on held-out hands", "rank correlation", "coverage of 90 % intervals")
        targets = (">= 0.90", ">= 0.65", "0.87 to 0.93")
        return [not_run(f"{n}", t) for n, t in zip(names, targets, strict=True)]
    rows = []
    for file in bench.asked.held_out:
        lines = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
        values = bench.best([line["text"] for line in lines])
        odd = np.array([line["kind"] == "ood" for line in lines])
        area = auroc(values[~odd], values[odd])
        rows.append(row(f"AUROC, {file.name}", area, "", ">= 0.90", area >= 0.90))
        rated = np.array([line.get("log10_km", np.nan) for line in lines], np.float64)
        known = np.isfinite(rated)
        if not known.any():
            continue
        rank = _rank_correlation(values[known], rated[known])
        texts = [line["text"] for line, one in zip(lines, known, strict=True) if one]
        per_text = bench.metrics.rarity(texts).per_text
        told = [(t, r) for t, r in zip(per_text, rated[known], strict=True) if t.best is not None]
        inside = float(np.mean([t.low <= r <= t.high for t, r in told]))
        rows += [
            row(f"rank correlation, {file.name}", rank, "", ">= 0.65", rank >= 0.65),
            row(f"coverage, {file.name}", inside, "", "0.87 to 0.93", 0.87 <= inside <= 0.93),
            row(f"no figure, {file.name}", len(per_text) - len(told), "texts", "", None),
        ]
    return rows


def unseen(bench: Bench) -> list[Row]:
    """Cover every origin by intervals from all others, and move unseen events by a register, each by a fit without it."""
    names = (
        "coverage of 90 % intervals, mean over origins left out",
        "same event, another register against natural, events left out",
    )
    targets = ("0.87 to 0.93", "<= 0.5")
    if not bench.rows_of("ratings.jsonl"):
        return [not_run(name, target) for name, target in zip(names, targets, strict=True)]
    from tools.rarity import train

    shares, moved = train.unseen(bench.ratings, bench.metrics.encoder)
    mean = float(np.mean([*shares.values()]))
    rows = [row(names[0], mean, "", targets[0], 0.87 <= mean <= 0.93)]
    rows += [row(f"  {origin}", share, "", "", None) for origin, share in shares.items()]
    return [*rows, row(names[1], moved, "decades", targets[1], moved <= 0.5)]


def model(bench: Bench) -> list[Row]:
    """Compare draws, phrasings and orders of a recorded model."""
    target = "<= 0.3 in the median"
    rows = []
    first = {r["text"]: r["log10_km"] for r in bench.rows_of("ratings.jsonl")}
    second = {r["text"]: r["log10_km"] for r in bench.rows_of("ratings2.jsonl")}
    gaps = _gaps(first, second)
    name = "two draws by different readers of the rated texts"
    rows.append(
        row(name, gaps, "decades", target, gaps <= 0.3)
        if gaps is not None
        else not_run(name, target)
    )
    for other in ("draw2", "phrased", "shuffled"):
        name = f"recorded answers, draw1 against {other}"
        files = [(bench.asked.recordings or Path()) / f"{one}.jsonl" for one in ("draw1", other)]
        if bench.asked.recordings is None or not all(file.exists() for file in files):
            rows.append(not_run(name, target))
            continue
        pair = [_answers(file) for file in files]
        gaps = _gaps(*pair)
        rows.append(row(name, gaps, "decades", target, gaps is not None and gaps <= 0.3))
    return rows


def anchors(bench: Bench) -> list[Row]:
    """Compare the head, and a model's recorded answers, with published rates before and after calibration."""
    rates = published_rates()
    rows = _calibrated("head", rates, estimate_anchors(bench.metrics._space, rates))
    files = [(bench.asked.recordings or Path()) / f"{name}.jsonl" for name in ANCHOR_DRAWS]
    if bench.asked.recordings is None or not all(file.exists() for file in files):
        return [*rows, not_run("model: median error left out", "<= 5")]
    draws = [_answers(file) for file in files]
    said = [
        float(np.mean([np.median([draw[text] for draw in draws]) for text in rate.texts]))
        for rate in rates
    ]
    return rows + _calibrated("model", rates, said)


def _calibrated(who: str, rates: Sequence[PublishedRate], said: Sequence[float]) -> list[Row]:
    """Return the errors of one estimate per rate; those of rates graded A and B are the headline."""
    graded = [place for place, rate in enumerate(rates) if rate.grade in "AB"]
    few, few_said = [rates[place] for place in graded], [said[place] for place in graded]
    found, all_found = calibrate(few, few_said), calibrate(rates, said)
    after = found.factor_left_out
    assert after is not None
    name = f"{who}: median error left out, {len(few)} rates graded A and B"
    by_all = float(10.0 ** np.median(np.abs(left_out(rates, said)[graded])))
    rows = [
        row(name, after, "x", "<= 5", after <= 5),
        row("  before calibration", found.factor_before, "x", "", None),
        row(f"  all {len(rates)} rates", all_found.factor_left_out, "x", "", None),
        row("  slope", found.slope, "", "", None),
        row("  each by all other rates, of any grade", by_all, "x", "", None),
    ]
    errors = 10.0 ** np.abs(left_out(few, few_said))
    for kind in dict.fromkeys(rate.kind for rate in few):
        part = [error for error, rate in zip(errors, few, strict=True) if rate.kind == kind]
        rows.append(row(f"  {kind}, {len(part)}", float(np.median(part)), "x", "", None))
    return rows


def speed(bench: Bench) -> list[Row]:
    """Measure the head beyond the encoder."""
    count = 10_000
    texts = [text.text for text in load_controls("tune")]
    texts = (texts * (count // len(texts) + 1))[:count]
    vectors = np.random.default_rng(0).standard_normal((count, 384), dtype=np.float32)
    vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    head = load_head("minilm")
    head.estimate(texts[:10], vectors[:10])
    began = time.perf_counter()
    head.estimate(texts, vectors)
    rate = 60.0 * count / (time.perf_counter() - began)
    tracemalloc.start()
    head.estimate(texts[:2_000], vectors[:2_000])
    small = tracemalloc.get_traced_memory()[1]
    tracemalloc.reset_peak()
    head.estimate(texts[:6_000], vectors[:6_000])
    grown = (tracemalloc.get_traced_memory()[1] - small) / 2**20
    tracemalloc.stop()
    return [
        row("texts a minute beyond encoding", rate, "", ">= 10,000", rate >= 10_000),
        row("memory for three times the texts", grown, "MB more", "<= 8", grown <= 8),
    ]


def style(bench: Bench) -> list[Row]:
    """Move texts in style alone."""
    texts = [text.text for text in load_controls("tune")]
    plain = bench.best(texts)
    rows = []
    for name, frame in ADDED.items():
        gap = float(np.median(np.abs(bench.best([frame.format(text) for text in texts]) - plain)))
        rows.append(row(f"added {name}", gap, "decades", "<= 0.3", gap <= 0.3))
    natural: dict[str, list[str]] = {}
    told: list[tuple[str, str]] = []
    for line in bench.rows_of("ratings2.jsonl"):
        kind = line["origin"].removeprefix("built-in author, ")
        event = re.sub(r"-\d+$", "", line["of"])
        if kind == "its scenario":
            natural.setdefault(event, []).append(line["text"])
        elif kind in REGISTERS:
            told.append((event, line["text"]))
    told = [(event, text) for event, text in told if event in natural]
    name = "same event, another register against natural, in the fit"
    if not told:
        return [*rows, row(name, "not run", "", "", None)]
    usual = {event: float(bench.best(found).mean()) for event, found in natural.items()}
    values = bench.best([text for _, text in told])
    moved = [abs(value - usual[event]) for value, (event, _) in zip(values, told, strict=True)]
    gap = float(np.median(moved))
    return [*rows, row(f"{name}, {len(told)} texts", gap, "decades", "", None)]


def picture(bench: Bench, file: Path) -> None:
    """Draw the head's estimates against the published rates, by kind."""
    rates = published_rates()
    own = estimate_anchors(bench.metrics._space, rates)
    clouds = [
        Cloud(
            kind, [(x, one.log10_km) for x, one in zip(own, rates, strict=True) if one.kind == kind]
        )
        for kind in ("own", "met", "occurring")
    ]
    axes = ("estimate of the head, log10 km", "published rate, log10 km")
    scatter(clouds, "Estimates and published rates", axes).figure().savefig(
        file, metadata={"Date": None}
    )


PHRASED = (
    "For each text, think of 10^8 km that passenger cars in Europe and North America drive. How often does a driver there come upon what matters in it?\n"
    "Answer with the decimal logarithm of the kilometres between two such occasions (3: once in 1,000 km); null for no driving."
)


def prepare(folder: Path) -> None:
    """Write the questions for blind readers: four about the same 60 texts, and two about the published rates' wordings."""
    pairs = Path(__file__).parents[1] / "tools/rarity/pairs.tsv"
    lines = [line.split("\t") for line in pairs.read_text(encoding="utf-8").splitlines()]
    draws = np.random.default_rng(0)
    texts = [lines[n][1 + 2 * (k % 2)] for k, n in enumerate(draws.permutation(len(lines))[:60])]
    shuffled = [texts[n] for n in draws.permutation(60)]
    wordings = [text for rate in published_rates() for text in rate.texts]
    folder.mkdir(parents=True, exist_ok=True)
    asked = EstimateRarity(texts=tuple(texts), population=POPULATION).messages()[0].text
    asked = asked[asked.index("You estimate") :].partition("\n- Where a text")[0]
    questions = {
        "draw1": (asked, texts),
        "draw2": (asked, texts),
        "phrased": (PHRASED, texts),
        "shuffled": (asked, shuffled),
    }
    for name in ANCHOR_DRAWS:
        questions[name] = (asked, [wordings[n] for n in draws.permutation(len(wordings))])
    for name, (told, shown) in questions.items():
        end = f'Write {name}.jsonl beside this file, a line {{"text": ..., "log10_km": ...}} for every text, copied exactly.'
        body = "\n".join(f"- {text}" for text in shown)
        (folder / f"{name}.md").write_text(f"{told}\n\n{end}\n\n{body}\n", encoding="utf-8")


def _answers(file: Path) -> dict[str, float]:
    rows = map(json.loads, file.read_text(encoding="utf-8").splitlines())
    return {row["text"]: row["log10_km"] for row in rows}


def _gaps(first: dict[str, float | None], second: dict[str, float | None]) -> float | None:
    both = [(first[text], second[text]) for text in first if text in second]
    found = [abs(a - b) for a, b in both if a is not None and b is not None]
    return float(np.median(found)) if found else None


def _rank_correlation(a: np.ndarray, b: np.ndarray) -> float:
    from scipy.stats import spearmanr

    return float(spearmanr(a, b)[0])


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--only", nargs="+", choices=PARTS, default=PARTS)
    parser.add_argument("--held-out", nargs="+", type=Path, default=[DATA / "held_out.jsonl"])
    parser.add_argument("--recordings", type=Path, default=DATA)
    parser.add_argument("--encoder", default="minilm")
    parser.add_argument("--prepare", type=Path)
    parser.add_argument("--picture", type=Path)
    asked = parser.parse_args()
    if asked.prepare is not None:
        prepare(asked.prepare)
        return 0
    os.environ.setdefault("HF_HUB_OFFLINE", "1")
    bench = Bench(asked)
    if asked.picture is not None:
        picture(bench, asked.picture)
        return 0
    rows = [found for part in asked.only for found in globals()[part](bench)]
    if asked.json:
        print(json.dumps(rows))
    else:
        for found in rows:
            state = {True: "holds", False: "FAILS", None: ""}[found["holds"]]
            value = str(found["value"])
            print(f"{found['name']:60} {value:>24} {found['unit']:8} {found['target']:20} {state}")
    return 0 if all(found["holds"] is not False for found in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
