"""Movement through the key poses of motions made to order.

The pose between two keys is that of a cubic, whose slopes are those of `oodscen.data._poses`. A body never moves
faster than its kind can, whatever its keys and the body that it follows do: it then lags behind. What stands on
another body is carried along at that one's speed; the limit is then that of its own steps.
"""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from oodscen._seeding import stream
from oodscen.data._motion import ABILITIES, EASE, Motion
from oodscen.driving._motion import columns as col
from oodscen.driving._motion.bodies import Situation
from oodscen.driving._roads.track import centre, point
from oodscen.numerics._exact import PI, TAU, atan2, quantised, sincos, wrapped
from oodscen.numerics._kernels import part

START, LANE, OTHER, EGO = range(4)
FRAMES = {"start": START, "lane": LANE, "other": OTHER, "ego": EGO}
TIME, DISTANCE = range(2)
ARGUMENTS = {"time": TIME, "ego": DISTANCE}
FIXED, ALONG, AGAINST = range(3)
FACINGS = {"fixed": FIXED, "along": ALONG, "against": AGAINST}
STAY, REPEAT, GO_ON = range(3)
ENDINGS = {"stay": STAY, "repeat": REPEAT, "go_on": GO_ON}

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

_ROLLING = frozenset({"cyclist", "car", "truck"})
ROLLING_MPS2 = 0.8
"""Deceleration of what rolls on when it is let go; other things slide, m/s^2."""
_UPON_M = 0.3
"""Height above another body's box up to which a body stands on it, m."""
_EASE = (EASE["time"], EASE["ego"])
_MOVING_MPS = 0.2
"""Speed above which a body turns towards its way, m/s."""


@part
def follow_keys(w: Situation, i: int, waited: float) -> None:
    """Move the actor in row `i` to its pose at the end of the step; its place on the road follows later."""
    state, frame = w.state, w.codes[i, col.FRAME]
    if frame != OTHER and waited < w.traits[i, col.DELAY] and not _comes_on(w, i, waited):
        return
    u = _argument(w, i, waited)
    place = key_place(w, i, u)
    x0, y0 = state[i, col.X], state[i, col.Y]
    x, y, base = _target(w, i, place)
    along, aside = 0.0, 0.0
    if frame == OTHER and state[i, ABOARD] == 1.0:
        along, aside = _spot(w, i)
        along -= x0
        aside -= y0
    dx, dy = x - x0, y - y0
    far = math.sqrt((dx - along) * (dx - along) + (dy - aside) * (dy - aside))
    most = w.traits[i, col.FASTEST] * w.dt
    if far > most:
        dx = along + (dx - along) * most / far
        dy = aside + (dy - aside) * most / far
    far = math.sqrt(dx * dx + dy * dy)
    if w.codes[i, col.FACING] != FIXED:
        base = _turned_to(w, i, dx, dy, far)
    state[i, col.X], state[i, col.Y] = quantised(x0 + dx), quantised(y0 + dy)
    state[i, col.YAW] = quantised(wrapped(base + key_value(w, place, YAW)))
    low, rise = state[i, col.LIFT], w.traits[i, col.CLIMB] * w.dt
    state[i, col.LIFT] = quantised(min(max(key_value(w, place, UP), low - rise), low + rise))
    if w.codes[i, col.TILTS] == 1:
        state[i, col.PITCH] = quantised(wrapped(key_value(w, place, PITCH)))
        state[i, col.ROLL] = quantised(wrapped(key_value(w, place, ROLL)))
    sine, cosine = sincos(state[i, col.YAW])
    state[i, col.SPEED] = quantised((dx * cosine + dy * sine) / w.dt)
    if frame == OTHER:
        _stand_on(w, i)
    if waited < 0.0:
        return
    state[i, STAGE] = MOVING
    if 0.0 <= w.traits[i, col.LET_GO] <= u:
        # The memory is now that of a falling body.
        state[i, col.MEMORY] = quantised(dx / w.dt)
        state[i, col.MEMORY + 1] = quantised(dy / w.dt)
        state[i, col.MEMORY + 2], state[i, col.MEMORY + 3] = 0.0, 1.0
        state[i, STAGE] = FREE


@part
def _argument(w: Situation, i: int, waited: float) -> float:
    """Return the place in the keys at the end of the step."""
    if waited < 0.0:
        return 0.0
    by, traits = w.codes[i, col.BY], w.traits
    u = waited + w.dt
    if by == DISTANCE:
        travelled = w.state[i, TRAVELLED] + max(0.0, w.state[0, col.S] - w.paths[0, col.PATH_S])
        u = w.state[i, TRAVELLED] = quantised(travelled)
    u = max(0.0, u - traits[i, col.DELAY]) * traits[i, col.PACE]
    if w.codes[i, col.THEN] == REPEAT:
        ease = _EASE[0] if by == TIME else _EASE[1]
        u = 0.5 * u * u / ease if u < ease else u - 0.5 * ease
    return u


class KeyPlace(NamedTuple):
    """A place between two keys."""

    key: int
    """Row of the key before it."""
    share: float
    """Share of the stretch to the next key."""
    beyond: float
    """Distance beyond the last key, which `key` then is."""


@part
def key_place(w: Situation, i: int, u: float) -> KeyPlace:
    """Return the place of an actor in its keys."""
    keys, first = w.traits, w.codes[i, col.KEY]
    last = first + w.codes[i, col.KEYS] - 1
    end = keys[last, col.AT]
    if u >= end:
        if w.codes[i, col.THEN] != REPEAT:
            return KeyPlace(last, 0.0, u - end)
        u -= end * math.floor(u / end)
    k = first
    while k + 1 < last and keys[k + 1, col.AT] <= u:
        k += 1
    return KeyPlace(k, (u - keys[k, col.AT]) / (keys[k + 1, col.AT] - keys[k, col.AT]), 0.0)


@part
def key_value(w: Situation, place: KeyPlace, axis: int) -> float:
    """Return one value of a pose."""
    keys, k, share = w.traits, place.key, place.share
    start = keys[k, col.POSE + axis]
    if share <= 0.0:
        # The slope at the end is 0 unless the motion goes on.
        return start + keys[k, col.SLOPE + axis] * place.beyond
    stop, span = keys[k + 1, col.POSE + axis], keys[k + 1, col.AT] - keys[k, col.AT]
    one, two = keys[k, col.SLOPE + axis] * span, keys[k + 1, col.SLOPE + axis] * span
    rise = stop - start
    cubic = one + two - 2.0 * rise
    square = 3.0 * rise - 2.0 * one - two
    return start + share * (one + share * (square + share * cubic))


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
    other = 0
    along, aside, askew = 0.0, 0.0, 0.0
    if frame == OTHER:
        other = w.codes[i, col.OTHER]
        along, aside = traits[i, col.APART_X], traits[i, col.APART_Y]
        askew = traits[i, col.APART_YAW]
    else:
        if state[i, STAGE] == WAITING:
            _hold(w, i)
        along, aside, askew = state[i, HELD], state[i, HELD + 1], state[i, HELD + 2]
    along += ahead
    aside += left
    sine, cosine = sincos(state[other, col.YAW])
    x = state[other, col.X] + along * cosine - aside * sine
    y = state[other, col.Y] + along * sine + aside * cosine
    return x, y, state[other, col.YAW] + askew


@part
def _spot(w: Situation, i: int) -> tuple[float, float]:
    """Return where in the world the place is now at which an actor stood on another body."""
    state, other = w.state, w.codes[i, col.OTHER]
    sine, cosine = sincos(state[other, col.YAW])
    along, aside = state[i, HELD], state[i, HELD + 1]
    return (
        state[other, col.X] + along * cosine - aside * sine,
        state[other, col.Y] + along * sine + aside * cosine,
    )


@part
def _stand_on(w: Situation, i: int) -> None:
    """Keep an actor's place on another body; once it has left that one's box, it is carried no more."""
    state, traits, other = w.state, w.traits, w.codes[i, col.OTHER]
    sine, cosine = sincos(state[other, col.YAW])
    dx, dy = state[i, col.X] - state[other, col.X], state[i, col.Y] - state[other, col.Y]
    along, aside = dx * cosine + dy * sine, dy * cosine - dx * sine
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
    sine, cosine = sincos(state[0, col.YAW])
    dx, dy = state[i, col.X] - state[0, col.X], state[i, col.Y] - state[0, col.Y]
    state[i, HELD] = quantised(dx * cosine + dy * sine)
    state[i, HELD + 1] = quantised(dy * cosine - dx * sine)
    state[i, HELD + 2] = quantised(wrapped(state[i, COURSE] - state[0, col.YAW]))


@part
def _turned_to(w: Situation, i: int, dx: float, dy: float, far: float) -> float:
    """Turn an actor towards its way, or its back to it, and return the heading."""
    course = w.state[i, COURSE]
    if far > _MOVING_MPS * w.dt:
        goal = atan2(dy, dx) + (PI if w.codes[i, col.FACING] == AGAINST else 0.0)
        most = w.traits[i, col.SPINNIEST] * w.dt
        course = quantised(wrapped(course + min(max(wrapped(goal - course), -most), most)))
        w.state[i, COURSE] = course
    return course


def key_table(motions: Sequence[Motion], bodies: int) -> tuple[list[list[float]], dict[str, int]]:
    """Return the rows of `Situation.traits` below the bodies, and the first row of each motion by its id."""
    rows: list[list[float]] = []
    firsts = {}
    for motion in motions:
        track = motion.track()
        firsts[motion.id] = bodies + len(rows)
        rows += [
            [at, *pose, *slopes]
            for at, pose, slopes in zip(track.at, track.poses, track.slopes, strict=True)
        ]
        if len(track.at) == 1:
            rows.append([1.0, *track.poses[0], *track.slopes[0]])
    return rows, firsts


def key_codes(motion: Motion, first: int) -> list[int]:
    """Return the columns of `Situation.codes` from `KEY` on."""
    return [
        first,
        max(2, len(motion.poses())),
        FRAMES[motion.frame],
        ARGUMENTS[motion.by],
        FACINGS[motion.facing],
        ENDINGS[motion.then],
        int(motion.is_tilting or any(pose.up < 0.0 for pose in motion.poses())),
    ]


def key_traits(motion: Motion, actor: str, seed: int) -> Mapping[int, float]:
    """Return the columns of `Situation.traits` of an actor that moves so."""
    drawn = stream(seed, "motion", actor)
    delay, pace = float(drawn.uniform(0.0, 1.0)), float(drawn.uniform(-1.0, 1.0))
    able = ABILITIES[motion.body]
    return {
        col.PIVOT: motion.pivot_m,
        col.DELAY: quantised(motion.delay * delay),
        col.PACE: quantised(1.0 + motion.pace * pace),
        col.LET_GO: -1.0 if motion.let_go is None else motion.let_go,
        col.FASTEST: motion.fastest,
        col.CLIMB: able.climb,
        col.SPINNIEST: able.spin * TAU / 360.0,
        col.DECELERATION: ROLLING_MPS2 if motion.body in _ROLLING else 0.0,
    }


def pose_first(w: Situation, i: int) -> bool:
    """Put an actor into the first of its key poses, and return whether it goes with another body."""
    state, traits, frame = w.state, w.traits, w.codes[i, col.FRAME]
    if frame in (START, LANE):
        traits[i, col.APART_X], traits[i, col.APART_Y] = state[i, col.X], state[i, col.Y]
        traits[i, col.APART_YAW] = state[i, col.YAW if frame == START else col.HEADING]
    state[i, COURSE] = state[i, col.YAW]
    first = w.codes[i, col.KEY]
    values = [w.traits[first, col.POSE + axis] for axis in range(6)]
    if frame != OTHER:
        state[i, col.YAW] = quantised(wrapped(state[i, col.YAW] + values[YAW]))
        state[i, col.HEADING] = quantised(wrapped(state[i, col.HEADING] + values[YAW]))
    if frame in (START, LANE) and w.codes[i, col.THEN] != REPEAT:
        sine, cosine = sincos(values[YAW])
        along, aside = (w.traits[first, col.SLOPE + axis] for axis in (AHEAD, LEFT))
        state[i, col.SPEED] = quantised((along * cosine + aside * sine) * traits[i, col.PACE])
    state[i, col.LIFT] = quantised(values[UP])
    state[i, col.PITCH], state[i, col.ROLL] = quantised(values[PITCH]), quantised(values[ROLL])
    if frame == OTHER:
        state[i, ABOARD] = 1.0
        _stand_on(w, i)
    return bool(frame == OTHER)
