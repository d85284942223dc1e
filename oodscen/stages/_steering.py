"""Asking a driver for controls, wherever one drives."""

from dataclasses import replace

from oodscen._abilities import Looks, MountsCamera, WantsFrames
from oodscen._arguments import instance_of
from oodscen._members import conforming, working
from oodscen._numbers import said
from oodscen.driving._base_simulator import render_checked
from oodscen.errors import UsageError
from oodscen.protocols import Camera, Control, Driver, Simulator, State


class Steering:
    """Shows a driver what it asks for, and takes its controls.

    Args:
        driver: Is shown states and pictures if it asks for them.
        simulator: The simulator in which it drives.
        camera: Takes its pictures, if it wants some.

    Raises:
        UsageError: If what should drive is no driver.
    """

    def __init__(self, driver: Driver, simulator: Simulator, camera: Camera) -> None:
        conforming("driver", driver)
        self._driver, self._simulator, self._camera = driver, simulator, camera
        self._wants_frames = isinstance(driver, WantsFrames) and bool(driver.wants_frames)
        self._looking = driver if isinstance(driver, Looks) else None

    def control(self, state: State) -> Control:
        """Return the driver's control in the simulator's state.

        Raises:
            UsageError: If the driver returns no control of finite numbers.
            SimulatorError: If the simulator fails.
            Exception: Anything that the driver raises.
        """
        with working("simulator", self._simulator.name):
            observation = self._simulator.observe()
            if self._wants_frames:
                frame = render_checked(self._simulator, self._camera, len(state.ids))
                observation = replace(observation, frame=frame)
        if self._looking is not None:
            self._looking.look(state)
        control = self._driver.act(observation)
        if not isinstance(control, Control) or not control.is_finite:
            raise UsageError(
                f"act() returned {said(control, 200)}, not a Control of finite numbers"
            )
        return control


def own_camera(driver: Driver) -> Camera | None:
    """Return the camera that a driver mounts, if it has one.

    Raises:
        UsageError: If it mounts something else.
    """
    mounted = driver.camera if isinstance(driver, MountsCamera) else None
    if mounted is not None:
        instance_of("the driver's camera", mounted, Camera)
    return mounted
