"""Distances between bodies, from a PyBullet world of collision shapes only."""

import math
from types import ModuleType

from oodscen_pybullet._types import Pose


class Bodies:
    """A set of boxes that are moved explicitly and queried for their distances.

    PyBullet never reports contacts of massless bodies, so distances are queried pair by pair.
    """

    def __init__(self, engine: ModuleType) -> None:
        self._engine = engine
        self._client: int = engine.connect(engine.DIRECT)
        self._bodies: list[int] = []
        self._poses: list[Pose | None] = []

    def close(self) -> None:
        """Disconnect; calling it twice is allowed."""
        if self._client >= 0:
            self._engine.disconnect(self._client)
            self._client = -1

    def clear(self) -> None:
        """Remove every body."""
        self._engine.resetSimulation(physicsClientId=self._client)
        self._bodies.clear()
        self._poses.clear()

    def add(self, length: float, width: float, height: float) -> bool:
        """Add a box that stands on its footprint; its row is the number of bodies added before it.

        Returns:
            True if the engine accepted the box.
        """
        engine = self._engine
        shape = engine.createCollisionShape(
            engine.GEOM_BOX,
            halfExtents=(0.5 * length, 0.5 * width, 0.5 * height),
            collisionFramePosition=(0.0, 0.0, 0.5 * height),
            physicsClientId=self._client,
        )
        body = engine.createMultiBody(0, shape, physicsClientId=self._client) if shape >= 0 else -1
        if body >= 0:
            self._bodies.append(body)
            self._poses.append(None)
        return bool(body >= 0)

    def move(self, row: int, pose: Pose) -> None:
        """Move one body to x, y, z, yaw."""
        if self._poses[row] == pose:
            return
        x, y, z, yaw = pose
        self._engine.resetBasePositionAndOrientation(
            self._bodies[row],
            (x, y, z),
            (0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw)),
            physicsClientId=self._client,
        )
        self._poses[row] = pose

    def distance(self, row: int, other: int, reach: float) -> float:
        """Return the distance between two bodies, m: 0 on contact, infinity beyond `reach`."""
        points = self._engine.getClosestPoints(
            self._bodies[row], self._bodies[other], reach, physicsClientId=self._client
        )
        return max(0.0, min((float(point[8]) for point in points), default=math.inf))
