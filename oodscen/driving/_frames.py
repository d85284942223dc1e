"""Frames from outside: checked, and copied into arrays that no later call of the simulator changes."""

from typing import Any

import numpy as np

from oodscen.errors import SimulatorError
from oodscen.protocols import Camera, Frame


def own_frame(frame: Frame, camera: Camera, bodies: int, method: str) -> Frame:
    """Return a copy of a frame whose arrays have the types and shapes that `Frame` promises.

    A simulator may draw into the same arrays every time.

    Args:
        frame: The frame that the method returned.
        camera: The camera that it was asked for.
        bodies: Number of bodies in the scene, the ego included.
        method: The simulator's name and method, for messages.

    Raises:
        SimulatorError: If it is something else; the message names the method.
    """
    if not isinstance(frame, Frame):
        raise SimulatorError(f"{method} returned a {type(frame).__name__}, not a Frame")
    size = (camera.height, camera.width)
    _check(f"{method} returned rgb", frame.rgb, np.uint8, (*size, 3), np.uint8)
    _check(f"{method} returned depth", frame.depth, np.floating, size, np.float32)
    _check(f"{method} returned ids", frame.ids, np.integer, size, np.int32)
    if not (frame.depth > 0.0).all():
        raise SimulatorError(f"{method} returned depth that is not positive; the sky's is infinite")
    least, most = int(frame.ids.min()), int(frame.ids.max())
    if least < 0 or most > bodies:
        raise SimulatorError(
            f"{method} returned ids from {least} to {most}, not from 0 to {bodies}: "
            "0 for scenery, 1 for the ego, then the actors"
        )
    unhidden = frame.unhidden
    if unhidden is not None:
        _check(f"{method} returned unhidden", unhidden, np.integer, (bodies,), np.int32)
        unhidden = np.array(unhidden, dtype=np.int32)
    tags = frame.tags
    if tags is not None:
        _check(f"{method} returned tags", tags, np.integer, size, np.uint8)
        tags = np.array(tags, dtype=np.uint8, order="C")
    return Frame(
        rgb=np.array(frame.rgb, order="C"),
        depth=np.array(frame.depth, dtype=np.float32, order="C"),
        ids=np.array(frame.ids, dtype=np.int32, order="C"),
        unhidden=unhidden,
        tags=tags,
    )


def _check(
    subject: str, value: Any, kind: Any, shape: tuple[int, ...], copied_to: type[np.generic]
) -> None:
    """Refuse anything but an array of a kind of numbers and a shape.

    Args:
        subject: The beginning of the message.
        value: The array.
        kind: A type of numpy or an abstract one, such as `np.integer`.
        shape: Its shape.
        copied_to: The type that is promised, for the message.

    Raises:
        SimulatorError: If it is something else.
    """
    expected = f"{np.dtype(copied_to)} {shape}"
    if not isinstance(value, np.ndarray):
        raise SimulatorError(f"{subject}: a {type(value).__name__}, not {expected}")
    # numpy counts time spans among the integers.
    is_of_kind = value.dtype.kind != "m" and np.issubdtype(value.dtype, kind)
    if not is_of_kind or value.shape != shape:
        raise SimulatorError(f"{subject}: {value.dtype} {value.shape}, not {expected}")
