"""The audit: how well every known shortcut separates rare from ordinary drives without understanding them."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np

from oodscen.data._base import Data, digest
from oodscen.data._episode import Episode
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.errors import StudyError
from oodscen.judging._items import Items, Mask, Ratio, judged_episodes
from oodscen.judging._leaderboard.figures import resample_ratios
from oodscen.judging._leaderboard.rows import Estimate
from oodscen.judging._shortcuts import facts
from oodscen.judging._shortcuts.learners import Learners
from oodscen.judging._shortcuts.rules import Guess, folds_of, is_audited
from oodscen.statistics._auroc import auroc_of_items
from oodscen.statistics._intervals import Floats, cluster_interval
from oodscen.statistics._resampling import Resampler

Needs = Literal["ground truth", "exact places", "pictures", "settings", "outcomes"]
_FLOOR: tuple[Needs, ...] = ("ground truth", "pictures")
"""Needs of the shortcuts that can be the floor: bodies and pictures.

Exact places and outcomes of actions are reported apart: no picture shows a decimetre, and going on fails in a scene
because scenes are made so.
"""


class ShortcutScore(Data):
    """The score of one shortcut."""

    name: str
    needs: Needs
    method: str
    """`rule`, `logistic regression`, `gradient boosting` or `pair`."""
    auroc: Estimate
    balanced_accuracy: Estimate
    called_by_kind: dict[str, float] = {}
    """Share called out of the ordinary, by kind of ordinary drive."""


class Audit(Data):
    """The scores of all shortcuts, by cross-validation over whole paths."""

    schema_version: Literal[1] = 1
    scenes: int
    ordinary: dict[str, int]
    """Number of ordinary drives by kind."""
    paths: int
    rows: tuple[ShortcutScore, ...]
    """Best first; those that need exact places or the outcomes of actions come last."""
    best: str
    """The shortcut on bodies or pictures with the highest balanced accuracy: the floor to beat."""
    calls: dict[str, bool]
    """By item: whether the best shortcut calls it out of the ordinary."""
    made_from: str
    """SHA-256 of the audited episodes."""

    def best_calls(self, episodes: Iterable[Episode]) -> tuple[str, Mapping[str, bool]] | None:
        """Return the name and the calls of the best shortcut; `None` if the audit is of other episodes."""
        return (self.best, self.calls) if source(episodes) == self.made_from else None

    def __str__(self) -> str:
        drives = ", ".join(f"{count} {kind}s" for kind, count in self.ordinary.items())
        cells = [("shortcut", "needs", "method", "AUROC", "balanced accuracy")]
        cells += [
            (
                row.name,
                row.needs,
                row.method,
                _cell(row.auroc, ".2f"),
                _cell(row.balanced_accuracy, ".1%"),
            )
            for row in self.rows
        ]
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        lines = [
            f"{self.scenes} scenes and {drives} of {self.paths} paths; learnt on other paths",
            *("  ".join(map(str.ljust, row, widths)).rstrip() for row in cells),
            f"floor to beat: {self.best}",
        ]
        return "\n".join(lines)


def _cell(figure: Estimate, form: str) -> str:
    if figure.value is None:
        return "-"
    ends = figure.interval
    between = f" [{ends.low:{form}}, {ends.high:{form}}]" if ends else ""
    return f"{figure.value:{form}}{between}"


def source(episodes: Iterable[Episode]) -> str:
    """Return the digest of the episodes that an audit depends on: those that are judged, the last of every item."""
    rows = sorted(
        (episode.id, episode.status, episode.trace_sha256, episode.made_from)
        for episode in judged_episodes(episodes)
    )
    return digest(rows)


def audit(
    episodes: Sequence[Episode],
    scenes: Iterable[Scene],
    scenarios: Iterable[Scenario],
    folder: Path,
    *,
    seed: int = 0,
) -> Audit:
    """Return the scores of all shortcuts on the scenes of a study and their ordinary drives.

    Names of frames are relative to `folder`; the seed is that of the classifiers and of the resampling.

    Raises:
        StudyError: If fewer than two paths have a scene with an ordinary drive.
        MissingExtra: If scikit-learn or OpenCV is not installed.
    """
    items = Items.of(judged_episodes(episodes), {scenario.id: scenario for scenario in scenarios})
    rows: list[int] = np.flatnonzero(is_audited(items)).tolist()
    clusters = [items.clusters[row] for row in rows]
    if len(set(clusters)) < 2:
        raise StudyError("an audit needs scenes with ordinary drives on two paths")
    ran = [items.episodes[row] for row in rows]
    is_rare = items.is_scene[rows]
    learners = Learners(is_rare, folds_of(clusters), seed)
    shortcuts = list(_shortcuts(learners, ran, {scene.id: scene for scene in scenes}, folder))
    resampler = Resampler(clusters, seed=seed)
    kinds = np.array([items.kinds[row] for row in rows])
    table = [_score(shortcut, is_rare, kinds, resampler) for shortcut in shortcuts]
    best = max(
        (shortcut.guess for shortcut in shortcuts if shortcut.needs in _FLOOR),
        key=lambda guess: guess.balanced(is_rare),
    )
    index_of = {row: index for index, row in enumerate(rows)}
    owners = np.array([index_of.get(owner, -1) for owner in items.owners[rows].tolist()])
    table.append(_pairs(ran, owners, folder, resampler))
    return Audit(
        scenes=int(is_rare.sum()),
        ordinary={
            kind: int((kinds == kind).sum()) for kind in sorted(set(kinds.tolist()) - {"rare"})
        },
        paths=resampler.units,
        rows=tuple(sorted(table, key=_rank)),
        best=best.name,
        calls=best.calls(ran),
        made_from=source(episodes),
    )


def _rank(row: ShortcutScore) -> tuple[bool, bool, float]:
    """Return the sort key of a row: outcomes last, exact places before them, the others best first."""
    return (
        row.needs == "outcomes",
        row.needs == "exact places",
        -(row.balanced_accuracy.value or 0.0),
    )


class _Shortcut(NamedTuple):
    """One shortcut with its calls."""

    guess: Guess
    needs: Needs
    method: str


def _shortcuts(
    learners: Learners, ran: Sequence[Episode], scenes: Mapping[str, Scene], folder: Path
) -> Iterator[_Shortcut]:
    """Yield every shortcut with its calls."""
    yield from _on_bodies(learners, ran)
    for name, columns in facts.settings(ran, scenes).items():
        yield _Shortcut(learners.linear(name, columns), "settings", "logistic regression")
    for moment in ("last", "first"):
        yield from _on_pictures(learners, ran, folder, moment)


def _on_bodies(learners: Learners, ran: Sequence[Episode]) -> Iterator[_Shortcut]:
    columns = facts.ground_truth(ran)
    for name, values in columns.items():
        yield _Shortcut(learners.rule(name, values), "ground truth", "rule")
    name = "distances, counts and pixels together"
    together = np.stack(list(columns.values()), axis=1)
    yield _Shortcut(learners.boosted(name, together), "ground truth", "gradient boosting")
    name = "exact places of the nearest bodies"
    places = np.array([facts.nearest_places(episode.sketch) for episode in ran], np.float64)
    yield _Shortcut(learners.boosted(name, places), "exact places", "gradient boosting")
    fails = np.array([facts.keeping_fails(episode) for episode in ran], np.float64)
    yield _Shortcut(learners.rule("keeping the speed fails", fails), "outcomes", "rule")


def _on_pictures(
    learners: Learners, ran: Sequence[Episode], folder: Path, moment: str
) -> Iterator[_Shortcut]:
    files = [folder / episode.frames.get(moment, "missing") for episode in ran]
    for name, columns in facts.pictures(files).items():
        label = f"{name}, {moment} frame"
        if columns.shape[1] == 1:
            yield _Shortcut(learners.rule(label, columns[:, 0]), "pictures", "rule")
            continue
        yield _Shortcut(learners.boosted(label, columns), "pictures", "gradient boosting")
        if moment == "last":
            yield _Shortcut(learners.linear(label, columns), "pictures", "logistic regression")


def _score(
    shortcut: _Shortcut, is_rare: Mask, kinds: np.ndarray[Any, Any], resampler: Resampler
) -> ShortcutScore:
    guess = shortcut.guess
    area = auroc_of_items(guess.score, is_rare, resampler)
    calls: Floats = guess.is_called.astype(np.float64)
    sides = [Ratio(calls, is_rare), Ratio(1.0 - calls, ~is_rare)]
    replicates = resample_ratios(resampler, sides).mean(axis=1)
    return ShortcutScore(
        name=guess.name,
        needs=shortcut.needs,
        method=shortcut.method,
        auroc=Estimate(
            value=area[0] if area else None,
            n=len(calls),
            interval=area[1] if area else None,
        ),
        balanced_accuracy=Estimate(
            value=guess.balanced(is_rare),
            n=len(calls),
            interval=cluster_interval(replicates, resampler.units),
        ),
        called_by_kind={
            kind: float(calls[kinds == kind].mean())
            for kind in sorted(set(kinds.tolist()) - {"rare"})
        },
    )


def _pairs(
    ran: Sequence[Episode], owners: np.ndarray[Any, Any], folder: Path, resampler: Resampler
) -> ShortcutScore:
    """Return the share of ordinary drives whose scene has the larger picture file; equal sizes count half.

    `owners` [n] are the rows of the drives' scenes, -1 for scenes.
    """
    files = [folder / episode.frames.get("last", "missing") for episode in ran]
    sizes = np.array([file.stat().st_size if file.is_file() else 0.0 for file in files])
    is_drive = owners >= 0
    wins = np.where(is_drive, np.sign(sizes[owners] - sizes) * 0.5 + 0.5, np.nan)
    replicates = resample_ratios(resampler, [Ratio(wins, is_drive)])[:, 0]
    return ShortcutScore(
        name="the larger JPEG file of a pair is the rare one",
        needs="pictures",
        method="pair",
        auroc=Estimate(),
        balanced_accuracy=Estimate(
            value=float(np.nanmean(wins)),
            n=int(is_drive.sum()),
            interval=cluster_interval(replicates, resampler.units),
        ),
    )
