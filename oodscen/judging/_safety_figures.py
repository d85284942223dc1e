"""Figures of the safe sets of a study."""

from collections.abc import Sequence

from oodscen.data._base import Data
from oodscen.data._episode import ACTIONS, Episode


class ActionSafety(Data):
    """The outcomes of one action over many scenes."""

    safe: float
    """Share of the scenes in which the action is safe."""
    unsafe: float
    """Share of the scenes in which the action can be executed and is unsafe."""
    marginal: float = 0.0
    """Share of the scenes in which the action is safe for some drivers only."""
    unavailable: float


class SafetyFigures(Data):
    """The safe sets of a study in figures, which show how well its scenes test drivers."""

    n: int
    """Number of episodes that ran."""
    decidable: float | None = None
    """Share of the episodes in which one action is safe and another is not."""
    base_rate: float | None = None
    """Mean probability that a random action is safe, of those that score; episodes without one are left out."""
    actions: dict[str, ActionSafety] = {}
    all_safe: tuple[str, ...] = ()
    """Scenes in which some action is safe and none is unsafe: any driver passes."""
    none_safe: tuple[str, ...] = ()
    """Scenes in which no action is safe for every driver."""
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
    names = dict.fromkeys((*ACTIONS, *(name for episode in ran for name in episode.actions)))
    rates = [episode.base_rate for episode in ran if episode.base_rate is not None]
    return SafetyFigures(
        n=n,
        decidable=sum(episode.is_decidable for episode in ran) / n,
        base_rate=sum(rates) / len(rates) if rates else None,
        actions={name: _action_safety(name, ran) for name in names},
        all_safe=tuple(
            episode.id for episode in ran if episode.safe_set and not episode.is_decidable
        ),
        none_safe=tuple(episode.id for episode in ran if not episode.safe_set),
        with_followers=sum(bool(episode.followers) for episode in ran),
        restaged={episode.id: episode.restaged for episode in ran if episode.restaged},
    )


def _action_safety(name: str, episodes: Sequence[Episode]) -> ActionSafety:
    outcomes = [episode.actions[name] for episode in episodes if name in episode.actions]
    n = max(1, len(outcomes))
    return ActionSafety(
        safe=sum(outcome.safe for outcome in outcomes) / n,
        unsafe=sum(outcome.is_unsafe for outcome in outcomes) / n,
        marginal=sum(outcome.marginal for outcome in outcomes) / n,
        unavailable=sum(outcome.unavailable for outcome in outcomes) / n,
    )
