"""The outcome of one driver in one scene or twin."""

from typing import Literal

from oodscen.data._base import Data


class DriveResult(Data):
    """The result of one driver in one scene or twin."""

    schema_version: Literal[1] = 1
    id: str
    """`<scene id>@<driver>`."""
    scene_id: str
    driver: str
    status: Literal["ok", "failed", "inconclusive"] = "ok"
    """`inconclusive`: a recorded run that ends early, never comes to its decision, or is not of the scene."""
    error: str | None = None
    error_type: str = ""
    is_twin: bool = False
    collisions: tuple[str, ...] = ()
    """Ids of the actors that the ego touched; a collision ends the drive."""
    off_road: bool = False
    """True if the ego left the drivable road, which ends the drive."""
    passed: bool = False
    """True without a collision and without leaving the road."""
    seconds: float = 0.0
    min_gap_m: float | None = None
    min_ttc_s: float | None = None
    """Minimum time to collision with anything, in seconds; `None` if there was none."""
    ttc_below_1_5_s: float = 0.0
    """Share of the steps with a time to collision below 1.5 s."""
    min_headway_s: float | None = None
    """Minimum time headway to anything ahead in the ego's path, in seconds."""
    median_headway_s: float | None = None
    progress_m: float = 0.0
    """Distance that the ego covered along its road, in metres."""
    progress: float = 0.0
    """`progress_m` as a share of the distance at constant initial speed over the same time."""
    peak_deceleration: float = 0.0
    """Hardest braking, in m/s^2."""
    peak_jerk: float | None = None
    """Largest jerk, in m/s^3, measured over 0.2 s."""
    twin_passed: bool | None = None
    """True if the same driver passed the twin; `None` if the twin was not driven."""
    progress_lost: float | None = None
    """Progress in the twin minus progress here: the cost of the hazard."""
    brakes_needlessly: bool | None = None
    """True if it braked harder than 4 m/s^2 in the twin, where keeping the speed is safe."""
    made_from: str = ""
    """SHA-256 digest of the scene, for its twin too."""
