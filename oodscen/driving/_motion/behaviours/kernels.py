"""The step of an actor, whatever its behaviour. `behaviours` describes them.

An actor sees the others as they were at the beginning of the step, so the order of actors does not
matter. The exception: an actor that rides on, is towed by or belongs to another body moves after it.
"""

from oodscen.driving._motion import columns as col
from oodscen.driving._motion.behaviours.codes import IN_WORLD, WALKING, Code
from oodscen.driving._motion.behaviours.lane_kernels import drive, turn_round
from oodscen.driving._motion.behaviours.walking_kernels import walk
from oodscen.driving._motion.behaviours.world_kernels import act_in_world
from oodscen.driving._motion.bodies import Situation
from oodscen.driving._motion.lane_keeping import (
    since,
)
from oodscen.driving._roads.track import (
    heading,
    locate,
    point,
)
from oodscen.numerics._exact import atan2, quantised, wrapped
from oodscen.numerics._kernels import part


@part
def act(w: Situation, i: int, time: float) -> None:
    """Move the actor in row `i` by one step that begins at `time`, s."""
    code = w.codes[i, col.BEHAVIOUR]
    if code == Code.STAND:
        return
    before, waited = w.state[i, col.SPEED], since(w, i, time)
    if code in IN_WORLD:
        act_in_world(w, i, code, waited)
        stand_in_world(w, i)
    else:
        if code in WALKING:
            if waited >= 0.0:
                walk(w, i, code, waited)
        elif code == Code.U_TURN and waited >= 0.0:
            turn_round(w, i)
        else:
            drive(w, i, code, waited)
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
