"""The observations and actions that an environment and its policies agree on."""

from typing import Any, ClassVar, Literal

from numpy.typing import NDArray

from oodscen._display import Brief
from oodscen._numbers import finite_number, whole_number
from oodscen.gymnasium._acting import action_space
from oodscen.gymnasium._observing import (
    Space,
    ego_numbers,
    neighbour_numbers,
    observation_space,
    picture,
)
from oodscen.protocols import Camera, Frame, Observation, State

ObservationKind = Literal["state", "frame", "both"]
ActionKind = Literal["continuous", "discrete"]
_CAMERA = Camera(width=128, height=96)
"""The camera of observations unless another is given."""
_USUAL_STEP_S = 0.1
"""Time for which an action holds, s, if the simulator's step divides it."""


def nearest_steps(seconds: float | None, dt: float) -> int:
    """Return the number of a simulator's steps that comes nearest to a time, or to the usual one."""
    return max(1, round((seconds or _USUAL_STEP_S) / dt))


class Interface(Brief):
    """The observations and actions of an environment, and of a policy that was trained in it.

    Args:
        observation: `state`, numbers about the ego and its neighbours; `frame`, a picture; or `both`.
        actions: `continuous`, acceleration and steering; or `discrete`, the seven actions.
        neighbours: Number of neighbours in the state.
        camera: The camera of the picture; by default the dash camera with 128 x 96 pixels.
        step_s: Time for which an action holds, s; `None` for the multiple of the simulator's step that is
            nearest to 0.1 s.

    Raises:
        UsageError: If a value is out of its range.
    """

    _repr_fields: ClassVar[tuple[str, ...]] = ("observation", "actions", "neighbours", "step_s")

    def __init__(
        self,
        observation: ObservationKind = "state",
        actions: ActionKind = "continuous",
        neighbours: int = 6,
        camera: Camera | None = None,
        step_s: float | None = None,
    ) -> None:
        self.observation = observation
        self.actions = actions
        self.neighbours = whole_number("neighbours", neighbours, 1, 200)
        self.camera = camera or _CAMERA
        self.step_s = None if step_s is None else finite_number("step_s", step_s, 0.01, 10.0)

    @property
    def observation_space(self) -> Space:
        """The Gymnasium space of the observations."""
        return observation_space(self.observation, self.neighbours, self.camera)

    @property
    def action_space(self) -> Space:
        """The Gymnasium space of the actions."""
        return action_space(self.actions)

    @property
    def wants_frames(self) -> bool:
        """True if observations have a picture."""
        return self.observation != "state"

    def observe(self, state: State, now: Observation, frame: Frame | None, source: str) -> Any:
        """Return the policy's observation of a state.

        Args:
            state: The true state.
            now: The driver's observation of it.
            frame: The picture of it; not used if observations have none.
            source: The method that made the frame, for messages.
        """
        if self.observation == "frame":
            return picture(frame, self.camera, source)
        observation: dict[str, NDArray[Any]] = {
            "ego": ego_numbers(state, now),
            "neighbours": neighbour_numbers(state, now, self.neighbours),
        }
        if self.observation == "both":
            observation["frame"] = picture(frame, self.camera, source)
        return observation
