import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.driving._motion.bodies import GRAVITY, MAX_DRIVE, WHEELBASE, Situation, drive_ego
from oodscen.driving._motion.columns import SPEED, STATE_WIDTH, YAW, X, Y
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.track import for_kernels
from oodscen.protocols import Control
from tests.driving.staging import CATALOGUE

DT = 0.05
controls = st.builds(Control, st.floats(-20, 20), st.floats(-2, 2))


class Ego:
    """The bicycle on its own."""

    def __init__(self, speed: float = 10.0) -> None:
        self.state = np.zeros((1, STATE_WIDTH))
        self.state[0, SPEED] = speed

    x = property(lambda self: float(self.state[0, X]))
    y = property(lambda self: float(self.state[0, Y]))
    yaw = property(lambda self: float(self.state[0, YAW]))
    speed = property(lambda self: float(self.state[0, SPEED]))

    def advance(self, control: Control, friction: float, dt: float) -> None:
        track, none = (
            for_kernels(load_corridor(CATALOGUE.maps[0]).track),
            np.zeros((1, 1), dtype=np.int64),
        )
        state = memoryview(self.state)
        situation = Situation(track, state, state, none, state, none, dt, friction, 1e4, 1e4)
        drive_ego(situation, control.acceleration, control.steering)


body = Ego


@given(st.floats(0, 45), st.floats(0.1, 1.2), st.lists(controls, min_size=1, max_size=30))
def test_the_friction_circle_is_never_exceeded(
    speed: float, friction: float, demands: list[Control]
) -> None:
    ego = body(round(speed, 6))
    for control in demands:
        before, yaw = ego.speed, ego.yaw
        ego.advance(control, friction, DT)
        along = (ego.speed - before) / DT
        turn = math.remainder(ego.yaw - yaw, math.tau) / DT
        across = 0.5 * (ego.speed + before) * turn
        assert math.hypot(along, across) <= friction * GRAVITY * (1 + 1e-6) + 2e-3
        assert ego.speed >= 0.0
        assert along <= MAX_DRIVE + 1e-3


@given(st.floats(1, 30), st.floats(-0.3, 0.3))
def test_constant_steering_drives_a_circle(speed: float, steering: float) -> None:
    slip = math.atan(0.5 * math.tan(steering))
    curvature = 2.0 * math.sin(slip) / WHEELBASE
    if speed**2 * abs(curvature) > 0.99 * GRAVITY:
        return
    ego = body(speed)
    for _ in range(40):
        ego.advance(Control(0.0, steering), 1.0, DT)
    # The exact solution of the bicycle model's differential equation, as a complex integral.
    turns = np.linspace(0.0, 2.0, 20_001) * speed * curvature
    course = np.exp(1j * (turns + slip)) * speed
    end = np.trapezoid(course, dx=2.0 / 20_000)
    assert abs(complex(ego.x, ego.y) - end) < 1e-3 * 2.0 * speed
    assert abs(math.remainder(ego.yaw - 2.0 * speed * curvature, math.tau)) < 1e-4


@settings(max_examples=20)
@given(st.floats(0, 40), st.floats(0.2, 1.0), st.floats(0.5, 9))
def test_braking_distance_is_that_of_physics(speed: float, friction: float, brake: float) -> None:
    ego = body(speed)
    while ego.speed > 0.0:
        ego.advance(Control(-brake), friction, DT)
    deceleration = min(brake, friction * GRAVITY)
    assert math.isclose(ego.x, speed**2 / (2 * deceleration), abs_tol=0.02 + 0.01 * speed)
    assert ego.y == 0.0


def test_there_is_no_reverse_gear() -> None:
    ego = body(0.0)
    ego.advance(Control(-5.0, 0.3), 1.0, DT)
    assert (ego.x, ego.y, ego.yaw, ego.speed) == (0.0, 0.0, 0.0, 0.0)


def test_not_a_number_is_no_demand() -> None:
    ego, other = body(), body()
    ego.advance(Control(math.nan, math.nan), 1.0, DT)
    other.advance(Control(), 1.0, DT)
    assert ego.state.tobytes() == other.state.tobytes()
    ego.advance(Control(math.inf, -math.inf), 1.0, DT)
    assert np.isfinite(ego.state).all()
