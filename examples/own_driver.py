"""Runs a custom driver in closed loop beside the shipped one, in a scene and its ordinary twin."""

from collections.abc import Callable

from oodscen import drive, make_driver, make_simulator
from oodscen.protocols import Control, Driver, Observation, State
from oodscen.testing import example_scene


class Watchful:
    """A driving stack: `look` is its perception, `act` its control."""

    def __init__(self) -> None:
        self.driver = make_driver("keep_speed")
        self.brakes = False

    def look(self, state: State) -> None:
        """Brake for good when the gap ahead becomes small."""
        if not self.brakes and state.gaps[1:].min(initial=float("inf")) < 15.0:
            self.driver, self.brakes = make_driver("emergency_brake"), True

    def act(self, observation: Observation) -> Control:
        """Return the control for the next step."""
        return self.driver.act(observation)


def main() -> None:
    """Drive the example scene with three stacks."""
    with make_simulator("flat") as simulator:
        stacks: dict[str, Callable[[], Driver] | str] = {
            "Blind": "keep_speed",
            "Watchful": Watchful,
            "RuleBased": "rule-based",
        }
        for name, stack in stacks.items():
            for result in drive([example_scene()], stack, simulator, name=name):
                end = f"touches {result.collisions[0]}" if result.collisions else "passes"
                print(f"{result.id:32} {end}, braking at most {result.peak_deceleration} m/s^2")


if __name__ == "__main__":
    main()
