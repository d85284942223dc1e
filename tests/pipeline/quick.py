"""The small studies that tests make variants of: small flat pictures, hashes for vectors, fifty texts as baseline."""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from oodscen import Study, StudyConfig
from oodscen._io.lock import locked
from oodscen._pipeline import run_study
from oodscen.data._episode import Episode
from oodscen.data._verdict import Verdict
from oodscen.judging._aspects.opinions import rescore_verdict
from oodscen.judging._scoring import GivenAnswers, answers_in, rescored
from oodscen.judging._selection import choose_items
from oodscen.study._stale_verdicts import Tables

ORDINARY = Path(__file__).with_name("ordinary.txt")
QUICK = StudyConfig.quick(
    simulator="flat",
    encoder="hash",
    baseline=str(ORDINARY),
    iterations=4,
    max_paths=2,
    seed=13,
    width=160,
    height=120,
)
SMALL = QUICK.model_copy(update={"max_paths": 1, "iterations": 2, "demands": False, "seed": 3})
"""One scene and its twin, for what needs no second one."""


LOGS = {"study.json", "calls.jsonl", "answers.jsonl", "report.html"}
"""Files that tell of a run and not of its study."""


def content(folder: Path) -> dict[str, bytes]:
    """Return every file of a study but its logs."""
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {
        str(path.relative_to(folder)): path.read_bytes() for path in files if path.name not in LOGS
    }


def lines(folder: Path, name: str) -> list[dict[str, Any]]:
    """Return the lines of a table."""
    return [json.loads(line) for line in (folder / name).read_text().splitlines()]


def rewrite(folder: Path, name: str, rows: Iterable[Mapping[str, Any]]) -> None:
    """Replace the lines of a table."""
    (folder / name).write_text("".join(json.dumps(row) + "\n" for row in rows))


def finished(config: StudyConfig, folder: Path) -> Path:
    """Return a folder with the finished study, which the first process that asks for it runs."""
    with locked(folder.with_name(f"{folder.name}.run"), "quick study", wait_s=600):
        if not folder.exists():
            part = folder.with_name(f"{folder.name}.part")
            run_study(part, config)
            part.rename(folder)
    return folder


def asked_about(study: Study) -> list[Episode]:
    """Return the episodes that answerers are asked about: every scene with one of its ordinary drives."""
    return choose_items(study.episodes, count=study.config.ordinary, seed=study.config.seed)


def as_made(study: Study, verdicts: Iterable[Verdict]) -> list[Verdict]:
    """Return made-up verdicts with the inputs and the scores that a run of the study would have given them."""
    tables = Tables.of(study)
    rule = tables.rule(study.config.people)
    episodes = {("ours", episode.scene_id): episode for episode in tables.episodes}
    episodes |= {("paper", one.scene_id): one for one in tables.whole}
    found = []
    for verdict in verdicts:
        item, name, protocol = verdict.scene_id, verdict.model, verdict.protocol
        made_from = rule.made_from(item, name, protocol, is_reference=verdict.kind == "reference")
        key = rule.keys.of(episodes[protocol, item], protocol)
        scored = rescored(verdict, key, GivenAnswers(name, answers_in(verdict), protocol=protocol))
        scored = rescore_verdict(scored, key.path, {}, "", key.visible)
        found.append(scored.model_copy(update={"kind": verdict.kind, "made_from": made_from}))
    return found
