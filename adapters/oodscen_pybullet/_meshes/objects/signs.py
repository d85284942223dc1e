"""Road signs; their faces look along -x."""

import math
from collections.abc import Sequence

from oodscen.numerics._exact import cos, sin
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._types import Point

_FACE_X = -0.06
"""x of a face on a post at the origin, m."""


def face(
    mesh: MeshBuilder,
    centre: Point,
    half: float,
    region: str,
    *,
    corners: int = 16,
    is_forward: bool = False,
    is_down: bool = False,
) -> None:
    """Add a regular polygon that shows a region, without a back.

    Args:
        mesh: The builder to add to.
        centre: The centre of the face.
        half: Half the height of the region's square, m.
        region: Name of the region.
        corners: 3 for a triangle, 8 for an octagon, many for a disc.
        is_forward: Whether it faces +x instead of -x.
        is_down: Whether a triangle stands on its tip.
    """
    shares = _outline(corners, is_down=is_down)
    mesh.textured_polygon(_placed(shares, centre, half, is_forward=is_forward), shares, region)


def _outline(corners: int, *, is_down: bool) -> list[tuple[float, float]]:
    """Return the corners of a face in its region's square, from the bottom left, 0 to 1."""
    if corners == 3:
        if is_down:
            return [(0.5, 0.02), (0.98, 0.9), (0.02, 0.9)]
        return [(0.02, 0.1), (0.98, 0.1), (0.5, 0.98)]
    size = 0.5 / cos(math.pi / corners) if corners == 8 else 0.495
    turns = [2 * math.pi * (i + 0.5) / corners for i in range(corners)]
    return [(0.5 + size * cos(turn), 0.5 + size * sin(turn)) for turn in turns]


def _placed(
    shares: Sequence[tuple[float, float]], centre: Point, half: float, *, is_forward: bool
) -> list[Point]:
    """Return the points of an outline around a centre."""
    x, y, z = centre
    out = -half if is_forward else half
    return [(x, y + out * (1 - 2 * u), z + half * (2 * v - 1)) for u, v in shares]


def _plate(
    mesh: MeshBuilder,
    centre: Point,
    half: float,
    region: str,
    *,
    corners: int = 16,
    is_down: bool = False,
    thickness: float = 0.015,
) -> None:
    """Add a sign's face and its grey back."""
    face(mesh, centre, half, region, corners=corners, is_down=is_down)
    x, y, z = centre
    outline = _outline(corners, is_down=is_down)
    mesh.polygon(_placed(outline, (x + thickness, y, z), half, is_forward=True), "grey")


def _post(mesh: MeshBuilder, height: float, radius: float = 0.04) -> None:
    mesh.cylinder((0, 0, 0), (0, 0, height), radius, "grey", sides=8)


def _sign(
    mesh: MeshBuilder, region: str, half: float, *,
    corners: int = 16, is_down: bool = False, lift: float,
) -> None:  # fmt: skip
    _post(mesh, lift + 1.6 * half)
    _plate(mesh, (_FACE_X, 0, lift + half), half, region, corners=corners, is_down=is_down)


def stop_sign(mesh: MeshBuilder) -> None:
    """A red octagon reading STOP, on a post."""
    _sign(mesh, "sign_stop", 0.42, corners=8, lift=1.8)


def yield_sign(mesh: MeshBuilder) -> None:
    """A give-way triangle, tip down, on a post."""
    _sign(mesh, "sign_yield", 0.46, corners=3, is_down=True, lift=1.8)


def speed_limit_sign(mesh: MeshBuilder) -> None:
    """A round 30 km/h speed limit sign, on a post."""
    _sign(mesh, "sign_limit", 0.38, lift=1.9)


def no_entry_sign(mesh: MeshBuilder) -> None:
    """A red disc with a white bar, on a post."""
    _sign(mesh, "sign_entry", 0.38, lift=1.9)


def warning_sign(mesh: MeshBuilder) -> None:
    """A warning triangle with an exclamation mark, on a post."""
    _sign(mesh, "sign_warning", 0.46, corners=3, lift=1.8)


def road_works_sign(mesh: MeshBuilder) -> None:
    """A low warning triangle showing a man digging, on a stand."""
    _post(mesh, 1.3, 0.03)
    _plate(mesh, (_FACE_X, 0, 0.95), 0.5, "sign_works", corners=3)
    for side in (-1.0, 1.0):
        mesh.beam((-0.34, side * 0.3, 0.03), (0.34, side * 0.3, 0.03), 0.06, "dark_grey")
        mesh.beam((0.0, side * 0.3, 0.03), (0, 0, 0.5), 0.04, "grey")


def sign_fallen(mesh: MeshBuilder) -> None:
    """A knocked-over stop sign: the post along x, the face propped up towards the viewer."""
    mesh.cylinder((1.7, 0.1, 0.04), (-0.6, 0, 0.22), 0.04, "grey", sides=8)
    mesh.ball(
        (1.75, 0.1, 0.08), (0.24, 0.24, 0.16), "concrete", around=8, down=5, jitter=0.2, key=81
    )
    plate = MeshBuilder()
    _plate(plate, (0, 0, 0), 0.42, "sign_stop", corners=8, thickness=0.0)
    # A rotation about y is a rotation about x between two quarter turns about z.
    side = MeshBuilder().add_surface(plate.build(), yaw=math.pi / 2)
    mesh.add_surface(side.build(), (-0.62, 0, 0.36), roll=0.62, yaw=-math.pi / 2)


STILL = (
    stop_sign,
    yield_sign,
    speed_limit_sign,
    no_entry_sign,
    warning_sign,
    road_works_sign,
    sign_fallen,
)
