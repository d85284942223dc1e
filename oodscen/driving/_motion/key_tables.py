"""The key poses of motions made to order as rows of the kernels' tables, and the start of their actors."""

from collections.abc import Mapping, Sequence

from oodscen._seeding import stream
from oodscen.data._designs.motion import ABILITIES, Motion
from oodscen.driving._motion import columns as col
from oodscen.driving._motion.bodies import Situation
from oodscen.driving._motion.keyframes import (
    ABOARD,
    AGAINST,
    AHEAD,
    ALONG,
    COURSE,
    DISTANCE,
    EGO,
    FIXED,
    GO_ON,
    LANE,
    LEFT,
    OTHER,
    PITCH,
    REPEAT,
    ROLL,
    START,
    STAY,
    TIME,
    UP,
    YAW,
    keep_place_on_other,
)
from oodscen.numerics._exact import PI, TAU, atan2, quantised, sincos, wrapped

_FRAMES = {"start": START, "lane": LANE, "other": OTHER, "ego": EGO}
_ARGUMENTS = {"time": TIME, "ego": DISTANCE}
_FACINGS = {"fixed": FIXED, "along": ALONG, "against": AGAINST}
_ENDINGS = {"stay": STAY, "repeat": REPEAT, "go_on": GO_ON}
_ROLLING = frozenset({"cyclist", "car", "truck"})
_ROLLING_MPS2 = 0.8
"""Deceleration of what rolls on when it is let go; other things slide, m/s^2."""


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
        if len(track.at) == 1:  # The kernels move between two keys.
            rows.append([1.0, *rows[-1][1:]])
    return rows, firsts


def key_codes(motion: Motion, first: int) -> list[int]:
    """Return the columns of `Situation.codes` from `KEY` on."""
    poses = motion.poses()
    return [
        first,
        max(2, len(poses)),
        _FRAMES[motion.frame],
        _ARGUMENTS[motion.by],
        _FACINGS[motion.facing],
        _ENDINGS[motion.then],
        int(motion.is_tilting or any(pose.up < 0.0 for pose in poses)),
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
        col.DECELERATION: _ROLLING_MPS2 if motion.body in _ROLLING else 0.0,
    }


def pose_first(w: Situation, i: int) -> bool:
    """Put an actor into the first of its key poses, and return whether it goes with another body."""
    state, traits, codes = w.state, w.traits, w.codes
    frame, facing, first = (codes[i, column] for column in (col.FRAME, col.FACING, col.KEY))
    values = [traits[first, col.POSE + axis] for axis in range(6)]
    askew = along = aside = 0.0
    if frame in (START, LANE):
        traits[i, col.APART_X], traits[i, col.APART_Y] = state[i, col.X], state[i, col.Y]
        traits[i, col.APART_YAW] = state[i, col.YAW if frame == START else col.HEADING]
        # The keys lie along the frame, which an actor on the road need not face.
        askew = traits[i, col.APART_YAW] if frame == LANE else 0.0
        if codes[i, col.THEN] != REPEAT:
            along, aside = (traits[first, col.SLOPE + axis] for axis in (AHEAD, LEFT))
    turn = 0.0
    if facing != FIXED and (along or aside):
        turn = atan2(aside, along) - askew + (PI if facing == AGAINST else 0.0)
    state[i, COURSE] = quantised(wrapped(state[i, col.YAW] + turn))
    turn += values[YAW]
    state[i, col.YAW] = quantised(wrapped(state[i, col.YAW] + turn))
    state[i, col.HEADING] = quantised(wrapped(state[i, col.HEADING] + turn))
    if along or aside:
        sine, cosine = sincos(askew + turn)
        state[i, col.SPEED] = quantised((along * cosine + aside * sine) * traits[i, col.PACE])
    state[i, col.LIFT] = quantised(values[UP])
    state[i, col.PITCH], state[i, col.ROLL] = quantised(values[PITCH]), quantised(values[ROLL])
    if frame == OTHER:
        state[i, ABOARD] = 1.0
        keep_place_on_other(w, i)
    return bool(frame == OTHER)
