"""Road signs, traffic lights and crossing gates; their faces look along -x."""

import itertools
import math

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.look import AMBER, GREEN, RED, Appearance
from oodscen_pybullet._meshes.shapes import upright
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


# ------------------------------------------------------------------ lights

_LENSES: dict[str, tuple[str, ...]] = {
    "red": ("red",),
    "amber": ("amber",),
    "green": ("green",),
    "off": (),
    "flashing": ("amber",),
    "all_on": ("red", "amber", "green"),
}
_GLOW = {"red": RED, "amber": AMBER, "green": GREEN}
_LED = 0.8
"""Share of a signal's glow that is visible by day."""


def _lit_lenses(shown: Appearance) -> tuple[str, ...]:
    """Return the colours that a light shows; by default red."""
    is_between = shown.state == "flashing" and shown.frame % 2 == 1
    return () if is_between else _LENSES.get(shown.state, ("red",))


def lens(mesh: MeshBuilder, centre: Point, radius: float, name: str, *, is_lit: bool) -> None:
    """Add a lens with its hood: `red`, `amber` or `green`."""
    x, y, z = centre
    colour = f"{name}_lit" if is_lit else f"lens_{name}"
    mesh.cylinder((x, y, z), (x - 0.02, y, z), radius, colour, sides=12)
    hood = [(x - 0.18, math.pi * k / 6) for k in range(7)]
    for (_, one), (_, two) in itertools.pairwise(hood):
        a = (y + radius * 1.1 * math.cos(one), z + radius * 1.1 * math.sin(one))
        b = (y + radius * 1.1 * math.cos(two), z + radius * 1.1 * math.sin(two))
        quad = [(x, *a), (x - 0.16, *a), (x - 0.16, *b), (x, *b)]
        mesh.polygon(quad, "black").polygon(quad[::-1], "black")
    if is_lit:
        mesh.lamp((x - 0.03, y, z), _GLOW[name], (-1, 0, 0), 2.0, by_day=_LED)


def traffic_light(mesh: MeshBuilder, shown: Appearance) -> None:
    """A traffic light on a post; the flashing state is amber."""
    lit = _lit_lenses(shown)
    mesh.cylinder((0, 0, 0), (0, 0, 0.5), 0.12, "dark_grey", sides=8)
    mesh.cylinder((0, 0, 0.5), (0, 0, 3.5), 0.07, "dark_grey", sides=8)
    mesh.box((-0.16, 0, 2.95), (0.22, 0.42, 1.16), "black")
    mesh.polygon(upright((-0.05, 0.32), (-0.05, -0.32), 2.28, 3.62), "black")
    mesh.polygon(upright((-0.045, -0.32), (-0.045, 0.32), 2.28, 3.62), "dark_grey")
    for y0, y1, z0, z1 in (
        (0.32, 0.28, 2.28, 3.62),
        (-0.28, -0.32, 2.28, 3.62),
        (0.32, -0.32, 2.28, 2.32),
        (0.32, -0.32, 3.58, 3.62),
    ):
        mesh.polygon(upright((-0.055, y0), (-0.055, y1), z0, z1), "white")
    for name, z in (("red", 3.32), ("amber", 2.95), ("green", 2.58)):
        lens(mesh, (-0.272, 0, z), 0.165, name, is_lit=name in lit)


def pedestrian_light(mesh: MeshBuilder, shown: Appearance) -> None:
    """A pedestrian light on a post, with a standing or a walking figure."""
    mesh.cylinder((0, 0, 0), (0, 0, 2.9), 0.055, "dark_grey", sides=8)
    mesh.box((-0.14, 0, 2.5), (0.2, 0.34, 0.74), "black")
    mesh.box((-0.08, 0, 1.15), (0.1, 0.14, 0.2), "yellow")
    is_dark = not _lit_lenses(shown)
    for figure, colour, z, states in (
        ("man", "red", 2.67, ("red", "")),
        ("walker", "green", 2.33, ("green", "flashing")),
    ):
        is_lit = not is_dark and shown.state in states
        quad = upright((-0.245, 0.14), (-0.245, -0.14), z - 0.15, z + 0.15)
        if is_lit:
            mesh.textured_quad(quad, f"sign_{figure}")
            mesh.lamp((-0.25, 0, z), _GLOW[colour], (-1, 0, 0), 0.8, by_day=_LED)
        else:
            mesh.polygon(quad, f"lens_{colour}")
        mesh.box((-0.28, 0, z + 0.17), (0.1, 0.32, 0.02), "black")


def temporary_light(mesh: MeshBuilder, shown: Appearance) -> None:
    """A portable traffic light on a yellow battery trailer."""
    lit = _lit_lenses(shown)
    mesh.box((0.1, 0, 0.42), (0.8, 0.7, 0.5), "machine")
    mesh.box((0.1, 0, 0.69), (0.84, 0.74, 0.06), "machine_dark")
    for side in (-1.0, 1.0):
        mesh.wheel(0.1, side * 0.4, 0.2, 0.12)
    mesh.cylinder((0.0, 0, 0.7), (0.0, 0, 2.2), 0.05, "grey", sides=8)
    mesh.box((-0.1, 0, 2.3), (0.2, 0.34, 1.0), "black")
    mesh.box((0.0, 0, 2.3), (0.03, 0.5, 1.16), "yellow")
    for name, z in (("red", 2.6), ("amber", 2.3), ("green", 2.0)):
        lens(mesh, (-0.2, 0, z), 0.12, name, is_lit=name in lit)


_HALF = 0.7071
"""Cosine and sine of the slope of an arm that is stuck half-way."""


def level_crossing_gate(mesh: MeshBuilder, shown: Appearance) -> None:
    """A railway gate with two red lamps; its arm lies across the lane, points up, or is stuck half-way."""
    is_open = shown.state == "open"
    right = -2.9
    mesh.box((0.25, right, 0.55), (0.5, 0.5, 1.1), "light_grey")
    mesh.cylinder((0, right, 0), (0, right, 3.0), 0.06, "white", sides=8)
    face(mesh, (-0.07, right, 2.75), 0.5, "sign_rail", corners=16)
    for k in range(10):
        colour = "white" if k % 2 else "red"
        a, b = 0.6 * k, 0.6 * (k + 1)
        if shown.state == "half":
            near, far = ((0.3, right + 0.2 + _HALF * c, 1.0 + _HALF * c) for c in (a, b))
            mesh.beam(near, far, 0.13, colour)
        elif is_open:
            mesh.beam((0.3, right + 0.2, 1.0 + a), (0.3, right + 0.2, 1.0 + b), 0.13, colour)
        else:
            mesh.beam((0.3, right + 0.2 + a, 1.0), (0.3, right + 0.2 + b, 1.0), 0.13, colour)
    mesh.box((-0.08, right, 2.0), (0.1, 0.8, 0.36), "black")
    for side in (-1.0, 1.0):
        is_lit = not is_open and (side > 0) == (shown.frame % 2 == 0)
        lens(mesh, (-0.13, right + side * 0.21, 2.0), 0.13, "red", is_lit=is_lit)


STILL = (
    stop_sign,
    yield_sign,
    speed_limit_sign,
    no_entry_sign,
    warning_sign,
    road_works_sign,
    sign_fallen,
)
VARIED = (traffic_light, pedestrian_light, temporary_light, level_crossing_gate)
