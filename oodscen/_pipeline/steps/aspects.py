"""Scores of open answers, by a judge model or the matcher."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from oodscen._concurrency import as_finished
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
from oodscen.study._stale_verdicts import OPINIONS


def judge_aspects(
    run: Context,
    verdicts: Sequence[Verdict],
    scenarios: Sequence[Scenario],
    scenes: Sequence[Scene],
) -> list[Verdict]:
    """Score every open aspect with the judge, or with the matcher if there is no judge."""
    paths = {scenario.id: scenario.path for scenario in scenarios}
    shown = {scene.id: scene.visible for scene in scenes}

    def truth(verdict: Verdict) -> tuple[tuple[str, ...], tuple[Visible, ...]]:
        scene = scene_of(verdict.scene_id)
        return paths.get(scene, ()), shown.get(scene, ())

    label, opinions = "", dict[str, Opinion]()
    if run.config.judge:
        judge = CircuitBreakerLLM(run.models.get(run.config.judge))
        label = judge_label(judge)
        asked = [(one.aspect, *truth(one)) for one in verdicts if is_open(one)]
        asked += [(example.answer, example.path, ()) for example in labelled_answers()]
        items = {opinion_id(label, *one): one for one in asked}

        def work(
            todo: Mapping[str, tuple[str, tuple[str, ...], tuple[Visible, ...]]],
        ) -> Iterator[Opinion]:
            threads = run.models.threads(run.config.judge or "")
            limits = run.models.limits
            with limits.lenient(JUDGING):
                for _, found in as_finished(
                    lambda item: ask_opinion(judge, *item),
                    todo.values(),
                    threads=threads,
                    cancel=run.cancel,
                ):
                    yield found

        others = _of_others(run, label, asked)
        rows = run.each("judge", OPINIONS, items, work, others=others)
        opinions = {row["id"]: Opinion.parse(row) for row in rows}
    rescore = [(verdict, *truth(verdict)) for verdict in verdicts]
    return [rescore_verdict(one, path, opinions, label, visible) for one, path, visible in rescore]


def _of_others(
    run: Context, label: str, asked: Iterable[tuple[str, tuple[str, ...], tuple[Visible, ...]]]
) -> list[dict[str, Any]]:
    """Return the lines of other judges about what is asked, which they need not be asked again."""
    lines = [line for line in run.store.lines(OPINIONS) if line.get("judge") != label]
    labels = {str(line.get("judge")) for line in lines}
    known = {opinion_id(other, *one) for one in asked for other in labels}
    return sorted(
        (line for line in lines if line["id"] in known), key=lambda one: (one["judge"], one["id"])
    )


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
        "matched": sum(bool(verdict.judge_error) for verdict in verdicts),
    }
    label = next((verdict.judge for verdict in verdicts if verdict.judge), "")
    if label:
        parsed = [Opinion.parse(line) for line in opinions]
        counts["agrees"], counts["labelled"] = agreement(parsed, label)
    return {"judged": counts} if any(counts.values()) else {}
