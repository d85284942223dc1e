"""Policies as drivers."""

import inspect
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np

from oodscen._arguments import checked
from oodscen._display import Brief
from oodscen._members import described, working
from oodscen.errors import UsageError
from oodscen.gymnasium._acting import ActionDecoder
from oodscen.gymnasium._interface import ActionKind, Interface, ObservationKind, nearest_steps
from oodscen.protocols import Camera, Control, Observation, State

_ROUNDING_S = 1e-4
"""Difference of two times of a simulator that comes of rounding, s; less than the shortest step."""


class PolicyDriver(Brief):
    """Lets a Gymnasium policy drive wherever a `Driver` does; every drive needs a new one.

    Args:
        policy: An object with `predict(observation)`, as of stable-baselines3, or a function of the
            observation. It returns an action, or a tuple that begins with one; a recurrent `predict` gets its
            state back.
        observation: As in the environment in which the policy was trained.
        actions: As there.
        neighbours: As there.
        camera: As there.
        step_s: As there.

    Raises:
        UsageError: If the policy is neither, or an argument makes no sense.
    """

    _repr_fields: ClassVar[tuple[str, ...]] = ("interface",)

    @checked
    def __init__(
        self,
        policy: Any,
        *,
        observation: ObservationKind = "state",
        actions: ActionKind = "continuous",
        neighbours: int = 6,
        camera: Camera | None = None,
        step_s: float | None = None,
    ) -> None:
        self.interface = Interface(observation, actions, neighbours, camera, step_s)
        self._ask, self._source = _asked(policy)
        self._steerer = ActionDecoder(actions)
        self._state: State | None = None
        self._begun: float | None = None

    @property
    def wants_frames(self) -> bool:
        """Return whether the policy sees pictures."""
        return self.interface.wants_frames

    @property
    def camera(self) -> Camera:
        """The camera of these pictures."""
        return self.interface.camera

    def look(self, state: State) -> None:
        """Take the true state."""
        self._state = state

    def act(self, observation: Observation) -> Control:
        """Return the control of the policy's action, which holds for `step_s`.

        Raises:
            UsageError: If the policy fails, or returns something that is not an action; or if `step_s` is not
                a multiple of the simulator's step.
        """
        if self._state is None:
            raise UsageError("PolicyDriver.act(): call look(state) first")
        if self._is_due(observation.time):
            seen = self.interface.observed(
                self._state, observation, observation.frame, "Observation.frame"
            )
            with working("driver", self._source):
                action = self._ask(seen)
            self._steerer.begin(action, observation, self._source)
            self._begun = observation.time
        return self._steerer.control(observation)

    def _is_due(self, time: float) -> bool:
        """Return whether the last action is over; by default, the second time says how long it holds."""
        if self._begun is None:
            return True
        since = round(time - self._begun, 6)
        if self.interface.step_s is None:
            dt = max(since, _ROUNDING_S)
            self.interface.step_s = nearest_steps(None, dt) * dt
        late = since - self.interface.step_s
        if late > _ROUNDING_S:
            raise UsageError(
                f"step_s is {self.interface.step_s:g} s, not a multiple of the simulator's step"
            )
        return late >= -_ROUNDING_S


def _asked(policy: Any) -> tuple[Callable[[Any], Any], str]:
    """Return a function from observations to actions, and its name."""
    method = getattr(policy, "predict", None)
    if isinstance(policy, type) or not (callable(method) or callable(policy)):
        raise UsageError(f"a policy has predict() or is a function; this is {described(policy)}")
    if not callable(method):
        name = getattr(policy, "__name__", type(policy).__name__)
        return lambda seen: _first(policy(seen))[0], f"{name}()"
    try:
        known = set(inspect.signature(method).parameters)
    except (TypeError, ValueError):
        known = set()
    memory: list[Any] = [None]

    def ask(seen: Any) -> Any:
        given: dict[str, Any] = {"deterministic": True} if "deterministic" in known else {}
        if "state" in known:
            given["state"] = memory[0]
        if "episode_start" in known:
            given["episode_start"] = np.array([memory[0] is None])
        action, memory[0] = _first(method(seen, **given))
        return action

    return ask, f"{type(policy).__name__}.predict()"


def _first(answer: Any) -> tuple[Any, Any]:
    """Return an action and a policy's state, which may be missing."""
    if isinstance(answer, tuple) and answer:
        return answer[0], answer[1] if len(answer) > 1 else None
    return answer, None
