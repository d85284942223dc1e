"""Kernels of behaviours in a lane: each moves its actor by one step."""

import math

from oodscen.driving._motion import columns as col
from oodscen.driving._motion.behaviours.codes import Code
from oodscen.driving._motion.bodies import Situation
from oodscen.driving._motion.car_following import (
    change_lane,
    cruise,
    desired_speed,
    idm_acceleration,
)
from oodscen.driving._motion.lane_keeping import (
    accelerate,
    grip,
    keep_lane,
    move,
    sideways_rate,
    smooth,
    speed_up,
)
from oodscen.driving._roads.track import centre, drivable_range
from oodscen.numerics._exact import PI, TAU, quantised, sin, wrapped
from oodscen.numerics._kernels import part

_PASSED_M = 15.0
"""Lead over the ego at which an overtaking actor moves back, m."""


@part
def drive(w: Situation, i: int, code: int, waited: float) -> None:
    """Move an actor along its lane by one step; `waited` is the time since its trigger, negative before."""
    traits = w.traits
    if code == Code.WRONG_WAY:
        keep_lane(w, i, speed_up(w, i, 2.0, desired_speed(w, i)), 0.0, 0.0)
    elif code in (Code.CUT_IN, Code.CUT_OUT):
        # An actor that cuts out knows the obstacle and means to pass it: only traffic counts.
        slowest = 0.5 if code == Code.CUT_OUT else -math.inf
        change_lane(w, i, _towards_target(w, i, waited), 0.0, 1.2, slowest)
    elif code in (Code.HARD_BRAKE, Code.STALL) and waited >= 0.0:
        keep_lane(w, i, accelerate(w, i, -traits[i, col.DECELERATION]), 0.0, 0.0)
    elif code == Code.HALT and waited >= 0.0:
        _halt(w, i, waited)
    elif code == Code.STOP_AND_GO and waited >= 0.0:
        _stop_and_go(w, i, waited)
    elif code in (Code.SWERVE, Code.WOBBLE):
        cruise(w, i, _weave(w, i, waited))
    elif code == Code.PULL_OUT:
        if waited >= 0.0:
            blend = _towards_target(w, i, waited)
            # A driver who leaves a row of parked vehicles means to pass them: only traffic counts.
            slowest = -math.inf if blend >= 1.0 else 0.5
            acceleration = idm_acceleration(w, i, desired_speed(w, i), 1.2, slowest)
            keep_lane(w, i, accelerate(w, i, min(2.0, acceleration)), blend, 0.0)
    elif code == Code.DRIFT and waited > 0.0:
        cruise(w, i, _within_road(w, i, traits[i, col.LATERAL] * waited))
    elif code == Code.OVERTAKE:
        _overtake(w, i, waited)
    elif code == Code.FOLLOW_LANE:
        acceleration = idm_acceleration(
            w, i, desired_speed(w, i), traits[i, col.HEADWAY], -math.inf
        )
        keep_lane(w, i, accelerate(w, i, max(acceleration, -traits[i, col.DECELERATION])), 0.0, 0.0)
    elif code in (
        Code.HARD_BRAKE,
        Code.STALL,
        Code.HALT,
        Code.STOP_AND_GO,
        Code.U_TURN,
        Code.DRIFT,
    ):  # Before the trigger.
        cruise(w, i, 0.0)
    else:
        raise ValueError("a behaviour without a kernel")


@part
def _towards_target(w: Situation, i: int, waited: float) -> float:
    """Return how far a lane change has come, from 0 to 1.

    The first memory column holds its progress before it is smoothed.
    """
    progress = w.state[i, col.MEMORY]
    if waited > 0.0:
        s = w.state[i, col.S]
        shift = centre(w.track, w.codes[i, col.TARGET], s)
        shift -= centre(w.track, w.codes[i, col.LANE], s) + w.traits[i, col.OFFSET]
        progress += w.dt * sideways_rate(w, i, shift, w.traits[i, col.DURATION])
        w.state[i, col.MEMORY] = quantised(min(1.0, progress))
    return smooth(progress)


@part
def _halt(w: Situation, i: int, waited: float) -> None:
    """Brake until it stands, wait for the pause, and drive on.

    The first memory column holds the time at which the pause begins, s; 0 before. A driver whom traffic stops earlier
    than its own braking would have begins it no earlier.
    """
    braking, begun = w.traits[i, col.DECELERATION], w.state[i, col.MEMORY]
    if begun == 0.0 and w.state[i, col.SPEED] == 0.0:
        begun = max(w.traits[i, col.GOAL] / braking, waited - w.dt)
        w.state[i, col.MEMORY] = begun
    if begun > 0.0 and waited >= begun + w.traits[i, col.PAUSE]:
        cruise(w, i, 0.0)
    else:
        acceleration = min(-braking, idm_acceleration(w, i, desired_speed(w, i), 1.2, -math.inf))
        keep_lane(w, i, accelerate(w, i, acceleration), 0.0, 0.0)


@part
def _stop_and_go(w: Situation, i: int, waited: float) -> None:
    """Brake in the first half of every period, and drive in the second."""
    cycles = waited / w.traits[i, col.PERIOD]
    if cycles - math.floor(cycles) >= 0.5:
        cruise(w, i, 0.0)
    else:
        acceleration = min(-2.5, idm_acceleration(w, i, w.traits[i, col.GOAL], 1.2, -math.inf))
        keep_lane(w, i, accelerate(w, i, acceleration), 0.0, 0.0)


@part
def _weave(w: Situation, i: int, waited: float) -> float:
    """Return a weaving actor's shift to the left, m; the amplitude grows over one period."""
    if waited < 0.0:
        return 0.0
    period = w.traits[i, col.PERIOD]
    rate = TAU / period
    amplitude = min(w.traits[i, col.AMPLITUDE], 0.8 * grip(w) / (rate * rate))
    growth = min(1.0, waited / period)
    return amplitude * growth * sin(rate * waited + w.traits[i, col.PHASE])


@part
def _within_road(w: Situation, i: int, shift: float) -> float:
    """Return the shift, limited so that it takes no part of the actor off the drivable road."""
    own = centre(w.track, w.codes[i, col.LANE], w.state[i, col.S]) + w.traits[i, col.OFFSET]
    is_road, low, high = drivable_range(w.track, w.state[i, col.S], own)
    if not is_road:
        return shift
    half = 0.5 * w.traits[i, col.WIDTH]
    return min(max(shift, min(0.0, low + half - own)), max(0.0, high - half - own))


@part
def _overtake(w: Situation, i: int, waited: float) -> None:
    """Move aside, pass, and move back once the ego is well behind."""
    aside = w.state[i, col.MEMORY]
    if waited >= 0.0:
        step = w.dt * sideways_rate(w, i, w.traits[i, col.LATERAL], 2.5)
        ahead = (w.state[i, col.S] - w.paths[0, col.PATH_S]) * w.codes[i, col.DIRECTION]
        aside = max(0.0, aside - step) if ahead > _PASSED_M else min(1.0, aside + step)
        w.state[i, col.MEMORY] = quantised(aside)
    shift = _within_road(w, i, smooth(aside) * w.traits[i, col.LATERAL])
    change_lane(w, i, 0.0, shift, 0.6, -math.inf)


@part
def turn_round(w: Situation, i: int) -> None:
    """Make a U-turn to the left on a circular arc, then drive straight on."""
    state, speed = w.state, w.traits[i, col.GOAL]
    duration = max(w.traits[i, col.DURATION], PI * speed / grip(w))
    before, done = state[i, col.SPEED], state[i, col.MEMORY]
    distance = speed_up(w, i, 2.0, speed)
    # An actor that is slower drives the same arc: none turns on the spot.
    usual = quantised(speed)
    pace = 0.5 * (before + state[i, col.SPEED]) / usual if usual > 0.0 else 0.0
    turn = min(pace * PI / duration * w.dt, PI - done)
    state[i, col.MEMORY] = quantised(done + turn)
    state[i, col.HEADING] = quantised(wrapped(state[i, col.HEADING] + turn))
    move(w, i, distance)
