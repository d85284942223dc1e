"""Measures the accuracy, speed, memory use and discrimination of the metrics.

Usage: python benchmarks/metrics.py [--json] [--only PART ...]

Parts: exactness, speed, memory, encoding, selection, controls, guard. The texts of `guard` are found through the
environment variable OODSCEN_CORPORA; the parts that compare with faiss-cpu, diversity and onnxruntime require
them. Times are ratios within one run, in which the compared tasks alternate.
"""

import argparse
import importlib.util
import json
import os
import sys
import tempfile
import time
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import numpy as np
from tqdm import tqdm

from oodscen import Metrics
from oodscen.baselines import load_controls
from oodscen.baselines._embedded import open_embeddings
from oodscen.baselines._ordinary import ordinary_driving
from oodscen.encoders import _similarity as kernel
from oodscen.encoders._minilm import MiniLM
from oodscen.encoders._onnx import OnnxMiniLM
from oodscen.encoders._similarity import nearest, nearest_other, smallest, unit
from oodscen.metrics._detection.detectors import DETECTORS
from oodscen.metrics._diversity import diversity
from oodscen.metrics._selection import most_diverse
from oodscen.statistics._auroc import auroc_interval
from oodscen.testing._encoder import HashEncoder

PARTS = ("exactness", "speed", "memory", "encoding", "selection", "controls", "guard")
QUERIES, REFERENCES, WIDTH, SET = 4_000, 40_000, 384, 20_000
MILLION = 1_000_000
ROUNDS = 5

Row = dict[str, object]


def row(name: str, value: object, unit_: str, target: str, holds: bool | None) -> Row:
    shown = round(value, 6) if isinstance(value, float) else value
    return {"name": name, "value": shown, "unit": unit_, "target": target, "holds": holds}


def vectors(seed: int, n: int, d: int = WIDTH) -> np.ndarray:
    return unit(np.random.default_rng(seed).standard_normal((n, d), dtype=np.float32))


def turns(tasks: dict[str, Callable[[], object]], rounds: int = ROUNDS) -> dict[str, float]:
    """Return the best CPU time of each task; the tasks alternate."""
    times: dict[str, list[float]] = {name: [] for name in tasks}
    for _ in tqdm(range(rounds), desc=" / ".join(tasks), disable=None):
        for name, task in tasks.items():
            began = time.process_time()
            task()
            times[name].append(time.process_time() - began)
    return {name: min(found) for name, found in times.items()}


def exactness() -> list[Row]:
    """Compare with float64, with torch, and with the package diversity."""
    worst = 0.0
    for seed, (n, m) in enumerate(((1, 1), (2, 2), (1, 9), (2, 5000), (700, 1300), (5000, 90))):
        draws = np.random.default_rng(seed)
        a, b = (draws.normal(size=(k, WIDTH)).astype(np.float32) for k in (n, m))
        b[draws.random(m) < 0.2] = 0.0
        b[draws.random(m) < 0.2] = b[0]
        a[draws.random(n) < 0.3] = b[0] * np.float32(1.0 + 1e-5)
        a[draws.random(n) < 0.1] = 0.0
        wide = [_exact(x) for x in (a, b)]
        cosines, own = wide[0] @ wide[1].T, wide[0] @ wide[0].T
        gaps = [
            np.abs(nearest(unit(a), unit(b)).cosine - cosines.max(axis=1)).max(),
            np.abs(smallest(unit(a), unit(b)) - cosines.min(axis=1)).max(),
        ]
        if n > 1:
            pairs = (own.sum() - np.trace(own)) / (n * (n - 1))
            np.fill_diagonal(own, -np.inf)
            found = diversity(unit(a), "float32")
            gaps.append(abs(found.nearest + own.max(axis=1).mean()))
            gaps.append(abs(found.pairwise + pairs))
        worst = max(worst, *map(float, gaps))
    rows = [row("largest gap to float64", worst, "", "<= 1e-5", worst <= 1e-5)]
    return [*rows, _chamfer()]


def _exact(x: np.ndarray) -> np.ndarray:
    wide = x.astype(np.float64)
    lengths = np.linalg.norm(wide, axis=1)[:, None]
    return np.divide(wide, lengths, out=np.zeros_like(wide), where=lengths > 0)


def _chamfer() -> Row:
    name, target = "gap to Chamfer distance of diversity", "<= 5e-4"
    found = importlib.util.find_spec("diversity")
    if found is None or found.origin is None:
        return row(name, "not run", "", target, False)
    # Import the module alone: the package itself needs spaCy, which this figure does not use.
    file = Path(found.origin).parent / "embedding.py"
    origin = importlib.util.spec_from_file_location("chamfer", file)
    assert origin is not None
    assert origin.loader is not None
    module = importlib.util.module_from_spec(origin)
    origin.loader.exec_module(module)
    texts = [control.text for control in load_controls("tune")]
    model = MiniLM()
    module.SentenceTransformer = lambda _: model._load()
    theirs = float(module.chamfer_dist(texts, verbose=False))
    ours = Metrics(model, ["a car"]).diversity(texts).nearest
    assert ours is not None
    gap = abs(1.0 + ours - theirs)
    return row(name, gap, "", target, gap <= 5.001e-4)


def _has(name: str) -> bool:
    try:
        return importlib.util.find_spec(name) is not None
    except ImportError:
        return False


def speed() -> list[Row]:
    """Compare with the bare matrix product in the same blocks, and with faiss."""
    queries, references, own = vectors(0, QUERIES), vectors(1, REFERENCES), vectors(2, SET)

    def bare() -> None:
        for _ in kernel._blocks(queries, references):
            pass

    tasks: dict[str, Callable[[], object]] = {
        "bare": bare,
        "oodness": lambda: nearest(queries, references),
        "diversity": lambda: nearest_other(own),
    }
    if _has("faiss"):
        import faiss

        index, inside = faiss.IndexFlatIP(WIDTH), faiss.IndexFlatIP(WIDTH)
        index.add(references)
        inside.add(own)
        tasks["faiss"] = lambda: index.search(queries, 1)
        tasks["faiss in itself"] = lambda: inside.search(own, 2)
    found = turns(tasks)
    bound = found["oodness"] / found["bare"]
    rows = [row("OOD-ness over the bare product", bound, "x", "<= 1.15", bound <= 1.15)]
    if not _has("faiss"):
        names = (("OOD-ness over faiss", "<= 1.0"), ("diversity: faiss over ours", ">= 1.25"))
        return rows + [row(name, "not run", "x", target, False) for name, target in names]
    over = found["oodness"] / found["faiss"]
    gain = found["faiss in itself"] / found["diversity"]
    return [
        *rows,
        row("OOD-ness over faiss", over, "x", "<= 1.0", over <= 1.0),
        row("diversity: faiss over ours", gain, "x", ">= 1.25", gain >= 1.25),
    ]


def memory() -> list[Row]:
    """Measure the memory allocated beyond the vectors, and stream a million rows from disk."""
    queries, references = vectors(0, QUERIES), vectors(1, REFERENCES)
    peak = max(
        _peak(lambda: nearest(queries, references)), _peak(lambda: nearest_other(references))
    )
    rows = [row("peak extra memory", peak / 2**20, "MB", "<= 256", peak <= 256 * 2**20)]
    encoder = HashEncoder(WIDTH)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "million.npy"
        stored = np.lib.format.open_memmap(file, "w+", np.float32, (MILLION, WIDTH))
        for first in tqdm(range(0, MILLION, 50_000), desc="write", disable=None):
            stored[first : first + 50_000] = vectors(10_000 + first, 50_000)
        stored[MILLION - 7] = queries[3]
        stored.flush()
        del stored
        file.with_name("million.npy.json").write_text(json.dumps({"encoder": encoder.name}))
        baseline = open_embeddings(file, encoder)
        began = time.perf_counter()
        peak = _peak(lambda: nearest(queries[:500], baseline))
        took = time.perf_counter() - began
        found = nearest(queries[3:4], baseline)
    right = int(found.index[0]) == MILLION - 7
    good = right and peak <= 256 * 2**20
    return [
        *rows,
        row("peak, a million rows from disk", peak / 2**20, "MB", "<= 256", good),
        row("500 texts against a million rows", took, "s", "", None),
    ]


def _peak(task: Callable[[], object]) -> int:
    tracemalloc.start()
    try:
        task()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def encoding() -> list[Row]:
    """Compare ONNX Runtime with stock sentence-transformers, on the same number of threads."""
    names = (
        ("encoding: sentence-transformers over ours", ">= 1.8"),
        ("smallest cosine", ">= 0.9999"),
    )
    if not _has("onnxruntime"):
        return [row(name, "not run", "", target, False) for name, target in names]
    import torch

    threads = os.cpu_count() or 1
    torch.set_num_threads(threads)
    texts = list(ordinary_driving().texts[-2000:])
    ours, model = OnnxMiniLM(threads=threads), MiniLM()._load()
    ours.encode(texts[:8])
    kept: dict[str, np.ndarray] = {}

    def run(name: str, encode: Callable[[], np.ndarray]) -> Callable[[], None]:
        def task() -> None:
            kept[name] = encode()

        return task

    found = turns(
        {
            "onnx": run("onnx", lambda: ours.encode(texts)),
            "default": run(
                "default",
                lambda: model.encode(texts, normalize_embeddings=True, show_progress_bar=False),
            ),
        },
        rounds=2,
    )
    gain = found["default"] / found["onnx"]
    cosine = float(np.einsum("ij,ij->i", kept["onnx"], kept["default"]).min())
    small = OnnxMiniLM(int8=True, threads=threads)
    return [
        row(names[0][0], gain, "x", names[0][1], gain >= 1.8),
        row(names[1][0], cosine, "", names[1][1], cosine >= 0.9999),
        row("int8: smallest cosine on samples", 1.0 - small.error, "", "shown", None),
    ]


def selection() -> list[Row]:
    """Measure the selection of 200 of 100,000."""
    rows = vectors(4, 100_000)
    found = []
    for method in ("max-min", "determinantal"):
        began = time.perf_counter()
        chosen = most_diverse(rows, 200, method)
        took = time.perf_counter() - began
        same = np.array_equal(chosen, most_diverse(rows, 200, method))
        found.append(row(f"200 of 100,000, {method}", took, "s", "<= 60", took <= 60 and same))
    return found


def controls() -> list[Row]:
    """Separate ordinary from OOD texts on the frozen pairs."""
    texts = [control.text for control in load_controls("frozen")]
    metrics = Metrics(OnnxMiniLM() if _has("onnxruntime") else MiniLM())
    found = {}
    for name in tqdm(("tabulated", *DETECTORS), desc="controls", disable=None):
        scores = np.array(metrics.oodness(texts, name).per_text)
        found[name] = auroc_interval(scores[::2], scores[1::2], is_paired=True)
    best = max(found, key=lambda name: found[name].value)
    rows = [
        row(
            "AUROC of the default on frozen controls",
            found["tabulated"].value,
            "",
            ">= 0.75",
            found["tabulated"].value >= 0.75,
        ),
        row(
            f"AUROC of the best detector ({best})",
            found[best].value,
            "",
            ">= 0.88 (goal)",
            found[best].value >= 0.88,
        ),
    ]
    return rows + [
        row(
            f"AUROC, {name}",
            f"{one.value:.3f} [{one.interval.low:.3f}, {one.interval.high:.3f}]",
            "",
            "",
            None,
        )
        for name, one in found.items()
        if one.interval
    ]


def guard() -> list[Row]:
    """Check that held-out off-topic texts are flagged, and none of the OOD sets."""
    metrics = Metrics()
    texts = (*load_controls("frozen", off_topic=True), *load_controls("blind", off_topic=True))
    flagged = set(metrics.off_topic([text.text for text in texts]).flagged)
    rows = []
    for kind, least in (("off-topic", 0.98), ("near-miss", 0.90)):
        own = [place for place, text in enumerate(texts) if text.kind == kind]
        share = float(np.mean([place in flagged for place in own]))
        rows.append(row(f"{kind} flagged", share, f"of {len(own)}", f">= {least}", share >= least))
        for split in ("frozen", "blind"):
            part = [place for place in own if texts[place].split == split]
            share = float(np.mean([place in flagged for place in part]))
            rows.append(row(f"  {split}", share, f"of {len(part)}", "(shown)", None))
    folder = os.environ.get("OODSCEN_CORPORA")
    if not folder:
        return [*rows, row("false alarms on OOD sets", "not run", "", "<= 0.01", False)]
    lines = [line for file in sorted(Path(folder).glob("ood_*.jsonl")) for line in file.open("rb")]
    share = metrics.off_topic([json.loads(line)["text"] for line in lines]).share
    return [*rows, row("false alarms on OOD sets", share, "", "<= 0.01", share <= 0.01)]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--only", nargs="+", choices=PARTS, default=PARTS)
    arguments = parser.parse_args()
    os.environ.setdefault("HF_HUB_OFFLINE", "1")
    parts = {part: globals()[part] for part in arguments.only}
    rows = [found for part in parts.values() for found in part()]
    if arguments.json:
        print(json.dumps(rows))
    else:
        for found in rows:
            state = {True: "holds", False: "FAILS", None: ""}[found["holds"]]
            print(
                f"{found['name']:45} {found['value']!s:>28} {found['unit']:3} {found['target']:16} {state}"
            )
    return 0 if all(found["holds"] is not False for found in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
