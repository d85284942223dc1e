"""The kinematic world: positions and motion of all bodies, and the ego driver's observation."""

import hashlib
import math
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from oodscen._arguments import checked, instance_of
from oodscen._display import Brief, brief
from oodscen._numbers import finite_number, said, seed_number, whole_number
from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._scene import Scene, Trigger
from oodscen.driving._motion import actions
from oodscen.driving._motion import columns as col
from oodscen.driving._motion.car_following import free_road
from oodscen.driving._motion.placing import PlacedBodies
from oodscen.driving._motion.rollouts import Trial, Variation, is_passed
from oodscen.driving._motion.stepping import (
    advance,
    is_pulled,
    look,
    publish,
    pull_triggers,
    see_paths,
)
from oodscen.driving._motion.tilting import tilts
from oodscen.driving._motion.triggers import CODES, ROUNDING_S
from oodscen.driving._roads.corridor import Corridor
from oodscen.errors import UnknownComponent, UsageError
from oodscen.numerics._exact import quantised, wrapped
from oodscen.numerics._kernels import seen
from oodscen.protocols import Control, Observation, State

_SLIPPERIEST, _GRIPPIEST = 0.001, 1.5
"""Limits of the scale of the road's friction; a scene's lies between 0 and the same upper one."""
_NEAR_M = 5.0
"""Distance of a measured pose from the last one up to which its place is searched around the last, m."""


class WorldSnapshot(NamedTuple):
    """All changing state of a world, as plain data."""

    step: int
    state: bytes
    run: str
    """Fingerprint of the scene and the seed that it belongs to."""

    def __repr__(self) -> str:
        return brief(self, self._asdict().items())


class BodyMotion(NamedTuple):
    """The motion of one body: position in the world and on the road, speed and acceleration."""

    x: float
    y: float
    yaw: float
    s: float
    t: float
    heading: float
    """Heading relative to the road, rad."""
    speed: float
    acceleration: float
    """Acceleration along the heading, m/s^2."""
    lift: float
    """Height above the road, m."""
    triggered: float
    """Time at which its trigger fired, s; negative before."""


class KinematicWorld(Brief):
    """Moves the ego and the actors of one scene along a corridor in steps of `dt`.

    All state is plain floats, rounded to 1e-6 in every step and computed with plain arithmetic. The same
    scene, seed and controls therefore give the same bits on any machine.
    """

    _repr_fields = ("ids", "dt", "step_count")

    @checked
    def __init__(
        self,
        corridor: Corridor,
        scene: Scene,
        catalogue: Catalogue,
        seed: int,
        *,
        dt: float = 0.05,
    ) -> None:
        """Place all bodies at the start.

        Args:
            corridor: The road of `scene.map`.
            scene: A scene that `staging_issues` accepts.
            catalogue: Source of sizes and of the behaviours' defaults.
            seed: The episode's seed.
            dt: Seconds per step.

        Raises:
            ValueError: If the lane of the ego or an actor does not exist, or actors belong to each other in
                a cycle or to a body that does not exist.
            KeyError: If the catalogue lacks an asset or behaviour.
        """
        self.corridor = corridor
        self.scene = scene
        self._seed = seed_number(seed)
        self.dt = finite_number("dt", dt, 1e-4, 10.0)
        self.step_count = 0
        placed = PlacedBodies(corridor, scene, catalogue, seed, dt=self.dt)
        self.lane = placed.lane
        self.ids = placed.ids
        """`ego`, then the actors in the scene's order."""
        self.sizes = placed.sizes
        """Length and width of every body, rows as in `ids`."""
        self._bodies, self._rows = placed.bodies, placed.rows
        self._state, self._traits, self._codes = placed.state, placed.traits, placed.codes
        self._situation = placed.situation
        self.friction = self._situation.friction
        self.visual_range = self._situation.visual_range
        see_paths(self._situation)
        pull_triggers(self._situation, 0.0)

    @property
    def time(self) -> float:
        """Seconds since the start."""
        return quantised(self.step_count * self.dt)

    def bodies(self) -> list[tuple[str, Asset, str]]:
        """Return id, asset and state of every body, rows as in `ids`."""
        return list(self._bodies)

    def state(self) -> State:
        """Return the public state; its arrays belong to the caller."""
        return self.publish()[0]

    def publish(self) -> tuple[State, NDArray[np.float64]]:
        """Return the public state, and the gaps between the circles around the footprints, [n], m."""
        count = len(self.ids)
        poses, rows, places = np.empty((count, 4)), np.empty((4, count)), np.empty((count, 2))
        off_road = publish(self._situation, seen(poses), seen(rows), seen(places))
        speeds, accelerations, gaps, apart = rows
        state = State(
            self.step_count,
            self.time,
            self.ids,
            poses,
            speeds,
            gaps,
            bool(off_road),
            accelerations,
            places,
        )
        return state, apart

    def poses(self) -> NDArray[np.float64]:
        """Return x, y, z and yaw of every body: [n, 4], rows as in `ids`."""
        return self.state().poses

    def speeds(self) -> NDArray[np.float64]:
        """Return every body's speed along the heading, m/s: [n], rows as in `ids`."""
        return self._state[:, col.SPEED].copy()

    def accelerations(self) -> NDArray[np.float64]:
        """Return every body's acceleration along the heading over the last step, m/s^2: [n]."""
        return self._state[:, col.ACCELERATION].copy()

    def tilts(self) -> dict[int, tuple[float, float, float]]:
        """Return pitch and roll, rad, and the height about which it turns, m, of every tilted body by row."""
        return tilts(self._state, self._traits)

    def motion(self, body: str) -> BodyMotion:
        """Return the motion of one body by its id; an unknown one is an `UnknownComponent`."""
        return BodyMotion(*self._state[self._row(body), : col.TRIGGERED + 1].tolist())

    @property
    def ego(self) -> BodyMotion:
        """The motion of the ego."""
        return self.motion("ego")

    def lanes(self, body: str) -> tuple[int, int]:
        """Return the strip where an actor is placed, and the strip that it may move to."""
        row = self._row(body)
        return int(self._codes[row, col.LANE]), int(self._codes[row, col.TARGET])

    def observe(self) -> Observation:
        """Return the ego driver's observation."""
        now = look(self._situation, self.lane)
        return Observation(
            self.time,
            now.speed,
            now.offset,
            now.heading_error,
            now.curvature,
            now.wheelbase,
            None if now.left == math.inf else now.left,
            None if now.right == -math.inf else now.right,
            now.roadside,
            now.friction,
            self.visual_range,
            now.curve_speed,
        )

    def is_off_road(self) -> bool:
        """Return whether any part of the ego's footprint is beside the drivable road."""
        return self.state().off_road

    def is_due(self, trigger: Trigger, owner: str | None = None) -> bool:
        """Return whether a trigger fires now.

        Args:
            trigger: A trigger of a decision or an actor.
            owner: Id of the actor to measure to if the trigger names none.

        Raises:
            UnknownComponent: If there is no such actor.
        """
        name = trigger.actor or owner
        row = 0 if trigger.kind == "time" or name is None else self._row(name)
        code = CODES[trigger.kind]
        return bool(is_pulled(self._situation, code, trigger.value, row, self.time))

    def free_road(self, body: str) -> tuple[float, float]:
        """Return the gap to the body that an actor sees ahead, m, and the speed at which it moves away, m/s.

        The values are from the beginning of the last step. The gap is infinite if nothing is ahead within the
        visual range: that of fog, rain and snow, and at night that of headlamps for bodies without lamps.
        """
        gap, away = free_road(self._situation, self._row(body), -math.inf)
        return float(gap), float(away)

    def _row(self, body: str) -> int:
        try:
            return self._rows[body]
        except (KeyError, TypeError):
            raise UnknownComponent("body", str(body), self.ids) from None

    def step(self, control: Control) -> None:
        """Advance by one `dt`."""
        advance(
            self._situation, self.step_count, float(control.acceleration), float(control.steering)
        )
        self.step_count += 1

    def alter(self, *, friction: float | None = None, speed: float | None = None) -> None:
        """Change the road's friction or the ego's speed, m/s, from now on; snapshots keep the speed only.

        Args:
            friction: Scale of the road's friction, from 0.001 to 1.5; 1 is dry asphalt.
            speed: The ego's speed; a negative one is 0.

        Raises:
            UsageError: If a value is not a finite number, or the friction is out of range.
        """
        if friction is not None:
            friction = finite_number("friction", friction, _SLIPPERIEST, _GRIPPIEST)
        if speed is not None:
            self._state[0, col.SPEED] = quantised(max(0.0, finite_number("speed", speed)))
        if friction is not None:
            self.friction = friction
            self._situation = self._situation._replace(friction=friction)

    @cached_property
    def _run(self) -> str:
        """A fingerprint of what is run: the scene, the seed and the length of a step."""
        run = f"{self.scene.model_dump_json()} {self._seed} {self.dt!r}"
        return hashlib.sha256(run.encode()).hexdigest()

    def snapshot(self) -> WorldSnapshot:
        """Return all changing state."""
        return WorldSnapshot(self.step_count, self._state.tobytes(), self._run)

    def restore(self, snapshot: WorldSnapshot) -> None:
        """Return to an earlier state of this world; the run then repeats exactly.

        Raises:
            UsageError: If it is no snapshot, or one of another scene or seed.
        """
        instance_of("snapshot", snapshot, WorldSnapshot)
        if snapshot.run != self._run:
            raise UsageError(
                f"snapshot must be one of the scene {self.scene.id!r} with the seed {self._seed}, not of another "
                "scene or seed"
            )
        self.step_count = snapshot.step
        self._state[:] = np.frombuffer(snapshot.state).reshape(self._state.shape)

    def is_passed(self, action: str, variation: Variation, seconds: float) -> bool:
        """Return whether the ego passes if it executes an action from now on.

        It then touches nothing, stays on the road and does not pass the scene's stop line while the light is red.
        The world itself does not change.

        Args:
            action: Id of a discrete action.
            variation: The driver's reaction time, the road's friction and the ego's speed.
            seconds: Time for which the action is watched, s.

        Raises:
            UnknownComponent: If there is no such action.
        """
        if action not in actions.CODES:
            raise UnknownComponent("action", str(action), actions.CODES)
        start = self._state.copy()
        line = self.scene.stop_line
        begins_s = (
            self.time + variation.reaction_s - ROUNDING_S if variation.reaction_s > 0.0 else 0.0
        )
        trial = Trial(
            actions.CODES[action],
            begins_s,
            float(variation.speed),
            max(1, round(seconds / self.dt)),
            math.inf if line is None else self.corridor.start + line.ahead_m,
            0.0 if line is None else line.red_from_s,
        )
        world = self._situation._replace(friction=variation.friction * self.friction)
        try:
            return bool(is_passed(world, seen(start), self.step_count, self.lane, trial))
        finally:
            self._state[:] = start

    def follow(self, poses: NDArray[np.float64], speeds: NDArray[np.float64]) -> None:
        """Advance by one `dt`, in which all bodies have moved to measured poses.

        Args:
            poses: [n, 4] x, y, z and yaw, rows as in `ids`.
            speeds: [n] along the headings, m/s.

        Raises:
            UsageError: If an array has another shape or holds a value that is not a finite number.
        """
        before = self.speeds()
        self.set_poses(poses, speeds)
        self._state[:, col.ACCELERATION] = (self.speeds() - before) / self.dt
        self.step_count += 1
        pull_triggers(self._situation, self.time)

    def set_poses(self, poses: NDArray[np.float64], speeds: NDArray[np.float64]) -> None:
        """Move all bodies to measured poses, or none if there is a fault.

        Args:
            poses: [n, 4] x, y, z and yaw, rows as in `ids`.
            speeds: [n] along the headings, m/s.

        Raises:
            UsageError: If an array has another shape or holds a value that is not a finite number.
        """
        count = len(self.ids)
        poses, speeds = _finite("poses", poses, (count, 4)), _finite("speeds", speeds, (count,))
        for row in range(count):
            self._move(row, poses[row], float(speeds[row]))

    def set_pose(self, row: int, pose: NDArray[np.float64], speed: float) -> None:
        """Move one body to a measured pose.

        Args:
            row: The body's row, as in `ids`.
            pose: x, y, z and yaw.
            speed: Its speed along the heading, m/s.

        Raises:
            UsageError: If there is no such row, or a value is not a finite number.
        """
        row = whole_number("row", row, 0, len(self.ids) - 1)
        self._move(row, _finite("pose", pose, (4,)), finite_number("speed", speed))

    def _move(self, row: int, pose: NDArray[np.float64], speed: float) -> None:
        x, y, z, yaw = pose.tolist()
        state = self._state[row]
        is_near = np.abs(state[[col.X, col.Y]] - (x, y)).max() < _NEAR_M
        s, t = self.corridor.locate(x, y, float(state[col.S]) if is_near else None)
        _, _, ground, road = self.corridor.point(s, t)
        state[col.X], state[col.Y], state[col.YAW] = x, y, wrapped(yaw)
        state[col.S], state[col.T], state[col.HEADING] = s, t, wrapped(yaw - road)
        state[col.SPEED], state[col.LIFT] = speed, max(0.0, z - ground)


def _finite(name: str, values: NDArray[np.float64], shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Return an array of finite numbers of this shape, or raise a `UsageError` that names it."""
    try:
        array = np.asarray(values, np.float64)
    except (TypeError, ValueError, OverflowError):
        raise UsageError(f"{name} must be numbers, not {said(values)}") from None
    if array.shape != shape:
        raise UsageError(f"{name} must be of shape {shape}, not {array.shape}")
    if not np.isfinite(array).all():
        raise UsageError(f"{name} must be finite numbers, not {said(array.tolist())}")
    return array
