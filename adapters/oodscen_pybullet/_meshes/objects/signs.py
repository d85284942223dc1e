"""Road signs; their faces look along -x."""

import math

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._types import Point


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
    shares: list[tuple[float, float]]
    if corners == 3:
        shares = [(0.02, 0.1), (0.98, 0.1), (0.5, 0.98)]
        if is_down:
            shares = [(0.5, 0.02), (0.98, 0.9), (0.02, 0.9)]
    else:
        size = 0.5 / math.cos(math.pi / corners) if corners == 8 else 0.495
        turns = [2 * math.pi * (i + 0.5) / corners for i in range(corners)]
        shares = [(0.5 + size * math.cos(t), 0.5 + size * math.sin(t)) for t in turns]
    x, y, z = centre
    out = -1.0 if is_forward else 1.0
    points = [(x, y + out * half * (1 - 2 * u), z + half * (2 * v - 1)) for u, v in shares]
    mesh.textured_polygon(points, shares, region)


def _plate(
    mesh: MeshBuilder,
    z: float,
    half: float,
    region: str,
    *,
    corners: int = 16,
    is_down: bool = False,
) -> None:
    """Add a sign's face with its grey back, on a post at the origin."""
    face(mesh, (-0.06, 0, z), half, region, corners=corners, is_down=is_down)
    back = MeshBuilder()
    face(back, (-0.045, 0, z), half, region, corners=corners, is_down=is_down, is_forward=True)
    plain = back.build()
    mesh.polygon(plain.vertices[_outline(corners)], "grey")


def _outline(corners: int) -> list[int]:
    """Return the rows of a fan's corners in order."""
    return [0, 1, *(3 * k + 2 for k in range(corners - 2))]


def _post(mesh: MeshBuilder, height: float, radius: float = 0.04) -> None:
    mesh.cylinder((0, 0, 0), (0, 0, height), radius, "grey", sides=8)


def _sign(
    mesh: MeshBuilder, region: str, half: float, *,
    corners: int = 16, is_down: bool = False, lift: float,
) -> None:  # fmt: skip
    _post(mesh, lift + 1.6 * half)
    _plate(mesh, lift + half, half, region, corners=corners, is_down=is_down)


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
    _plate(mesh, 0.95, 0.5, "sign_works", corners=3)
    for side in (-1.0, 1.0):
        mesh.beam((-0.34, side * 0.3, 0.03), (0.34, side * 0.3, 0.03), 0.06, "dark_grey")
        mesh.beam((0.0, side * 0.3, 0.03), (0, 0, 0.5), 0.04, "grey")


def sign_fallen(mesh: MeshBuilder) -> None:
    """A knocked-over stop sign: the post along x, the face propped up towards the viewer."""
    mesh.cylinder((1.7, 0.1, 0.04), (-0.6, 0, 0.22), 0.04, "grey", sides=8)
    mesh.ball(
        (1.75, 0.1, 0.08), (0.24, 0.24, 0.16), "concrete", around=8, down=5, jitter=0.2, key=81
    )
    tilt, half = 0.62, 0.42
    plain = MeshBuilder()
    face(plain, (0, 0, 0), half, "sign_stop", corners=8)
    back = MeshBuilder()
    face(back, (0, 0, 0), half, "sign_stop", corners=8, is_forward=True)
    base = MeshBuilder().polygon(back.build().vertices[_outline(8)], "grey")
    turned = MeshBuilder()
    for part in (plain, base):
        # A rotation about y is a rotation about x between two quarter turns about z.
        side = MeshBuilder().add_surface(part.build(), yaw=math.pi / 2).build()
        lean = MeshBuilder().add_surface(side, roll=tilt).build()
        turned.add_surface(lean, yaw=-math.pi / 2)
    mesh.add_surface(turned.build(), (-0.62, 0, 0.36))


STILL = (
    stop_sign,
    yield_sign,
    speed_limit_sign,
    no_entry_sign,
    warning_sign,
    road_works_sign,
    sign_fallen,
)
