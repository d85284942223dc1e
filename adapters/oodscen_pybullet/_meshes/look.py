"""The appearance requested of a mesh: state, paint, lamps and animation frame."""

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
    """The lamps of a vehicle, lit or not."""

    running: bool = False
    """True if head and tail lamps are on."""
    brake: bool = False
    left: bool = False
    right: bool = False
    beacon: bool = False
    is_second: bool = False
    """True if beacons are in the second half of their cycle."""


@dataclass(frozen=True)
class Appearance:
    """The requested appearance of one asset."""

    state: str = ""
    """A state of the asset; the suffix `+brake` also lights the brake lamps."""
    paint: str = ""
    running: bool = False
    """True if head and tail lamps are on."""
    frame: int = 0
    """Animation frame, as in `appearance.Look`."""

    @cached_property
    def lights(self) -> Lights:
        """The lit lamps."""
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
        """The index of the paint, for numbered looks."""
        return int(self.paint or 0)

    @property
    def gait(self) -> tuple[float, bool] | None:
        """The completed fraction of the stride, and whether it is a run; `None` means standing."""
        if self.frame < WALKING:
            return None
        return (self.frame - WALKING) % STEPS / STEPS, self.frame >= RUNNING

    @property
    def cycle(self) -> float:
        """The completed fraction of a cycle of smoke, of a wheel or of pedals."""
        return self.frame % STEPS / STEPS
