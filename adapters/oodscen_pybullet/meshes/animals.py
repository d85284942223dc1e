"""Animals, facing x."""

from oodscen_pybullet.meshes.bodywork import Lights
from oodscen_pybullet.meshes.builder import MeshBuilder, Point


def _legs(
    mesh: MeshBuilder,
    x: tuple[float, float],
    y: float,
    top: float,
    thick: float,
    colours: tuple[str, str],
) -> None:
    """Add four legs in a walking pose, hooves or paws in the second colour."""
    for index, hip in enumerate(x):
        for side in (-1.0, 1.0):
            step = 0.09 * top * (1.6 if (index + (side > 0)) % 2 else -1.6)
            knee = (hip + step * 0.3, side * y, top * 0.5)
            foot = (hip + step, side * y, 0.07 * top)
            mesh.cylinder(
                (hip, side * y, top), knee, thick, colours[0], sides=6, end_radius=thick * 0.62
            )
            mesh.cylinder(knee, foot, thick * 0.62, colours[0], sides=6, end_radius=thick * 0.5)
            mesh.box(
                (foot[0] + thick * 0.2, foot[1], 0.035 * top),
                (thick * 1.5, thick * 1.1, 0.07 * top),
                colours[1],
            )


def _antler(mesh: MeshBuilder, side: float, base: Point) -> None:
    x, _, z = base
    y = side * base[1]
    tip1, tip2 = (x - 0.12, y + side * 0.18, z + 0.22), (x + 0.02, y + side * 0.26, z + 0.48)
    mesh.beam((x, y, z), tip1, 0.04, "antler", end_width=0.032)
    mesh.beam(tip1, tip2, 0.032, "antler", end_width=0.015)
    mesh.beam(
        (x - 0.04, y + side * 0.06, z + 0.08),
        (x + 0.16, y + side * 0.1, z + 0.24),
        0.028,
        "antler",
        end_width=0.012,
    )
    mesh.beam(tip1, (x + 0.10, y + side * 0.20, z + 0.40), 0.028, "antler", end_width=0.012)
    mesh.beam(tip1, (x - 0.22, y + side * 0.22, z + 0.42), 0.028, "antler", end_width=0.012)


def deer(lights: Lights, paint: str) -> MeshBuilder:
    """A stag with antlers, a pale rump and a raised head."""
    mesh = MeshBuilder()
    mesh.ball((-0.35, 0, 0.98), (0.40, 0.21, 0.25), "deer", around=10, down=6)
    mesh.ball((0.28, 0, 0.99), (0.42, 0.22, 0.28), "deer", around=10, down=6)
    mesh.ball((-0.02, 0, 0.92), (0.55, 0.17, 0.19), "deer_pale", around=8, down=5)
    mesh.ball((-0.69, 0, 1.0), (0.10, 0.13, 0.15), "deer_pale", around=8, down=5)
    mesh.cylinder((0.48, 0, 1.05), (0.80, 0, 1.48), 0.16, "deer", sides=8, end_radius=0.09)
    mesh.ball((0.86, 0, 1.53), (0.16, 0.085, 0.10), "deer", around=8, down=5)
    mesh.cylinder((0.92, 0, 1.52), (1.10, 0, 1.44), 0.07, "deer_dark", sides=7, end_radius=0.045)
    for side in (-1.0, 1.0):
        mesh.beam(
            (0.78, side * 0.07, 1.58), (0.70, side * 0.22, 1.66), 0.06, "deer_dark", end_width=0.02
        )
        _antler(mesh, side, (0.80, 0.06, 1.60))
    mesh.beam((-0.74, 0, 1.08), (-0.84, 0, 0.94), 0.09, "deer_dark", end_width=0.04)
    _legs(mesh, (-0.48, 0.42), 0.12, 0.86, 0.085, ("deer", "deer_dark"))
    return (
        mesh.solid((0.0, 0, 0.6), (1.5, 0.42, 1.2)).solid((0.8, 0, 1.4), (0.6, 0.3, 0.7)).centred()
    )


def dog(lights: Lights, paint: str) -> MeshBuilder:
    """A brown dog of a shepherd's size with its tail up."""
    mesh = MeshBuilder()
    mesh.ball((-0.18, 0, 0.48), (0.24, 0.12, 0.13), "dog", around=9, down=5)
    mesh.ball((0.14, 0, 0.50), (0.26, 0.14, 0.16), "dog", around=9, down=5)
    mesh.ball((-0.03, 0, 0.54), (0.34, 0.10, 0.11), "dog_dark", around=8, down=5)
    mesh.cylinder((0.28, 0, 0.55), (0.42, 0, 0.70), 0.10, "dog", sides=7, end_radius=0.075)
    mesh.ball((0.46, 0, 0.74), (0.12, 0.09, 0.09), "dog", around=8, down=5)
    mesh.cylinder((0.52, 0, 0.73), (0.67, 0, 0.69), 0.055, "dog_dark", sides=7, end_radius=0.04)
    mesh.ball((0.68, 0, 0.70), (0.025, 0.025, 0.02), "black", around=6, down=4)
    for side in (-1.0, 1.0):
        mesh.beam(
            (0.41, side * 0.06, 0.79), (0.39, side * 0.08, 0.92), 0.07, "dog_dark", end_width=0.015
        )
    mesh.beam((-0.38, 0, 0.54), (-0.55, 0, 0.70), 0.07, "dog_dark", end_width=0.06)
    mesh.beam((-0.55, 0, 0.70), (-0.60, 0, 0.86), 0.06, "dog_dark", end_width=0.02)
    _legs(mesh, (-0.27, 0.25), 0.08, 0.46, 0.055, ("dog", "dog_dark"))
    mesh.cylinder((0.33, 0, 0.60), (0.36, 0, 0.635), 0.105, "red", sides=8)
    return mesh.centred().solid((0.0, 0, 0.4), (1.1, 0.26, 0.8))


def cow(lights: Lights, paint: str) -> MeshBuilder:
    """A black and white cow."""
    mesh = MeshBuilder()
    mesh.ball(
        (-0.45, 0, 1.02),
        (0.62, 0.36, 0.40),
        "cow_white",
        around=10,
        down=6,
        jitter=0.02,
        second_colour="cow_white",
    )
    mesh.ball((0.35, 0, 1.00), (0.62, 0.34, 0.40), "cow_white", around=10, down=6)
    mesh.ball((-0.02, 0, 0.96), (0.75, 0.36, 0.39), "cow_white", around=10, down=6)
    patches = (
        (-0.55, 0.2, 1.12, 0.4),
        (0.35, 0.16, 1.14, 0.36),
        (-0.05, -0.2, 1.12, 0.4),
        (0.6, -0.16, 1.05, 0.30),
        (-0.8, -0.14, 1.1, 0.28),
    )
    for x, y, z, size in patches:
        mesh.ball((x, y, z), (size, 0.22, size * 0.72), "cow_black", around=9, down=6)
    mesh.cylinder((0.75, 0, 1.12), (1.10, 0, 1.32), 0.24, "cow_black", sides=8, end_radius=0.16)
    mesh.hull((1.02, 1.30, -0.14, 0.14, 1.12), (1.00, 1.22, -0.13, 0.13, 1.50), "cow_black")
    mesh.beam((1.18, 0, 1.30), (1.50, 0, 1.08), 0.22, "cow_white", end_width=0.18)
    mesh.ball((1.50, 0, 1.07), (0.09, 0.12, 0.09), "cow_pink", around=8, down=5)
    for side in (-1.0, 1.0):
        mesh.beam(
            (1.08, side * 0.12, 1.42), (1.04, side * 0.34, 1.40), 0.12, "cow_black", end_width=0.04
        )
        mesh.beam(
            (1.10, side * 0.10, 1.50), (1.14, side * 0.20, 1.66), 0.05, "antler", end_width=0.015
        )
    mesh.ball((-0.4, 0, 0.66), (0.2, 0.16, 0.13), "cow_pink", around=8, down=5)
    mesh.beam((-1.03, 0, 1.22), (-1.14, 0, 0.72), 0.06, "cow_white", end_width=0.04)
    mesh.ball((-1.14, 0, 0.66), (0.06, 0.06, 0.11), "cow_black", around=6, down=4)
    _legs(mesh, (-0.72, 0.58), 0.22, 0.80, 0.115, ("cow_white", "cow_black"))
    return (
        mesh.solid((-0.05, 0, 0.7), (2.0, 0.7, 1.4)).solid((1.2, 0, 1.3), (0.7, 0.4, 0.6)).centred()
    )
