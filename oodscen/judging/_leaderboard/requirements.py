"""Requirements on models: met, failed, or not decided yet, with at most 5 % of boards in error.

A requirement is a list of bars. A model meets it if every bar is shown to be reached, so that each is tested at
the whole level (an intersection-union test); it fails if one is shown to be missed, each tested at its share of
the level. The level of 5 % is divided by the number of models. One of "meets" and "fails" is true of a model, so
the probability of any false word on a board is at most 5 %. Whole paths are the units of the test
(`oodscen.statistics._bar_test`). Missing answers count as wrong for "meets", and as right for "fails".
"""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Literal

import numpy as np

from oodscen.data._base import Data
from oodscen.data._episode import Episode
from oodscen.data._scenario import Scenario
from oodscen.data._verdict import Verdict, is_without_pictures
from oodscen.errors import UsageError
from oodscen.judging._items import AnswerColumns, Floats, Items, Mask, judged_episodes
from oodscen.judging._leaderboard.figures import FAULTS
from oodscen.judging._leaderboard.figures import figures as figures_of
from oodscen.statistics._bar_test import p_below, times_needed

ALPHA = 0.05
"""The largest probability of any false "meets" or "fails" on a board."""

Grade = Literal["meets", "fails", "cannot tell yet"]
_BAR = re.compile(r"\s*([a-z-]+)\s*(>=|<=)\s*(\d+(?:\.\d*)?|\.\d+)\s*(%?)\s*")

FIGURES = {
    "notice-both": "scenes noticed, their ordinary drives left alone",
    "act-both": "safe in the scene, safe and not needless in its ordinary drives",
    "notice": "scenes called out of the ordinary",
    "alarms": "ordinary drives called out of the ordinary",
    "name": "the unusual named in own words",
    "pick": "the unusual picked from a list",
    "safe": "safe action in a scene",
    "needless": "needless stop in an ordinary drive",
}
"""Figures on which a bar can be put."""


class Bar(Data):
    """A bound on one figure."""

    figure: str
    sign: Literal[">=", "<="]
    value: float
    """In [0, 1]."""

    def __str__(self) -> str:
        return f"{self.figure}{self.sign}{self.value:g}"


class BarResult(Data):
    """One bar, and one model's figure."""

    bar: Bar
    share: float | None
    """The figure over the answers that score; `None` without any."""
    items: int
    """Items that count, unanswered ones included."""
    missing: int
    paths: int
    p_meets: float
    """p of the hypothesis that the bar is missed."""
    p_fails: float
    """p of the hypothesis that the bar is reached."""


class RequirementResult(Data):
    """The grade of a model, or of a driving stack, against a requirement."""

    name: str
    """Name of the judged model, or of the driving stack."""
    grade: Grade
    more_scenes: int | None = None
    """Scenes of further paths that would decide, if all figures stayed as they are; `None` if it is decided, or
    if the figures lie at the bar or have no answers."""
    bars: tuple[BarResult, ...]

    def __str__(self) -> str:
        listing = ", ".join(
            f"{result.bar.figure} {'-' if result.share is None else f'{result.share:.1%}'}"
            for result in self.bars
        )
        return f"{self.name}: {self.words} ({listing})"

    @property
    def words(self) -> str:
        """The grade, with the number of further scenes that would decide."""
        if self.grade != "cannot tell yet":
            return self.grade
        if not any(result.items for result in self.bars):
            return "cannot tell, as it has no answers that count"
        if self.more_scenes is None:
            return "cannot tell yet, and more scenes of this kind would hardly tell"
        noun = "scene" if self.more_scenes == 1 else "scenes"
        return f"cannot tell yet, {self.more_scenes:,} more {noun}"


def parse_requirement(text: str, figures: Mapping[str, str] = FIGURES) -> tuple[Bar, ...]:
    """Return the bars of a text such as `safe>=0.9,needless<=5%`, each on one of some figures.

    Raises:
        UsageError: If it is malformed, names an unknown figure, asks for many faults or for few successes, or holds
            two bars on one figure.
    """
    bars: list[Bar] = []
    for part in text.split(","):
        match = _BAR.fullmatch(part)
        if match is None:
            raise UsageError(f"{part.strip()!r} is not a requirement: expected, e.g., safe>=0.9")
        name, sign, number, percent = match.groups()
        value = float(number) / (100 if percent else 1)
        if name not in figures:
            raise UsageError(f"no figure is called {name!r}; there are {', '.join(figures)}")
        if not 0 <= value <= 1:
            raise UsageError(f"the bar of {name} must lie between 0 and 1")
        if name in FAULTS and sign == ">=":
            raise UsageError(
                f"{name} counts faults, of which less is better: write {name}<={number}{percent}"
            )
        if name not in FAULTS and sign == "<=":
            raise UsageError(f"of {name}, more is better: write {name}>={number}{percent}")
        bar = Bar(figure=name, sign=sign, value=value)
        if twin := next((other for other in bars if other.figure == name), None):
            raise UsageError(f"{twin} and {bar} are two bars on one figure; keep one")
        bars.append(bar)
    return tuple(bars)


def requirements(
    verdicts: Iterable[Verdict],
    episodes: Iterable[Episode],
    scenarios: Iterable[Scenario],
    bars: Sequence[Bar],
    *,
    seed: int = 0,
) -> list[RequirementResult]:
    """Return the grade of every model, in order of their names; references have none.

    Answers by the paper's protocol do not count, so a model without others cannot be graded.

    `episodes` are those of scenes and ordinary drives; `bars` holds at least one.
    """
    items = Items.of(judged_episodes(episodes), {scenario.id: scenario for scenario in scenarios})
    grouped: dict[str, list[Verdict]] = {}
    for verdict in verdicts:
        is_graded = verdict.kind == "model" and not is_without_pictures(verdict.model)
        if is_graded:
            rows = grouped.setdefault(verdict.model, [])
            if verdict.protocol == "ours":
                rows.append(verdict)
    level = ALPHA / max(sum(map(bool, grouped.values())), 1)
    return [
        _grade(items, model, AnswerColumns.of(items, rows), bars, level, seed)
        for model, rows in sorted(grouped.items())
    ]


def _grade(
    items: Items, model: str, sheet: AnswerColumns, bars: Sequence[Bar], level: float, seed: int
) -> RequirementResult:
    ratios = figures_of(items, sheet)
    tests = []
    for bar in bars:
        ratio = ratios[bar.figure]
        values = np.where(ratio.is_there, ratio.above, np.nan)
        tests.append(RequirementTest(items.clusters, values, ratio.missing(sheet), bar, seed))
    per_path = int(items.is_scene.sum()) / max(len(set(items.clusters)), 1)
    return grade_of(model, tests, level, per_path)


def grade_of(
    name: str, tests: Sequence["RequirementTest"], level: float, per_path: float
) -> RequirementResult:
    """Return the grade of a model or a driving stack by the tests of its bars.

    `level` is the largest probability of a false word about it, `per_path` its mean number of scenes of a path.
    """
    results = tuple(test.result() for test in tests)
    level_each = level / len(tests)
    if all(result.p_meets <= level for result in results):
        return RequirementResult(name=name, grade="meets", bars=results)
    if any(result.p_fails <= level_each for result in results):
        return RequirementResult(name=name, grade="fails", bars=results)
    more_scenes = None
    times = _times(tests, results, level, level_each)
    if times is not None:
        paths = max(result.paths for result in results)
        more_scenes = max(math.ceil((times - 1) * paths * per_path), 1)
    return RequirementResult(
        name=name, grade="cannot tell yet", more_scenes=more_scenes, bars=results
    )


def _times(
    tests: Sequence["RequirementTest"],
    results: Sequence[BarResult],
    level: float,
    level_each: float,
) -> float | None:
    """Return how many times as large the study must be to decide, if its figures stay as they are."""
    to_fail = [test.times(level_each, is_met=False) for test in tests]
    possible = [times for times in to_fail if times is not None]
    if possible:
        return min(possible)
    to_meet = []
    for test, result in zip(tests, results, strict=True):
        if result.p_meets > level:
            times = test.times(level, is_met=True)
            if times is None:
                return None
            to_meet.append(times)
    return max(to_meet)


class RequirementTest:
    """The test of one bar: gaps of every path, with missing answers against the grade that is tested.

    Args:
        clusters: [n] the path of every item.
        values: [n] the figure of every item, in [0, 1]; NaN if there is none.
        missing: [n] True for items that should have a figure and have none.
        bar: The bound.
        seed: Seed of the test.
    """

    def __init__(
        self, clusters: Sequence[str], values: Floats, missing: Mask, bar: Bar, seed: int
    ) -> None:
        self._bar, self._seed = bar, seed
        is_there = np.isfinite(values)
        self._missing, self._counts = missing, is_there | missing
        above = np.where(is_there, values, 0.0)
        self._n, self._sum = int(is_there.sum()), float(above.sum())
        rows: list[int] = np.flatnonzero(self._counts).tolist()
        paths = [clusters[row] for row in rows]
        unit_of = {path: unit for unit, path in enumerate(sorted(set(paths)))}
        units = np.array([unit_of[path] for path in paths], np.int64)
        self._units = len(unit_of)
        is_least = bar.sign == ">="
        hits = above[rows] if is_least else np.where(missing, 0.0, 1 - above)[rows]
        self._share = bar.value if is_least else 1 - bar.value
        self._size = np.bincount(units, minlength=self._units).astype(np.float64)
        self._right = np.bincount(units, weights=hits, minlength=self._units)
        self._unanswered = np.bincount(units, weights=missing[rows], minlength=self._units)

    def gaps(self, *, is_met: bool) -> tuple[Floats, float]:
        """Return the gap of every path in favour of "meets" or "fails", and the least that a path can have."""
        most = max(float(self._size.max(initial=0)), 1.0)
        if is_met:
            return (self._right - self._share * self._size) / most, -self._share
        right = self._right + self._unanswered
        return (self._share * self._size - right) / most, self._share - 1

    def p(self, *, is_met: bool) -> float:
        """Return the p-value of the opposite of "meets" or "fails"."""
        gaps, least = self.gaps(is_met=is_met)
        # A bar that cannot be missed (>= 0) is met, and never failed.
        if is_met and self._share <= 0:
            return 0.0
        if not len(gaps) or (not is_met and self._share <= 0):
            return 1.0
        return p_below(gaps, least, seed=self._seed)

    def times(self, level: float, *, is_met: bool) -> float | None:
        """Return how many times as many paths would show "meets" or "fails"; `None` if hardly any number would."""
        gaps, least = self.gaps(is_met=is_met)
        return times_needed(gaps, least, level, seed=self._seed)

    def result(self) -> BarResult:
        """Return the figure and both p-values."""
        return BarResult(
            bar=self._bar,
            share=round(self._sum / self._n, 6) if self._n else None,
            items=int(self._counts.sum()),
            missing=int(self._missing.sum()),
            paths=self._units,
            p_meets=self.p(is_met=True),
            p_fails=self.p(is_met=False),
        )
