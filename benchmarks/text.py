"""Measures the texts: OOD-ness, diversity, distinctness, and distance from their ordinary twins.

Usage: python benchmarks/text.py [--json] [--llm NAME] [--seed N] [--style STYLE] [--study FOLDER] [--only PART ...]

Without `--study`, the built-in author or the model named by `--llm` first grows the trees and writes the texts.
Parts: sets, twins, redteam, pruning, claims. CityFlow-NL is found through the environment variable
OODSCEN_CORPORA; without it its rows are `not run`. Each figure comes with its interval over paths and, if they
exist, the paper's figure (nuScenes text as baseline: not comparable in absolute terms) and that of a frontier
model that followed the paper by hand.
"""

import argparse
import importlib
import json
import os
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from tqdm import tqdm

from oodscen import Describer, Metrics, Scenario, Study, StudyConfig, make_llm
from oodscen._entry_points import DEFAULT_LLM
from oodscen._parallel.threads import as_finished
from oodscen._pipeline.pipeline import Pipeline
from oodscen._registry import make_encoder
from oodscen._words.text import folded_words
from oodscen.author._knowledge.loading import load_knowledge
from oodscen.author._reading.recognition import Recogniser
from oodscen.baselines import load_baseline
from oodscen.encoders._cached import CachedEncoder
from oodscen.encoders._similarity import unit
from oodscen.errors import AnswerError
from oodscen.prompts._scenario.describe_path import STYLES
from oodscen.stages._spread import spread_subset
from oodscen.statistics._intervals import Interval
from oodscen.statistics._resampling import bootstrap_mean

OTHERS = {
    "redteam": "_text_redteam",
    "pruning": "_text_pruning",
    "claims": "_text_claims",
}
PARTS = ("sets", "twins", *OTHERS)
CORPUS = "cityflow_nl_2023.jsonl"
SIMULATABLE = 130
SAMPLE = 1_000
PAPER = {
    "10": {"OOD-ness": -0.677, "diversity": -0.635},
    "100": {"OOD-ness": -0.691, "diversity": -0.638},
    "1000": {"OOD-ness": -0.690, "diversity": -0.642},
    "simulatable": {"OOD-ness": -0.765, "diversity": -0.762},
}
FRONTIER = {
    "100": {"CityFlow": -0.504, "pairwise": -0.53, "nearest": -0.70},
    "simulatable": {"CityFlow": -0.536, "pairwise": -0.66, "nearest": -0.85},
}
LEAST = {
    "100": {"CityFlow": -0.51, "pairwise": -0.53, "nearest": -0.72},
    "1000": {"pairwise": -0.55, "nearest": -0.88},
    "simulatable": {"CityFlow": -0.54, "pairwise": -0.66},
}
LEAST_GAP = {"shipped": 0.05, "CityFlow": 0.03}
NEAREST_WITHIN = 0.90

Row = dict[str, object]


def row(
    name: str,
    value: float | str,
    target: str = "",
    holds: bool | None = None,
    *,
    interval: Interval | None = None,
    **beside: object,
) -> Row:
    shown = round(value, 4) if isinstance(value, float) else value
    found: Row = {"name": name, "value": shown, "unit": "", "target": target, "holds": holds}
    if interval is not None:
        found["interval"] = [round(interval.low, 4), round(interval.high, 4)]
    return {**found, **{key: one for key, one in beside.items() if one is not None}}


class Measured:
    """The sets of one study, and the encoders and baselines that measure them."""

    def __init__(self, sets: dict[str, list[Scenario]], seed: int) -> None:
        self.sets = sets
        self.encoder = CachedEncoder(make_encoder(_encoder()))
        self.shipped = Metrics(self.encoder, seed=seed)
        folder = os.environ.get("OODSCEN_CORPORA")
        file = Path(folder or ".") / CORPUS
        self.cityflow = (
            Metrics(self.encoder, load_baseline(file), seed=seed)
            if folder and file.exists()
            else None
        )

    def vectors(self, texts: Sequence[str]) -> np.ndarray:
        """Return [n, d] vectors of unit length."""
        return unit(self.encoder.encode(list(texts)))


def _encoder() -> str:
    found = importlib.util.find_spec("onnxruntime")
    return "minilm-onnx" if found is not None else "minilm"


def sets(measured: Measured) -> list[Row]:
    """Measure every set, and properties of all its texts."""
    rows = []
    for name, chosen in measured.sets.items():
        if name == "simulatable, all":
            continue
        rows += _set(name, chosen, measured)
    largest = measured.sets["1000"]
    everything = [*largest, *measured.sets["simulatable, all"]]
    for name in ("1000", "simulatable, all"):
        near = _within(measured.sets[name], measured)
        mean = float(near.mean())
        rows.append(
            row(
                f"nearest similarity within a path, {name}",
                mean,
                f"<= {NEAREST_WITHIN}",
                mean <= NEAREST_WITHIN,
            )
        )
    flagged = len(measured.shipped.off_topic([one.text for one in everything]).flagged)
    rows.append(row(f"flagged as off-topic, of {len(everything)}", flagged, "0", flagged == 0))
    for name, one in (("1000", largest), ("simulatable, all", measured.sets["simulatable, all"])):
        equal = len(one) - len({folded_words(scenario.text) for scenario in one})
        rows.append(row(f"equal but for case and punctuation, {name}", equal, "0", equal == 0))
    other = _told_otherwise(everything)
    rows.append(row(f"of another kind than the path, of {len(everything)}", other, "0", other == 0))
    return rows


def _set(name: str, chosen: list[Scenario], measured: Measured) -> list[Row]:
    least, frontier, paper = LEAST.get(name, {}), FRONTIER.get(name, {}), PAPER[name]
    label = f"{name} (n={len(chosen)})"
    rows = []
    for corpus, metrics in (("CityFlow", measured.cityflow), ("shipped", measured.shipped)):
        title = f"OOD-ness on {corpus}, {label}"
        bound = least.get(corpus)
        target = f">= {bound}" if bound is not None else ""
        if metrics is None:
            rows.append(row(title, "not run", target, False if bound is not None else None))
            continue
        found = metrics.oodness(chosen)
        rows.append(
            row(
                title,
                found.mean,
                target,
                found.mean >= bound if bound is not None else None,
                interval=found.interval,
                paper=paper["OOD-ness"],
                frontier=frontier.get(corpus),
            )
        )
    found = measured.shipped.diversity(chosen)
    for kind, value, interval in (
        ("pairwise", found.pairwise, found.pairwise_interval),
        ("nearest", found.nearest, found.nearest_interval),
    ):
        bound = least.get(kind)
        rows.append(
            row(
                f"diversity, {kind}, {label}",
                float(value),
                f">= {bound}" if bound is not None else "",
                value >= bound if bound is not None else None,
                interval=interval,
                paper=paper["diversity"] if kind == "pairwise" else None,
                frontier=frontier.get(kind),
            )
        )
    return rows


def _within(scenarios: list[Scenario], measured: Measured) -> np.ndarray:
    """Return, for each text that shares its path, its largest cosine similarity to another text there."""
    vectors = measured.vectors([scenario.text for scenario in scenarios])
    places: dict[str, list[int]] = {}
    for place, scenario in enumerate(scenarios):
        places.setdefault(scenario.leaf, []).append(place)
    found = []
    for own in places.values():
        if len(own) > 1:
            cosines = vectors[own] @ vectors[own].T
            np.fill_diagonal(cosines, -1.0)
            found.append(cosines.max(axis=1))
    return np.concatenate(found)


def _told_otherwise(scenarios: list[Scenario]) -> int:
    """Count the texts that the knowledge base assigns to a kind other than their path's."""
    recogniser = Recogniser(load_knowledge())
    wrong = 0
    for scenario in scenarios:
        told = recogniser.recognise(scenario.text).hazard
        covered = recogniser.covered_by(scenario.path[-1])
        wrong += bool(told is not None and covered and told not in covered)
    return wrong


def twins(measured: Measured, llm: str, seed: int) -> list[Row]:
    """Compare texts with their ordinary twins."""
    chosen = spread_subset(measured.sets["1000"], SAMPLE)
    describer = Describer(make_llm(llm, seed=seed))

    def twin(scenario: Scenario) -> str | None:
        if scenario.ordinary is not None:
            return scenario.ordinary
        try:
            return describer.ordinary(scenario)
        except AnswerError:
            return None

    threads = 1 if llm == DEFAULT_LLM else 8
    numbered = list(enumerate(chosen))
    done = tqdm(
        as_finished(lambda item: twin(item[1]), numbered, threads=threads),
        total=len(chosen),
        desc="twins",
        disable=None,
    )
    found = {number: text for (number, _), text in done}
    pairs = [(one, found[n]) for n, one in numbered if found[n] is not None]
    words = [
        len(folded_words(text).split()) / len(folded_words(one.text).split()) for one, text in pairs
    ]
    rows = [
        row("texts with an ordinary twin", len(pairs), f"{len(chosen)}", len(pairs) == len(chosen))
    ]
    clusters = [one.leaf for one, _ in pairs]
    for corpus, metrics in (("shipped", measured.shipped), ("CityFlow", measured.cityflow)):
        least = LEAST_GAP[corpus]
        title, target = f"gap to the twin on {corpus}", f">= {least}, interval above 0"
        if metrics is None:
            rows.append(row(title, "not run", target, False))
            continue
        ood = np.array(metrics.oodness([one.text for one, _ in pairs]).per_text)
        gaps = ood - np.array(metrics.oodness([text for _, text in pairs]).per_text)
        interval = bootstrap_mean(gaps, clusters, seed=seed)
        mean = float(gaps.mean())
        holds = mean >= least and interval is not None and interval.low > 0.0
        rows.append(row(title, mean, target, holds, interval=interval))
        rows.append(row(f"texts further out than their twin on {corpus}", float((gaps > 0).mean())))
    rows.append(row("length of the twin over that of the text", float(np.mean(words))))
    return rows


def texts_of(arguments: argparse.Namespace, folder: str) -> dict[str, list[Scenario]]:
    """Return the sets of a study, writing them first if no study is given."""
    if arguments.study is not None:
        study = Study.open(arguments.study)
        drawn = {
            str(size): [
                Scenario.parse(line) for line in study.store.lines(f"texts.diverse.{size}.jsonl")
            ]
            for size in (10, 100, 1000)
        }
        simulatable = [
            Scenario.parse(line)
            for line in study.store.lines("scenarios.jsonl")
            if "error" not in line
        ]
    else:
        config = StudyConfig(
            llm=arguments.llm, seed=arguments.seed, style=arguments.style, encoder=_encoder()
        )
        pipeline = Pipeline(folder, config)
        pipeline.prepare()
        texts = pipeline.write_texts()
        drawn = {str(size): chosen for size, chosen in texts.sets.items()}
        simulatable = texts.scenarios
    first = simulatable[:SIMULATABLE]
    return {**drawn, "simulatable": first, "simulatable, all": simulatable}


def others(name: str, llm: str, seed: int) -> list[Row]:
    """Return the rows of a part that has its own file."""
    try:
        module = importlib.import_module(OTHERS[name])
    except ModuleNotFoundError as error:
        return [row(f"{name}: {error}", "not run", "", False)]
    return list(module.rows(llm=llm, seed=seed))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--only", nargs="+", choices=PARTS, default=PARTS)
    parser.add_argument("--llm", default=DEFAULT_LLM)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--style", choices=STYLES, default="natural")
    parser.add_argument("--study", type=Path, help="Folder of a study with the default sizes.")
    arguments = parser.parse_args()
    os.environ.setdefault("HF_HUB_OFFLINE", "1")
    rows: list[Row] = []
    if {"sets", "twins"} & set(arguments.only):
        with tempfile.TemporaryDirectory() as folder:
            measured = Measured(texts_of(arguments, folder), arguments.seed)
        if "sets" in arguments.only:
            rows += sets(measured)
        if "twins" in arguments.only:
            rows += twins(measured, arguments.llm, arguments.seed)
    for name in OTHERS:
        if name in arguments.only:
            rows += others(name, arguments.llm, arguments.seed)
    if arguments.json:
        print(json.dumps(rows))
    else:
        show(rows)
    return 0 if all(found["holds"] is not False for found in rows) else 1


def show(rows: list[Row]) -> None:
    for found in rows:
        state = {True: "holds", False: "FAILS", None: ""}[found["holds"]]
        low_high = found.get("interval")
        interval = f"[{low_high[0]}, {low_high[1]}]" if low_high else ""
        beside = " ".join(f"{key} {found[key]}" for key in ("paper", "frontier") if key in found)
        print(
            f"{found['name']:52} {found['value']!s:>9} {interval:>20} {found['target']:26} {state:6} {beside}"
        )


if __name__ == "__main__":
    sys.exit(main())
