"""The kernels of all behaviours: each moves its actor by one step. `behaviours` describes them.

An actor sees the others as they were at the beginning of the step, so the order of actors does not
matter. The exception: an actor that rides on, is towed by or belongs to another body moves after it.
"""

import math
from enum import IntEnum

from oodscen.driving._motion import columns as col
from oodscen.driving._motion.bodies import GRAVITY, Situation
from oodscen.driving._motion.car_following import (
    accelerate,
    change_lane,
    cruise,
    desired_speed,
    grip,
    idm_acceleration,
    keep_lane,
    move,
    sideways_duration,
    since,
    smooth,
    speed_up,
)
from oodscen.driving._motion.keyframes import FREE, STAGE, follow_keys
from oodscen.driving._roads.track import centre, drivable_range, heading, locate, point
from oodscen.numerics._exact import PI, TAU, atan2, cos, quantised, sin, sincos, wrapped
from oodscen.numerics._kernels import part

_ROUNDING = 1e-9
"""Rounding of distances gone and times waited, m or s."""
_TAUT_M, _NO_POLE_M = 5e-6, 1e-6
"""Slack of a pole up to which it does not pull, and distance from the hitch at which it has no direction, m."""


class Code(IntEnum):
    """The behaviours by number; a code without a branch below raises `ValueError` as its actor moves."""

    STAND = 0
    FOLLOW_LANE = 1
    WRONG_WAY = 2
    CUT_IN = 3
    HARD_BRAKE = 4
    STALL = 5
    STOP_AND_GO = 6
    REVERSE = 7
    SWERVE = 8
    PULL_OUT = 9
    U_TURN = 10
    CROSS_ROAD = 11
    HESITATE = 12
    WALK_ALONG = 13
    BOLT = 14
    WOBBLE = 15
    DRIFT = 16
    CUT_OUT = 17
    OVERTAKE = 18
    WANDER = 19
    DART = 20
    BLOWN = 21
    HALT = 22
    RUN_RED = 23
    ROLL_AWAY = 24
    FALL = 25
    TOWED = 26
    OPEN_DOOR = 27
    KEYED = 28


WALKING = tuple(
    int(code)
    for code in (
        *(Code.CROSS_ROAD, Code.HESITATE, Code.WALK_ALONG, Code.BOLT),
        *(Code.DART, Code.WANDER, Code.BLOWN, Code.REVERSE),
    )
)
"""Codes of actors that move along their own heading."""
IN_WORLD = tuple(
    int(code)
    for code in (
        *(Code.RUN_RED, Code.ROLL_AWAY, Code.FALL),
        *(Code.TOWED, Code.OPEN_DOOR, Code.KEYED),
    )
)
"""Codes of actors that move in world coordinates; all others move along the road."""
_SLIDING = 0.5
"""Share of the road's grip for a sliding body."""
_PASSED_M = 15.0
"""Lead over the ego at which an overtaking actor moves back, m."""


@part
def act(w: Situation, i: int, time: float) -> None:
    """Move the actor in row `i` by one step that begins at `time`, s."""
    code = w.codes[i, col.BEHAVIOUR]
    if code == Code.STAND:
        return
    before, waited = w.state[i, col.SPEED], since(w, i, time)
    if code in IN_WORLD:
        _act_in_world(w, i, code, waited)
        stand_in_world(w, i)
    else:
        if code in WALKING:
            if waited >= 0.0:
                _walk(w, i, code, waited)
        elif code == Code.U_TURN and waited >= 0.0:
            _turn_round(w, i)
        else:
            _drive(w, i, code, waited)
        stand_on_road(w, i)
    w.state[i, col.ACCELERATION] = quantised((w.state[i, col.SPEED] - before) / w.dt)


@part
def stand_on_road(w: Situation, i: int) -> None:
    """Compute the world pose from the position on the road."""
    x, y, _, cosine, sine = point(w.track, w.state[i, col.S], w.state[i, col.T])
    w.state[i, col.X], w.state[i, col.Y] = quantised(x), quantised(y)
    w.state[i, col.YAW] = quantised(wrapped(atan2(sine, cosine) + w.state[i, col.HEADING]))


@part
def stand_in_world(w: Situation, i: int) -> None:
    """Compute the position on the road from the world pose."""
    s, t = locate(w.track, w.state[i, col.X], w.state[i, col.Y], w.state[i, col.S])
    w.state[i, col.S], w.state[i, col.T] = quantised(s), quantised(t)
    w.state[i, col.HEADING] = quantised(wrapped(w.state[i, col.YAW] - heading(w.track, s)))


@part
def _drive(w: Situation, i: int, code: int, waited: float) -> None:
    traits = w.traits
    if code == Code.WRONG_WAY:
        keep_lane(w, i, speed_up(w, i, 2.0, desired_speed(w, i)), 0.0, 0.0)
    elif code in (Code.CUT_IN, Code.CUT_OUT):
        shift = centre(w.track, w.codes[i, col.TARGET], w.state[i, col.S])
        shift -= centre(w.track, w.codes[i, col.LANE], w.state[i, col.S]) + traits[i, col.OFFSET]
        blend = smooth(waited / sideways_duration(w, shift, traits[i, col.DURATION]))
        # An actor that cuts out knows the obstacle and means to pass it: only traffic counts.
        change_lane(w, i, blend, 0.0, 1.2, 0.5 if code == Code.CUT_OUT else -math.inf)
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
            blend = smooth(waited / traits[i, col.DURATION])
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
    """Return the shift, limited so that the actor stays on drivable road."""
    own = centre(w.track, w.codes[i, col.LANE], w.state[i, col.S]) + w.traits[i, col.OFFSET]
    is_road, low, high = drivable_range(w.track, w.state[i, col.S], own)
    if not is_road:
        return shift
    half = 0.5 * w.traits[i, col.WIDTH]
    return min(max(shift, low + half - own), high - half - own)


@part
def _overtake(w: Situation, i: int, waited: float) -> None:
    """Move aside, pass, and move back once the ego is well behind."""
    aside = w.state[i, col.MEMORY]
    if waited >= 0.0:
        step = w.dt / sideways_duration(w, w.traits[i, col.LATERAL], 2.5)
        ahead = (w.state[i, col.S] - w.paths[0, 0]) * w.codes[i, col.DIRECTION]
        aside = max(0.0, aside - step) if ahead > _PASSED_M else min(1.0, aside + step)
        w.state[i, col.MEMORY] = quantised(aside)
    shift = _within_road(w, i, smooth(aside) * w.traits[i, col.LATERAL])
    change_lane(w, i, 0.0, shift, 0.6, -math.inf)


@part
def _turn_round(w: Situation, i: int) -> None:
    """Make a U-turn to the left on a circular arc, then drive straight on."""
    state, speed = w.state, w.traits[i, col.GOAL]
    duration = max(w.traits[i, col.DURATION], PI * speed / grip(w))
    done = state[i, col.MEMORY]
    turn = min(PI / duration * w.dt, PI - done)
    state[i, col.MEMORY] = quantised(done + turn)
    state[i, col.HEADING] = quantised(wrapped(state[i, col.HEADING] + turn))
    move(w, i, speed_up(w, i, 2.0, speed))


@part
def _walk(w: Situation, i: int, code: int, waited: float) -> None:
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
    state, distance = w.state, w.traits[i, col.DISTANCE]
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


@part
def _act_in_world(w: Situation, i: int, code: int, waited: float) -> None:
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
        ride(w, i)
        sine, cosine = sincos(w.state[w.codes[i, col.OTHER], col.YAW])
        speed = w.state[w.codes[i, col.OTHER], col.SPEED]
        state[i, col.MEMORY], state[i, col.MEMORY + 1] = speed * cosine, speed * sine
    else:
        _fall(w, i)


@part
def _swing_open(w: Situation, i: int, waited: float) -> None:
    """Turn about the front edge, away from the body that the door belongs to."""
    ride(w, i)
    state = w.state
    side = 1.0 if w.traits[i, col.APART_Y] >= 0.0 else -1.0
    half = 0.5 * w.traits[i, col.LENGTH]
    sine, cosine = sincos(state[i, col.YAW])
    hinge_x, hinge_y = state[i, col.X] + half * cosine, state[i, col.Y] + half * sine
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
def ride(w: Situation, i: int) -> None:
    """Keep a fixed pose relative to the body that the actor belongs to."""
    state, traits, other = w.state, w.traits, w.codes[i, col.OTHER]
    sine, cosine = sincos(state[other, col.YAW])
    ahead, aside = traits[i, col.APART_X], traits[i, col.APART_Y]
    state[i, col.X] = quantised(state[other, col.X] + ahead * cosine - aside * sine)
    state[i, col.Y] = quantised(state[other, col.Y] + ahead * sine + aside * cosine)
    state[i, col.YAW] = quantised(wrapped(state[other, col.YAW] + traits[i, col.APART_YAW]))
    state[i, col.SPEED] = quantised(state[other, col.SPEED] * cos(traits[i, col.APART_YAW]))


@part
def _follow(w: Situation, i: int) -> None:
    """Follow the tail of another body without wheel slip: a tractrix."""
    state, other, pole = w.state, w.codes[i, col.OTHER], w.traits[i, col.POLE]
    sine, cosine = sincos(state[other, col.YAW])
    tail = 0.5 * w.traits[other, col.LENGTH]
    hitch_x, hitch_y = state[other, col.X] - tail * cosine, state[other, col.Y] - tail * sine
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
