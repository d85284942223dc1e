"""Traffic lights and crossing gates; their faces look along -x."""

import itertools
import math

from oodscen.numerics._exact import cos, sin
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.look import AMBER, GREEN, RED, Appearance
from oodscen_pybullet._meshes.objects.signs import face
from oodscen_pybullet._meshes.shapes import across, upright
from oodscen_pybullet._types import Point

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
_ARM_DIRECTIONS = {"open": (0.0, 1.0), "half": (0.7071, 0.7071)}
"""Direction of a gate's arm, to the left and upwards, by its state; it lies across the lane in the others."""


def _lit_lenses(shown: Appearance) -> tuple[str, ...]:
    """Return the colours that a light shows; by default red."""
    if shown.state == "flashing" and shown.frame % 2 == 1:
        return ()
    return _LENSES.get(shown.state, ("red",))


def _add_lens(mesh: MeshBuilder, centre: Point, radius: float, name: str, *, is_lit: bool) -> None:
    """Add a lens with its hood: `red`, `amber` or `green`."""
    x, y, z = centre
    colour = f"{name}_lit" if is_lit else f"lens_{name}"
    mesh.cylinder((x, y, z), (x - 0.02, y, z), radius, colour, sides=12)
    turns = [math.pi * k / 6 for k in range(7)]
    rim = [(y + radius * 1.1 * cos(t), z + radius * 1.1 * sin(t)) for t in turns]
    for start, end in itertools.pairwise(rim):
        hood = [(x, *start), (x - 0.16, *start), (x - 0.16, *end), (x, *end)]
        mesh.polygon(hood, "black").polygon(hood[::-1], "black")
    if is_lit:
        mesh.lamp((x - 0.03, y, z), _GLOW[name], (-1, 0, 0), 2.0, by_day=_LED)


def traffic_light(mesh: MeshBuilder, shown: Appearance) -> None:
    """A traffic light on a post; the flashing state is amber."""
    lit = _lit_lenses(shown)
    mesh.cylinder((0, 0, 0), (0, 0, 0.5), 0.12, "dark_grey", sides=8)
    mesh.cylinder((0, 0, 0.5), (0, 0, 3.5), 0.07, "dark_grey", sides=8)
    mesh.box((-0.16, 0, 2.95), (0.22, 0.42, 1.16), "black")
    mesh.polygon(across(-0.05, 0.32, 2.28, 3.62), "black")
    mesh.polygon(across(-0.045, -0.32, 2.28, 3.62), "dark_grey")
    for y0, y1, z0, z1 in (
        (0.32, 0.28, 2.28, 3.62),
        (-0.28, -0.32, 2.28, 3.62),
        (0.32, -0.32, 2.28, 2.32),
        (0.32, -0.32, 3.58, 3.62),
    ):
        mesh.polygon(upright((-0.055, y0), (-0.055, y1), z0, z1), "white")
    for name, z in (("red", 3.32), ("amber", 2.95), ("green", 2.58)):
        _add_lens(mesh, (-0.272, 0, z), 0.165, name, is_lit=name in lit)


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
        quad = across(-0.245, 0.14, z - 0.15, z + 0.15)
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
        _add_lens(mesh, (-0.2, 0, z), 0.12, name, is_lit=name in lit)


def level_crossing_gate(mesh: MeshBuilder, shown: Appearance) -> None:
    """A railway gate with two red lamps; its arm lies across the lane, points up, or is stuck half-way."""
    is_open = shown.state == "open"
    right = -2.9
    mesh.box((0.25, right, 0.55), (0.5, 0.5, 1.1), "light_grey")
    mesh.cylinder((0, right, 0), (0, right, 3.0), 0.06, "white", sides=8)
    face(mesh, (-0.07, right, 2.75), 0.5, "sign_rail", corners=16)
    left, up = _ARM_DIRECTIONS.get(shown.state, (1.0, 0.0))
    for k in range(10):
        ends = (0.6 * k, 0.6 * (k + 1))
        start, end = ((0.3, right + 0.2 + left * along, 1.0 + up * along) for along in ends)
        mesh.beam(start, end, 0.13, "white" if k % 2 else "red")
    mesh.box((-0.08, right, 2.0), (0.1, 0.8, 0.36), "black")
    for side in (-1.0, 1.0):
        is_lit = not is_open and (side > 0) == (shown.frame % 2 == 0)
        _add_lens(mesh, (-0.13, right + side * 0.21, 2.0), 0.13, "red", is_lit=is_lit)


VARIED = (traffic_light, pedestrian_light, temporary_light, level_crossing_gate)
