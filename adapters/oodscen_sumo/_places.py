"""Places as SUMO gives them: front bumpers, and lanes with one length per edge."""

import math
from typing import Any, NamedTuple


class FrontBumper(NamedTuple):
    """A place as SUMO gives it: the middle of the front bumper, and the compass direction."""

    x: float
    y: float
    angle_deg: float
    """Clockwise from north, degrees."""

    @classmethod
    def of(cls, x: float, y: float, yaw: float, *, length: float) -> "FrontBumper":
        """Return the place of a body of this length whose centre and yaw are parameters."""
        half = 0.5 * length
        return cls(x + half * math.cos(yaw), y + half * math.sin(yaw), 90.0 - math.degrees(yaw))

    def pose(self, length: float) -> tuple[float, float, float]:
        """Return x and y of the body's centre, m, and its yaw, rad."""
        yaw, half = math.remainder(math.radians(90.0 - self.angle_deg), math.tau), 0.5 * length
        return self.x - half * math.cos(yaw), self.y - half * math.sin(yaw), yaw


class LanePlace(NamedTuple):
    """A place on a lane of SUMO, which measures all lanes of an edge by one length.

    Equal distances on two lanes of a bent road are therefore not side by side: a vehicle that changes lanes
    would jump along the road. Here its place goes over from one lane's to the other's on the way.
    """

    edge: str
    along_m: float
    lane: int
    """Index of the lane, from the right."""
    left_m: float
    """Distance to the left of the lane's middle, m."""

    @classmethod
    def of(cls, sumo: Any, vehicle: str) -> "LanePlace":
        """Return the place of a vehicle's front bumper."""
        get = sumo.vehicle
        return cls(
            get.getRoadID(vehicle),
            get.getLanePosition(vehicle),
            get.getLaneIndex(vehicle),
            get.getLateralLanePosition(vehicle),
        )

    @classmethod
    def at(cls, sumo: Any, x: float, y: float) -> "LanePlace":
        """Return the place at x and y, m."""
        edge, along_m, lane = sumo.simulation.convertRoad(x, y)
        middle = cls(edge, along_m, lane, 0.0)
        (x_middle, y_middle), heading = middle._middle(sumo, middle.lane)
        left_m = (y - y_middle) * math.cos(heading) - (x - x_middle) * math.sin(heading)
        return middle._replace(left_m=left_m)

    def heading(self, sumo: Any) -> float:
        """Return the lane's heading, rad."""
        return self._middle(sumo, self.lane)[1]

    def width(self, sumo: Any) -> float:
        """Return the lane's width, m."""
        return float(sumo.lane.getWidth(f"{self.edge}_{self.lane}"))

    def shift(self, sumo: Any) -> tuple[float, float, float]:
        """Return how far a vehicle is from where SUMO has it: x and y, m, and yaw, rad."""
        beside = self.lane + (1 if self.left_m > 0.0 else -1)
        if not 0 <= beside < sumo.edge.getLaneNumber(self.edge):
            return 0.0, 0.0, 0.0
        (x, y), heading = self._middle(sumo, self.lane)
        (x_beside, y_beside), heading_beside = self._middle(sumo, beside)
        width = 0.5 * (self.width(sumo) + self._replace(lane=beside).width(sumo))
        way = min(abs(self.left_m) / width, 1.0)
        part = 0.5 - 0.5 * math.cos(math.pi * way)  # It begins and ends gently.
        cos, sin = math.cos(heading), math.sin(heading)
        ahead_m = part * ((x_beside - x) * cos + (y_beside - y) * sin)
        turn = part * math.remainder(heading_beside - heading, math.tau)
        return ahead_m * cos, ahead_m * sin, turn

    def _middle(self, sumo: Any, lane: int) -> tuple[tuple[float, float], float]:
        """Return x and y of a lane's middle at this distance, m, and its heading, rad."""
        angle_deg = sumo.lane.getAngle(f"{self.edge}_{lane}", self.along_m)
        place = sumo.simulation.convert2D(self.edge, self.along_m, lane)
        return place, math.radians(90.0 - angle_deg)
