"""The record of one simulated scene."""

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import ClassVar, Literal

from oodscen._display import escaped, html_table
from oodscen.data._base import Data, LeanData
from oodscen.data._bird_sketch import Sketch
from oodscen.data._pairing import is_ordinary, is_twin
from oodscen.data._scene import StopLine
from oodscen.data._sighting import Sighting
from oodscen.errors import UnknownComponent

ACTIONS = (
    "keep_speed",
    "slow_down",
    "stop",
    "emergency_brake",
    "change_lane_left",
    "change_lane_right",
    "pull_over",
)
"""Ids of the discrete actions, in the order of presentation and reports."""

MOMENTS = ("first", "middle", "last")
"""The three frames of the paper's protocol, in order."""


def moments(count: int) -> tuple[str, ...]:
    """Return the moments of `count` frames at even distances in time, e.g. `first`, `at-33`, `at-67`, `last`.

    The numbers are percents of the time between the first and the last frame.
    """
    inner = (round(100 * index / (count - 1)) for index in range(1, count - 1))
    return ("first", *("middle" if share == 50 else f"at-{share}" for share in inner), "last")


def share_of(moment: str) -> float:
    """Return the time of a moment as a share of the time between the first and the last frame.

    Raises:
        UnknownComponent: If there is no such moment.
    """
    shares = {"first": 0.0, "middle": 0.5, "last": 1.0}
    if moment in shares:
        return shares[moment]
    percent = re.fullmatch(r"at-([1-9][0-9]?)", moment) if isinstance(moment, str) else None
    if percent is None:
        raise UnknownComponent("moment", f"{moment}"[:80], [*MOMENTS, "at-1 ... at-99"])
    return int(percent[1]) / 100


def in_order(names: Iterable[str]) -> tuple[str, ...]:
    """Return moments in order of time."""
    return tuple(sorted(names, key=share_of))


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
"""The actions from the least to the most intrusive, of which the changes of lane count alike; unlisted ones come last."""
_ALIKE = {"change_lane_left": "change_lane_right"}
"""Actions that are no more intrusive than the one before them."""


Label = Literal["safe", "unsafe", "marginal", "unavailable"]


class ActionOutcome(LeanData):
    """The outcome of one action executed from the decision point."""

    _left_out: ClassVar = ("ran_red",)

    safe: bool
    """True if the ego touched nothing, stayed on drivable road and passed no stop line at a red light up to the
    horizon, whichever driver executed the action."""
    marginal: bool = False
    """True if some drivers passed and others did not: the action is neither safe nor unsafe, and scores neither
    way."""
    unavailable: bool = False
    """True if the lane that the action needs does not exist; `safe` is then false."""
    margin_m: float | None = None
    """Smallest gap to any body from the first step after the decision on, m; 0 on contact; `None` if unavailable or
    if the road is empty. This and what follows are those of the driver with the middle reaction time."""
    min_ttc_s: float | None = None
    """Minimum time to collision with any body, s; 0 on contact; `None` if there is none."""
    pet_s: float | None = None
    """Minimum post-encroachment time, s; 0 on contact; `None` if no path was crossed."""
    contacts: tuple[str, ...] = ()
    """Ids of the actors that the ego touched."""
    off_road: bool = False
    ran_red: bool = False
    """True if the ego passed the episode's stop line while the light was red; left out of the JSON text if
    false."""
    final_speed: float | None = None
    """The ego's speed at the end, m/s."""
    peak_deceleration: float | None = None
    """Hardest braking of the ego, m/s^2, never negative; `None` if unavailable or not measured."""
    peak_jerk: float | None = None
    """Largest jerk of the ego along its path, m/s^3, over 0.2 s."""

    @property
    def is_unsafe(self) -> bool:
        """Return whether the action can be executed and no driver passed."""
        return self.label == "unsafe"

    @property
    def label(self) -> Label:
        """The outcome in a word."""
        if self.unavailable:
            return "unavailable"
        if self.safe:
            return "safe"
        return "marginal" if self.marginal else "unsafe"


def as_offered(actions: Iterable[str]) -> list[str]:
    """Sort actions in the order in which they are offered, unknown ones last."""
    names = set(actions)
    return [*(name for name in ACTIONS if name in names), *sorted(names - set(ACTIONS))]


def has_enough_margin(outcome: ActionOutcome) -> bool:
    """Return whether an action was safe and kept a margin of `ENOUGH_M` and `ENOUGH_TTC_S` to everything."""
    is_near = outcome.margin_m is not None and outcome.margin_m < ENOUGH_M
    is_soon = outcome.min_ttc_s is not None and outcome.min_ttc_s < ENOUGH_TTC_S
    return outcome.safe and not (is_near or is_soon)


def best_action(outcomes: Mapping[str, ActionOutcome]) -> str | None:
    """Return the best of the safe actions; `None` if no action is safe.

    Actions with enough margin come first (`has_enough_margin`); among them the least intrusive is best
    (`INTERVENTIONS`), then the one with the larger gap, then the one with gentler braking. If no action has enough
    margin, the largest gap wins, then the least intrusive action.
    """
    safe = [name for name in as_offered(outcomes) if outcomes[name].safe]
    return min(safe, key=lambda name: _rank(name, outcomes[name]), default=None)


def _rank(action: str, outcome: ActionOutcome) -> tuple[bool, tuple[float, float, float], int]:
    """Return the rank of a safe action; the least is best."""
    gap_m = math.inf if outcome.margin_m is None else outcome.margin_m
    braking = outcome.peak_deceleration or 0.0
    intrusion = _intrusion(_ALIKE.get(action, action))
    is_tight = not has_enough_margin(outcome)
    order = (-gap_m, intrusion, braking) if is_tight else (intrusion, -gap_m, braking)
    return is_tight, order, _intrusion(action)


def _intrusion(action: str) -> int:
    """Return the index of an action in `INTERVENTIONS`; unlisted ones come last."""
    return INTERVENTIONS.index(action) if action in INTERVENTIONS else len(INTERVENTIONS)


def base_rate(outcomes: Mapping[str, ActionOutcome]) -> float | None:
    """Return the probability that an action drawn at random from those that score is safe."""
    scoring = [outcome.safe for outcome in outcomes.values() if not outcome.marginal]
    return sum(scoring) / len(scoring) if scoring else None


class Follower(Data):
    """A vehicle close behind the ego."""

    gap_m: float
    """Distance between the bodies, m."""
    speed_mps: float
    what: str
    """Id of its asset in the catalogue."""


class Episode(LeanData):
    """One run of one scene: the approach to the decision point, and every action from there."""

    _left_out: ClassVar = ("stop_line",)

    schema_version: Literal[1] = 1
    id: str
    scene_id: str
    status: Literal["ok", "failed"]
    error: str | None = None
    error_type: str | None = None
    """Name of the exception, e.g. `SceneError`, `SpawnError`, `SimulatorCrash`."""
    retryable: bool = False
    """True if the simulator's process died: the same command tries this episode again."""
    simulator: str = ""
    seed: int = 0
    dt: float = 0.0
    """Seconds per step."""
    decision_s: float | None = None
    """Time of the decision point, s."""
    decision_fired: bool = False
    """False if the trigger never fired, so that the end of the approach became the decision point."""
    frames: dict[str, str] = {}
    """Image files by moment (`first`, `middle`, `last`), relative to the study's folder."""
    files: tuple[str, ...] = ()
    """Further requested files: traces, annotations, videos."""
    file_sha256: dict[str, str] = {}
    """SHA-256 of the frames and further files, by name."""
    frame_sha256: dict[str, str] = {}
    """SHA-256 of the raw pixels, by moment."""
    visible: dict[str, dict[str, int]] = {}
    """Visible pixels of every visible actor, by moment."""
    hazard_visible: bool | None = None
    """True if an unusual actor is visible in one of the frames, or the weather differs from the ordinary one;
    `None` for ordinary drives and without frames."""
    sighting: Sighting | None = None
    """The look of the hazard at the decision; `None` for ordinary drives, without frames, and where only the weather is
    the hazard."""
    trace_sha256: str = ""
    """SHA-256 of all states up to the decision point."""
    is_deterministic: bool = True
    """False if replaying the approach gave a different trace; no action then counts as safe."""
    actions: dict[str, ActionOutcome] = {}
    """Outcomes by action id."""
    sketch: Sketch | None = None
    """The bird's-eye sketch of the decision point and of every action's outcome."""
    ego_speed_mps: float | None = None
    """Speed of the ego at the decision, m/s."""
    frame_times_s: dict[str, float] = {}
    """Time of every frame since the start, s, by moment."""
    reaction_s: tuple[float, ...] = ()
    """Reaction times of the drivers who tried every action, s; empty for a failed episode."""
    horizon_s: float | None = None
    """Time for which every action was watched, s."""
    stop_line: StopLine | None = None
    """The line that no action may pass while the light is red; left out of the JSON text of drives without one."""
    follower: Follower | None = None
    """The nearest of `followers` at the decision."""
    followers: tuple[str, ...] = ()
    """Actors behind the ego in its lane at the decision point, close enough to matter; the front camera
    never shows them."""
    restaged: str = ""
    """The change that made some action safe and another unsafe; empty if the scene was not re-staged."""
    made_from: str = ""
    """In a study: SHA-256 of the scene as run; its ordinary drives have the same value."""

    @property
    def is_twin(self) -> bool:
        """Return whether this is the episode of an ordinary twin."""
        return is_twin(self.scene_id)

    @property
    def is_ordinary(self) -> bool:
        """Return whether this is the episode of an ordinary drive: a twin or a demand."""
        return is_ordinary(self.scene_id)

    @property
    def is_below_floor(self) -> bool:
        """Return whether a viewer cannot name the hazard at the decision; such scenes are not judged."""
        return self.sighting is not None and bool(self.sighting.faults)

    def label(self, action: str) -> Label:
        """Return the outcome of an action in a word; one that was not tried is unavailable."""
        outcome = self.actions.get(action)
        return "unavailable" if outcome is None else outcome.label

    @property
    def marginal_set(self) -> tuple[str, ...]:
        """Ids of the actions that are safe for some drivers only; they score neither way."""
        return tuple(name for name, outcome in self.actions.items() if outcome.marginal)

    @property
    def safe_set(self) -> tuple[str, ...]:
        """Ids of the safe actions."""
        return tuple(name for name, outcome in self.actions.items() if outcome.safe)

    @property
    def best_action(self) -> str | None:
        """The best of the safe actions; `None` if no action is safe.

        The least intrusive one with enough margin, and of both changes of lane that with the larger gap; if none has
        enough, the one with the largest gap.
        """
        return best_action(self.actions)

    @property
    def base_rate(self) -> float | None:
        """The probability that an action drawn at random from those that score is safe; marginal ones do not."""
        return base_rate(self.actions)

    @property
    def is_decidable(self) -> bool:
        """Return whether the choice matters: some action is safe, and another that can be executed is not."""
        outcomes = self.actions.values()
        return any(outcome.safe for outcome in outcomes) and any(
            outcome.is_unsafe for outcome in outcomes
        )

    def _repr_html_(self) -> str:
        """Return the outcomes of the actions as a table for notebooks."""
        title = f"{self.scene_id} in {self.simulator}" if self.simulator else self.scene_id
        if self.status == "failed":
            return f"<p>{escaped(title)}: failed: {escaped(self.error or '')}</p>"
        rows = [
            (
                action,
                outcome.label,
                _figure(outcome.margin_m, "m"),
                _figure(outcome.min_ttc_s, "s"),
                ", ".join(_touched(outcome)),
            )
            for action, outcome in self.actions.items()
        ]
        head = ("action", "outcome", "margin", "minimum TTC", "touched")
        when = "" if self.decision_s is None else f", decision at {self.decision_s:.2f} s"
        return html_table(rows, head=head, caption=f"{title}{when}")


def _touched(outcome: ActionOutcome) -> Iterator[str]:
    """Yield the actors, edges and lights that an action did not keep clear of."""
    yield from outcome.contacts
    if outcome.off_road:
        yield "off the road"
    if outcome.ran_red:
        yield "past the red light"


def _figure(value: float | None, unit: str) -> str:
    return "–" if value is None else f"{value:.2f} {unit}"
