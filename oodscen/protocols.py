"""The four protocols: all that an adapter author must read.

An `LLM` turns a request into text, an `Encoder` turns texts into vectors, a `Simulator` turns a
scene into states and frames, a `Driver` turns observations into controls. Implementations are
plain classes with these members; no base class is required. Most simulators are shorter as a
subclass of `oodscen.driving.MirrorSimulator`.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, Self, runtime_checkable

import numpy as np
from numpy.typing import NDArray
from pydantic import field_validator

from oodscen._text import whole
from oodscen.data._base import Data
from oodscen.data._catalogue import Catalogue
from oodscen.data._messages import Image, Message
from oodscen.data._scene import Scene
from oodscen.errors import UsageError

if TYPE_CHECKING:
    from oodscen.prompts._base import Prompt

__all__ = [
    "LLM",
    "Camera",
    "Completion",
    "Control",
    "Driver",
    "Encoder",
    "Frame",
    "Image",
    "Message",
    "Observation",
    "Request",
    "Simulator",
    "State",
    "Usage",
]

# ------------------------------------------------------------------ language models


@dataclass(frozen=True)
class Request:
    """One question to a language model."""

    prompt: "Prompt[Any]"
    """The typed question; clients that send text need not look at it."""
    messages: tuple[Message, ...]
    """The rendered conversation, earlier turns and repair turns included."""
    schema: dict[str, Any]
    """JSON schema of the answer."""
    sample: int = 0
    """Which of several independent draws of the same question this is."""
    attempt: int = 1
    """How often this draw has been put, this time included; above 1 the last turns ask for repair."""


class Usage(Data):
    """What one call consumed."""

    noun: ClassVar[str] = "usage"

    input_tokens: int = 0
    output_tokens: int = 0
    cached_tokens: int = 0
    """Of the input, what the provider had cached."""
    cost_usd: float | None = None
    """`None` where the price is not known."""


class Completion(Data):
    """What a language model returned."""

    noun: ClassVar[str] = "completion"

    text: str
    """Raw, as it came, but for halves of surrogate pairs: they are replaced."""
    usage: Usage = Usage()
    requests: int = 1
    """HTTP requests that were made for it, retries included; 0 for a model that needs none."""

    @field_validator("text")
    @classmethod
    def _whole(cls, text: str) -> str:
        return whole(text)


@runtime_checkable
class LLM(Protocol):
    """A language model, or a vision-language model."""

    name: str
    """What reports call it, e.g. `gpt-4o`."""

    def complete(self, request: Request) -> Completion:
        """Answer one request. May be called from several threads.

        Raises:
            LLMError: When there is no answer.
        """
        ...


# ------------------------------------------------------------------ encoders


@runtime_checkable
class Encoder(Protocol):
    """A text encoder."""

    @property
    def name(self) -> str:
        """Includes whatever decides the values: model and weights hash. A plain attribute will do."""
        ...

    @property
    def dimension(self) -> int:
        """Length of a vector. A plain attribute will do."""
        ...

    def encode(self, texts: Sequence[str]) -> NDArray[np.float32]:
        """Return one row per text, in order: [n, d] float32, always."""
        ...


# ------------------------------------------------------------------ simulators


MAX_SIZE = 8192
"""Most pixels along a side of a picture."""


@dataclass(frozen=True)
class Camera:
    """A camera on the ego, looking forward."""

    width: int = 640
    height: int = 480
    fov_deg: float = 60.0
    """Horizontal field of view."""
    x: float = 0.6
    """Forward of the ego's centre, m."""
    y: float = 0.0
    z: float = 1.4
    """Above the road, m: a dash camera by default."""
    pitch_deg: float = 2.0
    """Downwards positive."""

    def __post_init__(self) -> None:
        for name in ("width", "height"):
            size = getattr(self, name)
            if type(size) is not int or not 1 <= size <= MAX_SIZE:
                raise UsageError(f"camera: {name} must be a whole number from 1 to {MAX_SIZE}")
        for name, least, most in (("fov_deg", 1.0, 170.0), ("pitch_deg", -90.0, 90.0)):
            if not least <= getattr(self, name) <= most:
                raise UsageError(f"camera: {name} must be from {least:g} to {most:g}")
        if not all(map(math.isfinite, (self.x, self.y, self.z))):
            raise UsageError("camera: x, y and z must be finite")


@dataclass(frozen=True, eq=False)
class Frame:
    """What a camera saw."""

    rgb: NDArray[np.uint8]
    """[height, width, 3]"""
    depth: NDArray[np.float32]
    """[height, width], metres along the optical axis; infinity for the sky."""
    ids: NDArray[np.int32]
    """[height, width]: 0 for scenery and sky, 1 for the ego, 2 + i for `State.ids[1 + i]`."""
    unhidden: NDArray[np.int32] | None = None
    """[n] pixels that each body would fill if nothing stood before it, rows as in `State.ids`;
    `None` where the simulator cannot tell."""


@dataclass(frozen=True)
class Control:
    """What the ego does during one step."""

    acceleration: float = 0.0
    """m/s^2 along the vehicle; the road's friction limits it."""
    steering: float = 0.0
    """Angle of the front wheels, rad, left positive."""

    @property
    def is_finite(self) -> bool:
        """Whether both are numbers, and finite."""
        try:
            return math.isfinite(self.acceleration) and math.isfinite(self.steering)
        except TypeError:
            return False


@dataclass(frozen=True, eq=False)
class State:
    """The world after a step. Row 0 of every array is the ego."""

    step: int
    time: float
    """s since the start."""
    ids: tuple[str, ...]
    """`ego`, then the actors in the scene's order."""
    poses: NDArray[np.float64]
    """[n, 4]: x, y, z of the footprint's centre on the ground, m, and yaw, rad."""
    speeds: NDArray[np.float64]
    """[n], m/s along the heading; negative in reverse."""
    gaps: NDArray[np.float64]
    """[n], m between the ego's body and each actor's; 0 on contact, infinity for row 0 and afar."""
    off_road: bool
    """The ego left the drivable road."""
    accelerations: NDArray[np.float64] | None = None
    """[n], m/s^2 along the heading, mean over the last step; `None` where it is not known."""
    places: NDArray[np.float64] | None = None
    """[n, 2]: s and t on the scene's corridor, m; `None` where it is not known."""

    @property
    def contacts(self) -> tuple[str, ...]:
        """Ids of the actors that the ego touches."""
        return tuple(name for name, gap in zip(self.ids, self.gaps, strict=True) if gap <= 0.0)

    def fingerprint(self) -> bytes:
        """Return the bytes that two equal states share."""
        return b"".join(array.tobytes() for array in (self.poses, self.speeds, self.gaps)) + bytes(
            [self.off_road]
        )


@runtime_checkable
class Simulator(Protocol):
    """Runs scenes, one at a time, in fixed steps."""

    name: str
    dt: float
    """Seconds per step."""

    def catalogue(self) -> Catalogue:
        """Return what can be shown; static, without starting anything heavy."""
        ...

    def reset(self, scene: Scene, seed: int) -> State:
        """Load a scene; the same scene and seed give the same bytes, whatever ran before.

        Raises:
            SceneError: When the catalogue or the road refuses the scene.
            SpawnError: When one actor cannot be placed.
        """
        ...

    def step(self, control: Control) -> State:
        """Advance by exactly one `dt`. Collisions are data in the state, never exceptions."""
        ...

    def render(self, camera: Camera) -> Frame:
        """Show the current state."""
        ...

    def observe(self) -> "Observation":
        """Return what a driver is told about the current state."""
        ...

    def close(self) -> None:
        """Release everything; may be called twice."""
        ...

    def __enter__(self) -> Self: ...

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None: ...


# ------------------------------------------------------------------ drivers


@dataclass(frozen=True, eq=False)
class Observation:
    """What a driver is told."""

    time: float
    speed: float
    """Of the ego, m/s."""
    offset_m: float
    """Of the ego's centre to the left of its starting lane's centre."""
    heading_error: float
    """Of the ego against its starting lane, rad, left positive."""
    curvature: float
    """Of that lane at the look-ahead point, 1/m, left positive."""
    wheelbase: float
    lane_left_m: float | None
    """Offset of the centre of the next driving lane to the left; `None` if there is none."""
    lane_right_m: float | None
    """Offset of the centre of the next driving lane to the right (negative)."""
    roadside_m: float
    """Offset at which the ego stands clear of the lane, or as far right as the road allows."""
    friction: float
    """Scale of the road's friction."""
    visual_range_m: float = 10_000.0
    """How far a driver sees through fog, rain and snow."""
    curve_speed: float = math.inf
    """Fastest speed from which the curves ahead can be taken on a dry road, m/s."""
    frame: Frame | None = None
    """Where the driver asked for it."""


@runtime_checkable
class Driver(Protocol):
    """Controls the ego."""

    def act(self, observation: Observation) -> Control:
        """Choose the control for the next step."""
        ...
