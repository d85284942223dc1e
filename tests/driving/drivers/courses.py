"""Cut-ins and braking leaders on a straight road, driven by a reference driver alone."""

import math

import numpy as np

from oodscen.protocols import Observation, State

DT = 0.05
LENGTH, WIDTH = 4.3, 1.9
"""The vehicles of ec-jrc/JRC-FSM, m."""


def cut_in(driver, ego_kmh, other_kmh, lateral, gap):
    """Return whether the driver hits a vehicle that cuts in from 3.5 m to its left.

    The course is that of `one_case cut_in` in ec-jrc/JRC-FSM: constant speeds, 1.6 m between the sides.

    Args:
        driver: The reference driver.
        ego_kmh: The ego's speed, km/h.
        other_kmh: The other's speed, km/h.
        lateral: Speed of the move to the side, m/s.
        gap: Distance along the road from the ego's front to the other's rear at its begin, m.
    """
    other = [gap + LENGTH, 1.6 + WIDTH, other_kmh / 3.6]

    def move():
        other[1] = max(0.0, other[1] - lateral * DT)

    return collides(driver, ego_kmh, other, move)


def collides(driver, ego_kmh, other, move, seconds=25.0):
    """Return whether the ego touches the other vehicle, which `move` moves sideways and brakes."""
    s, speed, rate = 0.0, ego_kmh / 3.6, 0.0
    for step in range(round(seconds / DT)):
        along, across = abs(other[0] - s) - LENGTH, abs(other[1]) - WIDTH
        if max(along, across) <= 0.0:
            return True
        gap = math.hypot(max(0.0, along), max(0.0, across))
        places = np.array([(s, 0.0), (other[0], other[1])])
        driver.look(
            State(
                step=step,
                time=step * DT,
                ids=("ego", "other"),
                poses=np.column_stack([places, np.zeros((2, 2))]),
                speeds=np.array([speed, other[2]]),
                gaps=np.array([math.inf, gap]),
                off_road=False,
                accelerations=np.array([0.0, rate]),
                places=places,
            )
        )
        control = driver.act(observation(step * DT, speed))
        before, was = speed, other[2]
        speed = max(0.0, speed + control.acceleration * DT)
        s += 0.5 * (before + speed) * DT
        move()
        other[0] += 0.5 * (was + other[2]) * DT
        rate = (other[2] - was) / DT
    return False


def observation(time, speed, **changes):
    """Return the observation of an ego in the middle of a straight dry lane."""
    plain = {
        "offset_m": 0.0,
        "heading_error": 0.0,
        "curvature": 0.0,
        "wheelbase": 2.7,
        "lane_left_m": 3.5,
        "lane_right_m": None,
        "roadside_m": -3.0,
        "friction": 1.0,
    }
    return Observation(time=time, speed=speed, **{**plain, **changes})
