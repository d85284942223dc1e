"""Abilities of simulators and drivers beyond their protocols.

An object has an ability if it has the members; it need not name the class. `docs/adapters.md` and `docs/judging.md`
list the members for their authors.
"""

from collections.abc import Sequence
from typing import Any, Protocol, runtime_checkable

from oodscen._numbers import said
from oodscen.data._scene import Scene
from oodscen.errors import Issue, SimulatorError
from oodscen.protocols import Camera, State


@runtime_checkable
class Snapshots(Protocol):
    """A simulator that can return to an earlier step of the current scene.

    Without it, every action is tried by resetting and repeating the approach.
    """

    def snapshot(self) -> Any:
        """Return the current state of all motion as plain data."""
        ...

    def restore(self, snapshot: Any) -> State:
        """Return to a snapshot of the current scene; the same controls then give the same bytes."""
        ...


@runtime_checkable
class Rehearses(Protocol):
    """A simulator that can try an action for other drivers and on other roads.

    Without it, only the reaction time is varied when an action is judged.
    """

    def rehearse(
        self,
        action: str,
        seconds: float,
        *,
        reaction_s: float,
        friction: float = 1.0,
        speed: float = 1.0,
    ) -> bool:
        """Return whether an action, begun now, passes.

        The ego touches nothing, stays on the road, and does not pass the scene's `stop_line` while the light is
        red. The simulator stays in its current state.

        Args:
            action: Id of a discrete action.
            seconds: Time for which the action is watched, s.
            reaction_s: Time for which the driver keeps lane and speed first, s.
            friction: Share of the scene's friction.
            speed: Share of the ego's current speed at which it drives on.
        """
        ...


@runtime_checkable
class ChecksScenes(Protocol):
    """A simulator that can tell why it will not run a scene as it is meant.

    Scenes are first checked on the kinematic world, in which behaviours of the simulator's own are
    replaced by those that they are like. This check follows.
    """

    def check(self, scene: Scene) -> Sequence[Issue]:
        """Return the reasons, each with its path in the scene; empty if the scene can be run.

        May be called without a `reset` and from several threads, and must not disturb a run.
        """
        ...


def own_issues(simulator: ChecksScenes, scene: Scene) -> list[Issue]:
    """Return the reasons of a simulator's own check.

    Raises:
        SimulatorError: If it returns anything else than a list of issues.
    """
    issues = simulator.check(scene)
    if not isinstance(issues, list | tuple) or not all(
        isinstance(issue, Issue) for issue in issues
    ):
        name = getattr(simulator, "name", type(simulator).__name__)
        raise SimulatorError(f"{name}: check() returned {said(issues, 80)}, not a list of issues")
    return list(issues)


@runtime_checkable
class NamesPackages(Protocol):
    """A simulator that names the installed packages on which its motion and pictures depend.

    A study records their versions.
    """

    packages: Sequence[str]
    """Names of distributions, such as `highway-env`."""


def packages_of(simulator: object) -> tuple[str, ...]:
    """Return the packages that a simulator names; none if it names none.

    Raises:
        SimulatorError: If they are no names.
    """
    if not isinstance(simulator, NamesPackages):
        return ()
    packages = simulator.packages
    if not isinstance(packages, list | tuple) or not all(
        isinstance(package, str) and package for package in packages
    ):
        name = getattr(simulator, "name", type(simulator).__name__)
        raise SimulatorError(f"{name}: packages is {said(packages, 80)}, not a list of names")
    return tuple(packages)


@runtime_checkable
class Looks(Protocol):
    """A driver that is shown the true state, as if it had perfect perception."""

    def look(self, state: State) -> None:
        """Receive the state; called before every `act`."""
        ...


@runtime_checkable
class WantsFrames(Protocol):
    """A driver that may ask for pictures."""

    wants_frames: bool
    """True to get the camera's picture with every observation."""


@runtime_checkable
class MountsCamera(Protocol):
    """A driver with a camera of its own, which takes its pictures if it `WantsFrames`.

    Without it, the dash camera does.
    """

    camera: Camera | None
    """The camera, moving with the ego; `None` for the dash camera."""
