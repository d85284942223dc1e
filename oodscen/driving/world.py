"""The kinematic world: who is where, what everybody does next, and what the ego's driver is told."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from oodscen.catalogue import Asset, Catalogue
from oodscen.driving.behaviours import BEHAVE, MOVES_BEFORE_TRIGGER
from oodscen.driving.bodies import (
    WHEELBASE,
    ActorBody,
    ActorSnapshot,
    EgoBody,
    EgoSnapshot,
    quantised,
    wrapped,
)
from oodscen.driving.corridor import Corridor
from oodscen.driving.triggers import is_reached
from oodscen.protocols import Control, Observation
from oodscen.scene import Actor, Scene, Trigger
from oodscen.seeding import stream

_CLEARANCE = 0.2
"""Metres beside its own path within which a driver still counts a body as being in its way."""
_FLAT = 0.08
"""Bodies that are lower than this are driven over, m."""


class WorldSnapshot(NamedTuple):
    """Everything that changes in a world; plain data."""

    step: int
    ego: EgoSnapshot
    actors: tuple[ActorSnapshot, ...]


class KinematicWorld:
    """Moves the ego and the actors of one scene along a corridor, in steps of `dt`.

    All state is plain floats, rounded to 1e-6 in every step: the same scene, seed and controls
    give the same bits.
    """

    def __init__(
        self,
        corridor: Corridor,
        scene: Scene,
        catalogue: Catalogue,
        seed: int,
        *,
        dt: float = 0.05,
    ) -> None:
        """Place everything at the start.

        Args:
            corridor: The road of `scene.map`.
            scene: One that `staging_issues` accepts.
            catalogue: For sizes and for the behaviours' defaults.
            seed: Of the episode.
            dt: Seconds per step.

        Raises:
            ValueError: When the ego's lane or an actor's lane does not exist.
            KeyError: When the catalogue has no such asset or behaviour.
        """
        self.corridor = corridor
        self.scene = scene
        self.dt = dt
        self.friction = scene.weather.friction
        self.step_count = 0
        self.lane = ego_strip(corridor, scene.ego.lane)
        start = corridor.start
        offset = corridor.centre(self.lane, start)
        x, y, _, yaw = corridor.point(start, offset)
        self.ego = EgoBody(
            quantised(x), quantised(y), quantised(yaw), scene.ego.speed, start, offset
        )
        self._locate_ego()
        assets = {asset.id: asset for asset in catalogue.assets}
        kinds = {kind.id: kind for kind in catalogue.behaviours}
        self.actors: list[ActorBody] = []
        self._triggers: list[Trigger] = []
        for actor in scene.actors:
            kind = kinds[actor.behaviour.name]
            defaults = {name: one.default for name, one in kind.parameters.items()}
            parameters = {**defaults, **actor.behaviour.parameters}
            self.actors.append(self._place(actor, assets[actor.asset], parameters, seed))
            self._triggers.append(actor.behaviour.trigger)
        self.ids = ("ego", *(actor.id for actor in self.actors))
        """`ego`, then the actors in the scene's order."""
        self._ego_asset = catalogue.ego
        self.sizes = [
            (asset.length, asset.width)
            for asset in (catalogue.ego, *(actor.asset for actor in self.actors))
        ]
        """Length and width of every body, rows as in `ids`."""
        rows = {name: row for row, name in enumerate(self.ids)}
        self._measured = [
            rows[trigger.actor or actor.id]
            for trigger, actor in zip(self._triggers, self.actors, strict=True)
        ]
        self._rows = rows
        self._paths: list[tuple[float, float, float, float, float, bool]] = []
        self._pull_triggers()

    # ------------------------------------------------------------------ what others read

    @property
    def time(self) -> float:
        """Seconds since the start."""
        return round(self.step_count * self.dt, 6)

    def bodies(self) -> list[tuple[str, Asset, str]]:
        """Return id, asset and state of every body, rows as in `ids`."""
        ego = self._ego_asset
        first = ("ego", ego, ego.states[0] if ego.states else "")
        return [first, *((actor.id, actor.asset, actor.state) for actor in self.actors)]

    def poses(self) -> NDArray[np.float64]:
        """Return x, y, z and yaw of every body: [n, 4], rows as in `ids`."""
        point = self.corridor.point
        ego = self.ego
        _, _, z, _ = point(ego.s, ego.t)
        rows = [(ego.x, ego.y, round(z, 6) + 0.0, ego.yaw)]
        for actor in self.actors:
            x, y, z, yaw = point(actor.s, actor.t)
            yaw = math.remainder(yaw + actor.heading, math.tau)
            rows.append(
                (round(x, 6) + 0.0, round(y, 6) + 0.0, round(z, 6) + 0.0, round(yaw, 6) + 0.0)
            )
        return np.array(rows)

    def speeds(self) -> NDArray[np.float64]:
        """Return everybody's speed along the heading, m/s: [n], rows as in `ids`."""
        return np.array([self.ego.speed, *(actor.speed for actor in self.actors)])

    def observe(self) -> Observation:
        """Return what the ego's driver is told."""
        road, ego, lane = self.corridor, self.ego, self.lane
        centre = road.centre(lane, ego.s)
        here = self._current_lane()
        left, right = road.neighbour(here, ego.s, 1), road.neighbour(here, ego.s, -1)
        return Observation(
            time=self.time,
            speed=ego.speed,
            offset_m=ego.t - centre,
            heading_error=wrapped(ego.yaw - road.point(ego.s, 0.0)[3]),
            curvature=_curvature_at(road, ego.s + max(1.0, 0.2 * ego.speed), ego.t),
            wheelbase=WHEELBASE,
            lane_left_m=None if left is None else road.centre(left, ego.s) - centre,
            lane_right_m=None if right is None else road.centre(right, ego.s) - centre,
            roadside_m=self._roadside(lane) - centre,
            friction=self.friction,
        )

    def is_off_road(self) -> bool:
        """Tell whether a part of the ego's footprint is beside the drivable road."""
        road, ego = self.corridor, self.ego
        length, width = self.sizes[0]
        askew = ego.yaw - road.heading(ego.s)
        reach = 0.5 * (length * abs(math.sin(askew)) + width * abs(math.cos(askew))) + 0.1
        if abs(road.bend(ego.s)) < 0.02 and road.is_drivable(ego.s, ego.t - reach, ego.t + reach):
            return False
        cos, sin = math.cos(ego.yaw), math.sin(ego.yaw)
        places = []
        for along, across in ((0.5, 0.5), (0.5, -0.5), (-0.5, 0.5), (-0.5, -0.5)):
            u, v = along * length, across * width
            x, y = ego.x + u * cos - v * sin, ego.y + u * sin + v * cos
            places.append(road.locate(x, y, ego.s))
        offsets = [t for _, t in places]
        low, high = min(offsets), max(offsets)
        return not all(road.is_drivable(s, low, high) for s, _ in places)

    def is_due(self, trigger: Trigger, owner: str | None = None) -> bool:
        """Tell whether a trigger fires now.

        Args:
            trigger: A decision, or an actor's.
            owner: Id of the actor to which it is measured where the trigger names none.
        """
        name = trigger.actor or owner
        row = 0 if trigger.kind == "time" or name is None else self._rows[name]
        return self._reached(trigger, row)

    # ------------------------------------------------------------------ motion

    def step(self, control: Control) -> None:
        """Advance by one `dt`."""
        self._paths = [self._path(row) for row in range(len(self.ids))]
        self.ego.advance(control, self.friction, self.dt)
        for actor in self.actors:
            BEHAVE[actor.behaviour](actor, self)
        self.step_count += 1
        self._locate_ego()
        self._pull_triggers()

    def snapshot(self) -> WorldSnapshot:
        """Return everything that changes."""
        return WorldSnapshot(
            self.step_count,
            self.ego.snapshot(),
            tuple(actor.snapshot() for actor in self.actors),
        )

    def restore(self, snapshot: WorldSnapshot) -> None:
        """Return to a state of this world; what follows equals what followed then."""
        self.step_count = snapshot.step
        self.ego.restore(snapshot.ego)
        for actor, values in zip(self.actors, snapshot.actors, strict=True):
            actor.restore(values)

    def free_road(self, body: ActorBody) -> tuple[float, float]:
        """Return the gap to what is ahead in a body's path, m, and its speed away from it.

        The gap is infinite where nothing is ahead.
        """
        row = self._rows[body.id]
        s, t, _, half_length, half_width, _ = self._paths[row]
        best, away = math.inf, 0.0
        for other, (os, ot, speed, reach, half, is_flat) in enumerate(self._paths):
            ahead = (os - s) * body.direction
            if ahead <= 0.0 or other == row or is_flat:
                continue
            if abs(ot - t) >= half + half_width + _CLEARANCE:
                continue
            gap = ahead - reach - half_length
            if gap < best:
                best, away = gap, speed * body.direction
        return best, away

    # ------------------------------------------------------------------ inside

    def _place(
        self, actor: Actor, asset: Asset, parameters: Mapping[str, float], seed: int
    ) -> ActorBody:
        road, place, name = self.corridor, actor.placement, actor.behaviour.name
        lane = neighbour_strip(road, self.lane, place.lane)
        target = lane
        if "lanes" in parameters:
            target = neighbour_strip(road, lane, round(parameters["lanes"]))
        heading = math.radians(place.heading_deg)
        if name == "wrong_way":
            heading = math.pi
        if road.strips[lane].direction < 0:
            heading += math.pi
        heading = quantised(wrapped(heading))
        s = quantised(road.start + place.ahead_m)
        speed = parameters.get("speed", 0.0) if name in MOVES_BEFORE_TRIGGER else 0.0
        return ActorBody(
            id=actor.id,
            asset=asset,
            state=actor.state or (asset.states[0] if asset.states else ""),
            behaviour=name,
            parameters=dict(parameters),
            lane=lane,
            target_lane=target,
            offset=place.offset_m,
            direction=1 if math.cos(heading) >= 0.0 else -1,
            phase=float(stream(seed, "actor", actor.id).uniform(0.0, math.tau)),
            s=s,
            t=quantised(road.centre(lane, s) + place.offset_m),
            heading=heading,
            speed=quantised(speed),
        )

    def _locate_ego(self) -> None:
        s, t = self.corridor.locate(self.ego.x, self.ego.y, self.ego.s)
        self.ego.s, self.ego.t = quantised(s), quantised(t)

    def _path(self, row: int) -> tuple[float, float, float, float, float, bool]:
        """Return s, t, speed along the road, half extents along and across, and whether it is flat."""
        length, width = self.sizes[row]
        if row == 0:
            ego = self.ego
            heading = ego.yaw - self.corridor.heading(ego.s)
            s, t, speed, is_flat = ego.s, ego.t, ego.speed, False
        else:
            actor = self.actors[row - 1]
            heading, s, t, speed = actor.heading, actor.s, actor.t, actor.speed
            is_flat = actor.asset.height < _FLAT
        cos, sin = math.cos(heading), math.sin(heading)
        along = 0.5 * (length * abs(cos) + width * abs(sin))
        across = 0.5 * (length * abs(sin) + width * abs(cos))
        return s, t, speed * cos, along, across, is_flat

    def _pull_triggers(self) -> None:
        """Note when each actor's trigger fires for the first time."""
        for actor, trigger, row in zip(self.actors, self._triggers, self._measured, strict=True):
            if actor.triggered < 0.0 and self._reached(trigger, row):
                actor.triggered = self.time

    def _reached(self, trigger: Trigger, row: int) -> bool:
        ego = self.ego
        ahead = actor_speed = ego_speed = 0.0
        if trigger.kind != "time":
            actor = self.actors[row - 1]
            ahead = actor.s - ego.s
            ego_speed = ego.speed * self.corridor.alignment(ego.s, ego.yaw)
            actor_speed = actor.speed * math.cos(actor.heading)
        return is_reached(
            trigger.kind,
            trigger.value,
            time=self.time,
            ahead=ahead,
            ego_speed=ego_speed,
            actor_speed=actor_speed,
        )

    def _current_lane(self) -> int:
        """Return the driving strip that holds the ego's centre, or the one in which it started."""
        road, ego = self.corridor, self.ego
        for index in road.driving:
            right, left = road.edges(index, ego.s)
            if right <= ego.t < left:
                return index
        return self.lane

    def _roadside(self, lane: int) -> float:
        """Return t where the ego stands clear of the lanes, or as far right as the road allows."""
        road, s = self.corridor, self.ego.s
        outer: int | None = lane
        rightmost = lane
        while outer is not None:
            rightmost = outer
            outer = road.neighbour(rightmost, s, -1)
        edge = road.edges(rightmost, s)[0]
        limits = road.drivable_range(s, road.centre(rightmost, s))
        verge = edge if limits is None else limits[0]
        half = 0.5 * self.sizes[0][1]
        return max(edge - half - 0.2, verge + half + 0.25)


def _curvature_at(road: Corridor, s: float, t: float) -> float:
    """Return the curvature of the line that keeps the offset `t`."""
    bend = road.bend(s)
    return bend / max(0.2, 1.0 - bend * t)


def ego_strip(corridor: Corridor, lane: int) -> int:
    """Return the strip of the ego's lane, counted from the right.

    Raises:
        ValueError: When the road has fewer lanes in the ego's direction.
    """
    lanes = corridor.ego_lanes
    if lane >= len(lanes):
        raise ValueError(f"the road has {len(lanes)} lanes in the ego's direction (0 is the right)")
    return lanes[lane]


def neighbour_strip(corridor: Corridor, strip: int, lanes: int) -> int:
    """Return the driving strip some lanes to the left of another, oncoming ones counted.

    Raises:
        ValueError: When there is no such lane.
    """
    driving = corridor.driving
    place = driving.index(strip) + lanes
    if not 0 <= place < len(driving):
        here = driving.index(strip)
        raise ValueError(
            f"there is no lane {lanes:+d}; from here they are {-here}..{len(driving) - 1 - here}"
        )
    return driving[place]
