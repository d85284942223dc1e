"""A driver of your own in closed loop: brakes when something stands ahead in its lane."""

from oodscen import make_simulator
from oodscen.driving import Cruise, action_driver
from oodscen.protocols import State
from oodscen.testing.scenes import example_scene


class Watchful:
    """Cruises, and brakes for good when a gap in front becomes small."""

    def __init__(self, brake_at_m: float) -> None:
        self.driver = Cruise()
        self.brake_at_m = brake_at_m
        self.has_braked = False

    def look(self, state: State) -> None:
        """Watch the distances to everything in the scene."""
        if not self.has_braked and state.gaps[1:].min(initial=float("inf")) < self.brake_at_m:
            self.driver = action_driver("emergency_brake")
            self.has_braked = True

    def act(self, observation):
        """Choose the control for the next step."""
        return self.driver.act(observation)


def main() -> None:
    """Drive the example scene with two tempers."""
    with make_simulator("flat") as simulator:
        for brake_at_m in (1.0, 15.0):
            driver = Watchful(brake_at_m)
            state = simulator.reset(example_scene(), seed=0)
            while state.time < 12 and not state.contacts:
                driver.look(state)
                state = simulator.step(driver.act(simulator.observe()))
            end = f"touches {state.contacts[0]}" if state.contacts else "stops in time"
            print(f"brakes at {brake_at_m:4.1f} m: {end} after {state.time:.2f} s")


if __name__ == "__main__":
    main()
