"""Reruns the scenes of a finished study from its folder and compares the episodes.

Usage: python benchmarks/reproduce.py STUDY [--json] [--workers N]

This fresh process reads every line of scenes.jsonl, with its keys in random order, and reruns it with its twin.
"""

import argparse
import json
import os
import random
import sys
from collections import Counter
from pathlib import Path
from typing import Any

from tqdm import tqdm

from oodscen import Study
from oodscen._pipeline.jobs import Job, SweepResult
from oodscen._pipeline.sweep import sweep
from oodscen.data._episode import Episode
from oodscen.data._pairing import kind_of
from oodscen.data._scene import Scene

COMPARED = ("trace_sha256", "frame_sha256", "actions", "decision_s", "status", "error")


def shuffled(value: Any, rng: random.Random) -> Any:
    """Return plain data with the keys of all mappings in random order."""
    if isinstance(value, dict):
        return {key: shuffled(value[key], rng) for key in rng.sample(list(value), len(value))}
    return [shuffled(item, rng) for item in value] if isinstance(value, list) else value


def differences(study: Study, result: SweepResult, recorded: Episode | None) -> list[str]:
    """Return the fields and files that differ from the study's record."""
    if recorded is None:
        return ["no episode"]
    found = [n for n in COMPARED if getattr(result.episode, n) != getattr(recorded, n)]
    for moment, file in recorded.frames.items():
        path = study.store.path(file)
        if not path.is_file() or path.read_bytes() != result.frames.get(moment):
            found.append(file)
    return found


def reproduce(study: Study, workers: int) -> list[dict[str, Any]]:
    """Rerun all scenes and ordinary drives of a study and count those that match the record."""
    rng = random.Random(0)
    scenes = [
        Scene.parse(shuffled(line, rng))
        for line in study.table("scenes")
        if line.get("status") != "failed" and "demand" not in line
    ]
    recorded = {episode.id: episode for episode in study.episodes}
    named = sum(recorded[s.id].made_from == s.digest() for s in scenes if s.id in recorded)
    same: Counter[str] = Counter()
    job = Job(study.config.simulator, study.config.seed, twins=True, demands=study.config.demands)
    wanted = Counter(kind_of(name) for name in recorded)
    bar = tqdm(total=wanted.total(), desc="reproduce", disable=None)
    for result in sweep(job, scenes, workers=workers):
        bar.update()
        found = differences(study, result, recorded.get(result.episode.id))
        same[kind_of(result.episode.id)] += not found
        if found:
            print(f"{result.episode.id}: other {', '.join(found)}", file=sys.stderr)
    what = "whose trace, frames and outcomes are as recorded"
    return [
        row("scenes whose episode names them as they are", named, "scenes", len(scenes)),
        row(f"scenes {what}", same["rare"], "scenes", wanted["rare"]),
        row(f"twins {what}", same["twin"], "twins", wanted["twin"]),
        row(f"demands {what}", same["demand"], "demands", wanted["demand"]),
    ]


def row(name: str, value: int, unit: str, target: int) -> dict[str, Any]:
    """Return one row of the report."""
    holds = value == target > 0
    return {"name": name, "value": value, "unit": unit, "target": target, "holds": holds}


def main() -> int:
    """Run the benchmark; return 0 if every target holds."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("study", type=Path, help="folder of a finished study")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--json", action="store_true", help="print the rows as JSON, last line")
    given = parser.parse_args()
    rows = reproduce(Study.open(given.study), given.workers)
    for one in rows:
        limit = "holds" if one["holds"] else "FAILS"
        print(f"{one['name']:62} {one['value']:>6} of {one['target']} {one['unit']:8} {limit}")
    if given.json:
        print(json.dumps(rows))
    return 0 if all(one["holds"] for one in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
