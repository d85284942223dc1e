"""Kernels of behaviours in world coordinates: each moves its actor by one step."""

import math

from oodscen.driving._motion import columns as col
from oodscen.driving._motion.behaviours.codes import Code
from oodscen.driving._motion.bodies import GRAVITY, Situation, place_on
from oodscen.driving._motion.keyframes import FREE, STAGE, follow_keys
from oodscen.driving._motion.lane_keeping import (
    grip,
    smooth,
    speed_up,
)
from oodscen.numerics._exact import PI, atan2, cos, quantised, sincos, wrapped
from oodscen.numerics._kernels import part

_SLIDING = 0.5
"""Share of the road's grip for a sliding body."""
_TAUT_M, _NO_POLE_M = 5e-6, 1e-6
"""Slack of a pole up to which it does not pull, and distance from the hitch at which it has no direction, m."""


@part
def act_in_world(w: Situation, i: int, code: int, waited: float) -> None:
    state = w.state
    if code == Code.RUN_RED:
        _roll(w, i, speed_up(w, i, 2.0, w.traits[i, col.GOAL]))
    elif code == Code.ROLL_AWAY:
        if waited >= 0.0:
            _roll(w, i, speed_up(w, i, w.traits[i, col.PUSH], w.traits[i, col.GOAL]))
    elif code == Code.KEYED and state[i, STAGE] != FREE:
        follow_keys(w, i, waited)
    elif code == Code.KEYED:
        _fall(w, i)
    elif code == Code.TOWED:
        _follow(w, i)
    elif code == Code.OPEN_DOOR:
        _swing_open(w, i, waited)
    elif code != Code.FALL:
        raise ValueError("a behaviour without a kernel")
    elif waited < 0.0:
        _ride(w, i)
        sine, cosine = sincos(w.state[w.codes[i, col.OTHER], col.YAW])
        speed = w.state[w.codes[i, col.OTHER], col.SPEED]
        state[i, col.MEMORY], state[i, col.MEMORY + 1] = speed * cosine, speed * sine
    else:
        _fall(w, i)


@part
def _swing_open(w: Situation, i: int, waited: float) -> None:
    """Turn about the front edge, away from the body that the door belongs to."""
    _ride(w, i)
    state = w.state
    side = 1.0 if w.traits[i, col.APART_Y] >= 0.0 else -1.0
    half = 0.5 * w.traits[i, col.LENGTH]
    hinge_x, hinge_y = place_on(w, i, half, 0.0)
    swing = w.traits[i, col.ANGLE] * PI / 180.0 * smooth(waited / w.traits[i, col.DURATION])
    state[i, col.YAW] = quantised(wrapped(state[i, col.YAW] - side * swing))
    sine, cosine = sincos(state[i, col.YAW])
    state[i, col.X] = quantised(hinge_x - half * cosine)
    state[i, col.Y] = quantised(hinge_y - half * sine)


@part
def _roll(w: Situation, i: int, distance: float) -> None:
    """Move along the actor's own yaw."""
    sine, cosine = sincos(w.state[i, col.YAW])
    w.state[i, col.X] = quantised(w.state[i, col.X] + distance * cosine)
    w.state[i, col.Y] = quantised(w.state[i, col.Y] + distance * sine)


@part
def _ride(w: Situation, i: int) -> None:
    """Keep a fixed pose relative to the body that the actor belongs to."""
    state, traits, other = w.state, w.traits, w.codes[i, col.OTHER]
    x, y = place_on(w, other, traits[i, col.APART_X], traits[i, col.APART_Y])
    state[i, col.X], state[i, col.Y] = quantised(x), quantised(y)
    state[i, col.YAW] = quantised(wrapped(state[other, col.YAW] + traits[i, col.APART_YAW]))
    state[i, col.SPEED] = quantised(state[other, col.SPEED] * cos(traits[i, col.APART_YAW]))


@part
def _follow(w: Situation, i: int) -> None:
    """Follow the tail of another body without wheel slip: a tractrix."""
    state, other, pole = w.state, w.codes[i, col.OTHER], w.traits[i, col.POLE]
    hitch_x, hitch_y = place_on(w, other, -0.5 * w.traits[other, col.LENGTH], 0.0)
    dx, dy = hitch_x - state[i, col.X], hitch_y - state[i, col.Y]
    apart = math.sqrt(dx * dx + dy * dy)
    if abs(apart - pole) < _TAUT_M or apart < _NO_POLE_M:
        state[i, col.SPEED] = 0.0
        return
    dx /= apart
    dy /= apart
    state[i, col.X] = quantised(hitch_x - pole * dx)
    state[i, col.Y] = quantised(hitch_y - pole * dy)
    state[i, col.YAW] = quantised(atan2(dy, dx))
    state[i, col.SPEED] = quantised((apart - pole) / w.dt)


@part
def _fall(w: Situation, i: int) -> None:
    """Fly off with the carrier's velocity, land, bounce, slide to rest, and spin meanwhile.

    The memory columns hold the velocity along world x and y, the upward velocity, and whether the body has
    left the carrier.
    """
    state, dt = w.state, w.dt
    vx, vy = state[i, col.MEMORY], state[i, col.MEMORY + 1]
    rising, is_off = state[i, col.MEMORY + 2], state[i, col.MEMORY + 3]
    if is_off == 0.0:
        sine, cosine = sincos(state[w.codes[i, col.OTHER], col.YAW])
        vx -= w.traits[i, col.LATERAL] * sine
        vy += w.traits[i, col.LATERAL] * cosine
    speed = math.sqrt(vx * vx + vy * vy)
    lift = state[i, col.LIFT]
    left = speed
    if lift > 0.0 or rising > 0.0:
        rising -= GRAVITY * dt
        lift += rising * dt
        if lift <= 0.0:
            lift = 0.0
            rising = -0.3 * rising if rising < -1.5 else 0.0
    else:
        braking = w.traits[i, col.DECELERATION]
        left = max(0.0, speed - (braking if braking > 0.0 else _SLIDING * grip(w)) * dt)
    mean = 0.5 * (speed + left)
    if speed > 0.0:
        state[i, col.X] = quantised(state[i, col.X] + vx / speed * mean * dt)
        state[i, col.Y] = quantised(state[i, col.Y] + vy / speed * mean * dt)
        vx *= left / speed
        vy *= left / speed
    spin = w.traits[i, col.SPIN] * PI / 180.0 * min(1.0, 0.2 * mean)
    state[i, col.YAW] = quantised(wrapped(state[i, col.YAW] + spin * dt))
    sine, cosine = sincos(state[i, col.YAW])
    state[i, col.SPEED] = quantised(vx * cosine + vy * sine)
    state[i, col.LIFT] = quantised(lift)
    state[i, col.MEMORY], state[i, col.MEMORY + 1] = quantised(vx), quantised(vy)
    state[i, col.MEMORY + 2], state[i, col.MEMORY + 3] = quantised(rising), 1.0
