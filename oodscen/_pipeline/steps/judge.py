"""The stage that judges models."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any, NamedTuple

from oodscen._entry_points import is_asked
from oodscen._io.study_files import AUDIT
from oodscen._parallel.threads import as_finished
from oodscen._pipeline.context import Context
from oodscen._pipeline.steps.aspects import judge_aspects
from oodscen._pipeline.steps.questioner import Item, Questioner
from oodscen._pipeline.steps.scenes import simulate_behind, simulate_whole
from oodscen.data._base import canonical_json
from oodscen.data._episode import Episode
from oodscen.data._pairing import demand_id, twin_id
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.data._verdict import (
    Protocol,
    Verdict,
    is_without_pictures,
    verdict_id,
    without_pictures,
)
from oodscen.errors import DataError
from oodscen.judging._leaderboard.leaderboard import leaderboard
from oodscen.judging._people import PersonAnswers, person
from oodscen.judging._references import (
    NAMED,
    Blind,
    NoveltyReference,
    Oracle,
    is_reference,
    takes_cases,
)
from oodscen.judging._shortcuts.audit import Audit
from oodscen.llm._circuit_breaker import CircuitBreakerLLM
from oodscen.llm._remote.rate_limit import JUDGING
from oodscen.prompts._judging.name_aspect import NameAspect
from oodscen.prompts._versions import prompt_versions
from oodscen.protocols import LLM
from oodscen.study._judged import Judged
from oodscen.study._stale_verdicts import VerdictRule

_VERDICTS = "verdicts.jsonl"


class Answerer(NamedTuple):
    """A model, a person or a reference that is judged."""

    model: LLM
    threads: int = 1
    """Number of questions that it may be asked at once."""


def evaluate(
    run: Context,
    episodes: Sequence[Episode],
    scenarios: Sequence[Scenario],
    scenes: Sequence[Scene],
) -> list[Verdict]:
    """Judge the reference answerers and every named model on scenes and ordinary drives.

    Scenes whose hazard cannot be named at the decision are left out together with their ordinary drives.

    Writes `verdicts.jsonl` and, from it, `leaderboard.json`. What follows from the answers in earlier verdicts is
    computed again, and references and people are asked again. At the end a judge model scores the open aspects
    of all verdicts, including those of earlier runs and of references; `opinions.jsonl` holds its answers.

    A model that is given up costs its own items only (`unasked`). New items of all models come first, then
    items left by a model that was given up, and last items that failed before; these keep their old verdict
    if they are not asked again, or if fewer of their questions are answered.
    """
    episodes, asked, scenes = Judged.of(episodes, scenes, run.config)
    answerers = _answerers(run, episodes, scenarios, scenes)
    shown: dict[Protocol, Sequence[Episode]] = {"ours": asked}
    if "paper" in run.config.protocols:
        shown["paper"] = simulate_whole(run, scenes)
    items = _items(run, answerers, shown)
    behind = simulate_behind(run, asked) if run.config.rear_view else {}
    people = [
        answerer.model
        for answerer in answerers.values()
        if isinstance(answerer.model, PersonAnswers)
    ]
    rule = VerdictRule(shown, scenarios, scenes, run.config, people)
    questioner = Questioner(run, rule.keys, episodes, behind)

    def made_from(key: str) -> str:
        item = items[key]
        return rule.made_from(
            item.episode.scene_id,
            item.model.name,
            item.protocol,
            is_reference=is_reference(item.model),
        )

    def is_whole(line: Mapping[str, Any]) -> bool:
        item = items[line["id"]]
        identity = {"scene_id": item.episode.scene_id, "protocol": item.protocol}
        return rule.is_possible(Verdict.parse({**line, **identity}))

    earlier = run.fitting(_VERDICTS, items, made_from, is_whole)
    _count_kept(run, answerers, items, earlier)

    def work(todo: Mapping[str, Item]) -> Iterator[Verdict]:
        return _ask(run, questioner, answerers, todo, earlier)

    rows = run.each("evaluate", _VERDICTS, items, work, made_from=made_from, is_whole=is_whole)
    stored = [Verdict.parse(row) for row in rows]
    rescored = [questioner.rescored(verdict, items[verdict.id]) for verdict in stored]
    scored = judge_aspects(run, rescored, scenarios, scenes)
    verdicts = [_mark_outdated(verdict) for verdict in scored]
    if verdicts != stored:
        run.store.write_lines(_VERDICTS, verdicts)
    board = leaderboard(
        verdicts,
        episodes,
        scenarios,
        whole=shown.get("paper", ()),
        audit=Audit.load(run.store.path(AUDIT)) if run.store.has(AUDIT) else None,
        seed=run.config.seed,
    )
    run.store.write("leaderboard.json", canonical_json(board.model_dump(mode="json")) + "\n")
    return verdicts


def _ask(
    run: Context,
    questioner: Questioner,
    answerers: Mapping[str, Answerer],
    todo: Mapping[str, Item],
    earlier: Mapping[str, Mapping[str, Any]],
) -> Iterator[Verdict]:
    """Yield the verdicts on items; one in the `earlier` lines keeps its verdict unless the new one tells as much."""
    for turn in ("new", "unasked", "failed"):
        items = [item for key, item in todo.items() if _turn(earlier.get(key)) == turn]
        with run.models.limits.lenient(math.inf if turn == "failed" else JUDGING):
            for name, answerer in answerers.items():
                batch = [item for item in items if item.answerer == name]
                for _, verdict in as_finished(
                    questioner.verdict, batch, threads=answerer.threads, cancel=run.cancel
                ):
                    line = earlier.get(verdict.id)
                    before = None if line is None else Verdict.parse(line)
                    yield verdict if before is None or not _is_less(verdict, before) else before


def _is_less(verdict: Verdict, before: Verdict) -> bool:
    """Return whether a failed verdict tells less about a model than the one before."""
    if verdict.status != "failed":
        return False
    if verdict.outcome == "unasked" and before.outcome != "unasked":
        return True
    return _answered(verdict) < _answered(before)


def _answered(verdict: Verdict) -> int:
    """Return the number of questions that got a usable answer."""
    return sum(answer is not None for answer in (verdict.is_ood, verdict.choice, verdict.action))


def _count_kept(
    run: Context,
    answerers: Mapping[str, Answerer],
    items: Mapping[str, Item],
    earlier: Mapping[str, Mapping[str, Any]],
) -> None:
    """Note in the run's ledger how many verdicts of every model that is asked are kept."""
    counts = Counter(items[key].answerer for key, line in earlier.items() if not run.is_again(line))
    for name in filter(is_asked, run.config.vlms):
        run.options.ledger.kept_verdicts[name] = answerers[name].model.name, counts[name]


def _items(
    run: Context, answerers: Mapping[str, Answerer], shown: Mapping[Protocol, Sequence[Episode]]
) -> dict[str, Item]:
    """Return what every answerer is asked about, by the id of the verdict."""
    items: dict[str, Item] = {}
    for protocol, episodes in shown.items():
        for name, (model, _) in answerers.items():
            if protocol not in _protocols(run, name, model):
                continue
            is_withheld = name not in run.config.vlms and is_without_pictures(name)
            row = without_pictures(model.name) if is_withheld else model.name
            for episode in episodes:
                if isinstance(model, PersonAnswers) and episode.scene_id not in model.items:
                    continue
                if not is_reference(model) or (episode.status == "ok" and episode.frames):
                    key = verdict_id(episode.scene_id, row, protocol)
                    items[key] = Item(episode, name, model, protocol, is_withheld)
    return items


def _turn(line: Mapping[str, Any] | None) -> str:
    """Return the turn in which an item is asked: new, left unasked, or failed."""
    if line is None:
        return "new"
    return "unasked" if line.get("outcome") == "unasked" else "failed"


def _answerers(
    run: Context,
    episodes: Sequence[Episode],
    scenarios: Sequence[Scenario],
    scenes: Sequence[Scene],
) -> dict[str, Answerer]:
    """Return everything that is judged, by the name by which the study asks it."""
    leaves = {
        scenario.id: (scenario.leaf, scenario.path[-1] if scenario.path else "")
        for scenario in scenarios
    }
    pictures = {}
    for episode in episodes:
        if episode.status == "ok" and "last" in episode.frames:
            with suppress(DataError):
                pictures[episode.scene_id] = run.store.inside(episode.frames["last"])
    maps = {
        drive_id: scene.map
        for scene in scenes
        for drive_id in (scene.id, twin_id(scene.id), demand_id(scene.id))
    }
    answerers = {name: Answerer(run.models.get(name)) for name in NAMED}
    for reference in (Blind(episodes, leaves), NoveltyReference(pictures, maps), Oracle()):
        answerers[reference.name] = Answerer(reference)
    for name in run.config.vlms:
        model = run.models.get(name)
        if is_reference(model):
            answerers[name] = Answerer(model)
        else:
            answerers[name] = Answerer(CircuitBreakerLLM(model), run.models.limits.concurrency)
    for name in run.config.withheld:
        if name in answerers and not takes_cases(answerers[name].model):
            answerers[without_pictures(name)] = answerers[name]
    for name in run.config.people:
        answerers[person(name)] = Answerer(PersonAnswers.load(run.store, name, episodes))
    return answerers


def _protocols(run: Context, name: str, model: LLM) -> tuple[Protocol, ...]:
    """Return the protocols that an answerer is judged by.

    References of every study are judged by all, also where one is named as a model; people and models without
    pictures by ours.
    """
    if isinstance(model, PersonAnswers):
        return ("ours",)
    if name in run.config.vlms and name not in NAMED:
        return run.config.protocols_of(name)
    return ("ours",) if is_without_pictures(name) else ("ours", "paper")


def _mark_outdated(verdict: Verdict) -> Verdict:
    """Mark a verdict whose answers belong to other versions of the prompts than this run's."""
    is_outdated = not verdict.prompts.items() <= prompt_versions().items()
    is_outdated |= verdict.protocol == "paper" and NameAspect.purpose in verdict.prompts
    if verdict.is_outdated is is_outdated:
        return verdict
    return verdict.model_copy(update={"is_outdated": is_outdated})


def outcomes(verdicts: Sequence[Verdict]) -> dict[str, dict[str, int]]:
    """Count the outcomes by model; `outdated` counts answers to other versions of the prompts."""
    counts: dict[str, Counter[str]] = {}
    for verdict in verdicts:
        if verdict.kind == "model":
            count = counts.setdefault(verdict.model, Counter())
            count[verdict.outcome] += 1
            count["outdated"] += verdict.is_outdated
    return {name: dict(sorted((+count).items())) for name, count in counts.items()}
