"""One episode of an environment: a scene from its start to its horizon."""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple, Self

from oodscen.data._scene import Scene
from oodscen.driving._trace import Course, least_time_to_collision
from oodscen.protocols import Control, Observation, Simulator, State
from oodscen.stages._drive import horizon


class PreparedScene(NamedTuple):
    """A scene or twin with its road, and the number of its steps."""

    scene: Scene
    course: Course
    steps: int

    @classmethod
    def of(cls, scene: Scene, simulator: Simulator, seed: int, *, is_twin: bool) -> Self:
        """Return a scene or its ordinary twin with the duration that a blind drive of the scene finds."""
        steps, decision_s, _ = horizon(scene, simulator, seed)
        driven = scene.twin(decision_s) if is_twin else scene
        return cls(driven, Course.of(driven, simulator.catalogue()), steps)


@dataclass
class RunningScene:
    """A scene that runs in a simulator; it begins where the simulator stands."""

    prepared: PreparedScene
    simulator: Simulator
    state: State
    """The true state."""
    observation: Observation
    """The driver's observation of the state."""
    steps_done: int = 0

    def __post_init__(self) -> None:
        self._start_m = self.place_m
        self.initial_speed = max(1.0, self.speed)
        """Speed by which progress is measured, m/s: that of the start, at least 1 m/s."""

    @classmethod
    def begin(cls, prepared: PreparedScene, simulator: Simulator, seed: int) -> Self:
        """Reset a simulator to the start of a scene."""
        state = simulator.reset(prepared.scene, seed)
        return cls(prepared, simulator, state, simulator.observe())

    def advance(self, control: Control) -> None:
        """Drive for one step of the simulator."""
        self.state = self.simulator.step(control)
        self.observation = self.simulator.observe()
        self.steps_done += 1

    @property
    def is_lost(self) -> bool:
        """True once the ego touches a body or is off the road."""
        return bool(self.state.contacts) or self.state.off_road

    @property
    def is_at_horizon(self) -> bool:
        """True once the scene's time is over."""
        return self.steps_done >= self.prepared.steps

    @property
    def speed(self) -> float:
        """Speed of the ego, m/s."""
        return float(self.state.speeds[0])

    @property
    def place_m(self) -> float:
        """Place of the ego along the road, m."""
        if self.state.places is not None:
            return float(self.state.places[0, 0])
        x, y = self.state.poses[0, :2].tolist()
        return float(self.prepared.course.corridor.locate(x, y, None)[0])

    def info(self, before: State | None) -> dict[str, Any]:
        """Return the facts of the state; `before` is the state one step earlier, from which velocities follow."""
        state = self.state
        return {
            "scene": self.prepared.scene.id,
            "time": state.time,
            "collision": bool(state.contacts),
            "collisions": state.contacts,
            "off_road": state.off_road,
            "ttc_s": least_time_to_collision(before, state, self.prepared.course),
            "gap_m": float(state.gaps[1:].min(initial=math.inf)),
            "speed": self.speed,
            "progress_m": self.place_m - self._start_m,
        }
