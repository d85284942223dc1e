"""What the models scored, with intervals, and how often each action was safe."""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from oodscen import paper
from oodscen.episode import ACTIONS, Episode
from oodscen.report import charts
from oodscen.verdict import Verdict

_Z95 = 1.959963984540054


@dataclass(frozen=True)
class Share:
    """A count out of a number of scenes, with its Wilson 95 % interval."""

    hits: int
    n: int

    @property
    def value(self) -> float:
        """In [0, 1]; 0 where nothing was counted."""
        return self.hits / self.n if self.n else 0.0

    @property
    def interval(self) -> tuple[float, float]:
        """Lower and upper bound, in [0, 1]."""
        return wilson(self.hits, self.n)

    @property
    def chart(self) -> Markup:
        """The share as a dot with its interval."""
        return charts.whisker(self.value, *self.interval)


@dataclass(frozen=True)
class Standing:
    """One row of the leaderboard."""

    model: str
    is_reference: bool
    answered: int
    failed: int
    called_ood: Share
    aspect: Share
    """Task 1: the OOD aspect named."""
    action: Share
    """Task 2: a safe action chosen."""


@dataclass(frozen=True)
class Paper:
    """One row of the paper's table."""

    model: str
    aspect: Share
    action: Share


@dataclass(frozen=True)
class ActionCount:
    """In how many scenes one action was safe, unsafe or unavailable."""

    action: str
    safe: int
    unsafe: int
    unavailable: int

    @property
    def chart(self) -> Markup:
        """The three counts as one bar."""
        return charts.shares(
            [("safe", self.safe), ("unsafe", self.unsafe), ("unavailable", self.unavailable)]
        )


def wilson(hits: int, n: int) -> tuple[float, float]:
    """Return the Wilson 95 % interval of a share.

    Source: E. B. Wilson, Probable inference, the law of succession, and statistical inference,
    JASA 22 (1927).
    """
    if not n:
        return 0.0, 1.0
    share, z2 = hits / n, _Z95 * _Z95
    middle = (share + z2 / (2 * n)) / (1 + z2 / n)
    half = _Z95 / (1 + z2 / n) * math.sqrt(share * (1 - share) / n + z2 / (4 * n * n))
    low = 0.0 if hits == 0 else max(middle - half, 0.0)
    return low, 1.0 if hits == n else min(middle + half, 1.0)


def standings(verdicts: Sequence[Verdict]) -> list[Standing]:
    """Count per model; real models first, then the references, each in order of task 2."""
    by_model: dict[str, list[Verdict]] = {}
    for verdict in verdicts:
        by_model.setdefault(verdict.model, []).append(verdict)
    rows = [_standing(model, found) for model, found in by_model.items()]
    return sorted(rows, key=lambda row: (row.is_reference, -row.action.value, row.model))


def floor(rows: Sequence[Standing]) -> Standing | None:
    """Return the reference that does best in task 2: what can be had without seeing anything."""
    seen = [row for row in rows if row.is_reference and row.action.n]
    return max(seen, key=lambda row: row.action.value, default=None)


def names_nothing(rows: Sequence[Standing]) -> bool:
    """Whether no reference ever named an aspect, so that task 1 has no floor to compare with."""
    references = [row for row in rows if row.is_reference and row.aspect.n]
    return bool(references) and not any(row.aspect.hits for row in references)


def papers_table() -> list[Paper]:
    """Return what the paper reports, of 130 scenes per model."""
    n = paper.PATHS * paper.PER_PATH
    return [
        Paper(model, Share(aspect, n), Share(action, n))
        for model, (aspect, action) in paper.VLM_SUCCESS.items()
    ]


def action_counts(episodes: Sequence[Episode]) -> list[ActionCount]:
    """Count the outcomes of every action."""
    known = dict.fromkeys(ACTIONS)
    known.update(dict.fromkeys(name for episode in episodes for name in episode.actions))
    rows = []
    for action in known:
        tally = Counter(
            "unavailable" if outcome.unavailable else "safe" if outcome.safe else "unsafe"
            for episode in episodes
            if (outcome := episode.actions.get(action)) is not None
        )
        rows.append(ActionCount(action, tally["safe"], tally["unsafe"], tally["unavailable"]))
    return rows


def choice(episode: Episode) -> str:
    """Say whether the choice of action matters: `mixed`, `all` safe, `none` safe, or empty."""
    available = [outcome.safe for outcome in episode.actions.values() if not outcome.unavailable]
    if not available:
        return ""
    if all(available):
        return "all"
    return "mixed" if any(available) else "none"


def chance(episodes: Sequence[Episode]) -> float | None:
    """Return how often a uniformly random action is safe, over all scenes; `None` without any."""
    rates = [
        len(episode.safe_set) / len(episode.actions) for episode in episodes if episode.actions
    ]
    return math.fsum(rates) / len(rates) if rates else None


def _standing(model: str, verdicts: Sequence[Verdict]) -> Standing:
    answered = [verdict for verdict in verdicts if verdict.status == "ok"]
    return Standing(
        model=model,
        is_reference=any(verdict.kind == "reference" for verdict in verdicts),
        answered=len(answered),
        failed=len(verdicts) - len(answered),
        called_ood=_share([verdict.is_ood for verdict in answered]),
        aspect=_share([verdict.aspect_is_right for verdict in answered]),
        action=_share([verdict.action_is_safe for verdict in answered]),
    )


def _share(found: Sequence[bool | None]) -> Share:
    known = [value for value in found if value is not None]
    return Share(sum(known), len(known))
