"""The pose of a camera on the ego and the projection of points onto its picture."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from oodscen.numerics import _exact as exact
from oodscen.protocols import Camera
from oodscen_pybullet._types import F32, Heading, Point, Pose

_DEGREE = math.radians(1.0)
NEAR_M = 0.2
"""Distance of the near plane, m."""
FAR_M = 420.0
"""Distance of the far plane, m."""


@dataclass(frozen=True)
class CameraView:
    """A camera at its place in the world; pixel centres are at half-integers."""

    width: int
    height: int
    focal: float
    """Focal length: pixels per unit of x / depth."""
    eye: Point
    right: Point
    up: Point
    forward: Point
    heading: Heading
    """Level direction ahead; the top of the picture if the camera looks straight down."""
    is_lit: bool = True
    """True if the ego's headlamps light what the camera sees: it is on the ego and looks forward."""

    @classmethod
    def of(cls, camera: Camera, pose: Pose, roll_deg: float = 0.0) -> Self:
        """Mount a camera on a vehicle, given the centre of its footprint and its yaw.

        Args:
            camera: The camera, relative to the vehicle.
            pose: Pose of the vehicle.
            roll_deg: Roll of the camera, degrees, clockwise.
        """
        x, y, z, yaw = pose
        s, c = exact.sincos(yaw)
        turn = camera.yaw_deg * _DEGREE
        sa, ca = exact.sincos(yaw + turn) if turn else (s, c)
        sp, cp = exact.sincos(camera.pitch_deg * _DEGREE)
        right, up = (sa, -ca, 0.0), (ca * sp, sa * sp, cp)
        if roll_deg:
            sr, cr = exact.sincos(roll_deg * _DEGREE)
            right, up = (
                (cr * right[0] - sr * up[0], cr * right[1] - sr * up[1], -sr * up[2]),
                (cr * up[0] + sr * right[0], cr * up[1] + sr * right[1], cr * up[2]),
            )
        return cls(
            width=camera.width,
            height=camera.height,
            focal=camera.width / 2 / exact.tan(camera.fov_deg * _DEGREE / 2),
            eye=(
                x + c * camera.x - s * camera.y,
                y + s * camera.x + c * camera.y,
                z + camera.z,
            ),
            right=right,
            up=up,
            forward=(ca * cp, sa * cp, -sp),
            heading=(ca, sa),
        )

    def view_matrix(self) -> list[float]:
        """Return OpenGL's view matrix, column by column."""
        rows = (self.right, self.up, tuple(-v for v in self.forward))
        moves = [-sum(a * b for a, b in zip(row, self.eye, strict=True)) for row in rows]
        columns: list[float] = []
        for axis in range(3):
            columns += [row[axis] for row in rows] + [0.0]
        return [*columns, *moves, 1.0]

    def projection_matrix(self, *, samples_corners: bool = True) -> list[float]:
        """Return OpenGL's projection matrix, column by column.

        Args:
            samples_corners: Whether the renderer samples pixel corners, as PyBullet's does; the
                principal point then moves by half a pixel, onto the centre of each pixel.
        """
        half = 1.0 if samples_corners else 0.0
        w, h, f = self.width, self.height, self.focal
        depth = FAR_M - NEAR_M
        return [
            2 * f / w, 0.0, 0.0, 0.0,
            0.0, 2 * f / h, 0.0, 0.0,
            half / w, half / h, -(FAR_M + NEAR_M) / depth, -1.0,
            0.0, 0.0, -2 * FAR_M * NEAR_M / depth, 0.0,
        ]  # fmt: skip

    def to_camera(self, point: Point) -> Point:
        """Return a world point in metres to the right, upwards and ahead of the camera."""
        dx, dy, dz = point[0] - self.eye[0], point[1] - self.eye[1], point[2] - self.eye[2]
        return (
            dx * self.right[0] + dy * self.right[1] + dz * self.right[2],
            dx * self.up[0] + dy * self.up[1] + dz * self.up[2],
            dx * self.forward[0] + dy * self.forward[1] + dz * self.forward[2],
        )

    def to_level(self, point: Point) -> tuple[float, float]:
        """Return a world point in level metres to the right and ahead of the camera, however it is tilted."""
        return self.level(point[0] - self.eye[0], point[1] - self.eye[1])

    def level(self, x: float, y: float) -> tuple[float, float]:
        """Return the parts of a direction in the world to the level right and ahead of the camera."""
        cos, sin = self.heading
        return x * sin - y * cos, x * cos + y * sin

    def pixel(self, point: Point) -> tuple[float, float, float] | None:
        """Return column, row and depth of a world point, or `None` if it is not beyond the near plane."""
        across, upwards, ahead = self.to_camera(point)
        if ahead < NEAR_M:
            return None
        return (
            self.width / 2 + self.focal * across / ahead,
            self.height / 2 - self.focal * upwards / ahead,
            ahead,
        )

    def slopes(self) -> tuple[F32, F32]:
        """Return x / depth by column, [width], and y / depth by row, [height], upwards."""
        columns = (np.arange(self.width, dtype=np.float32) + np.float32(0.5)) - self.width / 2
        rows = self.height / 2 - (np.arange(self.height, dtype=np.float32) + np.float32(0.5))
        scale = np.float32(1.0 / self.focal)
        return (columns * scale).astype(np.float32), (rows * scale).astype(np.float32)

    def rises(self) -> F32:
        """Return the rise towards the world's up per metre of depth, by row: [height]."""
        _, upwards = self.slopes()
        return np.asarray(
            upwards * np.float32(self.up[2]) + np.float32(self.forward[2]), np.float32
        )


def metres(buffer: F32) -> F32:
    """Convert the renderer's depth buffer to metres along the optical axis, infinity for the sky."""
    near, far = np.float32(NEAR_M), np.float32(FAR_M)
    depth = far * near / (far - (far - near) * buffer)
    return np.where(buffer >= np.float32(0.9999995), np.float32(np.inf), depth).astype(np.float32)
