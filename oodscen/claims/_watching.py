"""Rollouts of a scene without a reacting ego: the approach, the decision and the time after it."""

import numpy as np

from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import Scene
from oodscen.driving._motion.actions import Cruise
from oodscen.driving._motion.world import KinematicWorld
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._trace import Course, Trace

DT = 0.1
"""Time step, s."""
APPROACH_S = 15.0
"""Longest wait for the decision, s."""
AFTER_S = 6.0
"""Time to watch after the decision, s; the scene's horizon if that is shorter."""


def watch(scene: Scene, catalogue: Catalogue) -> Trace:
    """Roll out a scene with a lane-keeping ego that ignores the hazard; nothing is rendered.

    All actors move as in any simulator that mirrors the kinematic world. The ego drives through
    obstacles, so late events are also seen.

    Args:
        scene: A scene without faults by `Scene.check`.
        catalogue: The catalogue of the scene's simulator.

    Returns:
        The ground truth of every step.
    """
    corridor = load_corridor(scene.map, catalogue)
    world = KinematicWorld(corridor, scene, catalogue, 0, dt=DT)
    driver = Cruise()
    states = [world.state()]
    end = np.inf
    while world.time < end:
        if end == np.inf and (world.time >= APPROACH_S or world.is_due(scene.decision)):
            end = world.time + min(AFTER_S, scene.horizon_s)
        world.step(driver.act(world.observe()))
        states.append(world.state())
    return Trace.from_states(states, Course.of(scene, catalogue))


def decision_s(scene: Scene, trace: Trace) -> float:
    """Return the time of the decision in a trace, s; the end of the trace if the trigger never fires.

    TTC values are taken from the trace, so the result may differ by one step from a simulator's.
    """
    trigger, time = scene.decision, trace["time"][:, 0]
    if trigger.kind == "time":
        return min(trigger.value, float(time[-1]))
    if trigger.actor not in trace.ids:
        return float(time[-1])
    row = trace.ids.index(trigger.actor)
    away = np.abs(trace["s"][:, row] - trace["s"][:, 0])
    value = away if trigger.kind == "distance" else trace["ttc_s"][:, row]
    due = np.flatnonzero(value <= trigger.value)
    return float(time[due[0]]) if len(due) else float(time[-1])
