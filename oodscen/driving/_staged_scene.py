"""A scene on its road, for simulators that own motion: starting places, and measures of any places."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from oodscen._arguments import checked, state_of
from oodscen._display import Brief
from oodscen._field_docs import with_fields
from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._scene import Actor, Scene
from oodscen.data._weather import Weather
from oodscen.driving._flat_frame import flat_frame
from oodscen.driving._motion.bodies import within_grip
from oodscen.driving._motion.world import KinematicWorld
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.errors import UsageError
from oodscen.protocols import Camera, Control, Frame, Observation, State

Floats = NDArray[np.float64]

_ON_ROAD_M = -1e9
"""A height for bodies without one, m: no body is ever measured below the road."""
_FARTHEST = 1e9
"""Largest coordinate, m, and angle, rad, with which distances can still be measured."""


@with_fields
@dataclass(frozen=True)
class StagedBody:
    """One body of a scene at its start."""

    id: str
    """`ego`, or the actor's id."""
    asset: Asset
    """Its size and kind."""
    state: str
    """One of the asset's states; empty if it has none."""
    pose: tuple[float, float, float, float]
    """x, y, z of the footprint's centre on the ground, m, and yaw, rad."""
    speed: float
    """Speed along the heading at the start, m/s; 0 for behaviours that stand until their trigger."""
    lane: int
    """Index in `Corridor.strips` of the lane in which it is placed."""
    goal_lane: int
    """Index of the lane that it may change to; `lane` if its behaviour changes none."""
    direction: int
    """+1 if it travels with the ego, -1 against it."""
    behaviour: str = ""
    """Id of its behaviour; empty for the ego."""
    parameters: Mapping[str, float] | None = None
    """All parameters of the behaviour, with the catalogue's defaults; `None` for the ego."""
    actor: Actor | None = None
    """Its entry in the scene; `None` for the ego."""


class LaneCentreline(NamedTuple):
    """The middle of one driving lane, in its direction of travel."""

    strip: int
    """Index in `Corridor.strips`."""
    direction: int
    """+1 for a lane in the ego's direction, -1 for an oncoming one."""
    points: Floats
    """[n, 2] x and y, m."""
    widths: Floats
    """[n] width of the lane at the points, m; 0 where it does not exist."""


class StagedScene(Brief):
    """A scene on its road: the bodies at their start, and measures of the places that they move to.

    Poses are [n, 4]: x, y, z of the footprint's centre on the ground, m, and yaw, rad; rows as in `ids`. A
    simulator without heights may give [n, 3]: x, y and yaw, for bodies that stand on the road.
    """

    _repr_fields = ("ids",)
    Body: TypeAlias = StagedBody
    """One of `bodies`."""

    @checked
    def __init__(
        self, scene: Scene, catalogue: Catalogue, seed: int = 0, *, dt: float = 0.05
    ) -> None:
        """Place all bodies at the start.

        Args:
            scene: A scene without faults by `Scene.check`.
            catalogue: The simulator's catalogue.
            seed: The episode's seed.
            dt: Seconds per step.
        """
        self.scene = scene
        self.catalogue = catalogue.for_scene(scene)
        self.corridor: Corridor = load_corridor(scene.map, catalogue)
        """The road: `point`, `locate`, `centre`, `edges`, `heading`, `bend` and `is_drivable` tell its geometry."""
        self._world = KinematicWorld(self.corridor, scene, catalogue, seed, dt=dt)
        self.ids = self._world.ids
        """`ego`, then the actors in the scene's order."""
        self.bodies = tuple(self._body(row) for row in range(len(self.ids)))
        """All bodies at their start, in the order of `ids`."""

    @cached_property
    def lanes(self) -> tuple[LaneCentreline, ...]:
        """Centrelines of all driving lanes from right to left, every two metres."""
        return lane_centrelines(self.corridor)

    def places(self, poses: Floats) -> Floats:
        """Return s along the corridor and t to its left of every body, m: [n, 2].

        Raises:
            UsageError: If the poses have another shape, or are not finite.
        """
        places = self._at(poses).state().places
        assert places is not None, "the kinematic world measures them"
        return places

    def gaps(self, poses: Floats) -> Floats:
        """Return the gaps between the ego's box and the others', as in `State.gaps`: [n], m.

        Raises:
            UsageError: If the poses have another shape, or are not finite.
        """
        return self._at(poses).state().gaps

    def off_road(self, poses: Floats) -> bool:
        """Return whether any part of the ego's footprint is beside the drivable road.

        Raises:
            UsageError: If the poses have another shape, or are not finite.
        """
        return self._at(poses).is_off_road()

    @checked
    def observation(self, state: State) -> Observation:
        """Return the ego driver's observation of a state of any simulator.

        Raises:
            UsageError: If the state is one of another scene.
        """
        state_of(self.scene, state)
        self._world.set_poses(state.poses, state.speeds)
        return replace(self._world.observe(), time=state.time)

    def within_grip(self, control: Control, speed: float, friction: float | None = None) -> Control:
        """Return the part of the ego's control that motor, wheels and tyres can follow on this road.

        The kinematic world drives its ego by this friction circle (Rajamani 2012, chapters 2 and 13).

        Args:
            control: The driver's control.
            speed: The ego's speed, m/s.
            friction: Friction scale, 1 on dry asphalt; by default the scene's.

        Raises:
            UsageError: If speed or friction is not a finite number.
        """
        if friction is None:
            friction = self.scene.weather.friction
        return within_grip(control, speed, friction)

    @checked
    def draw(self, camera: Camera, poses: Floats, weather: Weather | None = None) -> Frame:
        """Draw the scene as shaded boxes on a plane, for a simulator without pictures of its own.

        Args:
            camera: The camera, relative to the ego, whose own box is not drawn.
            poses: The poses of all bodies.
            weather: The weather to show, by default the scene's: fog, night, rain and snow.

        Raises:
            UsageError: If the poses have another shape, or are not finite.
        """
        all_poses = self._with_heights(poses)
        assets = [body.asset for body in self.bodies]
        return flat_frame(camera, self.corridor, weather or self.scene.weather, assets, all_poses)

    def _at(self, poses: Floats) -> KinematicWorld:
        """Return the world with all bodies standing at poses."""
        all_poses = self._with_heights(poses)
        self._world.set_poses(all_poses, np.zeros(len(all_poses)))
        return self._world

    def _with_heights(self, poses: Floats) -> Floats:
        """Return the caller's poses with z.

        Raises:
            UsageError: If they have another shape, or are not finite.
        """
        try:
            return with_heights(poses, len(self.ids))
        except (TypeError, ValueError, OverflowError) as error:
            raise UsageError(f"poses must be those of all bodies, not {error}") from None

    def _body(self, row: int) -> StagedBody:
        """Return the body in a row, as the world has it now."""
        world = self._world
        body_id, asset, state = world.bodies()[row]
        x, y, z, yaw = map(float, world.poses()[row])
        body = StagedBody(
            id=body_id,
            asset=asset,
            state=state,
            pose=(x, y, z, yaw),
            speed=float(world.speeds()[row]),
            lane=world.lane,
            goal_lane=world.lane,
            direction=1 if self.corridor.alignment(world.motion(body_id).s, yaw) >= 0.0 else -1,
        )
        if row == 0:
            return body
        actor = self.scene.actors[row - 1]
        lane, goal_lane = world.lanes(body_id)
        kind = self.catalogue.behaviour(actor.behaviour.name)
        defaults = {name: parameter.default for name, parameter in kind.parameters.items()}
        return replace(
            body,
            lane=lane,
            goal_lane=goal_lane,
            behaviour=actor.behaviour.name,
            parameters={**defaults, **actor.behaviour.parameters},
            actor=actor,
        )


def lane_centrelines(corridor: Corridor) -> tuple[LaneCentreline, ...]:
    """Return the middle of every driving lane of a road, from right to left.

    The points are about 2 m apart along the road's reference line.
    """
    count = max(2, math.ceil(corridor.length / 2.0) + 1)
    along = np.linspace(0.0, corridor.length, count)
    x, y, cos, sin = (
        np.interp(along, corridor.s, values)
        for values in (corridor.x, corridor.y, corridor.cos, corridor.sin)
    )
    lines = []
    for index in corridor.driving:
        strip = corridor.strips[index]
        right, left = (np.interp(along, corridor.s, edge) for edge in (strip.right, strip.left))
        t = 0.5 * (right + left)
        points = np.stack([x - t * sin, y + t * cos], axis=1)
        direction = -1 if strip.direction < 0 else 1
        lines.append(
            LaneCentreline(index, direction, points[::direction], (left - right)[::direction])
        )
    return tuple(lines)


def with_heights(poses: Floats, count: int) -> Floats:
    """Return poses with z; bodies without one stand on the road.

    Raises:
        ValueError: If the poses have another shape, are not finite or beyond all sense.
    """
    array = np.asarray(poses)
    if array.dtype.kind not in "iuf":
        raise ValueError(f"poses of {array.dtype}, not of numbers")
    array = array.astype(np.float64)
    if array.shape not in ((count, 3), (count, 4)):
        raise ValueError(f"poses of shape {array.shape}, not ({count}, 4) or ({count}, 3)")
    if not np.isfinite(array).all():
        raise ValueError("poses that are not finite")
    if np.abs(array).max(initial=0.0) > _FARTHEST:
        raise ValueError(f"poses beyond {_FARTHEST:.0e} m or rad")
    if array.shape == (count, 4):
        return array
    return np.insert(array, 2, _ON_ROAD_M, axis=1)
