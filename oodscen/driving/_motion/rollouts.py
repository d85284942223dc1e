"""Rollouts of an action by drivers who differ, without publishing any state."""

from typing import NamedTuple

from oodscen.driving._motion import columns as col
from oodscen.driving._motion.actions import KEEP, Look, follow_plan, plan_action
from oodscen.driving._motion.bodies import WHEELBASE, Situation
from oodscen.driving._motion.stepping import advance, is_off_road, is_touching, look
from oodscen.numerics._exact import quantised
from oodscen.numerics._kernels import Kernel, Numbers, part

# Kernels call each other's plain functions.
_advance, _look = advance.plain, look.plain


class Variation(NamedTuple):
    """The difference of one rollout from the others."""

    reaction_s: float
    """Time for which the driver keeps lane and speed before the action begins, s."""
    friction: float = 1.0
    """Share of the scene's friction."""
    speed: float = 1.0
    """Share of the ego's speed at the decision."""


@part
def glance(w: Situation, lane: int) -> Look:
    """Return the driver's observation."""
    offset, askew, curvature, left, right, roadside, fastest = _look(w, lane)
    return Look(
        w.state[0, col.SPEED],
        offset,
        askew,
        curvature,
        left,
        right,
        roadside,
        fastest,
        w.friction,
        WHEELBASE,
    )


@Kernel
def is_passed(
    w: Situation,
    start: Numbers,
    count: int,
    lane: int,
    action: int,
    begins_s: float,
    speed: float,
    steps: int,
    line_s: float,
    red_from_s: float,
) -> bool:
    """Return whether the ego touches nothing, stays on the road and passes no stop line at red.

    Args:
        w: The world; its state is changed.
        start: The state at the decision.
        count: Number of steps before the decision.
        lane: The strip in which the ego started.
        action: Code of the action.
        begins_s: Time at which the action begins, s; the ego keeps lane and speed before.
        speed: Factor of the ego's speed at the decision.
        steps: Number of steps.
        line_s: Station of the stop line, m; infinite if there is none.
        red_from_s: Time from which its light is red, s.
    """
    for i in range(start.shape[0]):
        for k in range(start.shape[1]):
            w.state[i, k] = start[i, k]
    w.state[0, col.SPEED] = quantised(w.state[0, col.SPEED] * speed)
    now = glance(w, lane)
    time = before = quantised(count * w.dt)
    reach = 0.5 * w.traits[0, col.LENGTH]
    is_before = w.state[0, col.S] + reach <= line_s
    is_reacting = begins_s <= time
    plan, travelled = plan_action(action if is_reacting else KEEP, now), 0.0
    for step in range(count, count + steps):
        time = quantised(step * w.dt)
        if not is_reacting and time >= begins_s:
            is_reacting = True
            plan, travelled, before = plan_action(action, now), 0.0, time
        travelled += now.speed * (time - before)
        before = time
        acceleration, steering = follow_plan(plan, travelled, now)
        _advance(w, step, acceleration, steering)
        if is_touching(w) or is_off_road(w):
            return False
        if is_before and w.state[0, col.S] + reach > line_s:
            if quantised((step + 1) * w.dt) >= red_from_s:
                return False
            is_before = False
        now = glance(w, lane)
    return True
