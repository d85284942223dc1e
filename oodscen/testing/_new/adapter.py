"""A small simulator with dynamics of its own: a bicycle for the ego, and lane keepers that mind each other.

Replace the bodies of `begin`, `move`, `bodies` and `draw` by calls of the simulator that you connect.
"""

import copy
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from oodscen import Catalogue
from oodscen.data import Asset, WeatherRange
from oodscen.driving import RestorableSimulator, StagedScene
from oodscen.protocols import Camera, Control, Frame

EGO = Asset(
    id="ego_car", category="vehicle", description="a red car", length=4.5, width=1.85, height=1.5
)
ASSETS = (
    Asset(id="car", category="vehicle", description="a car", length=4.4, width=1.8, height=1.5),
    Asset(
        id="van", category="vehicle", description="a white van", length=5.6, width=2.0, height=2.4
    ),
    Asset(
        id="adult",
        category="pedestrian",
        description="an adult",
        length=0.5,
        width=0.55,
        height=1.75,
    ),
    Asset(
        id="cardboard_box",
        category="object",
        description="a cardboard box",
        length=1.0,
        width=1.0,
        height=0.9,
    ),
)
BEHAVIOURS = ("stand", "follow_lane", "hard_brake", "walk_along")
"""The built-in behaviours that this simulator can move. What they promise is in their descriptions."""
MAPS = ("residential_two_lane", "urban_avenue", "rural_curve")


@dataclass
class Mover:
    """One body and its motion."""

    body: StagedScene.Body
    x: float
    y: float
    yaw: float
    speed: float
    is_triggered: bool = False

    def parameter(self, name: str, otherwise: float = 0.0) -> float:
        """Return a parameter of its behaviour, or another number if that has no such parameter."""
        return float((self.body.parameters or {}).get(name, otherwise))


class MySimulator(RestorableSimulator):
    """Moves the bodies of a scene, and draws them as boxes."""

    name = "my_simulator"

    def catalogue(self) -> Catalogue:
        """Return what the simulator can show and do: promise only what it keeps."""
        return Catalogue(
            simulator=self.name,
            version="1",
            ego=EGO,
            assets=ASSETS,
            behaviours=tuple(kind for kind in self.BEHAVIOURS if kind.id in BEHAVIOURS),
            maps=tuple(road for road in self.MAPS if road.id in MAPS),
            weather=WeatherRange(
                min_sun_elevation_deg=20.0,
                sun_is_drawn=False,
                min_fog_visual_range_m=30.0,
                min_friction=0.3,
            ),
        )

    def begin(self, staged: StagedScene, seed: int) -> None:
        """Put all bodies at their start."""
        self.road = staged.corridor
        self.friction = staged.scene.weather.friction
        self.movers = [
            Mover(body, body.pose[0], body.pose[1], body.pose[3], body.speed)
            for body in staged.bodies
        ]

    def triggered(self, body: StagedScene.Body) -> None:
        """Let an actor begin what it waited for."""
        self.movers[self.staged.ids.index(body.id)].is_triggered = True

    def move(self, control: Control) -> None:
        """Move the ego, then the actors, which see where the others were."""
        before = self.movers
        self.movers = [copy.copy(mover) for mover in before]
        self._drive(self.movers[0], control)
        for mover in self.movers[1:]:
            match mover.body.behaviour:
                case "follow_lane":
                    hardest = -mover.parameter("deceleration")
                    self._follow(mover, max(self._attention(mover, before), hardest))
                case "hard_brake":
                    braking = -mover.parameter("deceleration")
                    wanted = self._attention(mover, before)
                    self._follow(mover, braking if mover.is_triggered else wanted)
                case "walk_along" if mover.is_triggered:
                    mover.speed = mover.parameter("speed")
                    mover.x += mover.speed * self.dt * math.cos(mover.yaw)
                    mover.y += mover.speed * self.dt * math.sin(mover.yaw)

    def bodies(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return x, y and yaw of all bodies, and their speeds."""
        poses = np.array([(mover.x, mover.y, mover.yaw) for mover in self.movers])
        return poses, np.array([mover.speed for mover in self.movers])

    def save(self) -> Any:
        """Return a copy of all that changes."""
        return [copy.copy(mover) for mover in self.movers]

    def resume(self, saved: Any) -> None:
        """Return to a copy."""
        self.movers = [copy.copy(mover) for mover in saved]

    def draw(self, camera: Camera) -> Frame:
        """Draw boxes on a plane; a simulator with pictures of its own returns those."""
        weather = self.staged.scene.weather.model_copy(update={"sun_elevation_deg": 45.0})
        return self.staged.draw(camera, self.state().poses, weather)

    def _drive(self, ego: Mover, control: Control) -> None:
        """Move the ego as a bicycle about its centre."""
        control = self.staged.within_grip(control, ego.speed, self.friction)
        slip = math.atan(0.5 * math.tan(control.steering))
        after = max(0.0, ego.speed + control.acceleration * self.dt)
        way = 0.5 * (ego.speed + after) * self.dt
        turn = way * math.sin(slip) / (0.5 * self.wheelbase)
        ego.x += way * math.cos(ego.yaw + 0.5 * turn + slip)
        ego.y += way * math.sin(ego.yaw + 0.5 * turn + slip)
        ego.yaw += turn
        ego.speed = after

    def _attention(self, mover: Mover, others: list[Mover]) -> float:
        """Return the acceleration of the intelligent driver model (Treiber et al. 2000)."""
        desired = max(mover.parameter("speed"), 0.1)
        acceleration = 1.8 * (1.0 - (mover.speed / desired) ** 4)
        for other in others:
            dx, dy = other.x - mover.x, other.y - mover.y
            ahead = dx * math.cos(mover.yaw) + dy * math.sin(mover.yaw)
            aside = abs(dy * math.cos(mover.yaw) - dx * math.sin(mover.yaw))
            if ahead > 0.0 and aside < 2.0 and not other.body.asset.is_passable(other.body.state):
                closing = mover.speed - other.speed * math.cos(other.yaw - mover.yaw)
                room = ahead - 0.5 * (mover.body.asset.length + other.body.asset.length)
                headway = mover.parameter("headway", 1.2)
                wanted = 2.0 + max(0.0, mover.speed * headway + mover.speed * closing / 4.2)
                acceleration -= 1.8 * (wanted / max(room, 0.1)) ** 2
        return acceleration

    def _follow(self, mover: Mover, acceleration: float) -> None:
        """Move along the lane; tyres limit the braking."""
        acceleration = max(acceleration, -9.0 * self.friction)
        after = max(0.0, mover.speed + acceleration * self.dt)
        way = 0.5 * (mover.speed + after) * self.dt * mover.body.direction
        s, t = self.road.locate(mover.x, mover.y)
        aside = t - self.road.centre(mover.body.lane, s)
        ahead = s + way / max(0.2, 1.0 - self.road.bend(s) * t)
        place = self.road.point(ahead, self.road.centre(mover.body.lane, ahead) + aside)
        mover.x, mover.y, _, heading = place
        if abs(way) > 1e-6:
            mover.yaw = heading if mover.body.direction > 0 else heading + math.pi
        mover.speed = after
