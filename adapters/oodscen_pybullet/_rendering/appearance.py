"""The current appearance of every body: paint, lamps, gait phase, phase of flashing lamps."""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from oodscen._seeding import stream
from oodscen.data._catalogue import Asset
from oodscen.data._details import Details
from oodscen.data._scene import Scene, Trigger
from oodscen.driving._sight.lamps import STANDING, has_lamps_on, is_braking, waits_in_traffic
from oodscen.numerics import _exact as exact
from oodscen_pybullet._meshes import FLASHING, GAITS, SMOKING, Mesh, asset_mesh, paints_of
from oodscen_pybullet._meshes.living.poses import pose_of
from oodscen_pybullet._meshes.look import (
    BEATS,
    RUNNING,
    STEPS,
    WALKING,
    Direction,
    beating,
    reacting,
)
from oodscen_pybullet._meshes.tilting import UPRIGHT, Tilt, tilted
from oodscen_pybullet._types import Pose

_RUNNING_PACE, _RUNNING_STRIDE = 2.4, 1.7
"""Speed above which legs run, in walking strides per second, and the length of a running stride in walking ones."""
_SIGNALS = frozenset({"signal", "work_zone"})
"""Categories of assets whose state may begin at a trigger."""
_FLASHES_HZ = 1.5
"""Cycles of a flashing lamp per second; it is lit for two thirds of each."""
_PUFFS_HZ = 6.0
"""Frames of smoke per second."""
_WARNED_S = 3.2
"""Time to arrival of the ego below which a person in its way reacts, s."""
_IN_THE_WAY_M = 2.2
"""Distance from the middle of the ego's way within which a person reacts, m."""
_APPROACHING_MPS = 3.0
"""Least speed of an ego that people react to, m/s."""
_AMBER_S = 2.0
"""Time for which a signal is amber before it is red, s."""
_BEFORE = {"red": "green", "green": "red", "amber": "green"}
"""State of a signal before another one."""
_ROUNDING = 1e-6
"""Amount by which a time, s, or a count may fall short of a change and count as past it."""


class Look(NamedTuple):
    """The mesh that shows a body."""

    asset: str
    state: str = ""
    """A state of the asset; the suffix `+brake` also lights the brake lamps."""
    paint: str = ""
    running: bool = False
    """True if head and tail lamps are on."""
    frame: int = 0
    """Animation frame of a self-moving part.

    Legs: 0 stands, 1 to 8 walk, 9 to 16 run; `look.reacting` adds a person's reaction. Flashing lamps:
    0 is lit, 1 dark. Smoke: 0 to 7. `look.beating` adds the beat of a pose.
    """
    details: Details | None = None
    tilt: Tilt = UPRIGHT


class _Body(NamedTuple):
    """A body of a scene, as far as it does not change."""

    asset: Asset
    state: str
    """The state that the scene gives it."""
    paint: str
    has_lamps_on: bool
    waits: bool
    """True if its driver waits in traffic."""
    details: Details | None
    """Its details, with the ids of meshes for things made to order."""
    trigger: Trigger


class SceneBodies:
    """The bodies of one scene and their appearance, the ego first."""

    def __init__(self, scene: Scene, seed: int) -> None:
        """Start with no bodies.

        Args:
            scene: Gives the weather and the drivers.
            seed: Seed of the paints.
        """
        self._scene = scene
        self._seed = seed
        self._bodies: list[_Body] = []
        self._actors = {actor.id: actor for actor in scene.actors}

    @property
    def assets(self) -> list[Asset]:
        """The assets of all bodies, the ego's first."""
        return [body.asset for body in self._bodies]

    def add(
        self, actor_id: str, asset: Asset, state: str, made: Mapping[str, str] | None = None
    ) -> None:
        """Add one body; the ego comes first.

        Args:
            actor_id: Id of the actor.
            asset: Its asset.
            state: A state of the asset.
            made: Ids of meshes by the names of the things made to order.
        """
        actor = self._actors.get(actor_id)
        body = _Body(
            asset=asset,
            state=state,
            paint=_choose_paint(self._seed, actor_id, asset.id),
            has_lamps_on=has_lamps_on(self._scene, actor_id),
            waits=waits_in_traffic(self._scene, actor_id),
            details=_with_meshes(actor.details if actor else None, made or {}),
            trigger=actor.behaviour.trigger if actor else Trigger(),
        )
        self._bodies.append(body)

    def looks(
        self,
        poses: Sequence[Pose],
        speeds: Sequence[float],
        accelerations: Sequence[float],
        fired: Sequence[float],
        time: float,
    ) -> list[Look]:
        """Return the look of every body.

        Args:
            poses: x, y, z and yaw of each body, m and rad.
            speeds: Speeds along the headings, m/s.
            accelerations: Accelerations along the headings, m/s^2.
            fired: Times at which the triggers fired, s; negative before.
            time: Time since the start, s.
        """
        looks = []
        for body, pose, speed, acceleration, fired_at in zip(
            self._bodies, poses, speeds, accelerations, fired, strict=True
        ):
            asset, state, details = body.asset, body.state, body.details
            if asset.category in _SIGNALS:
                state = phase_of(asset, state, body.trigger, fired_at, time)
            frame = frame_of(asset.id, state, pose, speed, time)
            if asset.category == "pedestrian" and asset.id in GAITS:
                direction = seen_coming(pose, poses[0], speeds[0])
                frame = reacting(frame, direction) if direction else frame
            if details is not None:
                frame = beating(frame, beat_of(details, pose, speed, time))
            if is_braking(speed, acceleration, waits=body.waits) and "brake" in asset.states:
                state = _with_brake_lamps(state)
            looks.append(Look(asset.id, state, body.paint, body.has_lamps_on, frame, details))
        return looks


def _with_brake_lamps(state: str) -> str:
    """Return a vehicle's state with its brake lamps lit, unless all lamps are dead."""
    if state == "unlit":
        return state
    return "brake" if state in ("", "off", "brake") else f"{state}+brake"


def phase_of(asset: Asset, state: str, trigger: Trigger, fired: float, time: float) -> str:
    """Return the state that a signal shows: its own from the trigger on, and before it the preceding one.

    A signal that has amber shows it for two seconds before it is red: up to a trigger by time, which is known in
    advance, or after another one.

    Args:
        asset: The signal.
        state: The state of the scene.
        trigger: The trigger of the signal's behaviour; by default it fires at the start.
        fired: Time at which it fired, s; negative before.
        time: Time since the start, s.
    """
    amber_s = _AMBER_S if state == "red" and "amber" in asset.states else 0.0
    if trigger.kind == "time":
        since = time - trigger.value
    else:
        since = time - fired - amber_s if fired >= 0.0 else -math.inf
    if since >= -_ROUNDING:
        return state
    return "amber" if since >= -amber_s - _ROUNDING else _BEFORE.get(state, state)


def seen_coming(pose: Pose, ego: Pose, speed: float) -> Direction | None:
    """Return the side on which a person sees the ego coming; `None` if they do not react to it.

    Args:
        pose: x, y, z and yaw of the person, m and rad.
        ego: Pose of the ego.
        speed: Its speed, m/s.
    """
    dx, dy = pose[0] - ego[0], pose[1] - ego[1]
    s, c = exact.sincos(ego[3])
    ahead, aside = c * dx + s * dy, c * dy - s * dx
    is_near = speed >= _APPROACHING_MPS and 0.0 < ahead < _WARNED_S * speed
    if not is_near or abs(aside) > _IN_THE_WAY_M:
        return None
    s, c = exact.sincos(pose[3])
    before, left = -c * dx - s * dy, s * dx - c * dy
    if before > 2.0 * abs(left):
        return "ahead"
    # People do not see what comes from behind.
    if before < -0.5 * abs(left):
        return None
    return "left" if left > 0.0 else "right"


def mesh_of(look: Look) -> Mesh:
    """Return a look's mesh."""
    asset, state, paint, running, frame, details, tilt = look
    mesh = asset_mesh(asset, state, paint, running=running, frame=frame, details=details)
    return mesh if tilt == UPRIGHT else tilted(mesh, tilt)


def frame_of(asset: str, state: str, pose: Pose, speed: float, time: float) -> int:
    """Return the animation frame of an asset; see `Look.frame`.

    Legs follow the position along the heading; lamps and smoke follow the time.
    """
    if asset in GAITS:
        return _leg_frame(GAITS[asset], pose, speed)
    if state in FLASHING or asset in FLASHING:
        return 0 if is_lit(time) else 1
    if asset in SMOKING:
        return math.floor(time * _PUFFS_HZ + _ROUNDING) % STEPS
    return 0


def beat_of(details: Details, pose: Pose, speed: float, time: float) -> int:
    """Return the beat of an actor's pose: by the time, or by the position along the heading."""
    cycle = pose_of(details)
    if cycle is None or cycle.second is None:
        return 0
    if cycle.period_s is not None:
        return math.floor(time * BEATS / cycle.period_s + _ROUNDING) % BEATS
    if cycle.stride_m is None or abs(speed) < STANDING:
        return 0
    return _step_along(cycle.stride_m, pose, BEATS)


def _with_meshes(details: Details | None, made: Mapping[str, str]) -> Details | None:
    """Return details with the ids of meshes in place of the names of things made to order."""
    if details is None or not made:
        return details
    named = {"holds": details.holds, "cargo": details.cargo}
    return details.model_copy(update={key: made.get(name, name) for key, name in named.items()})


def _step_along(length: float, pose: Pose, steps: int) -> int:
    """Return the step that the position along the heading has reached, of those in a length, m."""
    x, y, _, yaw = pose
    s, c = exact.sincos(yaw)
    way = (x * c + y * s) / length
    return math.floor(round(steps * (way - math.floor(way)), 3)) % steps


def is_lit(time: float) -> bool:
    """Return whether flashing lamps are lit at a time, s."""
    return math.floor(time * _FLASHES_HZ * 3.0 + _ROUNDING) % 3 < 2


def _leg_frame(stride_m: float, pose: Pose, speed: float) -> int:
    """Return the frame of legs that stand, walk or run, given the length of a walking stride."""
    pace = abs(speed)
    if pace < STANDING:
        return 0
    if pace > _RUNNING_PACE * stride_m:
        return RUNNING + _step_along(_RUNNING_STRIDE * stride_m, pose, STEPS)
    return WALKING + _step_along(stride_m, pose, STEPS)


def _choose_paint(seed: int, actor_id: str, asset: str) -> str:
    """Choose an actor's paint, the same in a scene and its twin."""
    paints = paints_of(asset)
    return paints[int(stream(seed, "paint", actor_id).integers(len(paints)))]
