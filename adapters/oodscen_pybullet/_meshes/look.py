"""What a mesh is asked for: state, paint, lamps and the moment."""

from dataclasses import dataclass
from functools import cached_property

WALKING = 1
"""First frame of a walk."""
RUNNING = 9
"""First frame of a run."""
STEPS = 8
"""Frames of a stride, and of a cycle of smoke."""


@dataclass(frozen=True)
class Lights:
    """Which lamps of a vehicle are on."""

    running: bool = False
    """Head and tail lamps."""
    brake: bool = False
    left: bool = False
    right: bool = False
    beacon: bool = False
    is_second: bool = False
    """Whether beacons are in the second half of their cycle."""


@dataclass(frozen=True)
class Shown:
    """How one asset is shown."""

    state: str = ""
    """One of the asset's states; `+brake` after it lights the brake lamps as well."""
    paint: str = ""
    running: bool = False
    """Whether head and tail lamps are on."""
    frame: int = 0
    """As in `cast.Look`."""

    @cached_property
    def lights(self) -> Lights:
        """The lamps that are lit."""
        words = self.state.split("+")
        is_lit = self.frame % 2 == 0
        return Lights(
            running=self.running,
            brake="brake" in words,
            left=is_lit and ("hazard" in words or "indicate_left" in words),
            right=is_lit and ("hazard" in words or "indicate_right" in words),
            beacon="beacon" in words,
            is_second=not is_lit,
        )

    @property
    def index(self) -> int:
        """The paint as a number, for looks that are numbered."""
        return int(self.paint or 0)

    @property
    def gait(self) -> tuple[float, bool] | None:
        """The share of the stride that is done, and whether at a run; `None` stands."""
        if self.frame < WALKING:
            return None
        return (self.frame - WALKING) % STEPS / STEPS, self.frame >= RUNNING

    @property
    def cycle(self) -> float:
        """The share of a cycle of smoke, of a wheel or of pedals that is done."""
        return self.frame % STEPS / STEPS
