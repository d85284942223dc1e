"""Cones, barriers and signs of road works; their faces look along -x."""

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._meshes.objects.signs import lens
from oodscen_pybullet._meshes.vehicles.bodywork import AMBER


def _face(mesh: MeshBuilder, x: float, half: float, low: float, high: float, region: str) -> None:
    """Add a printed face that looks along -x, and a grey back."""
    mesh.picture([(x, half, low), (x, -half, low), (x, -half, high), (x, half, high)], region)
    mesh.box((x + 0.03, 0, (low + high) / 2), (0.04, 2 * half, high - low), "grey")


def cone(mesh: MeshBuilder) -> None:
    """An orange traffic cone with two white bands."""
    mesh.box((0, 0, 0.025), (0.42, 0.42, 0.05), "black")
    rings = (
        (0.05, 0.16),
        (0.26, 0.115),
        (0.40, 0.088),
        (0.50, 0.068),
        (0.62, 0.046),
        (0.75, 0.024),
    )
    colours = ("fluor_orange", "white", "fluor_orange", "white", "fluor_orange")
    for (z0, r0), (z1, r1), colour in zip(rings, rings[1:], colours, strict=False):
        mesh.cylinder((0, 0, z0), (0, 0, z1), r0, colour, sides=12, end_radius=r1)


def barrier(mesh: MeshBuilder) -> None:
    """A red and white striped barrier with two lamps, across the lane."""
    for z, shift in ((0.86, 0), (0.42, 1)):
        for index in range(8):
            colour = "white" if (index + shift) % 2 else "red"
            mesh.box((0, -0.875 + 0.25 * index, z), (0.05, 0.25, 0.24), colour)
    for side in (-1.0, 1.0):
        mesh.beam((-0.28, side * 0.85, 0.03), (-0.03, side * 0.85, 0.98), 0.06, "grey")
        mesh.beam((0.28, side * 0.85, 0.03), (0.03, side * 0.85, 0.98), 0.06, "grey")
        mesh.cylinder((0, side * 0.7, 0.98), (0, side * 0.7, 1.06), 0.05, "dark_grey", sides=8)
        mesh.cylinder(
            (-0.05, side * 0.7, 1.14), (0.05, side * 0.7, 1.14), 0.09, "amber_lit", sides=10
        )
        mesh.lamp((0, side * 0.7, 1.14), AMBER, (0, 0, 0), 1.2)
    mesh.centred()


def arrow_board(mesh: MeshBuilder, shown: Appearance) -> None:
    """A trailer with an illuminated arrow."""
    region = "arrow_right" if shown.state == "right" else "arrow_left"
    _face(mesh, -0.2, 0.95, 1.2, 2.45, region)
    mesh.box((-0.15, 0, 1.825), (0.08, 2.0, 1.35), "black")
    sign = 1.0 if region == "arrow_left" else -1.0
    for across, down in ((0.22, 0.5), (0.5, 0.5), (0.8, 0.5), (0.36, 0.14), (0.36, 0.86)):
        y = sign * (0.95 - 1.9 * across)
        mesh.lamp((-0.22, y, 2.45 - 1.25 * down), AMBER, (-1, 0, 0), 1.6)
    mesh.box((0, 0, 0.86), (0.1, 0.1, 0.7), "grey")
    mesh.box((0.1, 0, 0.52), (1.1, 1.3, 0.16), "machine")
    for side in (-1.0, 1.0):
        mesh.wheel(0.1, side * 0.72, 0.3, 0.18)
        mesh.box((0.0, side * 0.5, 0.85), (0.08, 0.08, 0.75), "machine")
        mesh.box((-0.46, side * 0.55, 0.48), (0.05, 0.2, 0.12), "tail")
    for index in range(6):
        mesh.box(
            (-0.47, -0.54 + 0.216 * index, 0.66),
            (0.03, 0.216, 0.14),
            "white" if index % 2 else "red",
        )
    mesh.beam((0.6, 0, 0.5), (1.3, 0, 0.42), 0.1, "grey")
    mesh.centred()


def road_closed_sign(mesh: MeshBuilder) -> None:
    """A white board reading ROAD CLOSED, on a striped trestle."""
    _face(mesh, -0.06, 0.9, 0.75, 1.65, "road_closed")
    for index in range(8):
        mesh.box(
            (-0.05, -0.7875 + 0.225 * index, 0.5),
            (0.05, 0.225, 0.22),
            "white" if index % 2 else "red",
        )
    _trestle(mesh)


def detour_sign(mesh: MeshBuilder) -> None:
    """An orange board reading DETOUR above an arrow."""
    _face(mesh, -0.06, 0.85, 0.7, 1.55, "detour")
    _trestle(mesh)


def _trestle(mesh: MeshBuilder) -> None:
    for side in (-1.0, 1.0):
        mesh.beam((0.02, side * 0.6, 0.05), (0.02, side * 0.6, 1.4), 0.07, "grey")
        mesh.beam((-0.4, side * 0.6, 0.04), (0.4, side * 0.6, 0.04), 0.08, "dark_grey")
        mesh.box((-0.2, side * 0.6, 0.1), (0.24, 0.3, 0.1), "tyre")


def drum(mesh: MeshBuilder) -> None:
    """An orange channelling drum with white bands and an amber lamp."""
    mesh.cylinder((0, 0, 0), (0, 0, 0.08), 0.31, "black", sides=14)
    rings = ((0.08, 0.29), (0.28, 0.28), (0.44, 0.27), (0.60, 0.26), (0.76, 0.25), (0.95, 0.24))
    colours = ("fluor_orange", "white", "fluor_orange", "white", "fluor_orange")
    for (z0, r0), (z1, r1), colour in zip(rings, rings[1:], colours, strict=False):
        mesh.cylinder((0, 0, z0), (0, 0, z1), r0, colour, sides=14, end_radius=r1)
    mesh.box((0, 0, 0.99), (0.06, 0.26, 0.1), "dark_grey")


def water_barrier(mesh: MeshBuilder) -> None:
    """Two water-filled plastic barriers, red and white, across the lane."""
    for y, colour in ((-0.77, "red"), (0.77, "white")):
        low, high = y - 0.75, y + 0.75
        mesh.hull((-0.28, 0.28, low, high, 0.0), (-0.24, 0.24, low, high, 0.24), colour)
        mesh.hull(
            (-0.24, 0.24, low, high, 0.24), (-0.12, 0.12, low + 0.02, high - 0.02, 0.5), colour
        )
        mesh.hull(
            (-0.12, 0.12, low + 0.02, high - 0.02, 0.5),
            (-0.1, 0.1, low + 0.03, high - 0.03, 0.9),
            colour,
        )
        for k in (-0.4, 0.0, 0.4):
            for side in (-1.0, 1.0):
                mesh.box((side * 0.2, y + k, 0.3), (0.14, 0.2, 0.14), "dark_grey")
        mesh.cylinder((0, y, 0.9), (0, y, 0.94), 0.06, "dark_grey", sides=8)
        stripe = "white" if colour == "red" else "red"
        for side in (-1.0, 1.0):
            mesh.box((side * 0.115, y, 0.72), (0.02, 1.3, 0.14), stripe)


def temporary_light(mesh: MeshBuilder, shown: Appearance) -> None:
    """A portable traffic light on a yellow battery trailer."""
    lit = {"red": "red", "green": "green", "amber": "amber", "flashing": "amber"}.get(
        shown.state or "red", ""
    )
    if shown.state == "flashing" and shown.frame % 2:
        lit = ""
    mesh.box((0.1, 0, 0.42), (0.8, 0.7, 0.5), "machine")
    mesh.box((0.1, 0, 0.69), (0.84, 0.74, 0.06), "machine_dark")
    for side in (-1.0, 1.0):
        mesh.wheel(0.1, side * 0.4, 0.2, 0.12)
    mesh.cylinder((0.0, 0, 0.7), (0.0, 0, 2.2), 0.05, "grey", sides=8)
    mesh.box((-0.1, 0, 2.3), (0.2, 0.34, 1.0), "black")
    mesh.box((0.0, 0, 2.3), (0.03, 0.5, 1.16), "yellow")
    for name, z in (("red", 2.6), ("amber", 2.3), ("green", 2.0)):
        lens(mesh, (-0.2, 0, z), 0.12, name, is_lit=name == lit)


def portable_toilet(mesh: MeshBuilder) -> None:
    """A blue portable toilet."""
    mesh.box((0, 0, 0.06), (1.2, 1.2, 0.12), "dark_grey")
    mesh.box((0, 0, 1.12), (1.12, 1.12, 2.0), "blue")
    mesh.hull((-0.58, 0.58, -0.58, 0.58, 2.12), (-0.4, 0.4, -0.56, 0.56, 2.34), "white")
    mesh.box((-0.57, 0, 1.08), (0.03, 0.8, 1.8), "sky_blue")
    mesh.box((-0.59, -0.3, 1.1), (0.03, 0.08, 0.16), "black")
    mesh.box((-0.59, 0, 1.62), (0.02, 0.3, 0.3), "white")
    mesh.box((-0.605, 0.05, 1.62), (0.01, 0.06, 0.2), "blue")
    mesh.box((-0.605, -0.06, 1.62), (0.01, 0.06, 0.2), "blue")
    for side in (-1.0, 1.0):
        for k in range(5):
            mesh.box((-0.4 + 0.2 * k, side * 0.565, 1.95), (0.14, 0.02, 0.05), "navy")
            mesh.box((-0.4 + 0.2 * k, side * 0.565, 1.0), (0.03, 0.03, 1.4), "navy")
    mesh.cylinder((0.4, 0.4, 2.2), (0.4, 0.4, 2.5), 0.06, "black", sides=8)


def scaffolding(mesh: MeshBuilder) -> None:
    """Two storeys of scaffolding with planks, along the edge of the lane."""
    xs, ys = (-1.6, 0.0, 1.6), (-0.5, 0.5)
    for x in xs:
        for y in ys:
            mesh.cylinder((x, y, 0), (x, y, 4.0), 0.035, "silver", sides=6)
            mesh.box((x, y, 0.015), (0.16, 0.16, 0.03), "rust")
        for z in (1.9, 3.7):
            mesh.beam((x, -0.5, z), (x, 0.5, z), 0.05, "silver")
    for z in (0.4, 1.9, 2.4, 2.9, 3.7):
        for y in ys:
            mesh.beam((-1.65, y, z), (1.65, y, z), 0.05, "silver")
    for y in ys:
        mesh.beam((-1.6, y, 0.3), (0.0, y, 1.9), 0.045, "machine")
        mesh.beam((0.0, y, 1.9), (1.6, y, 3.7), 0.045, "machine")
    for k in range(4):
        mesh.box((0, -0.375 + 0.25 * k, 1.97), (3.3, 0.23, 0.05), "wood" if k % 2 else "wood_dark")
    mesh.box((0, 0.5, 2.1), (3.3, 0.03, 0.2), "wood")
    mesh.beam((-0.4, -0.42, 0.0), (0.4, -0.42, 2.0), 0.06, "fluor_orange")
    mesh.beam((-0.15, -0.42, 0.0), (0.65, -0.42, 2.0), 0.06, "fluor_orange")


def generator(mesh: MeshBuilder) -> None:
    """A yellow generator on a trailer, with a light mast folded down."""
    mesh.hull((-0.85, 0.75, -0.5, 0.5, 0.45), (-0.8, 0.7, -0.48, 0.48, 1.35), "machine")
    mesh.hull((-0.88, 0.78, -0.53, 0.53, 1.35), (-0.7, 0.6, -0.4, 0.4, 1.45), "black")
    mesh.box((-0.05, 0, 0.4), (1.9, 0.8, 0.1), "dark_grey")
    for side in (-1.0, 1.0):
        for k in range(5):
            mesh.box((-0.55 + 0.14 * k, side * 0.495, 0.95), (0.08, 0.03, 0.4), "black")
        mesh.box((0.4, side * 0.495, 0.95), (0.36, 0.03, 0.3), "light_grey")
        mesh.wheel(-0.05, side * 0.58, 0.3, 0.18)
        mesh.beam((0.85, side * 0.35, 0.42), (1.7, 0, 0.4), 0.08, "dark_grey")
    mesh.cylinder((1.5, 0, 0), (1.5, 0, 0.6), 0.035, "grey", sides=6)
    mesh.cylinder((-0.5, 0.2, 1.45), (-0.5, 0.2, 1.75), 0.05, "exhaust", sides=8)
    mesh.beam((-0.7, -0.25, 1.5), (0.6, -0.25, 1.5), 0.08, "silver")
    for x in (-0.6, -0.2):
        mesh.box((x, -0.25, 1.62), (0.1, 0.36, 0.22), "head")
    mesh.box((-0.88, 0, 0.6), (0.03, 0.7, 0.14), "red")


STILL = (
    cone, barrier, road_closed_sign, detour_sign, drum, water_barrier, portable_toilet,
    scaffolding, generator,
)  # fmt: skip
VARIED = (arrow_board, temporary_light)
