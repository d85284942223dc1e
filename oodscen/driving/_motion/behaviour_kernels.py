"""The kernels of all behaviours: each moves its actor by one step. `behaviours` describes them.

An actor sees the others as they were at the beginning of the step, so the order of actors does not
matter. The exception: an actor that rides on, is towed by or belongs to another body moves after it.
"""

import math

from oodscen.driving._motion.bodies import (
    ACCELERATION,
    AMPLITUDE,
    ANGLE,
    APART_X,
    APART_Y,
    APART_YAW,
    BEHAVIOUR,
    DECELERATION,
    DIRECTION,
    DISTANCE,
    DURATION,
    FLIGHT,
    GOAL,
    GRAVITY,
    HEADING,
    HEADWAY,
    HOME_S,
    HOME_T,
    LANE,
    LATERAL,
    LENGTH,
    LIFT,
    MEMORY,
    OFFSET,
    OTHER,
    PAUSE,
    PERIOD,
    PHASE,
    POLE,
    PUSH,
    QUICKNESS,
    RADIUS,
    SPEED,
    SPIN,
    TARGET,
    WIDTH,
    YAW,
    S,
    Situation,
    T,
    X,
    Y,
)
from oodscen.driving._motion.car_following import (
    accelerate,
    attentive,
    cruise,
    desired_speed,
    grip,
    hurry,
    keep_lane,
    move,
    sideways,
    since,
    smooth,
    speed_up,
    turned,
)
from oodscen.driving._roads.track import centre, drivable_range, heading, locate, point
from oodscen.numerics._exact import PI, TAU, atan2, cos, quantised, sin, sincos, wrapped
from oodscen.numerics._kernels import part

NAMES = (
    "stand",
    "follow_lane",
    "wrong_way",
    "cut_in",
    "hard_brake",
    "stall",
    "stop_and_go",
    "reverse",
    "swerve",
    "pull_out",
    "u_turn",
    "cross_road",
    "hesitate",
    "walk_along",
    "bolt",
    "wobble",
    "drift",
    "cut_out",
    "overtake",
    "wander",
    "dart",
    "blown",
    "run_red",
    "roll_away",
    "fall",
    "towed",
    "open_door",
)
"""Ids of behaviours in the order of their codes; from `run_red` on, they move in world coordinates."""
(
    STAND,
    FOLLOW_LANE,
    WRONG_WAY,
    CUT_IN,
    HARD_BRAKE,
    STALL,
    STOP_AND_GO,
    REVERSE,
    SWERVE,
    PULL_OUT,
    U_TURN,
    CROSS_ROAD,
    HESITATE,
    WALK_ALONG,
    BOLT,
    WOBBLE,
    DRIFT,
    CUT_OUT,
    OVERTAKE,
    WANDER,
    DART,
    BLOWN,
    RUN_RED,
    ROLL_AWAY,
    FALL,
    TOWED,
    OPEN_DOOR,
) = range(27)

_SLIDING = 0.5
"""Share of the road's grip for a sliding body."""
_PASSED_M = 15.0
"""Lead over the ego at which an overtaking actor moves back, m."""


@part
def act(w: Situation, i: int, time: float) -> None:
    """Move an actor by one step.

    Args:
        w: The world.
        i: The actor's row.
        time: Time at the beginning of the step, s.
    """
    code = w.codes[i, BEHAVIOUR]
    if code == STAND:
        return
    before, waited = w.state[i, SPEED], since(w, i, time)
    if code >= RUN_RED:
        _act_in_world(w, i, code, waited)
        stand_in_world(w, i)
    else:
        if code in (CROSS_ROAD, HESITATE, WALK_ALONG, BOLT, DART, WANDER, BLOWN, REVERSE):
            if waited >= 0.0:
                _walk(w, i, code, waited)
        elif code == U_TURN and waited >= 0.0:
            _turn_round(w, i)
        else:
            _drive(w, i, code, waited)
        stand_on_road(w, i)
    w.state[i, ACCELERATION] = quantised((w.state[i, SPEED] - before) / w.dt)


@part
def stand_on_road(w: Situation, i: int) -> None:
    """Compute the world pose from the position on the road."""
    x, y, _, cosine, sine = point(w.track, w.state[i, S], w.state[i, T])
    w.state[i, X], w.state[i, Y] = quantised(x), quantised(y)
    w.state[i, YAW] = quantised(wrapped(atan2(sine, cosine) + w.state[i, HEADING]))


@part
def stand_in_world(w: Situation, i: int) -> None:
    """Compute the position on the road from the world pose."""
    s, t = locate(w.track, w.state[i, X], w.state[i, Y], w.state[i, S])
    w.state[i, S], w.state[i, T] = quantised(s), quantised(t)
    w.state[i, HEADING] = quantised(wrapped(w.state[i, YAW] - heading(w.track, s)))


# ------------------------------------------------------------------ in the lane


@part
def _drive(w: Situation, i: int, code: int, waited: float) -> None:
    traits = w.traits
    if code == WRONG_WAY:
        keep_lane(w, i, speed_up(w, i, 2.0, desired_speed(w, i)), 0.0, 0.0)
    elif code in (CUT_IN, CUT_OUT):
        shift = centre(w.track, w.codes[i, TARGET], w.state[i, S])
        shift -= centre(w.track, w.codes[i, LANE], w.state[i, S]) + traits[i, OFFSET]
        blend = smooth(waited / sideways(w, shift, traits[i, DURATION]))
        # An actor that cuts out knows the obstacle and means to pass it: only traffic counts.
        hurry(w, i, blend, 0.0, 1.2, 0.5 if code == CUT_OUT else -math.inf)
    elif code in (HARD_BRAKE, STALL) and waited >= 0.0:
        keep_lane(w, i, accelerate(w, i, -traits[i, DECELERATION]), 0.0, 0.0)
    elif code == STOP_AND_GO and waited >= 0.0:
        cycles = waited / traits[i, PERIOD]
        if cycles - math.floor(cycles) >= 0.5:
            cruise(w, i, 0.0, 0.0)
        else:
            acceleration = min(-2.5, attentive(w, i, traits[i, GOAL], 1.2, -math.inf))
            keep_lane(w, i, accelerate(w, i, acceleration), 0.0, 0.0)
    elif code in (SWERVE, WOBBLE):
        cruise(w, i, 0.0, _weave(w, i, waited))
    elif code == PULL_OUT:
        if waited >= 0.0:
            blend = smooth(waited / traits[i, DURATION])
            acceleration = attentive(w, i, desired_speed(w, i), 1.2, -math.inf)
            keep_lane(w, i, accelerate(w, i, min(2.0, acceleration)), blend, 0.0)
    elif code == DRIFT and waited > 0.0:
        cruise(w, i, 0.0, _within_road(w, i, traits[i, LATERAL] * waited))
    elif code == OVERTAKE:
        _overtake(w, i, waited)
    elif code == FOLLOW_LANE:
        acceleration = attentive(w, i, desired_speed(w, i), traits[i, HEADWAY], -math.inf)
        keep_lane(w, i, accelerate(w, i, max(acceleration, -traits[i, DECELERATION])), 0.0, 0.0)
    else:
        cruise(w, i, 0.0, 0.0)


@part
def _weave(w: Situation, i: int, waited: float) -> float:
    """Return a weaving actor's shift to the left, m; the amplitude grows over one period."""
    if waited < 0.0:
        return 0.0
    period = w.traits[i, PERIOD]
    rate = TAU / period
    amplitude = min(w.traits[i, AMPLITUDE], 0.8 * grip(w) / (rate * rate))
    growth = min(1.0, waited / period)
    return amplitude * growth * sin(rate * waited + w.traits[i, PHASE])


@part
def _within_road(w: Situation, i: int, shift: float) -> float:
    """Return the shift, limited so that the actor stays on drivable road."""
    own = centre(w.track, w.codes[i, LANE], w.state[i, S]) + w.traits[i, OFFSET]
    is_road, low, high = drivable_range(w.track, w.state[i, S], own)
    if not is_road:
        return shift
    half = 0.5 * w.traits[i, WIDTH]
    return min(max(shift, low + half - own), high - half - own)


@part
def _overtake(w: Situation, i: int, waited: float) -> None:
    """Move aside, pass, and move back once the ego is well behind."""
    aside = w.state[i, MEMORY]
    if waited >= 0.0:
        step = w.dt / sideways(w, w.traits[i, LATERAL], 2.5)
        ahead = (w.state[i, S] - w.paths[0, 0]) * w.codes[i, DIRECTION]
        aside = max(0.0, aside - step) if ahead > _PASSED_M else min(1.0, aside + step)
        w.state[i, MEMORY] = quantised(aside)
    shift = _within_road(w, i, smooth(aside) * w.traits[i, LATERAL])
    hurry(w, i, 0.0, shift, 0.6, -math.inf)


@part
def _turn_round(w: Situation, i: int) -> None:
    """Make a U-turn to the left on a circular arc, then drive straight on."""
    state, speed = w.state, w.traits[i, GOAL]
    duration = max(w.traits[i, DURATION], PI * speed / grip(w))
    done = state[i, MEMORY]
    turn = min(PI / duration * w.dt, PI - done)
    state[i, MEMORY] = quantised(done + turn)
    state[i, HEADING] = quantised(wrapped(state[i, HEADING] + turn))
    move(w, i, speed_up(w, i, 2.0, speed))


# ------------------------------------------------------------------ on foot and in the wind


@part
def _walk(w: Situation, i: int, code: int, waited: float) -> None:
    """Move along the actor's own heading once triggered."""
    state, distance = w.state, w.traits[i, DISTANCE]
    if code == REVERSE:
        move(w, i, speed_up(w, i, 1.5, -w.traits[i, GOAL]))
    elif code == WALK_ALONG:
        _go(w, i, math.inf, w.traits[i, QUICKNESS])
    elif code == DART:
        _go(w, i, distance, max(5.0, w.traits[i, QUICKNESS]))
    elif code == WANDER:
        _wander(w, i)
    elif code == BLOWN:
        _blow(w, i, waited)
    elif code != HESITATE or state[i, MEMORY] < distance - 1e-9:
        _go(w, i, distance, w.traits[i, QUICKNESS])
    elif state[i, MEMORY + 1] < w.traits[i, PAUSE] - 1e-9:
        state[i, MEMORY + 1] = quantised(state[i, MEMORY + 1] + w.dt)
    else:
        if state[i, MEMORY + 2] == 0.0:
            state[i, MEMORY + 2] = 1.0
            state[i, HEADING] = turned(state[i, HEADING])
        _go(w, i, 2.0 * distance, w.traits[i, QUICKNESS])


@part
def _go(w: Situation, i: int, distance: float, quickness: float) -> None:
    """Go straight on for a given distance and stop there."""
    covered = speed_up(w, i, quickness, w.traits[i, GOAL])
    left = distance - w.state[i, MEMORY]
    if covered >= left:
        covered = max(left, 0.0)
        w.state[i, SPEED] = 0.0
    w.state[i, MEMORY] = quantised(w.state[i, MEMORY] + covered)
    move(w, i, covered)


@part
def _wander(w: Situation, i: int) -> None:
    """Walk from spot to spot around home, with a pause at every third spot.

    Successive spots follow the golden ratio and its two-dimensional counterpart, which fills the disc
    evenly without randomness.
    """
    state, traits = w.state, w.traits
    leg, spent = state[i, MEMORY], state[i, MEMORY + 1]
    origin = traits[i, PHASE] / TAU
    turn = origin + 0.6180339887498949 * (leg + 1.0)
    share = origin + 0.7548776662466927 * (leg + 1.0)
    sine, cosine = sincos(TAU * (turn - math.floor(turn)))
    radius = traits[i, RADIUS] * math.sqrt(share - math.floor(share))
    ahead = traits[i, HOME_S] + radius * cosine - state[i, S]
    aside = traits[i, HOME_T] + radius * sine - state[i, T]
    thirds = leg / 3.0
    is_pause = thirds - math.floor(thirds) > 0.5
    goal = 0.0
    if not is_pause:
        error = wrapped(atan2(aside, ahead) - state[i, HEADING])
        most = 2.5 * w.dt
        error = min(max(error, -most), most)
        state[i, HEADING] = quantised(wrapped(state[i, HEADING] + error))
        sine, cosine = sincos(state[i, HEADING])
        left = math.sqrt(ahead * ahead + aside * aside)
        goal = traits[i, GOAL] * max(0.0, ahead * cosine + aside * sine) / max(left, 1.0)
        is_pause = left < 0.3
        if is_pause:
            spent = 8.0
    move(w, i, speed_up(w, i, 1.5, goal))
    spent += w.dt
    if spent > (2.0 if goal == 0.0 and thirds - math.floor(thirds) > 0.5 else 8.0):
        leg, spent = leg + 1.0, 0.0
    state[i, MEMORY], state[i, MEMORY + 1] = leg, quantised(spent)


@part
def _blow(w: Situation, i: int, waited: float) -> None:
    """Roll and hop along the heading in gusts, swaying slightly."""
    state = w.state
    phase = TAU * waited / w.traits[i, PERIOD]
    gust = 0.65 + 0.35 * sin(phase + w.traits[i, PHASE])
    goal, before = w.traits[i, GOAL] * gust, state[i, SPEED]
    speed = before + min(max(goal - before, -6.0 * w.dt), 6.0 * w.dt)
    state[i, SPEED] = quantised(speed)
    move(w, i, 0.5 * (before + speed) * w.dt)
    sway = 0.2 * speed * sin(0.61803 * phase) * w.dt
    sine, cosine = sincos(state[i, HEADING])
    state[i, S] = quantised(state[i, S] - sway * sine)
    state[i, T] = quantised(state[i, T] + sway * cosine)
    state[i, LIFT] = quantised(w.traits[i, FLIGHT] * 0.5 * (1.0 - cos(phase)))


# ------------------------------------------------------------------ in world coordinates


@part
def _act_in_world(w: Situation, i: int, code: int, waited: float) -> None:
    state = w.state
    if code == RUN_RED:
        _roll(w, i, speed_up(w, i, 2.0, w.traits[i, GOAL]))
    elif code == ROLL_AWAY:
        if waited >= 0.0:
            _roll(w, i, speed_up(w, i, w.traits[i, PUSH], w.traits[i, GOAL]))
    elif code == TOWED:
        _follow(w, i)
    elif code == OPEN_DOOR:
        ride(w, i)
        side = 1.0 if w.traits[i, APART_Y] >= 0.0 else -1.0
        half = 0.5 * w.traits[i, LENGTH]
        sine, cosine = sincos(state[i, YAW])
        hinge_x, hinge_y = state[i, X] + half * cosine, state[i, Y] + half * sine
        swing = w.traits[i, ANGLE] * PI / 180.0 * smooth(waited / w.traits[i, DURATION])
        state[i, YAW] = quantised(wrapped(state[i, YAW] - side * swing))
        sine, cosine = sincos(state[i, YAW])
        state[i, X] = quantised(hinge_x - half * cosine)
        state[i, Y] = quantised(hinge_y - half * sine)
    elif waited < 0.0:
        ride(w, i)
        sine, cosine = sincos(w.state[w.codes[i, OTHER], YAW])
        speed = w.state[w.codes[i, OTHER], SPEED]
        state[i, MEMORY], state[i, MEMORY + 1] = speed * cosine, speed * sine
    else:
        _fall(w, i)


@part
def _roll(w: Situation, i: int, distance: float) -> None:
    """Move along the actor's own yaw."""
    sine, cosine = sincos(w.state[i, YAW])
    w.state[i, X] = quantised(w.state[i, X] + distance * cosine)
    w.state[i, Y] = quantised(w.state[i, Y] + distance * sine)


@part
def ride(w: Situation, i: int) -> None:
    """Keep a fixed pose relative to the body that the actor belongs to."""
    state, traits, other = w.state, w.traits, w.codes[i, OTHER]
    sine, cosine = sincos(state[other, YAW])
    ahead, aside = traits[i, APART_X], traits[i, APART_Y]
    state[i, X] = quantised(state[other, X] + ahead * cosine - aside * sine)
    state[i, Y] = quantised(state[other, Y] + ahead * sine + aside * cosine)
    state[i, YAW] = quantised(wrapped(state[other, YAW] + traits[i, APART_YAW]))
    state[i, SPEED] = quantised(state[other, SPEED] * cos(traits[i, APART_YAW]))


@part
def _follow(w: Situation, i: int) -> None:
    """Follow the tail of another body without wheel slip: a tractrix."""
    state, other, pole = w.state, w.codes[i, OTHER], w.traits[i, POLE]
    sine, cosine = sincos(state[other, YAW])
    tail = 0.5 * w.traits[other, LENGTH]
    hitch_x, hitch_y = state[other, X] - tail * cosine, state[other, Y] - tail * sine
    dx, dy = hitch_x - state[i, X], hitch_y - state[i, Y]
    apart = math.sqrt(dx * dx + dy * dy)
    if abs(apart - pole) < 5e-6 or apart < 1e-6:
        state[i, SPEED] = 0.0
        return
    dx /= apart
    dy /= apart
    state[i, X] = quantised(hitch_x - pole * dx)
    state[i, Y] = quantised(hitch_y - pole * dy)
    state[i, YAW] = quantised(atan2(dy, dx))
    state[i, SPEED] = quantised((apart - pole) / w.dt)


@part
def _fall(w: Situation, i: int) -> None:
    """Fly off with the carrier's velocity, land, bounce, slide to rest, and spin meanwhile.

    The memory columns hold the velocity along world x and y, the upward velocity, and whether the body has
    left the carrier.
    """
    state, dt = w.state, w.dt
    vx, vy = state[i, MEMORY], state[i, MEMORY + 1]
    rising, is_off = state[i, MEMORY + 2], state[i, MEMORY + 3]
    if is_off == 0.0:
        sine, cosine = sincos(state[w.codes[i, OTHER], YAW])
        vx -= w.traits[i, LATERAL] * sine
        vy += w.traits[i, LATERAL] * cosine
    speed = math.sqrt(vx * vx + vy * vy)
    lift = state[i, LIFT]
    left = speed
    if lift > 0.0 or rising > 0.0:
        rising -= GRAVITY * dt
        lift += rising * dt
        if lift <= 0.0:
            lift = 0.0
            rising = -0.3 * rising if rising < -1.5 else 0.0
    else:
        left = max(0.0, speed - _SLIDING * grip(w) * dt)
    mean = 0.5 * (speed + left)
    if speed > 0.0:
        state[i, X] = quantised(state[i, X] + vx / speed * mean * dt)
        state[i, Y] = quantised(state[i, Y] + vy / speed * mean * dt)
        vx *= left / speed
        vy *= left / speed
    spin = w.traits[i, SPIN] * PI / 180.0 * min(1.0, 0.2 * mean)
    state[i, YAW] = quantised(wrapped(state[i, YAW] + spin * dt))
    sine, cosine = sincos(state[i, YAW])
    state[i, SPEED] = quantised(vx * cosine + vy * sine)
    state[i, LIFT] = quantised(lift)
    state[i, MEMORY], state[i, MEMORY + 1] = quantised(vx), quantised(vy)
    state[i, MEMORY + 2], state[i, MEMORY + 3] = quantised(rising), 1.0
