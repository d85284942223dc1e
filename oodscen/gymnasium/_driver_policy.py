"""Drivers as policies of an environment."""

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from oodscen._display import Brief
from oodscen._members import conforming, working
from oodscen._registry import driver_maker
from oodscen.errors import UsageError
from oodscen.gymnasium._acting import as_action
from oodscen.protocols import Camera, Control, Driver
from oodscen.stages._steering import own_camera

if TYPE_CHECKING:
    from oodscen.gymnasium._env import SceneEnv


class DriverPolicy(Brief):
    """Lets a driver act in an environment with continuous actions, as a policy with `predict`.

    The driver sees what drivers see, the true state and its own observation, and not the observation of the
    environment. Every episode gets a new driver.

    Args:
        driver: Makes a driver, or a name that `make_driver` takes.
        env: The environment.

    Raises:
        UsageError: If the environment has discrete actions, or there is no such driver.
    """

    _repr_fields: ClassVar[tuple[str, ...]] = ("env",)

    def __init__(self, driver: Callable[[], Driver] | str, env: "SceneEnv") -> None:
        if env.interface.actions != "continuous":
            raise UsageError("a driver acts in an environment with continuous actions")
        self.env = env
        self._make = driver_maker(driver) if isinstance(driver, str) else driver
        self._driver: Driver | None = None
        self._episode: int | None = None

    def predict(
        self, observation: Any = None, *unused: Any, **ignored: Any
    ) -> tuple[NDArray[np.float32], None]:
        """Return the driver's action, and no state, as policies of stable-baselines3 do; it ignores all arguments."""
        return self(observation), None

    def __call__(self, observation: Any = None) -> NDArray[np.float32]:
        """Return the driver's action.

        Raises:
            UsageError: Before the first reset, or if the driver returns no control.
        """
        env = self.env
        if env.state is None or env.driver_observation is None:
            raise UsageError("a driver's policy: call the environment's reset() first")
        if self._driver is None or self._episode != env.episode:
            with working("driver", getattr(self._make, "__name__", type(self._make).__name__)):
                self._driver = conforming("driver", self._make())
            self._episode = env.episode
        assert self._driver is not None
        seen = env.driver_observation
        if getattr(self._driver, "wants_frames", False):
            seen = replace(seen, frame=env.look(own_camera(self._driver) or Camera()))
        if (look := getattr(self._driver, "look", None)) is not None:
            look(env.state)
        source = f"{type(self._driver).__name__}.act()"
        with working("driver", source):
            control = self._driver.act(seen)
        if not isinstance(control, Control) or not control.is_finite:
            raise UsageError(f"{source} returned {control!r:.80}, not a Control of finite numbers")
        return as_action(control)
