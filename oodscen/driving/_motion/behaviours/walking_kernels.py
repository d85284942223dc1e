"""Kernels of behaviours on foot and in the wind: each moves its actor along its own heading by one step."""

import math

from oodscen.driving._motion import columns as col
from oodscen.driving._motion.behaviours.codes import Code
from oodscen.driving._motion.bodies import Situation
from oodscen.driving._motion.lane_keeping import move, speed_up
from oodscen.numerics._exact import PI, TAU, atan2, cos, quantised, sin, sincos, wrapped
from oodscen.numerics._kernels import part

_ROUNDING = 1e-9
"""Rounding of distances gone and times waited, m or s."""


@part
def walk(w: Situation, i: int, code: int, waited: float) -> None:
    """Move along the actor's own heading once triggered."""
    distance = w.traits[i, col.DISTANCE]
    if code == Code.REVERSE:
        move(w, i, speed_up(w, i, 1.5, -w.traits[i, col.GOAL]))
    elif code == Code.WALK_ALONG:
        _go(w, i, math.inf, w.traits[i, col.QUICKNESS])
    elif code == Code.DART:
        _go(w, i, distance, max(5.0, w.traits[i, col.QUICKNESS]))
    elif code == Code.WANDER:
        _wander(w, i)
    elif code == Code.BLOWN:
        _blow(w, i, waited)
    elif code in (Code.CROSS_ROAD, Code.BOLT):
        _go(w, i, distance, w.traits[i, col.QUICKNESS])
    elif code == Code.HESITATE:
        _hesitate(w, i)
    else:
        raise ValueError("a behaviour without a kernel")


@part
def _hesitate(w: Situation, i: int) -> None:
    """Go a given distance, pause, and go back."""
    # Distances gone are rounded, and would never reach one that is not.
    state, distance = w.state, quantised(w.traits[i, col.DISTANCE])
    if state[i, col.MEMORY] < distance - _ROUNDING:
        _go(w, i, distance, w.traits[i, col.QUICKNESS])
    elif state[i, col.MEMORY + 1] < w.traits[i, col.PAUSE] - _ROUNDING:
        state[i, col.MEMORY + 1] = quantised(state[i, col.MEMORY + 1] + w.dt)
    else:
        if state[i, col.MEMORY + 2] == 0.0:
            state[i, col.MEMORY + 2] = 1.0
            state[i, col.HEADING] = quantised(wrapped(state[i, col.HEADING] + PI))
        _go(w, i, 2.0 * distance, w.traits[i, col.QUICKNESS])


@part
def _go(w: Situation, i: int, distance: float, quickness: float) -> None:
    """Go straight on for a given distance and stop there."""
    covered = speed_up(w, i, quickness, w.traits[i, col.GOAL])
    left = distance - w.state[i, col.MEMORY]
    if covered >= left:
        covered = max(left, 0.0)
        w.state[i, col.SPEED] = 0.0
    w.state[i, col.MEMORY] = quantised(w.state[i, col.MEMORY] + covered)
    move(w, i, covered)


@part
def _wander(w: Situation, i: int) -> None:
    """Walk from spot to spot around home, with a pause at every third spot.

    Successive spots follow the golden ratio and its two-dimensional counterpart, which fills the disc
    evenly without randomness.
    """
    state, traits = w.state, w.traits
    leg, spent = state[i, col.MEMORY], state[i, col.MEMORY + 1]
    origin = traits[i, col.PHASE] / TAU
    turn = origin + 0.6180339887498949 * (leg + 1.0)
    share = origin + 0.7548776662466927 * (leg + 1.0)
    sine, cosine = sincos(TAU * (turn - math.floor(turn)))
    radius = traits[i, col.RADIUS] * math.sqrt(share - math.floor(share))
    ahead = traits[i, col.HOME_S] + radius * cosine - state[i, col.S]
    aside = traits[i, col.HOME_T] + radius * sine - state[i, col.T]
    thirds = leg / 3.0
    is_pause = thirds - math.floor(thirds) > 0.5
    goal = 0.0
    if not is_pause:
        error = wrapped(atan2(aside, ahead) - state[i, col.HEADING])
        most = 2.5 * w.dt
        error = min(max(error, -most), most)
        state[i, col.HEADING] = quantised(wrapped(state[i, col.HEADING] + error))
        sine, cosine = sincos(state[i, col.HEADING])
        left = math.sqrt(ahead * ahead + aside * aside)
        goal = traits[i, col.GOAL] * max(0.0, ahead * cosine + aside * sine) / max(left, 1.0)
        is_pause = left < 0.3
        if is_pause:
            spent = 8.0
    move(w, i, speed_up(w, i, 1.5, goal))
    spent += w.dt
    if spent > (2.0 if goal == 0.0 and thirds - math.floor(thirds) > 0.5 else 8.0):
        leg, spent = leg + 1.0, 0.0
    state[i, col.MEMORY], state[i, col.MEMORY + 1] = leg, quantised(spent)


@part
def _blow(w: Situation, i: int, waited: float) -> None:
    """Roll and hop along the heading in gusts, swaying slightly."""
    state = w.state
    phase = TAU * waited / w.traits[i, col.PERIOD]
    gust = 0.65 + 0.35 * sin(phase + w.traits[i, col.PHASE])
    goal, before = w.traits[i, col.GOAL] * gust, state[i, col.SPEED]
    speed = before + min(max(goal - before, -6.0 * w.dt), 6.0 * w.dt)
    state[i, col.SPEED] = quantised(speed)
    move(w, i, 0.5 * (before + speed) * w.dt)
    sway = 0.2 * speed * sin(0.61803 * phase) * w.dt
    sine, cosine = sincos(state[i, col.HEADING])
    state[i, col.S] = quantised(state[i, col.S] - sway * sine)
    state[i, col.T] = quantised(state[i, col.T] + sway * cosine)
    state[i, col.LIFT] = quantised(w.traits[i, col.FLIGHT] * 0.5 * (1.0 - cos(phase)))
