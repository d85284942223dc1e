"""The tracks of all bodies in the simulator and in the reference world, under the same controls."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from oodscen.data._scene import Scene
from oodscen.driving._motion.world import KinematicWorld
from oodscen.driving._roads.building import load_corridor
from oodscen.protocols import Control, State
from oodscen.testing._kit.probe import Probe

START_M = 0.3
"""Tolerance of a body's place at the start, m."""
START_DEG = 5.0
"""Tolerance of its heading there, degrees."""
START_SPEED = 0.5
"""Tolerance of its speed there, m/s."""
SECONDS = 5.0
"""Length of a run, s."""
ONSET_S = 0.35
"""Tolerance of the time at which a trigger shows in an actor's motion, s."""
_STRAY_M = 0.15
"""Distance from its uniform motion at which a body has left it, m."""


@dataclass(frozen=True)
class Tracks:
    """The motion of all bodies in a run."""

    dt: float
    poses: NDArray[np.float64]
    """[steps, n, 4] x, y, z (m) and heading (rad)."""
    speeds: NDArray[np.float64]
    """[steps, n] m/s."""

    @classmethod
    def of(cls, states: Sequence[State], dt: float) -> "Tracks":
        """Return the tracks of a run."""
        return cls(dt, np.stack([s.poses for s in states]), np.stack([s.speeds for s in states]))

    def onset(self, row: int) -> float | None:
        """Return the time at which a body leaves its initial uniform motion, s."""
        first, speed = self.poses[0, row], self.speeds[0, row]
        times = self.dt * np.arange(len(self.poses))
        velocity = np.stack([np.cos(first[3]), np.sin(first[3])]) * speed
        uniform = first[:2] + times[:, None] * velocity
        offsets = np.linalg.norm(self.poses[:, row, :2] - uniform, axis=1)
        strayed = np.flatnonzero(offsets > _STRAY_M)
        return float(times[strayed[0]]) if len(strayed) else None


def run_both(
    probe: Probe,
    scene: Scene,
    control: Callable[[float], Control],
    *,
    seconds: float = SECONDS,
) -> tuple[Tracks, Tracks]:
    """Run a scene in the simulator and in the reference world, under controls by time."""
    dt = probe.simulator.dt
    steps = round(seconds / dt)
    states = [probe.simulator.reset(scene, 0)]
    world = KinematicWorld(
        load_corridor(scene.map, probe.catalogue), scene, probe.catalogue, 0, dt=dt
    )
    poses, speeds = [world.poses()], [world.speeds()]
    for step in range(steps):
        command = control(step * dt)
        states.append(probe.simulator.step(command))
        world.step(command)
        poses.append(world.poses())
        speeds.append(world.speeds())
    return Tracks.of(states, dt), Tracks(dt, np.stack(poses), np.stack(speeds))


def start_fault(tracks: Tracks, reference: Tracks, row: int) -> str:
    """Return how a body's start differs from the reference world's; empty if it does not."""
    offset_m = float(np.linalg.norm(tracks.poses[0, row, :2] - reference.poses[0, row, :2]))
    if not offset_m <= START_M:
        return f"starts {offset_m:.1f} m from its place"
    turn_deg = turned_by(float(tracks.poses[0, row, 3]), float(reference.poses[0, row, 3]))
    if not abs(turn_deg) <= START_DEG:
        return f"starts with a heading {turn_deg:.0f} degrees off"
    speed, expected = float(tracks.speeds[0, row]), float(reference.speeds[0, row])
    if not abs(speed - expected) <= START_SPEED:
        return f"starts at {speed:.1f} m/s, not {expected:.1f}"
    return ""


def turned_by(heading: float, reference: float) -> float:
    """Return the turn from a reference heading to another, both in rad, in degrees."""
    return math.degrees(math.remainder(heading - reference, math.tau))
