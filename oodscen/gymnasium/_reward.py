"""The reward of one step of an environment."""

from collections.abc import Mapping
from dataclasses import dataclass, fields

from oodscen._numbers import finite_number
from oodscen.driving._motion.bodies import GRAVITY
from oodscen.errors import UnknownComponent

CRITICAL_TTC_S = 1.5
"""Time to collision below which `Reward.critical` counts, s."""


@dataclass(frozen=True)
class Reward:
    """The weights of a reward: the sum of what happened in the simulator's steps of an action.

    The defaults let a drive of ten seconds at constant speed earn about 10. A collision costs as
    much as 20 s of progress earn, and standing still from the start earns 0.
    """

    progress: float = 1.0
    """Per second at the initial speed: the distance along the road, as a share of the distance at the
    initial speed (at least 1 m/s). Driving faster earns no more."""
    offset: float = -0.05
    """Per second and metre beside the centre of the lane in which the ego started."""
    braking: float = -0.5
    """Per second, times the square of the deceleration in g."""
    critical: float = -1.0
    """Per second at a time to collision below 1.5 s."""
    collision: float = -20.0
    """For a collision, which ends the episode."""
    off_road: float = -20.0
    """For leaving the drivable road, which ends the episode."""

    @classmethod
    def of(cls, weights: Mapping[str, float]) -> "Reward":
        """Return a reward with some weights in place of the defaults.

        Raises:
            UnknownComponent: If there is no such weight.
            UsageError: If a weight is not a finite number.
        """
        names = [field.name for field in fields(cls)]
        for name in weights:
            if name not in names:
                raise UnknownComponent("weight of the reward", str(name)[:80], names)
        return cls(**weights)

    def __post_init__(self) -> None:
        for field in fields(self):
            weight = finite_number(f"reward: {field.name}", getattr(self, field.name), -1e6, 1e6)
            object.__setattr__(self, field.name, weight)

    def terms(
        self,
        seconds: float,
        *,
        progress: float,
        offset_m: float,
        deceleration: float,
        ttc_s: float,
        collision: bool,
        off_road: bool,
    ) -> dict[str, float]:
        """Return the weighted terms of one step of the simulator by name.

        Args:
            seconds: Duration of the step, s.
            progress: Distance along the road as a share of that at the initial speed; above 1 counts as 1.
            offset_m: The ego's offset from the centre of the lane in which it started, m.
            deceleration: Mean deceleration during the step, m/s^2; negative if it accelerated.
            ttc_s: Least time to collision with any body at the end of the step, s.
            collision: True if the ego touches a body.
            off_road: True if it is beside the drivable road.
        """
        braking = max(0.0, deceleration) / GRAVITY
        return {
            "progress": self.progress * min(1.0, progress) * seconds,
            "offset": self.offset * abs(offset_m) * seconds,
            "braking": self.braking * braking * braking * seconds,
            "critical": self.critical * seconds if ttc_s < CRITICAL_TTC_S else 0.0,
            "collision": self.collision if collision else 0.0,
            "off_road": self.off_road if off_road else 0.0,
        }
