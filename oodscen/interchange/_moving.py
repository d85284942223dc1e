"""Simulators that are lent for runs of which only the motion counts."""

from collections.abc import Iterator
from contextlib import contextmanager

from oodscen._members import working
from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._scene import Scene
from oodscen.driving import MirrorSimulator
from oodscen.driving._checked_simulator import checked_simulator, moves_as_world
from oodscen.driving._exclusive import exclusive
from oodscen.driving._roads.corridor import Corridor
from oodscen.errors import SimulatorError
from oodscen.numerics._exact import Floats
from oodscen.protocols import Camera, Frame, Simulator


class UnrenderedSimulator(MirrorSimulator):
    """The kinematic world of a catalogue without pictures."""

    name = "unrendered"

    def __init__(self, catalogue: Catalogue, dt: float = MirrorSimulator.dt) -> None:
        super().__init__()
        self._catalogue = catalogue
        self.dt = dt

    def catalogue(self) -> Catalogue:
        """Return the catalogue of the world."""
        return self._catalogue

    def load(self, corridor: Corridor, scene: Scene, seed: int) -> None:
        """Do nothing: there is no scenery."""

    def spawn(
        self, actor_id: str, asset: Asset, state: str, pose: tuple[float, float, float, float]
    ) -> None:
        """Do nothing: bodies are only boxes of the world."""

    def place(self, poses: Floats, speeds: Floats) -> None:
        """Do nothing: poses are only those of the world."""

    def draw(self, camera: Camera) -> Frame:
        """Refuse.

        Raises:
            SimulatorError: Always.
        """
        raise SimulatorError("this simulator has no pictures")


@contextmanager
def moving(simulator: Simulator | None, catalogue: Catalogue) -> Iterator[Simulator]:
    """Lend a simulator; in place of none, and of one that moves as the kinematic world, that world without pictures.

    Raises:
        SimulatorError: When the simulator fails, whatever it raises.
        UsageError: When another thread uses the simulator.
    """
    if simulator is None:
        yield UnrenderedSimulator(catalogue)
    elif moves_as_world(simulator):
        yield UnrenderedSimulator(catalogue, simulator.dt)
    else:
        with exclusive(simulator), working("simulator", simulator.name):
            yield checked_simulator(simulator)
