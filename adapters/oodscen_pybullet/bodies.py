"""What touches what: a PyBullet world of collision shapes only."""

import math
from types import ModuleType

from oodscen_pybullet.meshes import asset_mesh

Pose = tuple[float, float, float, float]


class Bodies:
    """Boxes and compounds of boxes that are moved by hand and asked for their distances.

    Massless bodies never report contacts in PyBullet, so distances are queried pair by pair.
    """

    def __init__(self, engine: ModuleType) -> None:
        self._engine = engine
        self._client: int = engine.connect(engine.DIRECT)
        self._bodies: list[int] = []
        self._moved: list[Pose | None] = []

    def close(self) -> None:
        """Disconnect; may be called twice."""
        if self._client >= 0:
            self._engine.disconnect(self._client)
            self._client = -1

    def clear(self) -> None:
        """Remove every body."""
        self._engine.resetSimulation(physicsClientId=self._client)
        self._bodies.clear()
        self._moved.clear()

    def add(self, asset: str, state: str = "") -> bool:
        """Add a body; its row is the number of bodies before it.

        Returns:
            Whether the engine took it.
        """
        solids = asset_mesh(asset, state).solids
        if not solids:
            self._bodies.append(-1)
            self._moved.append(None)
            return True
        engine = self._engine
        shape = engine.createCollisionShapeArray(
            shapeTypes=[engine.GEOM_BOX] * len(solids),
            halfExtents=[half for _, half in solids],
            collisionFramePositions=[centre for centre, _ in solids],
            collisionFrameOrientations=[(0, 0, 0, 1)] * len(solids),
            physicsClientId=self._client,
        )
        body = engine.createMultiBody(0, shape, physicsClientId=self._client) if shape >= 0 else -1
        if body >= 0:
            self._bodies.append(body)
            self._moved.append(None)
        return bool(body >= 0)

    def move(self, row: int, pose: Pose) -> None:
        """Put one body at x, y, z, yaw."""
        if self._bodies[row] < 0 or self._moved[row] == pose:
            return
        x, y, z, yaw = pose
        self._engine.resetBasePositionAndOrientation(
            self._bodies[row],
            (x, y, z),
            (0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw)),
            physicsClientId=self._client,
        )
        self._moved[row] = pose

    def distance(self, row: int, other: int, reach: float) -> float:
        """Return the distance between two bodies, m.

        0 on contact; infinity beyond `reach`, or where one of them is nothing to touch.
        """
        one, two = self._bodies[row], self._bodies[other]
        if one < 0 or two < 0:
            return math.inf
        points = self._engine.getClosestPoints(one, two, reach, physicsClientId=self._client)
        return max(0.0, min((float(point[8]) for point in points), default=math.inf))
