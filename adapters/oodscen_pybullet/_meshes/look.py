"""The appearance requested of a mesh: state, paint, lamps and animation frame."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, NamedTuple

from oodscen.data._details import Details

RED = (1.0, 0.12, 0.08)
WHITE = (1.0, 0.97, 0.86)
AMBER = (1.0, 0.62, 0.08)
BLUE = (0.25, 0.5, 1.0)
GREEN = (0.25, 1.0, 0.5)

WALKING = 1
"""First frame of a walk."""
RUNNING = 9
"""First frame of a run."""
STEPS = 8
"""Frames of a stride, and of a cycle of smoke."""
POSTURES = RUNNING + STEPS
"""Frames of one posture of a person."""
BEATS = 8
"""Frames from a pose's first key frame to the next one like it."""

Direction = Literal["ahead", "left", "right"]
_DIRECTIONS: tuple[Direction | None, ...] = (None, "ahead", "left", "right")
_BEAT = POSTURES * len(_DIRECTIONS)
"""Frames of one beat of a pose."""


def reacting(frame: int, direction: Direction) -> int:
    """Return the frame that shows a person in the same step reacting to a vehicle."""
    return frame + POSTURES * _DIRECTIONS.index(direction)


def beating(frame: int, beat: int) -> int:
    """Return the frame that shows a person in the same step in another beat of its pose."""
    return frame + _BEAT * beat


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


class Gait(NamedTuple):
    """A moment of a walk or a run."""

    phase: float
    """Completed fraction of the stride."""
    runs: bool

    def of(self, side: float, *, backwards: bool = False) -> "Gait":
        """Return the moment for a person's right (-1) or left (1) leg, and for the arm opposite to it."""
        phase = self.phase + (0.5 if side > 0 else 0.0)
        return Gait(-phase if backwards else phase, self.runs)


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
    details: Details | None = None
    """Pose, open parts ...; a design asks for the parts by name."""

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
    def gait(self) -> Gait | None:
        """The moment of the stride; `None` means standing."""
        frame = self.frame % POSTURES
        if frame < WALKING:
            return None
        return Gait((frame - WALKING) % STEPS / STEPS, frame >= RUNNING)

    @property
    def warned(self) -> Direction | None:
        """The direction of a vehicle that a person reacts to; `None` if there is none."""
        return _DIRECTIONS[self.frame // POSTURES % len(_DIRECTIONS)]

    @property
    def beat(self) -> int:
        """The frame of the cycle of a pose."""
        return self.frame // _BEAT

    def has(self, part: str) -> bool:
        """Return whether a part is in a state such as `bonnet_open`."""
        return self.details is not None and part in self.details.parts

    @property
    def cycle(self) -> float:
        """The completed fraction of a cycle of smoke."""
        return self.frame % STEPS / STEPS

    def colour(self, name: str) -> str:
        """Return a colour's name, with `paint` replaced by the paint."""
        return self.paint if name == "paint" else name

    def painted(self, paint: str) -> "Appearance":
        """Return the same look in another paint."""
        return replace(self, paint=paint)

    def applies(self, word: str, side: float) -> bool:
        """Return whether a condition of a design is met.

        Args:
            word: A state of the asset, or a lamp that is lit at this moment: `running`, `brake`,
                `beacon`, `indicator` for that of the part's own side, `indicators` for both;
                `first` and `second` are the halves of a cycle; `loaded` if it carries a load of its own.
            side: 1 for a part on the left side, -1 for its mirror image.
        """
        lights = self.lights
        lamps = {
            "running": lights.running,
            "brake": lights.brake,
            "beacon": lights.beacon,
            "indicator": lights.left if side > 0 else lights.right,
            "indicators": lights.left and lights.right,
            "first": not lights.is_second,
            "second": lights.is_second,
            "loaded": self.details is not None and bool(self.details.cargo),
        }
        return lamps.get(word, word in self.state.split("+") or self.has(word))
