"""Scores of open answers, by a judge model or the matcher."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from oodscen._parallel.threads import as_finished
from oodscen._pipeline.context import Context
from oodscen.data._pairing import scene_of
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene, Visible
from oodscen.data._verdict import Verdict
from oodscen.judging._aspects.labelled import agreement, labelled_answers
from oodscen.judging._aspects.opinions import (
    Opinion,
    ask_opinion,
    is_open,
    judge_label,
    opinion_id,
    rescore_verdict,
)
from oodscen.llm._circuit_breaker import CircuitBreakerLLM
from oodscen.llm._remote.rate_limit import JUDGING
from oodscen.protocols import LLM
from oodscen.study._stale_verdicts import OPINIONS

Question = tuple[str, tuple[str, ...], tuple[Visible, ...]]
"""An open answer, the path of the scene and everything that can be seen of its hazard."""


def judge_aspects(
    run: Context,
    verdicts: Sequence[Verdict],
    scenarios: Sequence[Scenario],
    scenes: Sequence[Scene],
) -> list[Verdict]:
    """Score every open aspect with the judge, or with the matcher if there is no judge."""
    paths = {scenario.id: scenario.path for scenario in scenarios}
    visibles = {scene.id: scene.visible for scene in scenes}

    def truth(verdict: Verdict) -> tuple[tuple[str, ...], tuple[Visible, ...]]:
        scene = scene_of(verdict.scene_id)
        return paths.get(scene, ()), visibles.get(scene, ())

    label = ""
    opinions: dict[str, Opinion] = {}
    if run.config.judge:
        judge = CircuitBreakerLLM(run.models.get(run.config.judge))
        label = judge_label(judge)
        questions = [(verdict.aspect, *truth(verdict)) for verdict in verdicts if is_open(verdict)]
        questions += [(example.answer, example.path, ()) for example in labelled_answers()]
        opinions = _opinions(run, judge, questions, run.models.threads(run.config.judge))
    scored = []
    for verdict in verdicts:
        path, visible = truth(verdict)
        scored.append(rescore_verdict(verdict, path, opinions, label, visible))
    return scored


def _opinions(
    run: Context, judge: LLM, questions: Sequence[Question], threads: int
) -> dict[str, Opinion]:
    """Return the judge's opinions by id; it is asked for those that the study does not hold."""
    label = judge_label(judge)

    def work(todo: Mapping[str, Question]) -> Iterator[Opinion]:
        with run.models.limits.lenient(JUDGING):
            for _, opinion in as_finished(
                lambda question: ask_opinion(judge, *question),
                todo.values(),
                threads=threads,
                cancel=run.cancel,
            ):
                yield opinion

    items = {opinion_id(label, *question): question for question in questions}
    others = _of_other_judges(run, label, questions)
    rows = run.each("judge", OPINIONS, items, work, others=others)
    return {row["id"]: Opinion.parse(row) for row in rows}


def _of_other_judges(
    run: Context, label: str, questions: Iterable[Question]
) -> list[dict[str, Any]]:
    """Return the lines of other judges about these questions, which they need not be asked again."""
    lines = [line for line in run.store.lines(OPINIONS) if line["judge"] != label]
    judges = {line["judge"] for line in lines}
    current = {opinion_id(judge, *question) for question in questions for judge in judges}
    return sorted(
        (line for line in lines if line["id"] in current),
        key=lambda line: (line["judge"], line["id"]),
    )


def unjudged(verdicts: Iterable[Verdict]) -> int:
    """Return the number of open aspects about which the judge gave no usable answer."""
    return sum(bool(verdict.judge_error) for verdict in verdicts)


def judged(
    verdicts: Sequence[Verdict], opinions: Iterable[Mapping[str, Any]] = ()
) -> dict[str, dict[str, int]]:
    """Count the open aspects scored by a judge model, and those left to the matcher after it failed.

    `labelled` counts the labelled answers that the judge was measured by, `agrees` those on which it agrees
    with the person who labelled them.

    Args:
        verdicts: The verdicts of a study.
        opinions: The lines of `opinions.jsonl`.
    """
    counts = {
        "judged": sum(bool(verdict.judge) for verdict in verdicts),
        "matched": unjudged(verdicts),
    }
    label = next((verdict.judge for verdict in verdicts if verdict.judge), "")
    if label:
        parsed = [Opinion.parse(line) for line in opinions]
        counts["agrees"], counts["labelled"] = agreement(parsed, label)
    return {"judged": counts} if any(counts.values()) else {}
