"""The four protocols that an adapter implements: `LLM`, `Encoder`, `Simulator` and `Driver`.

An `LLM` turns a request into text, an `Encoder` turns texts into vectors, a `Simulator` turns a scene into states and
frames, and a `Driver` turns observations into controls. Implementations are plain classes with these members; no base
class is required. Simulators are shorter as subclasses of `oodscen.driving.DynamicSimulator`, if they own motion, or of
`MirrorSimulator`, if they only draw. An adapter may import this module, `oodscen.driving`, `oodscen.data`,
`oodscen.errors`, and the other public names that docs/api.md lists.

Simulators and drivers may have further members, which docs/adapters.md and docs/judging.md list: what has one has the
ability. Units are SI: metres, seconds, radians, unless a name ends in `_deg`. Axes are those of ISO 8855: x forward,
y to the left, z up; angles and curvatures are positive to the left (counter-clockwise).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, Protocol, Self, runtime_checkable

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_validator

from oodscen._display import Brief, png
from oodscen._field_docs import with_fields
from oodscen._numbers import finite_number, whole_number
from oodscen._words.text import whole
from oodscen.data._base import Data
from oodscen.data._catalogue import Catalogue
from oodscen.data._messages import Image, Message
from oodscen.data._scene import Scene

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
    "Observation",
    "Request",
    "Simulator",
    "State",
    "Usage",
]


@dataclass(frozen=True, repr=False)
class Request(Brief):
    """One question to a language model."""

    prompt: "Prompt[Any]"
    """The typed question; clients that send text may ignore it."""
    messages: tuple[Message, ...]
    """The rendered conversation, including earlier turns and repair turns."""
    schema: dict[str, Any]
    """JSON schema of the answer."""
    sample: int = 0
    """Index of this draw among several independent draws of the same question."""
    attempt: int = 1
    """Number of this try of the draw, counted from 1; above 1, the last turns ask for a repair."""
    repeat: int = 0
    """Number of answers to this very request that were of no use and are asked for again."""


class Usage(Data):
    """The tokens and the cost of one call."""

    input_tokens: int = 0
    """0 if the number is not known."""
    output_tokens: int = 0
    """0 if the answer is empty, or the number is not known."""
    cached_tokens: int = 0
    """Input tokens that the provider had cached."""
    cost_usd: float | None = None
    """`None` if it is not known."""


InsteadOfText = Literal["a tool call", "reasoning"]
"""The part of a response that can stand in place of a text."""


class Completion(Data):
    """A language model's response to one request."""

    text: str
    """The raw response text; only lone surrogates are replaced, and the end of a text that is too long to be read."""
    usage: Usage = Usage()
    requests: int = Field(default=1, ge=0)
    """HTTP requests made for this completion, including retries; 0 for a model that makes none."""
    is_cut_off: bool = False
    """True if the text ends because a limit on its length was reached."""
    instead: InsteadOfText | None = None
    """The part of the response that stood in place of a text, if there was none."""
    answered_by: str | None = None
    """Name of the model that answered, if the one that was asked passes questions on, as a fallback does."""

    @field_validator("text")
    @classmethod
    def _whole(cls, text: str) -> str:
        return whole(text)


@runtime_checkable
class LLM(Protocol):
    """A language model or vision-language model.

    Optional members: `price`, a tuple of USD per million tokens of input and of output;
    `speaks_for`, the name of the model whose words this one repeats, as a replay does.
    """

    name: str
    """The model's name in reports, e.g. `gpt-4o`."""

    def complete(self, request: Request) -> Completion:
        """Answer one request. May be called from several threads.

        Raises:
            LLMError: If there is no answer.
        """
        ...


@runtime_checkable
class Encoder(Protocol):
    """A text encoder.

    Optional member: `cacheable`, true if vectors may be stored on disk under `name`.
    """

    @property
    def name(self) -> str:
        """Name that identifies the values: model and hash of the weights. May be a plain attribute."""
        ...

    @property
    def dimension(self) -> int:
        """Length of a vector. May be a plain attribute."""
        ...

    def encode(self, texts: Sequence[str]) -> NDArray[np.float32]:
        """Return one row per text, in order: always [n, d] float32.

        Raises:
            EncoderError: If there are no vectors.
        """
        ...


MAX_AWAY_M = 1e6
"""Greatest distance of a camera from the ego along an axis, m."""
MAX_SIZE = 8192
"""Maximum pixels along a side of a picture."""
_ABOVE_M = 85.0
"""Length of road in a picture from above, m."""


@with_fields
@dataclass(frozen=True)
class Camera:
    """A pinhole camera that moves with the ego, looking forward unless `pitch_deg` or `yaw_deg` turns it.

    Pixels are square. Positions are relative to the centre of the ego's footprint and turn with its yaw.
    """

    width: int = 640
    height: int = 480
    fov_deg: float = 60.0
    """Horizontal field of view, degrees."""
    x: float = 0.6
    """Distance ahead of the ego's centre, m."""
    y: float = 0.0
    """Distance to the left of the ego's centre, m."""
    z: float = 1.4
    """Height above the road, m; the default is a dash camera's."""
    pitch_deg: float = 2.0
    """Pitch, degrees, downwards positive."""
    yaw_deg: float = 0.0
    """Direction relative to the ego's heading, degrees, left positive; 0 looks forward, 180 back."""

    @classmethod
    def above(
        cls, width: int = 640, height: int = 480, *, x: float = 32.5, z: float | None = None
    ) -> "Camera":
        """Return a camera that looks straight down; the ego's direction is up in its pictures.

        Its pictures reach from 10 m behind the ego to 75 m ahead by default: most hazards are staged within 72 m.

        Args:
            width: Width of the picture, pixels.
            height: Height of the picture, pixels.
            x: Distance of the picture's middle ahead of the ego's centre, m.
            z: Height above the road, m; the picture's width shows 1.15 times as many metres. By default as high as
                the picture needs to show 85 m along the road, which is 98 m for 640 x 480 pixels.
        """
        fov_deg = 60.0
        if z is None:
            width = whole_number("camera: width", width, 1, MAX_SIZE)
            height = whole_number("camera: height", height, 1, MAX_SIZE)
            z = 0.5 * _ABOVE_M * width / height / math.tan(0.5 * math.radians(fov_deg))
        return cls(width, height, fov_deg, x, 0.0, z, 90.0)

    def __post_init__(self) -> None:
        # They are Python's own numbers: products of numpy's small ones overflow.
        own: dict[str, float] = {
            name: whole_number(f"camera: {name}", getattr(self, name), 1, MAX_SIZE)
            for name in ("width", "height")
        }
        for name, least, most in (
            ("fov_deg", 1.0, 170.0),
            ("pitch_deg", -90.0, 90.0),
            ("yaw_deg", -180.0, 180.0),
            *((axis, -MAX_AWAY_M, MAX_AWAY_M) for axis in ("x", "y", "z")),
        ):
            own[name] = finite_number(f"camera: {name}", getattr(self, name), least, most)
        for name, number in own.items():
            object.__setattr__(self, name, number)

    def behind(self) -> "Camera":
        """Return a camera with as many pixels that looks back from the rear window."""
        return Camera(self.width, self.height, x=-2.0, z=1.2, pitch_deg=4.0, yaw_deg=180.0)


def camera_for(catalogue: Catalogue, camera: Camera | None = None) -> Camera:
    """Return a camera that a simulator can draw with.

    Args:
        catalogue: The simulator's catalogue.
        camera: The wanted camera; a simulator that sees from above only keeps its size.
    """
    if catalogue.camera == "top" and (camera is None or camera.pitch_deg != 90.0):
        return Camera.above(camera.width, camera.height) if camera else Camera.above()
    return camera or Camera()


@with_fields
@dataclass(frozen=True, eq=False, repr=False)
class Frame(Brief):
    """One camera picture with depth and instance ids."""

    rgb: NDArray[np.uint8]
    """[height, width, 3]"""
    depth: NDArray[np.float32]
    """[height, width], metres along the optical axis; infinity for the sky."""
    ids: NDArray[np.int32]
    """[height, width]: 0 for scenery and sky, 1 for the ego, 2 + i for `State.ids[1 + i]`."""
    unhidden: NDArray[np.int32] | None = None
    """[n] pixels that each body would fill if nothing occluded it, rows as in `State.ids`;
    `None` if the simulator cannot tell."""
    tags: NDArray[np.uint8] | None = None
    """[height, width] semantic class of scenery and sky, with the numbers of `carla.CityObjectLabel`
    (1 roads, 2 sidewalks, 3 buildings ...; CARLA 0.9.14 and later), 0 for bodies and the unknown;
    `None` if the simulator cannot tell."""

    def _repr_png_(self) -> bytes | None:
        return png(self.rgb)


@with_fields
@dataclass(frozen=True)
class Control:
    """The ego's control input for one step. The simulator limits it to what the tyres can transmit."""

    acceleration: float = 0.0
    """Acceleration along the vehicle, m/s^2; braking ends at a standstill and never reverses."""
    steering: float = 0.0
    """Front wheel angle, rad, left positive."""

    @property
    def is_finite(self) -> bool:
        """Return whether both values are finite numbers."""
        try:
            return math.isfinite(self.acceleration) and math.isfinite(self.steering)
        except (TypeError, ValueError, OverflowError):
            return False


@with_fields
@dataclass(frozen=True, eq=False, repr=False)
class State(Brief):
    """The world after a step. Row 0 of every array is the ego."""

    step: int
    time: float
    """Seconds since the start."""
    ids: tuple[str, ...]
    """`ego`, then the actors in the scene's order."""
    poses: NDArray[np.float64]
    """[n, 4]: x, y, z of the footprint's centre on the ground, m, and yaw, rad."""
    speeds: NDArray[np.float64]
    """[n], m/s along the heading; negative in reverse."""
    gaps: NDArray[np.float64]
    """[n], m between the ego's box and each actor's, as the catalogue sizes them; 0 exactly on contact,
    infinity for row 0, beyond about 60 m, and for bodies that can be driven over or through."""
    off_road: bool
    """True if any part of the ego's footprint is beside the drivable road."""
    accelerations: NDArray[np.float64] | None = None
    """[n], m/s^2 along the heading, averaged over the last step; `None` if unknown."""
    places: NDArray[np.float64] | None = None
    """[n, 2]: s along the scene's corridor and t to its left, m; `None` if unknown."""

    @property
    def contacts(self) -> tuple[str, ...]:
        """Ids of the actors that the ego is touching."""
        return tuple(name for name, gap in zip(self.ids, self.gaps, strict=True) if gap <= 0.0)

    def fingerprint(self) -> bytes:
        """Return bytes that are the same for equal states."""
        arrays = (self.poses, self.speeds, self.gaps, np.array(self.off_road, bool))
        return b"".join(array.tobytes() for array in arrays)


@runtime_checkable
class Simulator(Protocol):
    """Runs scenes, one at a time and in one thread at a time, in fixed steps.

    The same scene, seed and controls give the same bytes, whatever ran before. Nothing expensive
    starts before the first `reset`. `step`, `render` and `observe` follow a `reset`.

    Optional members: `snapshot` with `restore`, `rehearse`, and `check`; docs/adapters.md has their signatures.
    """

    name: str
    dt: float
    """Seconds per step."""

    def catalogue(self) -> Catalogue:
        """Return the simulator's vocabulary; static data, without starting anything heavy."""
        ...

    def reset(self, scene: Scene, seed: int) -> State:
        """Load a scene and return its first state, at time 0.

        Args:
            scene: The scene; the ego starts where its map says.
            seed: The seed of everything random in the scene.

        Raises:
            SceneError: If the catalogue or the road refuses the scene.
            SpawnError: If an actor cannot be placed.
        """
        ...

    def step(self, control: Control) -> State:
        """Advance by exactly one `dt`.

        Collisions and leaving the road are reported in the state, never raised. The caller ends the
        run; until then the bodies keep moving as if they had not touched.
        """
        ...

    def render(self, camera: Camera) -> Frame:
        """Render the current state, which does not change it."""
        ...

    def observe(self) -> "Observation":
        """Return the driver's observation of the current state."""
        ...

    def close(self) -> None:
        """Release all resources; may be called twice."""
        ...

    def __enter__(self) -> Self: ...

    def __exit__(self, *error: object) -> None: ...


@with_fields
@dataclass(frozen=True, eq=False, repr=False)
class Observation(Brief):
    """The input of a driver. Offsets are from the centre of the lane in which the ego started."""

    time: float
    """Seconds since the start."""
    speed: float
    """The ego's speed, m/s."""
    offset_m: float
    """Offset of the ego's centre, m, left positive."""
    heading_error: float
    """Heading of the ego relative to that lane, rad, left positive."""
    curvature: float
    """Curvature of that lane 0.2 s ahead, at least 1 m, in 1/m, left positive."""
    wheelbase: float
    """Distance between the ego's axles, m."""
    lane_left_m: float | None
    """Offset of the driving lane to the left of the ego's current one, m, oncoming lanes included;
    `None` if there is none."""
    lane_right_m: float | None
    """Offset of the driving lane to the right of the ego's current one, m; `None` if there is none."""
    roadside_m: float
    """Offset at which a stopped ego stands 0.2 m to the right of all driving lanes, m, or as far to the
    right as the drivable road allows, 0.25 m from its edge."""
    friction: float
    """Friction scale of the road; 1 is dry asphalt."""
    visual_range_m: float = 10_000.0
    """Distance that a driver can see through fog, rain and snow, m."""
    curve_speed: float = math.inf
    """Fastest current speed from which a driver can still slow down for the curves ahead on a dry
    road, at 60 % of the grip in a curve, m/s."""
    frame: Frame | None = None
    """The camera picture; `None` unless the driver requests frames."""


@runtime_checkable
class Driver(Protocol):
    """Controls the ego in one episode; every episode gets a new driver.

    Optional members: `look(state)`, which is given the true state before every `act`; `wants_frames`, true to get the
    camera's picture with every observation; `camera`, a `Camera` to take in place of the dash camera.
    """

    def act(self, observation: Observation) -> Control:
        """Return the control for the next step."""
        ...
