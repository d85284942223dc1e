"""The leaderboard: the scores of every model and reference, with n, intervals and tests."""

from collections import Counter
from collections.abc import Iterable, Sequence

import numpy as np

from oodscen._arguments import checked
from oodscen._numbers import seed_number
from oodscen.data._episode import Episode, as_offered
from oodscen.data._scenario import Scenario
from oodscen.data._verdict import Protocol, Verdict
from oodscen.judging._items import AnswerColumns, Items, Mask, judged_episodes, last_by
from oodscen.judging._leaderboard.board import Leaderboard
from oodscen.judging._leaderboard.comparisons import comparisons
from oodscen.judging._leaderboard.gains import with_gains
from oodscen.judging._leaderboard.rows import ActionTally, LeaderboardRow, SceneGroup
from oodscen.judging._leaderboard.scored_rows import SharedValues, standing
from oodscen.judging._shortcuts.audit import Audit
from oodscen.judging._shortcuts.rules import rule_calls, shortcut_verdicts
from oodscen.statistics._answers import intraclass
from oodscen.statistics._resampling import Resampler


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

    Intervals resample whole paths (`oodscen.statistics._intervals.share_interval`); comparisons are
    paired over common items and corrected by Holm within a task. An item without an answer counts as
    missing, never as wrong; `Rate.with_missing_wrong` gives the score with all of them counted as wrong. Open aspects
    scored by different judges are not compared.

    Args:
        verdicts: Verdicts of any models, on scenes and twins, including failed ones. The last verdict of a model on an
            item replaces earlier ones.
        episodes: Episodes of the scenes and twins, which give the safe actions; the last one of an item counts.
        scenarios: The scenarios, which give the path of each scene.
        whole: Episodes of the paper's protocol, which tell whether its frames show the hazard.
        audit: The audit of these episodes, whose best shortcut is the one to beat; without one it is the best
            rule on the bodies that the simulator knows.
        seed: Seed of the resampling.
    """
    seed_number(seed)
    episodes = judged_episodes(episodes)
    items = Items.of(episodes, {scenario.id: scenario for scenario in scenarios})
    whole_ran = [
        episode
        for episode in last_by(whole, lambda episode: episode.scene_id)
        if episode.status == "ok"
    ]
    seen = {episode.scene_id for episode in whole_ran if episode.hazard_visible}
    study = SharedValues(
        items,
        Resampler(items.clusters, seed=seed),
        _groups(items),
        np.array([episode.scene_id in seen for episode in items.episodes], np.bool_),
    )
    grouped: dict[tuple[str, Protocol], list[Verdict]] = {}
    for verdict in last_by(verdicts, lambda row: (row.model, row.protocol, row.scene_id)):
        grouped.setdefault((verdict.model, verdict.protocol), []).append(verdict)
    sheets = {key: AnswerColumns.of(items, group) for key, group in grouped.items()}
    rows = [standing(study, sheets[key], group) for key, group in grouped.items()]
    standings = with_gains(items, study.resampler, sorted(rows, key=_rank), sheets)
    calls = (audit.best_calls(episodes) if audit else None) or rule_calls(items)
    asked = {verdict.scene_id for group in grouped.values() for verdict in group}
    calls_asked = [call for call in shortcut_verdicts(items, calls) if call.scene_id in asked]
    shortcut = None
    if calls_asked:
        sheet = AnswerColumns.of(items, calls_asked)
        shortcut = standing(study, sheet, calls_asked)
        sheets[shortcut.model, "ours"] = sheet
    judged = [row for row in rows if row.is_judged]
    scene, acted = items.is_scene, items.is_scene & items.has_actions
    return Leaderboard(
        scenes=int(scene.sum()),
        ordinary=int((~scene).sum()),
        paths=len({path for path, rare in zip(items.clusters, scene, strict=True) if rare}),
        decidable=int(items.is_decidable.sum()),
        all_safe=int((acted & (items.unsafe == 0)).sum()),
        none_safe=int((acted & (items.safe == 0)).sum()),
        chance=items.chance_over(acted),
        icc=_icc(items, [sheets[row.model, row.protocol] for row in judged or rows]),
        judge=_judge(grouped.values()),
        whole=len(whole_ran),
        whole_shown=len(seen),
        actions=_tallies(items),
        standings=tuple(standings),
        shortcut=shortcut,
        comparisons=tuple(comparisons(items, seed, standings, shortcut, sheets)),
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
    judges = Counter(verdict.judge for verdicts in grouped for verdict in verdicts if verdict.judge)
    return max(judges, key=judges.__getitem__, default="")


def _groups(items: Items) -> list[tuple[SceneGroup, Mask]]:
    """Return every class, family and path with its scenes, in order of appearance."""
    groups = []
    for level, labels in items.levels.items():
        for name in dict.fromkeys(filter(None, labels)):
            mask = np.array([label == name for label in labels]) & items.is_scene
            if not mask.any():
                continue
            group = SceneGroup(
                level=level,
                name=name,
                parent=items.parent(level, int(np.flatnonzero(mask)[0])),
                scenes=int(mask.sum()),
                chance=items.chance_over(mask & items.has_actions),
            )
            groups.append((group, mask))
    return groups


def _tallies(items: Items) -> tuple[ActionTally, ...]:
    """Return the outcomes of every action over the scenes."""
    tallies: dict[str, Counter[str]] = {}
    for episode in items.episodes:
        if episode.is_ordinary:
            continue
        for action, outcome in episode.actions.items():
            tallies.setdefault(action, Counter())[outcome.label] += 1
    return tuple(ActionTally(action=action, **tallies[action]) for action in as_offered(tallies))


def _icc(items: Items, sheets: Iterable[AnswerColumns]) -> float | None:
    """Return the greatest intraclass correlation, within a path, of safe actions in scenes."""
    correlations = []
    for sheet in sheets:
        scores = items.is_scene & np.isfinite(sheet.safe)
        paths = [path for path, is_scored in zip(items.clusters, scores, strict=True) if is_scored]
        correlations.append(intraclass(sheet.safe[scores], paths))
    return max((value for value in correlations if value is not None), default=None)
