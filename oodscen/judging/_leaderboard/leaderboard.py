"""The leaderboard: the scores of every model and reference, with n, intervals and tests."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from oodscen._arguments import checked
from oodscen._numbers import seed_number
from oodscen.data._episode import Episode, as_offered
from oodscen.data._pairing import is_ordinary
from oodscen.data._scenario import Scenario
from oodscen.data._verdict import NOTHING, Protocol, Verdict
from oodscen.judging._items import AnswerColumns, Floats, Items, Mask, Ratio
from oodscen.judging._leaderboard.board import Leaderboard
from oodscen.judging._leaderboard.comparisons import comparisons
from oodscen.judging._leaderboard.figures import FAULTS, PairColumns, figures, rate, resample_ratios
from oodscen.judging._leaderboard.gains import mean_of, with_gains
from oodscen.judging._leaderboard.scores import (
    ActionScore,
    ActionTally,
    Confusion,
    Detection,
    Estimate,
    Identification,
    LeaderboardRow,
    PairedScores,
    Rate,
    SceneGroup,
)
from oodscen.judging._shortcuts.audit import Audit
from oodscen.judging._shortcuts.rules import rule_calls, shortcut_verdicts
from oodscen.statistics._answers import above_chance, d_prime, intraclass
from oodscen.statistics._auroc import auroc_of_items
from oodscen.statistics._intervals import percentiles
from oodscen.statistics._resampling import Resampler


@dataclass(frozen=True, eq=False)
class _SharedValues:
    """The values that all rows of a leaderboard share."""

    items: Items
    resampler: Resampler
    groups: Sequence[tuple[SceneGroup, Mask]]
    shown: Mask
    """[n] the items whose hazard is visible under the paper's protocol."""


@checked
def leaderboard(
    verdicts: Iterable[Verdict],
    episodes: Iterable[Episode],
    scenarios: Iterable[Scenario],
    *,
    whole: Iterable[Episode] = (),
    audit: Audit | None = None,
    seed: int = 0,
) -> Leaderboard:
    """Return the leaderboard of some verdicts.

    Intervals resample whole paths (`oodscen.statistics._intervals.share_bounds`); comparisons are
    paired over common items and corrected by Holm within a task. An item without an answer counts as
    missing, never as wrong; `Rate.with_missing_wrong` gives the score with all of them counted as wrong. Open aspects
    scored by different judges are not compared.

    Args:
        verdicts: Verdicts of any models, on scenes and twins, including failed ones.
        episodes: Episodes of the scenes and twins, which give the safe actions.
        scenarios: The scenarios, which give the path of each scene.
        whole: Episodes of the paper's protocol, which tell whether its frames show the hazard.
        audit: The audit of these episodes, whose best shortcut is the one to beat; without one it is the best
            rule on the bodies that the simulator knows.
        seed: Seed of the resampling.
    """
    seed_number(seed)
    found = list(episodes)
    ran = [episode for episode in whole if episode.status == "ok"]
    seen = {episode.scene_id for episode in ran if episode.hazard_visible}
    items = Items.of(found, {one.id: one for one in scenarios})
    study = _SharedValues(
        items,
        Resampler(items.clusters, seed=seed),
        _groups(items),
        np.array([episode.scene_id in seen for episode in items.episodes], np.bool_),
    )
    grouped: dict[tuple[str, Protocol], list[Verdict]] = {}
    for verdict in verdicts:
        grouped.setdefault((verdict.model, verdict.protocol), []).append(verdict)
    sheets = {key: AnswerColumns.of(items, given) for key, given in grouped.items()}
    rows = [_standing(study, sheets[key], given) for key, given in grouped.items()]
    standings = with_gains(items, study.resampler, sorted(rows, key=_rank), sheets)
    calls = (audit.best_calls(found) if audit else None) or rule_calls(items)
    asked = {one.scene_id for given in grouped.values() for one in given}
    shortcut = [one for one in shortcut_verdicts(items, calls) if one.scene_id in asked]
    floor = None
    if shortcut:
        sheet = AnswerColumns.of(items, shortcut)
        floor = _standing(study, sheet, shortcut)
        sheets[floor.model, "ours"] = sheet
    real = [row for row in rows if row.is_judged] or rows
    likeness = [_likeness(items, sheets[row.model, row.protocol]) for row in real]
    scene = items.is_scene
    return Leaderboard(
        scenes=int(scene.sum()),
        ordinary=int((~scene).sum()),
        paths=len(set(items.clusters)),
        decidable=int(items.is_decidable.sum()),
        all_safe=int((scene & items.has_actions & (items.unsafe == 0)).sum()),
        none_safe=int((scene & items.has_actions & (items.safe == 0)).sum()),
        chance=items.chance_over(scene & items.has_actions),
        icc=max((value for value in likeness if value is not None), default=None),
        judge=_judge(grouped.values()),
        whole=len(ran),
        whole_shown=len(seen),
        actions=_tallies(items),
        standings=tuple(standings),
        shortcut=floor,
        comparisons=tuple(comparisons(items, seed, standings, floor, sheets)),
        seed=seed,
    )


def _rank(row: LeaderboardRow) -> tuple[bool, str, float, float, str]:
    return (
        row.kind == "reference",
        row.protocol,
        -(row.paired.act.with_missing_wrong or 0),
        -(row.control.safe.with_missing_wrong or 0),
        row.model,
    )


def _judge(grouped: Iterable[Sequence[Verdict]]) -> str:
    """Return the judge that scored most of the open aspects; empty for the matcher."""
    count = Counter(verdict.judge for found in grouped for verdict in found if verdict.judge)
    return count.most_common(1)[0][0] if count else ""


def _standing(
    study: _SharedValues, sheet: AnswerColumns, verdicts: Sequence[Verdict]
) -> LeaderboardRow:
    items, protocol = study.items, verdicts[0].protocol
    scene, twin = items.is_scene, ~items.is_scene
    columns = {
        **figures(items, sheet),
        "specificity": Ratio(1.0 - sheet.called, twin),
        "open_shown": Ratio(sheet.open, scene & study.shown & (protocol == "paper")),
        "collision_free": Ratio(sheet.success, scene),
        "decidable": Ratio(sheet.safe, items.is_decidable, is_neutral=sheet.is_neutral),
        "ordinary_safe": Ratio(sheet.safe, twin, is_neutral=sheet.is_neutral),
        "above_chance": Ratio(sheet.safe - items.chance, items.is_decidable, 1.0 - items.chance),
    }
    found = resample_ratios(study.resampler, list(columns.values()))
    replicates = dict(zip(columns, found.T, strict=True))
    rates = {
        name: rate(study.resampler, column, sheet, replicates[name], is_fault=name in FAULTS)
        for name, column in columns.items()
        if name != "above_chance"
    }
    return LeaderboardRow(
        model=verdicts[0].model,
        kind="reference" if any(v.kind == "reference" for v in verdicts) else "model",
        protocol=protocol,
        asked=len(verdicts),
        outcomes=dict(sorted(Counter(_outcome(v) for v in verdicts).items())),
        contradictions=sum(bool(v.contradiction) for v in verdicts),
        outdated=sum(v.is_outdated for v in verdicts),
        paired=_paired_scores(study, sheet, rates),
        detection=_detection(study, sheet, rates, replicates),
        identification=Identification(
            open=rates["name"],
            open_shown=rates["open_shown"],
            closed=rates["pick"],
            judged=sum(bool(v.judge) for v in verdicts),
            unjudged=sum(bool(v.judge_error) for v in verdicts),
        ),
        control=_control(study, sheet, rates, replicates["above_chance"]),
        actions=dict(
            Counter(
                v.action for v in verdicts if v.action and not is_ordinary(v.scene_id)
            ).most_common()
        ),
        groups=tuple(_group(study, sheet, group, mask) for group, mask in study.groups),
        confusions=_confusions(items, verdicts),
    )


def _paired_scores(
    study: _SharedValues, sheet: AnswerColumns, rates: Mapping[str, Rate]
) -> PairedScores:
    pairs = PairColumns.of(study.items, sheet)
    return PairedScores(
        notice=rates["notice-both"],
        act=rates["act-both"],
        act_by_kind={
            kind: rate(
                study.resampler,
                Ratio(pairs.act, pairs.mask & mask, is_neutral=pairs.is_neutral),
                sheet,
            )
            for kind, mask in pairs.kinds.items()
        },
        drop=mean_of(study.resampler, Ratio(pairs.drop, pairs.mask)),
    )


def _by_kind(
    study: _SharedValues, sheet: AnswerColumns, values: Floats, mask: Mask
) -> dict[str, Rate]:
    """Return a figure that counts faults, for every kind of ordinary drive."""
    kinds = np.array(study.items.kinds)
    return {
        kind: rate(study.resampler, Ratio(values, mask & (kinds == kind)), sheet, is_fault=True)
        for kind in sorted(set(study.items.kinds) - {"rare"})
    }


def _group(study: _SharedValues, sheet: AnswerColumns, group: SceneGroup, mask: Mask) -> SceneGroup:
    """Return a group with the scores of one answerer in its scenes."""
    columns = {
        "detected": Ratio(sheet.called, mask),
        "open": Ratio(sheet.open, mask),
        "closed": Ratio(sheet.closed, mask),
        "safe": Ratio(sheet.safe, mask, is_neutral=sheet.is_neutral),
    }
    rates = {name: rate(study.resampler, column, sheet) for name, column in columns.items()}
    return group.model_copy(update=rates)


def _outcome(verdict: Verdict) -> str:
    """Return how judging ended; verdicts of the first schema version tell only whether it failed."""
    if verdict.status == "failed" and verdict.outcome == "answered":
        return "error"
    return verdict.outcome


def _control(
    study: _SharedValues,
    sheet: AnswerColumns,
    rates: Mapping[str, Rate],
    replicates: NDArray[np.float64],
) -> ActionScore:
    """Return the figures of task 2; `replicates` are the [r] ones of `above_chance`."""
    items = study.items
    reach = items.is_decidable & np.isfinite(sheet.safe)
    chance, decidable = items.chance_over(reach), rates["decidable"]
    corrected = None
    if chance is not None and decidable.value is not None:
        corrected = above_chance(decidable.value, chance)
    return ActionScore(
        safe=rates["safe"],
        collision_free=rates["collision_free"],
        decidable=decidable,
        chance=chance,
        above_chance=Estimate(
            value=corrected,
            n=decidable.n,
            interval=percentiles(replicates, study.resampler.count(reach)),
        ),
        ordinary_safe=rates["ordinary_safe"],
        needless=rates["needless"],
        needless_by_kind=_by_kind(
            study, sheet, sheet.cautious, ~items.is_scene & items.keeping_is_safe
        ),
    )


def _detection(
    study: _SharedValues,
    sheet: AnswerColumns,
    rates: Mapping[str, Rate],
    replicates: Mapping[str, NDArray[np.float64]],
) -> Detection:
    """Return the figures of detection; `replicates` are [r] by the names of the rates."""
    items, resampler = study.items, study.resampler
    sensitivity, specificity = rates["notice"], rates["specificity"]
    balanced = discriminability = auroc = Estimate()
    if sensitivity.value is not None and specificity.value is not None:
        known = np.isfinite(sheet.called)
        n, units = sensitivity.n + specificity.n, resampler.count(known)
        both = (replicates["notice"] + replicates["specificity"]) / 2
        balanced = Estimate(
            value=(sensitivity.value + specificity.value) / 2,
            n=n,
            interval=percentiles(both, units),
        )
        called = np.where(known, sheet.called, 0.0)
        sides = (items.is_scene, ~items.is_scene)
        columns = [values * side for side in sides for values in (called, known)]
        counts = resampler.weights @ resampler.summed(np.stack(columns, axis=1))
        draws = np.array([d_prime(*row) for row in counts.tolist()], np.float64)
        alarms = specificity.n - specificity.hits
        discriminability = Estimate(
            value=d_prime(sensitivity.hits, sensitivity.n, alarms, specificity.n),
            n=n,
            interval=percentiles(draws, units),
        )
    if area := auroc_of_items(sheet.p_ood, items.is_scene, resampler):
        auroc = Estimate(value=area[0], n=int(np.isfinite(sheet.p_ood).sum()), interval=area[1])
    return Detection(
        sensitivity=sensitivity,
        specificity=specificity,
        alarms=rates["alarms"],
        alarms_by_kind=_by_kind(study, sheet, sheet.called, ~items.is_scene),
        balanced_accuracy=balanced,
        with_missing_wrong=_worst_balanced(study, sheet, sensitivity, specificity),
        auroc=auroc,
        d_prime=discriminability,
        stated=int(sheet.stated.sum()),
    )


def _worst_balanced(
    study: _SharedValues, sheet: AnswerColumns, sensitivity: Rate, specificity: Rate
) -> Estimate:
    """Return the balanced accuracy with every missing answer counted as wrong."""
    if sensitivity.with_missing_wrong is None or specificity.with_missing_wrong is None:
        return Estimate()
    items, resampler = study.items, study.resampler
    right = np.nan_to_num(sheet.right("detection", items), nan=0.0)
    columns = [
        Ratio(right, sheet.was_asked & items.is_scene),
        Ratio(right, sheet.was_asked & ~items.is_scene),
    ]
    replicates = resample_ratios(resampler, columns).mean(axis=1)
    return Estimate(
        value=(sensitivity.with_missing_wrong + specificity.with_missing_wrong) / 2,
        n=int(sheet.was_asked.sum()),
        interval=percentiles(replicates, resampler.count(sheet.was_asked)),
    )


def _groups(items: Items) -> list[tuple[SceneGroup, Mask]]:
    """Return every class, family and path with its scenes, in order of appearance."""
    found = []
    for level, labels in items.levels.items():
        for name in dict.fromkeys(label for label in labels if label):
            mask = np.array([label == name for label in labels]) & items.is_scene
            if mask.any():
                at = int(np.flatnonzero(mask)[0])
                group = SceneGroup(
                    level=level,
                    name=name,
                    parent=items.parent(level, at),
                    scenes=int(mask.sum()),
                    chance=items.chance_over(mask & items.has_actions),
                )
                found.append((group, mask))
    return found


def _confusions(items: Items, verdicts: Sequence[Verdict]) -> tuple[Confusion, ...]:
    pairs = Counter(
        (items.leaf_of(v.scene_id), v.choice or NOTHING)
        for v in verdicts
        if v.choice_is_right is False and not is_ordinary(v.scene_id)
    )
    ordered = sorted(pairs.items(), key=lambda item: (-item[1], item[0]))
    return tuple(Confusion(truth=t, chosen=c, count=count) for (t, c), count in ordered)


def _tallies(items: Items) -> tuple[ActionTally, ...]:
    rows: dict[str, Counter[str]] = {}
    for episode in items.episodes:
        if episode.is_ordinary:
            continue
        for action, outcome in episode.actions.items():
            rows.setdefault(action, Counter())[outcome.label] += 1
    return tuple(ActionTally(action=action, **dict(rows[action])) for action in as_offered(rows))


def _likeness(items: Items, sheet: AnswerColumns) -> float | None:
    there = items.is_scene & np.isfinite(sheet.safe)
    labels = [label for label, keep in zip(items.clusters, there, strict=True) if keep]
    return intraclass(sheet.safe[there], labels)
