"""Plays OpenSCENARIO files in esmini, through its library, for the benchmark of the exchange formats."""

import ctypes
import os
import pickle
import re
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

LIBRARY = os.environ.get("ESMINI_LIB", "")
"""Path of `libesminiLib.so`."""


class _ObjectState(ctypes.Structure):
    """`SE_ScenarioObjectState` of esmini 3."""

    _fields_ = (
        ("id", ctypes.c_int),
        ("model_id", ctypes.c_int),
        ("control", ctypes.c_int),
        ("timestamp", ctypes.c_double),
        *((name, ctypes.c_double) for name in ("x", "y", "z", "h", "p", "r")),
        ("road_id", ctypes.c_uint32),
        ("junction_id", ctypes.c_uint32),
        ("t", ctypes.c_double),
        ("lane_id", ctypes.c_int),
        ("lane_offset", ctypes.c_double),
        ("s", ctypes.c_double),
        ("speed", ctypes.c_double),
        *((name, ctypes.c_double) for name in ("cx", "cy", "cz", "width", "length", "height")),
        ("object_type", ctypes.c_int),
        ("object_category", ctypes.c_int),
        ("wheel_angle", ctypes.c_double),
        ("wheel_rotation", ctypes.c_double),
        ("visibility_mask", ctypes.c_int),
    )


class Played(NamedTuple):
    """What esmini made of a file."""

    names: tuple[str, ...] = ()
    time: NDArray[np.float64] = np.zeros(0)
    poses: NDArray[np.float64] = np.zeros((0, 0, 4))
    """[n, bodies, 4] x, y, z of the footprints' centres and heading."""
    speeds: NDArray[np.float64] = np.zeros((0, 0))
    started: dict[str, float] = {}
    """Time at which each storyboard element started, by name."""
    error: str = ""


def played(path: Path, dt: float, steps: int, speeds: NDArray[np.float64] | None = None) -> Played:
    """Play a file in a process of its own: esmini keeps state from one scenario to the next.

    Args:
        path: The file.
        dt: Seconds per step.
        steps: Number of steps.
        speeds: Speed of the ego at the start of every step, m/s. Without it esmini takes the mean speed of the last step.
    """
    ours, its = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(ours)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        try:
            told = pickle.dumps(_played(path, dt, steps, speeds))
        except Exception as error:
            told = pickle.dumps(Played(error=repr(error)))
        with os.fdopen(its, "wb") as out:
            out.write(told)
        os._exit(0)
    os.close(its)
    with os.fdopen(ours, "rb") as answer:
        told = answer.read()
    os.waitpid(child, 0)
    found: Played = pickle.loads(told) if told else Played(error="esmini crashed")
    return found


def _played(path: Path, dt: float, steps: int, speeds: NDArray[np.float64] | None) -> Played:
    library: Any = ctypes.CDLL(LIBRARY)
    library.SE_StepDT.argtypes = [ctypes.c_double]
    library.SE_ReportObjectSpeed.argtypes = [ctypes.c_int, ctypes.c_double]
    library.SE_GetSimulationTime.restype = ctypes.c_double
    library.SE_GetObjectName.restype = ctypes.c_char_p
    log = path.with_suffix(".log")
    words = ["esmini", "--osc", str(path.resolve()), "--headless", "--disable_stdout"]
    words += ["--logfile_path", str(log), "--traj_filter", "0.0"]
    arguments = (ctypes.c_char_p * len(words))(*[word.encode() for word in words])
    if library.SE_InitWithArgs(len(words), arguments) != 0:
        text = log.read_text(errors="replace") if log.exists() else ""
        return Played(error=text[-300:])
    ids = [library.SE_GetId(index) for index in range(library.SE_GetNumberOfObjects())]
    names = tuple(library.SE_GetObjectName(one).decode() for one in ids)
    rows, times = [_states(library, ids)], [library.SE_GetSimulationTime()]
    for step in range(steps):
        if speeds is not None:
            library.SE_ReportObjectSpeed(ids[names.index("ego")], float(speeds[step]))
        if library.SE_StepDT(dt) != 0 or library.SE_GetQuitFlag():
            break
        rows.append(_states(library, ids))
        times.append(library.SE_GetSimulationTime())
    library.SE_Close()
    table = np.array(rows)
    text = log.read_text(errors="replace")
    log.unlink()
    starts: dict[str, float] = {}
    pattern = r"^\[([\d.]+)\] \[info\] (\S+) standbyState -> startTransition"
    for time, name in re.findall(pattern, text, re.M):
        starts.setdefault(name, float(time))
    return Played(names, np.array(times), table[:, :, :4], table[:, :, 4], starts)


def _states(library: Any, ids: list[int]) -> list[list[float]]:
    rows = []
    for one in ids:
        state = _ObjectState()
        library.SE_GetObjectState(one, ctypes.byref(state))
        level = state.cx * np.cos(state.p)
        x, y = state.x + level * np.cos(state.h), state.y + level * np.sin(state.h)
        rows.append([x, y, state.z - state.cx * np.sin(state.p), state.h, state.speed])
    return rows
