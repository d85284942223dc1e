"""Safe sets: the safe actions of each scene, the best of them, and the score of a random choice."""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import ClassVar

from oodscen.data._base import Data
from oodscen.data._episode import ACTIONS, ActionOutcome, Episode

ENOUGH_M = 0.5
"""The smallest gap with enough margin, m. A vehicle passing in the next lane is about 1 m away."""
ENOUGH_TTC_S = 1.5
"""The smallest time to collision with enough margin, s. Below it a conflict is serious (van der Horst and Hogema,
"Time-to-collision and collision avoidance systems", 1993).
"""
INTERVENTIONS = (
    "keep_speed",
    "slow_down",
    "change_lane_right",
    "change_lane_left",
    "stop",
    "pull_over",
    "emergency_brake",
)
"""The actions from the least to the most intrusive; unlisted actions come last."""


def as_offered(actions: Iterable[str]) -> list[str]:
    """Sort actions in the order in which they are offered, unknown ones last."""
    known = set(actions)
    return [*(name for name in ACTIONS if name in known), *sorted(known - set(ACTIONS))]


def has_enough_margin(outcome: ActionOutcome) -> bool:
    """Return whether an action was safe and kept a margin of `ENOUGH_M` and `ENOUGH_TTC_S` to everything."""
    is_near = outcome.margin_m is not None and outcome.margin_m < ENOUGH_M
    is_soon = outcome.min_ttc_s is not None and outcome.min_ttc_s < ENOUGH_TTC_S
    return outcome.safe and not (is_near or is_soon)


def best_action(outcomes: Mapping[str, ActionOutcome]) -> str | None:
    """Return the best of the safe actions; `None` if no action is safe.

    Actions with enough margin come first (`has_enough_margin`); among them the least intrusive is best
    (`INTERVENTIONS`), then the one with gentler braking. If no action has enough margin, the largest gap wins,
    then
    the least intrusive action.
    """
    ranked = []
    for index, name in enumerate(as_offered(outcomes)):
        outcome = outcomes[name]
        if outcome.safe:
            gap = math.inf if outcome.margin_m is None else outcome.margin_m
            braking = outcome.peak_deceleration or 0.0
            is_listed = name in INTERVENTIONS
            rank = INTERVENTIONS.index(name) if is_listed else len(INTERVENTIONS)
            is_enough = has_enough_margin(outcome)
            order = (rank, braking, -gap) if is_enough else (-gap, rank, braking)
            ranked.append((not is_enough, order, index, name))
    return min(ranked)[-1] if ranked else None


def base_rate(outcomes: Mapping[str, ActionOutcome]) -> float | None:
    """Return the probability that an action drawn at random from those offered is safe."""
    if not outcomes:
        return None
    return sum(outcome.safe for outcome in outcomes.values()) / len(outcomes)


class ActionSafety(Data):
    """The outcomes of one action over many scenes."""

    noun: ClassVar[str] = "action safety"

    safe: float
    """Share of the scenes in which the action is safe."""
    unsafe: float
    """Share of the scenes in which the action can be executed and is unsafe."""
    unavailable: float


class SafetyFigures(Data):
    """Figures from a study's safe sets that tell how well its scenes test drivers."""

    noun: ClassVar[str] = "safety figures"

    n: int
    """Number of episodes that ran."""
    decidable: float | None = None
    """Share of the episodes in which one action is safe and another is not."""
    base_rate: float | None = None
    """Mean probability that a random action is safe."""
    actions: dict[str, ActionSafety] = {}
    all_safe: tuple[str, ...] = ()
    """Scenes in which every action that can be executed is safe: any driver passes."""
    none_safe: tuple[str, ...] = ()
    """Scenes in which no action is safe: every driver fails."""
    with_followers: int = 0
    """Episodes with an actor close behind the ego, which the front camera never shows."""
    restaged: dict[str, str] = {}
    """Re-staged scenes, each with the change that was made."""


def safety_figures(episodes: Sequence[Episode]) -> SafetyFigures:
    """Return a summary of the safe sets of the episodes that ran; pass scenes or twins, not both."""
    ran = [episode for episode in episodes if episode.status == "ok" and episode.actions]
    if not ran:
        return SafetyFigures(n=0)
    n = len(ran)
    executed = {
        episode.id: [o.safe for o in episode.actions.values() if not o.unavailable]
        for episode in ran
    }
    names = dict.fromkeys((*ACTIONS, *(name for episode in ran for name in episode.actions)))
    rates = [base_rate(episode.actions) or 0.0 for episode in ran]
    return SafetyFigures(
        n=n,
        decidable=sum(episode.is_decidable for episode in ran) / n,
        base_rate=sum(rates) / n,
        actions={name: _of_action(name, ran) for name in names},
        all_safe=tuple(name for name, safe in executed.items() if all(safe)),
        none_safe=tuple(name for name, safe in executed.items() if not any(safe)),
        with_followers=sum(bool(episode.followers) for episode in ran),
        restaged={episode.id: episode.restaged for episode in ran if episode.restaged},
    )


def _of_action(name: str, ran: Sequence[Episode]) -> ActionSafety:
    found = [episode.actions[name] for episode in ran if name in episode.actions]
    n = max(1, len(found))
    return ActionSafety(
        safe=sum(outcome.safe for outcome in found) / n,
        unsafe=sum(outcome.is_unsafe for outcome in found) / n,
        unavailable=sum(outcome.unavailable for outcome in found) / n,
    )
