"""Init: where every entity starts, and how fast."""

import numpy as np
from numpy.typing import NDArray

from oodscen.interchange._elements import Element, child, within
from oodscen.interchange._trajectories import world_position


def write_start(actions: Element, name: str, pose: NDArray[np.float64], speed: float) -> None:
    """Append an entity's pose and, unless it stands, its speed at the start."""
    private = child(actions, "Private", entityRef=name)
    teleport = within(private, "PrivateAction", "TeleportAction")
    world_position(child(teleport, "Position"), pose)
    if abs(speed) > 1e-9:
        write_speed(child(private, "PrivateAction"), speed)


def write_speed(action: Element, speed: float) -> None:
    """Append an immediate change of speed."""
    holder = within(action, "LongitudinalAction", "SpeedAction")
    child(holder, "SpeedActionDynamics", dynamicsShape="step", dynamicsDimension="time", value=0.0)
    child(child(holder, "SpeedActionTarget"), "AbsoluteTargetSpeed", value=float(speed))
