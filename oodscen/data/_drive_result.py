"""The outcome of one driver in one scene or twin."""

from typing import ClassVar, Literal

from oodscen.data._base import Data


class DriveResult(Data):
    """What became of one driver in one scene or twin."""

    noun: ClassVar[str] = "drive result"

    schema_version: Literal[1] = 1
    id: str
    """`<scene id>@<driver>`."""
    scene_id: str
    driver: str
    status: Literal["ok", "failed"] = "ok"
    error: str | None = None
    error_type: str = ""
    is_twin: bool = False
    collisions: tuple[str, ...] = ()
    """Ids of the actors that the ego touched; the drive ends there."""
    off_road: bool = False
    """The ego left the drivable road; the drive ends there."""
    passed: bool = False
    """Neither."""
    seconds: float = 0.0
    min_gap_m: float | None = None
    min_ttc_s: float | None = None
    """Least time to collision with anything; `None` where there was none."""
    ttc_below_1_5_s: float = 0.0
    """Share of the steps with a time to collision below 1.5 s."""
    min_headway_s: float | None = None
    """Least time headway to anything ahead in the ego's path."""
    median_headway_s: float | None = None
    progress_m: float = 0.0
    """How far the ego came along its road."""
    progress: float = 0.0
    """That, as a share of how far a driver comes who keeps the first speed for as long."""
    peak_deceleration: float = 0.0
    """m/s^2."""
    peak_jerk: float | None = None
    """m/s^3, over 0.2 s."""
    twin_passed: bool | None = None
    """How the same driver fared in the twin; `None` where it was not driven."""
    progress_lost: float | None = None
    """Progress in the twin less progress here: what the hazard cost."""
    brakes_needlessly: bool | None = None
    """In the twin, where keeping the speed is safe, it braked harder than 4 m/s^2."""
    made_from: str = ""
    """SHA-256 of the scene, also for its twin."""
