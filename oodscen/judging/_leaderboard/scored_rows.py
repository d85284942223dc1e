"""The row of one answerer in a leaderboard."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from oodscen.data._pairing import is_ordinary
from oodscen.data._verdict import NOTHING, Protocol, Verdict
from oodscen.judging._items import AnswerColumns, Floats, Items, Mask, Ratio
from oodscen.judging._leaderboard.figures import FAULTS, PairColumns, figures, rate, resample_ratios
from oodscen.judging._leaderboard.gains import mean_of
from oodscen.judging._leaderboard.rows import (
    ActionScore,
    Confusion,
    Detection,
    Estimate,
    Identification,
    LeaderboardRow,
    PairedScores,
    Rate,
    SceneGroup,
)
from oodscen.statistics._answers import above_chance, d_prime
from oodscen.statistics._auroc import auroc_of_items
from oodscen.statistics._intervals import cluster_interval
from oodscen.statistics._resampling import Resampler


@dataclass(frozen=True, eq=False)
class SharedValues:
    """The values that all rows of a leaderboard share."""

    items: Items
    resampler: Resampler
    groups: Sequence[tuple[SceneGroup, Mask]]
    shown: Mask
    """[n] the items whose hazard is visible under the paper's protocol."""


def standing(
    study: SharedValues, sheet: AnswerColumns, verdicts: Sequence[Verdict]
) -> LeaderboardRow:
    """Return the row of the answerer that gave some verdicts, of which there is at least one."""
    protocol = verdicts[0].protocol
    scores = _Scores.of(study, sheet, protocol)
    rare = [verdict for verdict in verdicts if not is_ordinary(verdict.scene_id)]
    return LeaderboardRow(
        model=verdicts[0].model,
        kind=verdicts[0].kind,
        protocol=protocol,
        asked=len(verdicts),
        outcomes=dict(sorted(Counter(map(outcome_of, verdicts)).items())),
        contradictions=sum(bool(verdict.contradiction) for verdict in verdicts),
        outdated=sum(verdict.is_outdated for verdict in verdicts),
        paired=scores.paired(),
        detection=scores.detection(),
        identification=Identification(
            open=scores.rates["name"],
            open_shown=scores.rates["open_shown"],
            closed=scores.rates["pick"],
            judged=sum(bool(verdict.judge) for verdict in verdicts),
            unjudged=sum(bool(verdict.judge_error) for verdict in verdicts),
        ),
        control=scores.control(),
        actions=dict(Counter(verdict.action for verdict in rare if verdict.action).most_common()),
        groups=tuple(scores.group(group, mask) for group, mask in study.groups),
        confusions=_confusions(study.items, rare),
    )


def outcome_of(verdict: Verdict) -> str:
    """Return how judging ended; verdicts of the first schema version tell only whether it failed."""
    if verdict.status == "failed" and verdict.outcome == "answered":
        return "error"
    return verdict.outcome


def _confusions(items: Items, verdicts: Sequence[Verdict]) -> tuple[Confusion, ...]:
    """Return the wrong choices with their numbers, most frequent first."""
    pairs = Counter(
        (items.leaf_of(verdict.scene_id), verdict.choice or NOTHING)
        for verdict in verdicts
        if verdict.choice_is_right is False
    )
    ordered = sorted(pairs.items(), key=lambda item: (-item[1], item[0]))
    return tuple(
        Confusion(truth=truth, chosen=chosen, count=count) for (truth, chosen), count in ordered
    )


@dataclass(frozen=True, eq=False)
class _Scores:
    """The rates of one answerer by name, and their [r] replicates over resampled paths."""

    study: SharedValues
    sheet: AnswerColumns
    rates: Mapping[str, Rate]
    replicates: Mapping[str, Floats]

    @classmethod
    def of(cls, study: SharedValues, sheet: AnswerColumns, protocol: Protocol) -> Self:
        """Return the scores of the answers in a sheet."""
        items, scene, ordinary = study.items, study.items.is_scene, ~study.items.is_scene
        columns = {
            **figures(items, sheet),
            "specificity": Ratio(1.0 - sheet.called, ordinary),
            "open_shown": Ratio(sheet.open, scene & study.shown & (protocol == "paper")),
            "collision_free": Ratio(sheet.success, scene),
            "decidable": Ratio(sheet.safe, items.is_decidable, is_neutral=sheet.is_neutral),
            "ordinary_safe": Ratio(sheet.safe, ordinary, is_neutral=sheet.is_neutral),
            "above_chance": Ratio(
                sheet.safe - items.chance, items.is_decidable, 1.0 - items.chance
            ),
        }
        ratios = resample_ratios(study.resampler, list(columns.values()))
        replicates = dict(zip(columns, ratios.T, strict=True))
        rates = {
            name: rate(study.resampler, column, sheet, replicates[name], is_fault=name in FAULTS)
            for name, column in columns.items()
            if name != "above_chance"
        }
        return cls(study, sheet, rates, replicates)

    def _rate(self, column: Ratio, *, is_fault: bool = False) -> Rate:
        return rate(self.study.resampler, column, self.sheet, is_fault=is_fault)

    def _estimate(self, value: float | None, n: int, replicates: Floats, counted: Mask) -> Estimate:
        """Return a value with its interval over the paths of the items that count."""
        units = self.study.resampler.count(counted)
        return Estimate(value=value, n=n, interval=cluster_interval(replicates, units))

    def _faults_by_kind(self, values: Floats, mask: Mask) -> dict[str, Rate]:
        """Return a figure that counts faults, for every kind of ordinary drive."""
        kinds = np.array(self.study.items.kinds)
        return {
            kind: self._rate(Ratio(values, mask & (kinds == kind)), is_fault=True)
            for kind in sorted(set(self.study.items.kinds) - {"rare"})
        }

    def group(self, group: SceneGroup, mask: Mask) -> SceneGroup:
        """Return a group with the scores in its scenes."""
        sheet = self.sheet
        columns = {
            "detected": Ratio(sheet.called, mask),
            "open": Ratio(sheet.open, mask),
            "closed": Ratio(sheet.closed, mask),
            "safe": Ratio(sheet.safe, mask, is_neutral=sheet.is_neutral),
        }
        rates = {name: self._rate(column) for name, column in columns.items()}
        return group.model_copy(update=rates)

    def paired(self) -> PairedScores:
        """Return the scores over scenes together with their ordinary drives."""
        items = self.study.items
        by_kind = {
            kind: PairColumns.of(items, self.sheet, kind)
            for kind in sorted(set(items.kinds) - {"rare"})
        }
        pairs = PairColumns.of(items, self.sheet)
        return PairedScores(
            notice=self.rates["notice-both"],
            act=self.rates["act-both"],
            act_by_kind={
                kind: self._rate(Ratio(columns.act, columns.mask, is_neutral=columns.is_neutral))
                for kind, columns in by_kind.items()
                if columns.mask.any()
            },
            drop=mean_of(self.study.resampler, Ratio(pairs.drop, pairs.mask)),
        )

    def control(self) -> ActionScore:
        """Return the figures of task 2."""
        items, sheet, rates = self.study.items, self.sheet, self.rates
        scored = items.is_decidable & np.isfinite(sheet.safe)
        chance, decidable = items.chance_over(scored), rates["decidable"]
        corrected = None
        if chance is not None and decidable.value is not None:
            corrected = above_chance(decidable.value, chance)
        replicates = self.replicates["above_chance"]
        return ActionScore(
            safe=rates["safe"],
            collision_free=rates["collision_free"],
            decidable=decidable,
            chance=chance,
            above_chance=self._estimate(corrected, decidable.n, replicates, scored),
            ordinary_safe=rates["ordinary_safe"],
            needless=rates["needless"],
            needless_by_kind=self._faults_by_kind(
                sheet.cautious, ~items.is_scene & items.keeping_is_safe
            ),
        )

    def detection(self) -> Detection:
        """Return the figures of detection."""
        sheet, is_scene = self.sheet, self.study.items.is_scene
        auroc = Estimate()
        if area := auroc_of_items(sheet.p_ood, is_scene, self.study.resampler):
            auroc = Estimate(value=area[0], n=int(np.isfinite(sheet.p_ood).sum()), interval=area[1])
        return Detection(
            sensitivity=self.rates["notice"],
            specificity=self.rates["specificity"],
            alarms=self.rates["alarms"],
            alarms_by_kind=self._faults_by_kind(sheet.called, ~is_scene),
            balanced_accuracy=self._balanced(),
            with_missing_wrong=self._worst_balanced(),
            auroc=auroc,
            d_prime=self._discriminability(),
            stated=int(sheet.stated.sum()),
        )

    def _balanced(self) -> Estimate:
        """Return the balanced accuracy over the answers."""
        noticed, quiet = self.rates["notice"], self.rates["specificity"]
        if noticed.value is None or quiet.value is None:
            return Estimate()
        value, n = (noticed.value + quiet.value) / 2, noticed.n + quiet.n
        replicates = (self.replicates["notice"] + self.replicates["specificity"]) / 2
        return self._estimate(value, n, replicates, np.isfinite(self.sheet.called))

    def _worst_balanced(self) -> Estimate:
        """Return the balanced accuracy with every missing answer counted as wrong."""
        noticed = self.rates["notice"].with_missing_wrong
        quiet = self.rates["specificity"].with_missing_wrong
        if noticed is None or quiet is None:
            return Estimate()
        items, sheet = self.study.items, self.sheet
        right = np.nan_to_num(sheet.right("detection", items), nan=0.0)
        sides = (items.is_scene, ~items.is_scene)
        columns = [Ratio(right, sheet.was_asked & side) for side in sides]
        replicates = resample_ratios(self.study.resampler, columns).mean(axis=1)
        n = int(sheet.was_asked.sum())
        return self._estimate((noticed + quiet) / 2, n, replicates, sheet.was_asked)

    def _discriminability(self) -> Estimate:
        """Return d' over the answers."""
        noticed, quiet = self.rates["notice"], self.rates["specificity"]
        if not noticed.n or not quiet.n:
            return Estimate()
        resampler, is_scene = self.study.resampler, self.study.items.is_scene
        answered = np.isfinite(self.sheet.called)
        called = np.where(answered, self.sheet.called, 0.0)
        columns = [values * side for side in (is_scene, ~is_scene) for values in (called, answered)]
        counts = resampler.weights @ resampler.summed(np.stack(columns, axis=1))
        # Rows as bytes are sorted several times faster than along an axis.
        rows = np.ascontiguousarray(counts).view(np.dtype((np.void, counts[:1].nbytes))).ravel()
        _, first, row_of = np.unique(rows, return_index=True, return_inverse=True)
        values = np.array([d_prime(*row) for row in counts[first].tolist()], np.float64)
        value = d_prime(noticed.hits, noticed.n, quiet.n - quiet.hits, quiet.n)
        return self._estimate(value, noticed.n + quiet.n, values[row_of], answered)
