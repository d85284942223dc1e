"""Common parts of road vehicles: shells, lamps, plates and printed livery."""

from collections.abc import Sequence

from oodscen_pybullet._meshes.builder import MeshBuilder, Point
from oodscen_pybullet._meshes.look import Lights

RED: Point = (1.0, 0.12, 0.08)
WHITE: Point = (1.0, 0.97, 0.86)
AMBER: Point = (1.0, 0.62, 0.08)
BLUE: Point = (0.25, 0.5, 1.0)

Section = tuple[float, Sequence[tuple[float, float]]]


def shell(
    mesh: MeshBuilder,
    sections: Sequence[Section],
    colours: Sequence[str],
    *,
    front: str,
    rear: str,
) -> None:
    """Add a body that is symmetric about the x axis.

    Args:
        mesh: The builder to add to.
        sections: From rear to front: x and the right outline upwards as (half width, z).
        colours: Colours of the side panels upwards, then of the top.
        front: Colour of the front end.
        rear: Colour of the rear end.
    """
    outlines: list[list[Point]] = []
    for x, outline in sections:
        right = [(x, -width, z) for width, z in outline]
        left = [(x, width, z) for width, z in reversed(outline)]
        outlines.append(right + left)
    panels = [*colours[:-1], colours[-1], *reversed(colours[:-1])]
    mesh.loft(outlines, panels)
    mesh.polygon(outlines[0], rear)
    mesh.polygon(outlines[-1][::-1], front)


def pillar(mesh: MeshBuilder, foot: Point, head: Point, colour: str, width: float = 0.07) -> None:
    """Add a roof pillar on both sides."""
    mesh.beam(foot, head, width, colour)
    mesh.beam((foot[0], -foot[1], foot[2]), (head[0], -head[1], head[2]), width, colour)


def arches(mesh: MeshBuilder, x: float, half_width: float, radius: float) -> None:
    """Add the dark openings of the wheel arches."""
    for side in (-1.0, 1.0):
        centre = (x, side * (half_width - 0.15), radius + 0.01)
        end = (x, side * (half_width + 0.004), radius + 0.01)
        mesh.cylinder(centre, end, radius, "black", sides=14)


def _lit_box(
    mesh: MeshBuilder, at: Point, size: Point, names: tuple[str, str, str], *, is_lit: bool
) -> None:
    """Add a lamp with dark, lit and core colours; a lit one is larger and has a bright core."""
    dark, lit, core = names
    x, y, z = at
    depth, width, height = size
    if not is_lit:
        mesh.box(at, size, dark)
        return
    mesh.box(at, (depth + 0.008, width + 0.03, height + 0.03), lit)
    mesh.box((x, y, z), (depth + 0.02, 0.6 * width, 0.6 * height), core)


def rear_lamps(
    mesh: MeshBuilder, lights: Lights, x: float, y: float, z: float, size: tuple[float, float]
) -> None:
    """Add the tail, brake and indicator lamps on both sides of the rear."""
    width, height = size
    low = z - height / 2 - 0.05
    for side in (-1.0, 1.0):
        at = (x, side * y, z)
        mesh.box((x + 0.006, side * y, z - 0.05), (0.05, width + 0.05, height + 0.15), "black")
        lit = "brake_lit" if lights.brake else "tail_lit"
        core = "brake_core" if lights.brake else "tail_lit"
        is_lit = lights.brake or lights.running
        _lit_box(mesh, at, (0.06, width, height), ("tail", lit, core), is_lit=is_lit)
        blinks = lights.left if side > 0 else lights.right
        turn = (x, side * y, low)
        _lit_box(
            mesh, turn, (0.06, width, 0.09), ("amber", "amber_lit", "amber_core"), is_lit=blinks
        )
        if is_lit:
            mesh.lamp(at, RED, (-1, 0, 0), 3.0 if lights.brake else 1.0)
        if blinks:
            mesh.lamp((x, side * (y + 0.05), low), AMBER, (-1, 0, 0), 3.0)


def head_lamps(
    mesh: MeshBuilder, lights: Lights, x: float, y: float, z: float, size: tuple[float, float]
) -> None:
    """Add the headlamps and front indicators on both sides."""
    width, height = size
    for side in (-1.0, 1.0):
        mesh.box((x, side * y, z), (0.06, width, height), "head_lit" if lights.running else "head")
        blinks = lights.left if side > 0 else lights.right
        outer = (x - 0.02, side * (y + width / 2 + 0.03), z)
        _lit_box(
            mesh, outer, (0.06, 0.07, height), ("amber", "amber_lit", "amber_core"), is_lit=blinks
        )
        if lights.running:
            mesh.lamp((x, side * y, z), WHITE, (1, 0, 0), 4.0)
        if blinks:
            mesh.lamp((x, outer[1], z), AMBER, (1, 0, 0), 3.0)


def plates(mesh: MeshBuilder, rear: tuple[float, float], front: tuple[float, float]) -> None:
    """Add both number plates, each at its x and z."""
    (x, z), half, tall = rear, 0.27, 0.065
    mesh.picture(
        [(x, half, z - tall), (x, -half, z - tall), (x, -half, z + tall), (x, half, z + tall)],
        "plate_rear",
    )
    x, z = front
    mesh.picture(
        [(x, -half, z - tall), (x, half, z - tall), (x, half, z + tall), (x, -half, z + tall)],
        "plate",
    )


def side_print(
    mesh: MeshBuilder, x: tuple[float, float], y: float, z: tuple[float, float], region: str
) -> None:
    """Print a region on both sides, readable from each."""
    (back, fore), (low, high) = x, z
    mesh.picture([(back, -y, low), (fore, -y, low), (fore, -y, high), (back, -y, high)], region)
    mesh.picture([(fore, y, low), (back, y, low), (back, y, high), (fore, y, high)], region)


def rear_print(mesh: MeshBuilder, x: float, y: float, z: tuple[float, float], region: str) -> None:
    """Print a region on the rear, from -y to y."""
    low, high = z
    mesh.picture([(x, y, low), (x, -y, low), (x, -y, high), (x, y, high)], region)


def front_print(mesh: MeshBuilder, x: float, y: float, z: tuple[float, float], region: str) -> None:
    """Print a region on the front, from -y to y."""
    low, high = z
    mesh.picture([(x, -y, low), (x, y, low), (x, y, high), (x, -y, high)], region)


def light_bar(mesh: MeshBuilder, lights: Lights, x: float, z: float, half: float) -> None:
    """Add a beacon bar across the roof: blue on the right, red on the left."""
    mesh.box((x, 0, z + 0.02), (0.3, 2 * half, 0.05), "dark_grey")
    first, second = lights.beacon and not lights.is_second, lights.beacon and lights.is_second
    for side, dark, bright, glow, lit in (
        (-1.0, "beacon", "beacon_lit", BLUE, first),
        (1.0, "beacon_red", "beacon_red_lit", RED, second),
    ):
        centre = side * half * 0.56
        mesh.box((x, centre, z + 0.105), (0.26, half * 0.85, 0.13), bright if lit else dark)
        if lit:
            mesh.lamp((x, centre, z + 0.1), glow, (0, 0, 0), 4.0)
    mesh.box((x, 0, z + 0.105), (0.22, half * 0.22, 0.11), "light_grey")


def underside(mesh: MeshBuilder, front: float, rear: float, half: float, z: float) -> None:
    """Add the underside of an overturned car: axles, exhaust, tank, sump."""
    for x in (front, rear):
        mesh.beam((x, -half, z + 0.02), (x, half, z + 0.02), 0.09, "rust")
    mesh.beam((front, 0.12, z), (rear, 0.12, z), 0.08, "metal")
    mesh.beam((front - 0.3, -0.35, z), (rear - 0.7, -0.35, z), 0.08, "exhaust")
    mesh.box((rear - 0.45, -0.4, z + 0.06), (0.5, 0.3, 0.1), "dirty_hub")
    mesh.box((rear + 0.6, 0.35, z + 0.03), (0.7, 0.5, 0.1), "black")
    mesh.box((front + 0.15, 0, z + 0.03), (0.6, 0.5, 0.12), "dark_grey")
