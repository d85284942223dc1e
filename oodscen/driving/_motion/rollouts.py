"""Rollouts of an action by drivers who differ, without publishing any state."""

from typing import NamedTuple

from oodscen.driving._motion import columns as col
from oodscen.driving._motion.actions import KEEP, follow_plan, plan_action
from oodscen.driving._motion.bodies import Situation
from oodscen.driving._motion.stepping import advance, is_off_road, is_touching, look
from oodscen.numerics._exact import quantised
from oodscen.numerics._kernels import Kernel, Numbers

# Kernels call each other's plain functions.
_advance, _look, _plan, _follow = (
    advance.plain,
    look.plain,
    plan_action.plain,
    follow_plan.plain,
)


class Variation(NamedTuple):
    """The difference of one rollout from the others."""

    reaction_s: float
    """Time for which the driver keeps lane and speed before the action begins, s."""
    friction: float = 1.0
    """Share of the scene's friction."""
    speed: float = 1.0
    """Share of the ego's speed at the decision."""


class Trial(NamedTuple):
    """An action to roll out, as kernels take it."""

    action: int
    """Code of the action."""
    begins_s: float
    """Time at which the action begins, s; the ego keeps lane and speed before."""
    speed: float
    """Factor of the ego's speed at the decision."""
    steps: int
    """Number of steps."""
    line_s: float
    """Station of the stop line, m; infinite if there is none."""
    red_from_s: float
    """Time from which its light is red, s."""


@Kernel
def is_passed(w: Situation, start: Numbers, count: int, lane: int, trial: Trial) -> bool:
    """Return whether the ego touches nothing, stays on the road and passes no stop line at red.

    The world's state is changed. `start` is its state at the decision, after `count` steps, and `lane` the strip in
    which the ego started.
    """
    for i in range(start.shape[0]):
        for k in range(start.shape[1]):
            w.state[i, k] = start[i, k]
    w.state[0, col.SPEED] = quantised(w.state[0, col.SPEED] * trial.speed)
    now = _look(w, lane)
    time = before = quantised(count * w.dt)
    reach = 0.5 * w.traits[0, col.LENGTH]
    is_before = w.state[0, col.S] + reach <= trial.line_s
    is_reacting = trial.begins_s <= time
    plan, travelled = _plan(trial.action if is_reacting else KEEP, now), 0.0
    for step in range(count, count + trial.steps):
        time = quantised(step * w.dt)
        if not is_reacting and time >= trial.begins_s:
            is_reacting = True
            plan, travelled, before = _plan(trial.action, now), 0.0, time
        travelled += now.speed * (time - before)
        before = time
        acceleration, steering = _follow(plan, travelled, now)
        _advance(w, step, acceleration, steering)
        if is_touching(w) or is_off_road(w):
            return False
        if is_before and w.state[0, col.S] + reach > trial.line_s:
            if quantised((step + 1) * w.dt) >= trial.red_from_s:
                return False
            is_before = False
        now = _look(w, lane)
    return True
