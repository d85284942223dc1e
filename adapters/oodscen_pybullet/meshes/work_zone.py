"""Cones, barriers and signs of road works; their faces look against x."""

from oodscen_pybullet.meshes.bodywork import AMBER, Lights
from oodscen_pybullet.meshes.builder import MeshBuilder


def _face(mesh: MeshBuilder, x: float, half: float, low: float, high: float, region: str) -> None:
    """Add a printed face that looks against x and a grey back."""
    mesh.picture([(x, half, low), (x, -half, low), (x, -half, high), (x, half, high)], region)
    mesh.box((x + 0.03, 0, (low + high) / 2), (0.04, 2 * half, high - low), "grey")


def cone(lights: Lights, paint: str) -> MeshBuilder:
    """An orange traffic cone with two white bands."""
    mesh = MeshBuilder()
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
    return mesh


def barrier(lights: Lights, paint: str) -> MeshBuilder:
    """A red and white striped barrier with two lamps, across the lane."""
    mesh = MeshBuilder()
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
    return mesh.centred().solid((0, 0, 0.5), (0.6, 2.0, 1.0))


def arrow_board(state: str) -> MeshBuilder:
    """A trailer with a lit arrow."""
    mesh = MeshBuilder()
    region = "arrow_right" if state == "right" else "arrow_left"
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
    return mesh.centred()


def road_closed_sign(lights: Lights, paint: str) -> MeshBuilder:
    """A white board that says ROAD CLOSED, on a striped trestle."""
    mesh = MeshBuilder()
    _face(mesh, -0.06, 0.9, 0.75, 1.65, "road_closed")
    for index in range(8):
        mesh.box(
            (-0.05, -0.7875 + 0.225 * index, 0.5),
            (0.05, 0.225, 0.22),
            "white" if index % 2 else "red",
        )
    _trestle(mesh)
    return mesh.centred()


def detour_sign(lights: Lights, paint: str) -> MeshBuilder:
    """An orange board that says DETOUR above an arrow."""
    mesh = MeshBuilder()
    _face(mesh, -0.06, 0.85, 0.7, 1.55, "detour")
    _trestle(mesh)
    return mesh.centred()


def _trestle(mesh: MeshBuilder) -> None:
    for side in (-1.0, 1.0):
        mesh.beam((0.02, side * 0.6, 0.05), (0.02, side * 0.6, 1.4), 0.07, "grey")
        mesh.beam((-0.4, side * 0.6, 0.04), (0.4, side * 0.6, 0.04), 0.08, "dark_grey")
        mesh.box((-0.2, side * 0.6, 0.1), (0.24, 0.3, 0.1), "tyre")
