"""Observations of an environment: numbers about the ego and its neighbours, and frames."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from oodscen.errors import SimulatorError
from oodscen.gymnasium._extra import gymnasium
from oodscen.protocols import Camera, Frame, Observation, State

EGO = (
    ("speed", 40.0),
    ("offset", 10.0),
    ("heading_error", math.pi),
    ("curvature", 0.2),
    ("acceleration", 10.0),
    ("lane_left", 10.0),
    ("lane_right", 10.0),
    ("roadside", 10.0),
    ("friction", 1.0),
    ("visual_range", 200.0),
    ("curve_speed", 40.0),
)
"""Numbers about the ego, and the value that becomes 1; larger ones are cut off."""
NEIGHBOUR = (
    ("present", 1.0),
    ("ahead", 100.0),
    ("left", 20.0),
    ("along", 100.0),
    ("across", 20.0),
    ("speed_ahead", 40.0),
    ("speed_left", 40.0),
    ("cos_heading", 1.0),
    ("sin_heading", 1.0),
    ("gap", 60.0),
)
"""Numbers about a neighbour, and the value that becomes 1; larger ones are cut off."""
_EGO_SCALE = np.array([scale for _, scale in EGO])
_NEIGHBOUR_SCALE = np.array([scale for _, scale in NEIGHBOUR])

Space = Any
"""A Gymnasium space of any kind; its own classes are generic in ways that a name cannot express."""


def observation_space(kind: str, neighbours: int, camera: Camera) -> Space:
    """Return the space of a kind of observation: `state`, `frame` or `both`."""
    spaces = gymnasium.spaces
    frame = spaces.Box(0, 255, (camera.height, camera.width, 3), np.uint8)
    if kind == "frame":
        return frame
    state: dict[str, Space] = {
        "ego": spaces.Box(-1.0, 1.0, (len(EGO),), np.float32),
        "neighbours": spaces.Box(-1.0, 1.0, (neighbours, len(NEIGHBOUR)), np.float32),
    }
    return spaces.Dict(state if kind == "state" else {**state, "frame": frame})


def ego_numbers(state: State, now: Observation) -> NDArray[np.float32]:
    """Return the numbers about the ego, scaled to -1..1; 0 for a lane that does not exist."""
    accelerations = state.accelerations
    values = {
        "speed": now.speed,
        "offset": now.offset_m,
        "heading_error": now.heading_error,
        "curvature": now.curvature,
        "acceleration": 0.0 if accelerations is None else accelerations[0],
        "lane_left": 0.0 if now.lane_left_m is None else now.lane_left_m - now.offset_m,
        "lane_right": 0.0 if now.lane_right_m is None else now.lane_right_m - now.offset_m,
        "roadside": now.roadside_m - now.offset_m,
        "friction": now.friction,
        "visual_range": now.visual_range_m,
        "curve_speed": now.curve_speed,
    }
    return _scaled(np.array([values[name] for name, _ in EGO]), _EGO_SCALE)


def neighbour_numbers(state: State, now: Observation, most: int) -> NDArray[np.float32]:
    """Return the numbers about the nearest bodies within the visual range, nearest first.

    [most, 10], scaled to -1..1; rows of zeros for absent bodies. Ahead and left are in the ego's axes, along
    and across on the road; speeds are relative to the ego's.
    """
    numbers = np.zeros((most, len(NEIGHBOUR)), np.float32)
    offsets = state.poses[1:, :2] - state.poses[0, :2]
    squares = offsets[:, 0] * offsets[:, 0] + offsets[:, 1] * offsets[:, 1]
    near = np.argsort(squares, kind="stable")[:most]
    near = near[squares[near] <= now.visual_range_m * now.visual_range_m]
    rows = near + 1
    yaw = float(state.poses[0, 3])
    cos, sin = math.cos(yaw), math.sin(yaw)
    x, y = offsets[near, 0], offsets[near, 1]
    ahead, left = x * cos + y * sin, y * cos - x * sin
    along, across = ahead, left
    if state.places is not None:
        along, across = (state.places[rows] - state.places[0]).T
    turns, speeds = state.poses[rows, 3] - yaw, state.speeds[rows]
    cos_heading, sin_heading = np.cos(turns), np.sin(turns)
    values = {
        "present": np.ones(len(rows)),
        "ahead": ahead,
        "left": left,
        "along": along,
        "across": across,
        "speed_ahead": speeds * cos_heading - state.speeds[0],
        "speed_left": speeds * sin_heading,
        "cos_heading": cos_heading,
        "sin_heading": sin_heading,
        "gap": state.gaps[rows],
    }
    columns = np.stack([values[name] for name, _ in NEIGHBOUR], axis=1)
    numbers[: len(rows)] = _scaled(columns, _NEIGHBOUR_SCALE)
    return numbers


def picture(frame: Frame | None, camera: Camera, source: str) -> NDArray[np.uint8]:
    """Return the colours of a frame.

    Raises:
        SimulatorError: If it has another shape or type than the camera's.
    """
    rgb = getattr(frame, "rgb", None)
    shape = (camera.height, camera.width, 3)
    if not isinstance(rgb, np.ndarray):
        raise SimulatorError(f"{source} gave a picture of {rgb!r:.80}, not of uint8 {list(shape)}")
    if rgb.shape != shape or rgb.dtype != np.uint8:
        raise SimulatorError(
            f"{source} gave a picture of {rgb.dtype} {list(rgb.shape)}, not of uint8 {list(shape)}"
        )
    return rgb


def _scaled(values: NDArray[np.float64], scale: NDArray[np.float64]) -> NDArray[np.float32]:
    return np.clip(values / scale, -1.0, 1.0).astype(np.float32)
