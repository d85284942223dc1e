"""Runs of changed scenes, with the settings of the scene's own run."""

from collections.abc import Sequence
from dataclasses import dataclass

from oodscen.data._episode import MOMENTS, Episode
from oodscen.data._reactions import REACTIONS_S
from oodscen.data._scene import Scene
from oodscen.protocols import Camera, Simulator
from oodscen.stages._simulate import Simulated, simulate


@dataclass(frozen=True)
class Rerunner:
    """Runs changed scenes as the scene itself was run."""

    simulator: Simulator
    seed: int = 0
    """Seed of the simulator's random streams."""
    traces: bool = False
    """Keep the ground truth of every action's rollout."""
    camera: Camera | None = None
    """The camera; by default the ego's dash camera."""
    reaction: Sequence[float] = REACTIONS_S
    """Reaction times of the drivers who try every action, s."""

    def probe(self, scene: Scene) -> Episode:
        """Run a scene without pictures."""
        return simulate(
            scene, self.simulator, seed=self.seed, render=False, reaction=self.reaction
        ).episode

    def keep_speed(self, scene: Scene) -> Episode:
        """Run a scene with the last picture alone, in which only keeping the speed is tried."""
        return simulate(
            scene,
            self.simulator,
            seed=self.seed,
            camera=self.camera,
            reaction=self.reaction,
            actions=("keep_speed",),
            moments=("last",),
        ).episode

    def run(self, scene: Scene, before: Simulated) -> Simulated:
        """Run a scene with frames of the same moments as those of an earlier run."""
        return simulate(
            scene,
            self.simulator,
            seed=self.seed,
            camera=self.camera,
            traces=self.traces,
            reaction=self.reaction,
            moments=tuple(before.frames) or MOMENTS,
        )
