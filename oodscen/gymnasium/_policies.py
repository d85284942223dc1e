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

_KEYWORDS = frozenset({"deterministic", "state", "episode_start"})
_ROUNDING_S = 1e-4
"""Difference of two times of a simulator that comes of rounding, s; less than the shortest step."""


class PolicyDriver(Brief):
    """Lets a Gymnasium policy drive wherever a `Driver` does; every drive needs a new one.

    Args:
        policy: An object with `predict(observation)`, as of stable-baselines3, or a function of the
            observation. It returns an action, or a tuple that begins with one, and gets what it takes of
            `deterministic=True`, `state`, which it returned last, and `episode_start`.
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
        self._policy = _PolicyFunction(policy)
        self._decoder = ActionDecoder(actions)
        self._state: State | None = None
        self._begun_at: float | None = None

    @property
    def wants_frames(self) -> bool:
        """True if the policy sees pictures."""
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
            seen = self.interface.observe(
                self._state, observation, observation.frame, "Observation.frame"
            )
            with working("driver", self._policy.source):
                action = self._policy(seen)
            self._decoder.begin(action, observation, self._policy.source)
            self._begun_at = observation.time
        return self._decoder.control(observation)

    def _is_due(self, time: float) -> bool:
        """Return whether the last action is over; by default, the second time says how long it holds."""
        if self._begun_at is None:
            return True
        since = round(time - self._begun_at, 6)
        if self.interface.step_s is None:
            dt = max(since, _ROUNDING_S)
            self.interface.step_s = nearest_steps(None, dt) * dt
        late = since - self.interface.step_s
        if late > _ROUNDING_S:
            raise UsageError(
                f"step_s is {self.interface.step_s:g} s, not a multiple of the simulator's step"
            )
        return late >= -_ROUNDING_S


class _PolicyFunction:
    """A policy as a function from observations to actions.

    It keeps the state that a recurrent policy returned until the next call.

    Args:
        policy: An object with `predict(observation)`, or a function of the observation.

    Raises:
        UsageError: If it is neither.
    """

    def __init__(self, policy: Any) -> None:
        predict = getattr(policy, "predict", None)
        if isinstance(policy, type) or not (callable(predict) or callable(policy)):
            raise UsageError(
                f"a policy has predict() or is a function; this is {described(policy)}"
            )
        if callable(predict):
            self.source = f"{type(policy).__name__}.predict()"
            """The method that returns the actions, for messages."""
            self._function = predict
        else:
            self.source = f"{getattr(policy, '__name__', type(policy).__name__)}()"
            self._function = policy
        self._keywords = _keywords_of(self._function)
        self._memory: Any = None

    def __call__(self, observation: Any) -> Any:
        keywords: dict[str, Any] = {}
        if "deterministic" in self._keywords:
            keywords["deterministic"] = True
        if "state" in self._keywords:
            keywords["state"] = self._memory
        if "episode_start" in self._keywords:
            keywords["episode_start"] = np.array([self._memory is None])
        answer = self._function(observation, **keywords)
        if not isinstance(answer, tuple) or not answer:
            return answer
        action, *rest = answer
        self._memory = rest[0] if rest else None
        return action


def _keywords_of(function: Callable[..., Any]) -> frozenset[str]:
    """Return which of the keywords of stable-baselines3's `predict` a function takes; none if that is not known.

    A `predict` that takes any keyword passes them on.
    """
    try:
        parameters = inspect.signature(function).parameters
    except (TypeError, ValueError):
        return frozenset()
    kinds = {parameter.kind for parameter in parameters.values()}
    if inspect.Parameter.VAR_KEYWORD in kinds and getattr(function, "__name__", "") == "predict":
        return _KEYWORDS
    return _KEYWORDS & parameters.keys()
