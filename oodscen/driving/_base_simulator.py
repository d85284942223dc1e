"""The common base of the base classes for simulators: catalogue, life cycle and road of a scene."""

from abc import ABC, abstractmethod
from typing import ClassVar, Self

from oodscen._abilities import ChecksScenes, own_issues
from oodscen._arguments import instance_of
from oodscen._display import Brief
from oodscen._members import as_catalogue
from oodscen._numbers import said
from oodscen.data._catalogue import BehaviourKind, Catalogue, RoadMap
from oodscen.data._scene import Scene
from oodscen.driving._frames import own_frame
from oodscen.driving._motion.behaviours.table import BEHAVIOURS
from oodscen.driving._motion.world import KinematicWorld
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._sight.placement import staging_issues, vocabulary_advice
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.errors import Issue, SceneError, SimulatorError, UsageError
from oodscen.protocols import Camera, Control, Frame, Observation, Simulator, State


class BaseSimulator(Brief, ABC):
    """Everything about a simulator that does not depend on who owns the motion."""

    BEHAVIOURS: ClassVar[tuple[BehaviourKind, ...]] = BEHAVIOURS
    """The behaviours of the kinematic world, for the catalogue."""
    MAPS: ClassVar[tuple[RoadMap, ...]] = SHIPPED_MAPS
    """The shipped maps, for the catalogue."""
    plays_motions: ClassVar[bool] = True
    """False if bodies cannot move through key poses: scenes with motions made to order are refused."""
    _repr_fields: ClassVar[tuple[str, ...]] = ("name", "dt")

    name: str
    """The simulator's name in reports and records."""
    dt: float = 0.05
    """Seconds per step."""

    def __init__(self) -> None:
        self._world: KinematicWorld | None = None
        self._state: State | None = None

    @abstractmethod
    def catalogue(self) -> Catalogue:
        """Return the simulator's vocabulary: static, cheap to call again, without starting anything."""

    @abstractmethod
    def draw(self, camera: Camera) -> Frame:
        """Render the camera's view; `ids` as in `Frame`: row r of the poses has id r + 1.

        The arrays may be the same in every call: they are checked and copied.
        """

    def release(self) -> None:
        """Release all resources; a later `reset` may acquire them again. May be called twice."""

    @property
    def world(self) -> KinematicWorld:
        """The kinematic world of the current scene.

        Raises:
            SimulatorError: Before the first `reset` or after `close`.
        """
        if self._world is None:
            raise SimulatorError(f"{self.name}: call reset before anything else")
        return self._world

    @property
    def corridor(self) -> Corridor:
        """The road of the current scene."""
        return self.world.corridor

    @abstractmethod
    def reset(self, scene: Scene, seed: int) -> State:
        """Load a scene. The same scene and seed give the same bytes, whatever ran before.

        Raises:
            SceneError: If the catalogue or the road refuses the scene.
            SpawnError: If an actor cannot be placed.
        """

    def render(self, camera: Camera) -> Frame:
        """Render the current state.

        Raises:
            SimulatorError: If `draw` returns something else than a frame of the camera's size.
            UsageError: If the camera is none.
        """
        instance_of("camera", camera, Camera)
        bodies = len(self.state().ids)
        return own_frame(self.draw(camera), camera, bodies, f"{self.name}: draw()")

    def observe(self) -> Observation:
        """Return the driver's observation of the current state."""
        return self.world.observe()

    def state(self) -> State:
        """Return the current state again."""
        if self._state is None:
            raise SimulatorError(f"{self.name}: call reset before anything else")
        return self._state

    def close(self) -> None:
        """Release all resources; may be called twice."""
        self._world = self._state = None
        self.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def _opened(self, scene: Scene) -> tuple[Corridor, Catalogue]:
        """Forget the last scene, and return the road and the catalogue of one that can be staged."""
        self._world = self._state = None
        instance_of("scene", scene, Scene)
        catalogue = as_catalogue(self.catalogue(), self.name)
        issues = staging_issues(scene, catalogue)
        if scene.motions and not self.plays_motions:
            fault = f"{self.name} moves bodies by itself and cannot play motions made to order"
            issues.append(Issue("motions", fault))
        if not issues and isinstance(self, ChecksScenes):
            issues = own_issues(self, scene)
        if issues:
            raise SceneError(scene.id, [*issues, *vocabulary_advice(scene, catalogue)])
        return load_corridor(scene.map, catalogue), catalogue

    def _keep_state(self, state: State) -> State:
        """Keep the current state, whose arrays become read-only, and return it."""
        for array in (state.poses, state.speeds, state.gaps, state.accelerations, state.places):
            assert array is not None, "the kinematic world measures all of them"
            array.setflags(write=False)
        self._state = state
        return state


def render_checked(simulator: Simulator, camera: Camera, bodies: int) -> Frame:
    """Render the current state of any simulator as a frame of the caller's own.

    `bodies` is the number of bodies in the scene, the ego included.

    Raises:
        SimulatorError: If `render` returns something else than a frame of the camera's size.
    """
    frame = simulator.render(camera)
    if getattr(type(simulator), "render", None) is BaseSimulator.render:
        return frame  # It is checked and copied already.
    return own_frame(frame, camera, bodies, f"{simulator.name}: render()")


def checked_control(control: Control) -> Control:
    """Return a control of finite numbers.

    Raises:
        UsageError: If it is anything else, which means that its driver is broken.
    """
    if not isinstance(control, Control) or not control.is_finite:
        raise UsageError(f"step() needs a Control of finite numbers, not {said(control, 200)}")
    return control
