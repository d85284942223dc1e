"""What one run of one scene left behind."""

from typing import ClassVar, Literal

from oodscen.data._base import Data
from oodscen.data._bird_sketch import Sketch
from oodscen.data._twins import is_twin

ACTIONS = (
    "keep_speed",
    "slow_down",
    "stop",
    "emergency_brake",
    "change_lane_left",
    "change_lane_right",
    "pull_over",
)
"""Ids of the discrete actions, in the order in which they are offered and reported."""

MOMENTS = ("first", "middle", "last")
"""The three frames of the paper's protocol, in order."""


class ActionOutcome(Data):
    """What happened when one action was executed from the decision point."""

    noun: ClassVar[str] = "action outcome"

    safe: bool
    """The ego touched nothing and stayed on drivable road up to the horizon."""
    unavailable: bool = False
    """The lane that the action needs does not exist; then `safe` is false."""
    margin_m: float | None = None
    """Smallest gap to anything, m; 0 on contact; `None` if unavailable or alone on the road."""
    min_ttc_s: float | None = None
    """Least time to collision with anything, s; 0 on contact; `None` where there is none."""
    pet_s: float | None = None
    """Least post-encroachment time, s; 0 on contact; `None` where nobody's path was crossed."""
    contacts: tuple[str, ...] = ()
    """Ids of the actors that the ego touched."""
    off_road: bool = False
    final_speed: float | None = None
    """m/s at the end."""
    peak_deceleration: float | None = None
    """Hardest braking of the ego, m/s^2, never negative; `None` if unavailable or not measured."""
    peak_jerk: float | None = None
    """Fastest change of the ego's acceleration along its path, m/s^3, over 0.2 s."""

    @property
    def is_unsafe(self) -> bool:
        """Whether it can be executed and is not safe."""
        return not (self.safe or self.unavailable)


class Episode(Data):
    """One run of one scene: up to the decision point, and every action from there."""

    noun: ClassVar[str] = "episode"

    schema_version: Literal[1] = 1
    id: str
    scene_id: str
    status: Literal["ok", "failed"]
    error: str | None = None
    error_type: str | None = None
    """Name of the exception, e.g. `SceneError`, `SpawnError`, `SimulatorCrash`."""
    retryable: bool = False
    """Its process died: another time may go well, and the same command tries it."""
    simulator: str = ""
    seed: int = 0
    dt: float = 0.0
    """Seconds per step."""
    decision_s: float | None = None
    """When the decision point was reached."""
    decision_fired: bool = False
    """False where the trigger never fired and the end of the approach was taken instead."""
    frames: dict[str, str] = {}
    """By moment (`first`, `middle`, `last`): the file, relative to the study."""
    files: tuple[str, ...] = ()
    """Further files that were asked for: traces, annotations, videos."""
    frame_sha256: dict[str, str] = {}
    """By moment: hash of the raw pixels."""
    visible: dict[str, dict[str, int]] = {}
    """By moment: pixels of every actor that can be seen."""
    hazard_visible: bool | None = None
    """An unusual actor can be seen in one of the frames, or the weather is unlike the ordinary;
    `None` without frames, and for twins."""
    trace_sha256: str = ""
    """Hash of all states up to the decision point."""
    is_deterministic: bool = True
    """False where replaying the approach gave another trace; then no action is called safe."""
    actions: dict[str, ActionOutcome] = {}
    """By action id."""
    sketch: Sketch | None = None
    """Where everybody is at the decision point, and where every action takes them."""
    followers: tuple[str, ...] = ()
    """Who is behind the ego in its lane at the decision point, near enough to matter: the front
    camera never shows them."""
    restaged: str = ""
    """How the scene was re-staged so that some action is safe and some is not; empty where it was not."""
    made_from: str = ""
    """In a study: SHA-256 of the scene as it was run, also for its twin."""

    @property
    def is_twin(self) -> bool:
        """Whether the episode is that of an ordinary twin."""
        return is_twin(self.scene_id)

    @property
    def safe_set(self) -> tuple[str, ...]:
        """The actions that were safe."""
        return tuple(name for name, outcome in self.actions.items() if outcome.safe)

    @property
    def is_decidable(self) -> bool:
        """Whether the choice matters: some action is safe, and some other that can be executed is not."""
        outcomes = self.actions.values()
        return any(one.safe for one in outcomes) and any(one.is_unsafe for one in outcomes)
