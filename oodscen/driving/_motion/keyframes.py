"""Movement through the key poses of motions made to order.

The pose between two keys is that of a cubic, whose slopes are those of `oodscen.data._designs.poses`. A body never moves
faster than its kind can, whatever its keys and the body that it follows do: it then lags behind. What stands on
another body is carried along at that one's speed; the limit is then that of its own steps.
"""

import math
from typing import NamedTuple

from oodscen.data._designs.motion import EASE
from oodscen.driving._motion import columns as col
from oodscen.driving._motion.bodies import Situation, place_on, place_relative_to
from oodscen.driving._roads.track import centre, point
from oodscen.numerics._exact import PI, atan2, quantised, sincos, wrapped
from oodscen.numerics._kernels import part

START, LANE, OTHER, EGO = range(4)
TIME, DISTANCE = range(2)
FIXED, ALONG, AGAINST = range(3)
STAY, REPEAT, GO_ON = range(3)

AHEAD, LEFT, UP, YAW, PITCH, ROLL = range(6)

# Memory of a body that moves through key poses.
TRAVELLED = col.MEMORY
"""Distance of the ego since the trigger, m."""
HELD = col.MEMORY + 1
"""First of three columns: its pose relative to the ego when the trigger fired; in the frames of the road and the
start, how far it has come ahead and to the left before; in the frame of another body, its place on that one."""
ABOARD = col.MEMORY + 3
"""In the frame of another body: 1 while it stands on that one, which carries it."""
COURSE = col.MEMORY + 4
"""Heading of its way, rad."""
STAGE = col.MEMORY + 5
WAITING, MOVING, FREE = 0.0, 1.0, 2.0
"""Values of `STAGE`: before its first key, between them, and let go."""

_UPON_M = 0.3
"""Height above another body's box up to which a body stands on it, m."""
_EASE = (EASE["time"], EASE["ego"])
"""`EASE` by `TIME` and `DISTANCE`."""
_MOVING_MPS = 0.2
"""Speed above which a body turns towards its way, m/s."""


@part
def follow_keys(w: Situation, i: int, waited: float) -> None:
    """Move the actor in row `i` to its pose at the end of the step; its place on the road follows later."""
    state, frame = w.state, w.codes[i, col.FRAME]
    if frame != OTHER and waited < w.traits[i, col.DELAY] and not _comes_on(w, i, waited):
        return
    argument = _argument(w, i, waited)
    place = key_place(w, i, argument)
    x, y, base = _target(w, i, place)
    dx, dy = _limited_move(w, i, x, y)
    if w.codes[i, col.FACING] != FIXED:
        base = _turned_to(w, i, dx, dy)
    state[i, col.X] = quantised(state[i, col.X] + dx)
    state[i, col.Y] = quantised(state[i, col.Y] + dy)
    state[i, col.YAW] = quantised(wrapped(base + key_value(w, place, YAW)))
    low, rise = state[i, col.LIFT], w.traits[i, col.CLIMB] * w.dt
    state[i, col.LIFT] = quantised(min(max(key_value(w, place, UP), low - rise), low + rise))
    if w.codes[i, col.TILTS] == 1:
        state[i, col.PITCH] = quantised(wrapped(key_value(w, place, PITCH)))
        state[i, col.ROLL] = quantised(wrapped(key_value(w, place, ROLL)))
    sine, cosine = sincos(state[i, col.YAW])
    state[i, col.SPEED] = quantised((dx * cosine + dy * sine) / w.dt)
    if frame == OTHER:
        keep_place_on_other(w, i)
    if waited < 0.0:
        return
    state[i, STAGE] = MOVING
    if 0.0 <= w.traits[i, col.LET_GO] <= argument:
        # The memory is now that of a falling body.
        state[i, col.MEMORY] = quantised(dx / w.dt)
        state[i, col.MEMORY + 1] = quantised(dy / w.dt)
        state[i, col.MEMORY + 2], state[i, col.MEMORY + 3] = 0.0, 1.0
        state[i, STAGE] = FREE


@part
def _limited_move(w: Situation, i: int, x: float, y: float) -> tuple[float, float]:
    """Return an actor's move towards a place in the world, no faster than it can, m.

    What carries it comes on top.
    """
    state = w.state
    dx, dy = x - state[i, col.X], y - state[i, col.Y]
    carried_x, carried_y = 0.0, 0.0
    if w.codes[i, col.FRAME] == OTHER and state[i, ABOARD] == 1.0:
        other, along, aside = w.codes[i, col.OTHER], state[i, HELD], state[i, HELD + 1]
        carried_x, carried_y = place_on(w, other, along, aside)
        carried_x -= state[i, col.X]
        carried_y -= state[i, col.Y]
    own_x, own_y = dx - carried_x, dy - carried_y
    distance = math.sqrt(own_x * own_x + own_y * own_y)
    most = w.traits[i, col.FASTEST] * w.dt
    if distance > most:
        dx = carried_x + own_x * most / distance
        dy = carried_y + own_y * most / distance
    return dx, dy


@part
def _argument(w: Situation, i: int, waited: float) -> float:
    """Return the argument of an actor's keys at the end of the step: a time, s, or a distance of the ego, m."""
    if waited < 0.0:
        return 0.0
    by, traits = w.codes[i, col.BY], w.traits
    argument = waited + w.dt
    if by == DISTANCE:
        travelled = w.state[i, TRAVELLED] + max(0.0, w.state[0, col.S] - w.paths[0, col.PATH_S])
        argument = w.state[i, TRAVELLED] = quantised(travelled)
    argument = max(0.0, argument - traits[i, col.DELAY]) * traits[i, col.PACE]
    if w.codes[i, col.THEN] != REPEAT:
        return argument
    ease = _EASE[by]
    return 0.5 * argument * argument / ease if argument < ease else argument - 0.5 * ease


class KeyPlace(NamedTuple):
    """A place between two keys."""

    key: int
    """Row of the key before it."""
    share: float
    """Share of the stretch to the next key."""
    beyond: float
    """Distance beyond the last key, which `key` then is."""


@part
def key_place(w: Situation, i: int, argument: float) -> KeyPlace:
    """Return the place of an actor in its keys at a time, s, or a distance of the ego, m."""
    keys, first = w.traits, w.codes[i, col.KEY]
    last = first + w.codes[i, col.KEYS] - 1
    end = keys[last, col.AT]
    if argument >= end:
        if w.codes[i, col.THEN] != REPEAT:
            return KeyPlace(last, 0.0, argument - end)
        argument -= end * math.floor(argument / end)
    k = first
    while k + 1 < last and keys[k + 1, col.AT] <= argument:
        k += 1
    share = (argument - keys[k, col.AT]) / (keys[k + 1, col.AT] - keys[k, col.AT])
    return KeyPlace(k, share, 0.0)


@part
def key_value(w: Situation, place: KeyPlace, axis: int) -> float:
    """Return one value of a pose."""
    keys, k, share = w.traits, place.key, place.share
    start = keys[k, col.POSE + axis]
    if share <= 0.0:
        # The slope at the end is 0 unless the motion goes on.
        return start + keys[k, col.SLOPE + axis] * place.beyond
    stop, span = keys[k + 1, col.POSE + axis], keys[k + 1, col.AT] - keys[k, col.AT]
    slope_start = keys[k, col.SLOPE + axis] * span
    slope_stop = keys[k + 1, col.SLOPE + axis] * span
    rise = stop - start
    cubic = slope_start + slope_stop - 2.0 * rise
    square = 3.0 * rise - 2.0 * slope_start - slope_stop
    return start + share * (slope_start + share * (square + share * cubic))


@part
def _target(w: Situation, i: int, place: KeyPlace) -> tuple[float, float, float]:
    """Return the place in the world at which an actor should be, and the heading of its frame."""
    state, traits, frame = w.state, w.traits, w.codes[i, col.FRAME]
    ahead, left = key_value(w, place, AHEAD), key_value(w, place, LEFT)
    if frame in (START, LANE):
        ahead += state[i, HELD]
        left += state[i, HELD + 1]
    if frame == LANE:
        s, lane = traits[i, col.HOME_S] + ahead, w.codes[i, col.LANE]
        t = traits[i, col.HOME_T] + left
        t += centre(w.track, lane, s) - centre(w.track, lane, traits[i, col.HOME_S])
        x, y, _, cosine, sine = point(w.track, s, t)
        return x, y, atan2(sine, cosine) + traits[i, col.APART_YAW]
    if frame == START:
        base = traits[i, col.APART_YAW]
        sine, cosine = sincos(base)
        x = traits[i, col.APART_X] + ahead * cosine - left * sine
        return x, traits[i, col.APART_Y] + ahead * sine + left * cosine, base
    if frame == OTHER:
        other = w.codes[i, col.OTHER]
        along, aside = traits[i, col.APART_X], traits[i, col.APART_Y]
        askew = traits[i, col.APART_YAW]
    else:
        other = 0
        if state[i, STAGE] == WAITING:
            _hold(w, i)
        along, aside, askew = state[i, HELD], state[i, HELD + 1], state[i, HELD + 2]
    x, y = place_on(w, other, along + ahead, aside + left)
    return x, y, state[other, col.YAW] + askew


@part
def keep_place_on_other(w: Situation, i: int) -> None:
    """Keep an actor's place on another body; once it has left that one's box, it is carried no more."""
    state, traits, other = w.state, w.traits, w.codes[i, col.OTHER]
    along, aside = place_relative_to(w, other, i)
    state[i, HELD], state[i, HELD + 1] = quantised(along), quantised(aside)
    top = state[other, col.LIFT] + traits[other, col.HEIGHT] + _UPON_M
    if (
        abs(along) > 0.5 * traits[other, col.LENGTH]
        or abs(aside) > 0.5 * traits[other, col.WIDTH]
        or state[i, col.LIFT] > top
    ):
        state[i, ABOARD] = 0.0


@part
def _comes_on(w: Situation, i: int, waited: float) -> bool:
    """Move an actor on that is moving before its first key; return whether it is, or its trigger has fired."""
    first, pace = w.codes[i, col.KEY], w.traits[i, col.PACE]
    ahead, left = w.traits[first, col.SLOPE + AHEAD], w.traits[first, col.SLOPE + LEFT]
    is_moving = w.codes[i, col.FRAME] in (START, LANE) and w.codes[i, col.THEN] != REPEAT
    if not is_moving or (ahead == 0.0 and left == 0.0):
        return waited >= 0.0
    # The part of the step before its first key: it comes on through its delay, and at its own pace.
    before = w.dt if waited < 0.0 else min(w.dt, w.traits[i, col.DELAY] - waited)
    w.state[i, HELD] = quantised(w.state[i, HELD] + ahead * pace * before)
    w.state[i, HELD + 1] = quantised(w.state[i, HELD + 1] + left * pace * before)
    return True


@part
def _hold(w: Situation, i: int) -> None:
    """Keep an actor's pose relative to the ego."""
    state = w.state
    along, aside = place_relative_to(w, 0, i)
    state[i, HELD], state[i, HELD + 1] = quantised(along), quantised(aside)
    state[i, HELD + 2] = quantised(wrapped(state[i, COURSE] - state[0, col.YAW]))


@part
def _turned_to(w: Situation, i: int, dx: float, dy: float) -> float:
    """Turn an actor towards its move, or its back to it, and return the heading."""
    course = w.state[i, COURSE]
    if math.sqrt(dx * dx + dy * dy) > _MOVING_MPS * w.dt:
        goal = atan2(dy, dx) + (PI if w.codes[i, col.FACING] == AGAINST else 0.0)
        most = w.traits[i, col.SPINNIEST] * w.dt
        course = quantised(wrapped(course + min(max(wrapped(goal - course), -most), most)))
        w.state[i, COURSE] = course
    return course
