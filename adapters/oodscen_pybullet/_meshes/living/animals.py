"""Four-legged animals and a goose, facing x; they stand, walk or run."""

from oodscen_pybullet._meshes.builder import MeshBuilder, Point
from oodscen_pybullet._meshes.living.limbs import joint, stride
from oodscen_pybullet._meshes.living.people import grounded
from oodscen_pybullet._meshes.look import Appearance

_WALK = {(-1.0, 0): 0.0, (-1.0, 1): 0.25, (1.0, 0): 0.5, (1.0, 1): 0.75}
"""Fraction of the stride at which a foot touches down, by side and pair, hind legs first."""
_GALLOP = {(-1.0, 0): 0.0, (1.0, 0): 0.12, (-1.0, 1): 0.5, (1.0, 1): 0.62}


def legs(
    mesh: MeshBuilder,
    shown: Appearance,
    x: tuple[float, float],
    y: float,
    top: float,
    thick: float,
    colours: tuple[str, str],
    *,
    half: float = 0.26,
) -> None:
    """Add four legs, with hooves or paws in the second colour.

    Args:
        mesh: The builder to add to.
        shown: Gives the phase of the stride.
        x: Position of the hind and of the fore legs.
        y: Half the distance between left and right legs.
        top: Height of the joints at the body, m.
        thick: Radius at the top, m.
        colours: Colours of the legs and of the hooves.
        half: Distance ahead of its joint at which a walking foot lands, as a fraction of `top`.
    """
    phase, runs = shown.gait or (0.0, False)
    hoof = 0.07 * top
    drop = 0.06 * top if shown.gait is not None else 0.0
    for pair, hip in enumerate(x):
        for side in (-1.0, 1.0):
            ahead, up = (0.05 if pair == 0 else 0.0) * side * top, 0.0
            if shown.gait is not None:
                own = phase - (_GALLOP if runs else _WALK)[side, pair]
                reach = (1.5 if runs else 1.0) * half * top
                ahead, up = stride(own, reach, (0.3 if runs else 0.14) * top, 0.4 if runs else 0.6)
            start, end = (hip, side * y, top - drop), (hip + ahead, side * y, hoof + up)
            bend = (-1.0 if pair == 0 else 0.6, 0.0, 0.0)
            knee, foot = joint(start, end, 0.48 * (top - hoof), 0.53 * (top - hoof), bend)
            mesh.cylinder(start, knee, thick, colours[0], sides=6, end_radius=0.6 * thick)
            mesh.cylinder(knee, foot, 0.6 * thick, colours[0], sides=6, end_radius=0.45 * thick)
            mesh.box(
                (foot[0] + 0.2 * thick, foot[1], foot[2] - 0.5 * hoof),
                (1.5 * thick, 1.1 * thick, hoof),
                colours[1],
            )


def _antler(mesh: MeshBuilder, side: float, base: Point) -> None:
    x, _, z = base
    y = side * base[1]
    tip1, tip2 = (x - 0.12, y + side * 0.18, z + 0.22), (x + 0.02, y + side * 0.26, z + 0.48)
    prongs = (
        ((x, y, z), tip1, 0.045, 0.035),
        (tip1, tip2, 0.035, 0.018),
        ((x - 0.04, y + side * 0.06, z + 0.08), (x + 0.16, y + side * 0.1, z + 0.24), 0.03, 0.014),
        (tip1, (x + 0.10, y + side * 0.20, z + 0.40), 0.03, 0.014),
        (tip1, (x - 0.22, y + side * 0.22, z + 0.42), 0.03, 0.014),
    )
    for start, end, wide, narrow in prongs:
        mesh.beam(start, end, wide, "antler", end_width=narrow)


def _eyes(mesh: MeshBuilder, x: float, y: float, z: float, size: float) -> None:
    for side in (-1.0, 1.0):
        mesh.ball((x, side * y, z), (size, 0.5 * size, size), "black", around=6, down=4)


def deer(mesh: MeshBuilder, shown: Appearance) -> None:
    """A stag with antlers, a pale rump and a raised head."""
    mesh.column(
        [
            ((-0.78, 0, 1.0), 0.08, 0.10),
            ((-0.66, 0, 1.0), 0.18, 0.21),
            ((-0.40, 0, 0.98), 0.21, 0.25),
            ((0.05, 0, 0.96), 0.19, 0.23),
            ((0.36, 0, 0.99), 0.21, 0.28),
            ((0.58, 0, 1.06), 0.14, 0.20),
        ],
        ("deer_pale", "deer", "deer", "deer", "deer"),
        axis="x",
    )
    mesh.ball((-0.02, 0, 0.86), (0.5, 0.15, 0.16), "deer_pale", around=8, down=5)
    mesh.cylinder((0.46, 0, 1.06), (0.80, 0, 1.50), 0.17, "deer", sides=8, end_radius=0.085)
    mesh.ball((0.86, 0, 1.53), (0.15, 0.085, 0.10), "deer", around=8, down=5)
    mesh.cylinder((0.92, 0, 1.52), (1.10, 0, 1.44), 0.07, "deer_dark", sides=7, end_radius=0.045)
    mesh.ball((1.10, 0, 1.45), (0.03, 0.03, 0.03), "black", around=6, down=4)
    _eyes(mesh, 0.93, 0.075, 1.57, 0.022)
    for side in (-1.0, 1.0):
        mesh.beam(
            (0.78, side * 0.07, 1.58), (0.70, side * 0.22, 1.66), 0.06, "deer_dark", end_width=0.02
        )
        _antler(mesh, side, (0.80, 0.06, 1.60))
    mesh.beam((-0.76, 0, 1.1), (-0.86, 0, 0.94), 0.09, "deer_dark", end_width=0.04)
    legs(mesh, shown, (-0.50, 0.42), 0.12, 0.88, 0.09, ("deer", "deer_dark"))
    grounded(mesh)


def moose(mesh: MeshBuilder, shown: Appearance) -> None:
    """A moose: very tall and dark, with broad antlers and a hanging muzzle."""
    mesh.column(
        [
            ((-1.22, 0, 1.42), 0.12, 0.16),
            ((-1.0, 0, 1.45), 0.28, 0.32),
            ((-0.4, 0, 1.46), 0.32, 0.38),
            ((0.2, 0, 1.52), 0.32, 0.42),
            ((0.55, 0, 1.66), 0.28, 0.42),
            ((0.95, 0, 1.62), 0.18, 0.28),
        ],
        "bear",
        axis="x",
        sides=10,
    )
    mesh.cylinder((0.75, 0, 1.66), (1.25, 0, 1.84), 0.27, "bear", sides=8, end_radius=0.16)
    mesh.ball((1.32, 0, 1.86), (0.24, 0.15, 0.17), "bear", around=8, down=5)
    mesh.cylinder((1.42, 0, 1.84), (1.72, 0, 1.60), 0.13, "deer_dark", sides=8, end_radius=0.12)
    mesh.ball((1.73, 0, 1.58), (0.12, 0.12, 0.12), "deer_dark", around=8, down=5)
    mesh.beam((1.15, 0, 1.62), (1.14, 0, 1.34), 0.1, "bear", end_width=0.05)
    _eyes(mesh, 1.44, 0.13, 1.92, 0.03)
    for side in (-1.0, 1.0):
        mesh.beam((1.2, side * 0.12, 1.96), (1.12, side * 0.36, 1.98), 0.1, "bear", end_width=0.03)
        mesh.beam((1.24, side * 0.1, 2.0), (1.2, side * 0.42, 2.12), 0.06, "antler")
        palm = [
            (1.30, side * 0.36, 2.06),
            (1.28, side * 0.78, 2.16),
            (1.05, side * 0.86, 2.34),
            (0.82, side * 0.62, 2.32),
            (0.98, side * 0.38, 2.12),
        ]
        mesh.polygon(palm, "antler").polygon(palm[::-1], "antler")
        for k in range(4):
            a = (1.30 - 0.14 * k, side * (0.72 + 0.04 * k), 2.16 + 0.05 * k)
            mesh.beam(
                a, (a[0] + 0.06, a[1] + side * 0.16, a[2] + 0.2), 0.05, "antler", end_width=0.015
            )
    mesh.beam((-1.2, 0, 1.5), (-1.28, 0, 1.34), 0.08, "bear", end_width=0.04)
    legs(mesh, shown, (-0.85, 0.55), 0.19, 1.3, 0.13, ("deer_pale", "black"))
    for x, side in ((-0.85, -1.0), (-0.85, 1.0), (0.55, -1.0), (0.55, 1.0)):
        mesh.cylinder(
            (x, side * 0.19, 1.36), (x, side * 0.19, 0.9), 0.16, "bear", sides=7, end_radius=0.1
        )
    grounded(mesh)


def horse(mesh: MeshBuilder, shown: Appearance) -> None:
    """A brown horse with a black mane and tail, without a rider."""
    mesh.column(
        [
            ((-0.92, 0, 1.22), 0.12, 0.16),
            ((-0.74, 0, 1.22), 0.26, 0.29),
            ((-0.2, 0, 1.18), 0.27, 0.29),
            ((0.3, 0, 1.20), 0.27, 0.32),
            ((0.62, 0, 1.28), 0.18, 0.26),
        ],
        "horse",
        axis="x",
        sides=10,
    )
    mesh.cylinder((0.45, 0, 1.28), (0.98, 0, 1.82), 0.25, "horse", sides=8, end_radius=0.12)
    mesh.cylinder((0.92, 0, 1.84), (1.36, 0, 1.56), 0.135, "horse", sides=8, end_radius=0.075)
    mesh.ball((1.36, 0, 1.56), (0.09, 0.075, 0.08), "hair", around=8, down=5)
    mesh.polygon(
        [(1.05, -0.03, 1.87), (1.3, -0.025, 1.69), (1.3, 0.025, 1.69), (1.05, 0.03, 1.87)], "white"
    )
    _eyes(mesh, 1.04, 0.11, 1.82, 0.025)
    mesh.hull((0.40, 0.62, -0.04, 0.04, 1.48), (0.74, 0.98, -0.03, 0.03, 2.0), "black")
    for side in (-1.0, 1.0):
        mesh.beam(
            (0.94, side * 0.07, 1.92), (0.97, side * 0.09, 2.06), 0.07, "horse", end_width=0.015
        )
    mesh.beam((-0.9, 0, 1.34), (-1.08, 0, 1.1), 0.1, "black", end_width=0.14)
    mesh.beam((-1.08, 0, 1.1), (-1.12, 0, 0.62), 0.14, "black", end_width=0.05)
    legs(mesh, shown, (-0.66, 0.44), 0.16, 1.08, 0.125, ("horse", "black"))
    grounded(mesh)


def cow(mesh: MeshBuilder, shown: Appearance) -> None:
    """A black and white cow."""
    mesh.column(
        [
            ((-1.05, 0, 1.06), 0.2, 0.24),
            ((-0.88, 0, 1.04), 0.33, 0.37),
            ((-0.3, 0, 0.98), 0.38, 0.42),
            ((0.4, 0, 0.99), 0.36, 0.41),
            ((0.78, 0, 1.05), 0.26, 0.32),
            ((0.95, 0, 1.1), 0.12, 0.18),
        ],
        "cow_white",
        axis="x",
        sides=10,
    )
    patches = (
        (-0.55, 0.24, 1.14, 0.36),
        (0.35, 0.2, 1.14, 0.33),
        (-0.05, -0.24, 1.10, 0.38),
        (0.6, -0.17, 1.05, 0.27),
        (-0.76, -0.2, 1.08, 0.24),
    )
    for x, y, z, size in patches:
        mesh.ball((x, y, z), (size, 0.2, size * 0.76), "cow_black", around=9, down=6)
    mesh.cylinder((0.75, 0, 1.12), (1.10, 0, 1.32), 0.24, "cow_black", sides=8, end_radius=0.16)
    mesh.hull((1.02, 1.30, -0.14, 0.14, 1.12), (1.00, 1.22, -0.13, 0.13, 1.50), "cow_black")
    mesh.beam((1.18, 0, 1.30), (1.50, 0, 1.08), 0.22, "cow_white", end_width=0.18)
    mesh.ball((1.50, 0, 1.07), (0.09, 0.12, 0.09), "cow_pink", around=8, down=5)
    _eyes(mesh, 1.22, 0.12, 1.36, 0.03)
    for side in (-1.0, 1.0):
        mesh.beam(
            (1.08, side * 0.12, 1.42), (1.04, side * 0.34, 1.40), 0.12, "cow_black", end_width=0.04
        )
        mesh.beam(
            (1.10, side * 0.10, 1.50), (1.14, side * 0.20, 1.66), 0.05, "antler", end_width=0.015
        )
    mesh.ball((-0.4, 0, 0.62), (0.2, 0.16, 0.13), "cow_pink", around=8, down=5)
    mesh.beam((-1.05, 0, 1.22), (-1.14, 0, 0.72), 0.06, "cow_white", end_width=0.04)
    mesh.ball((-1.14, 0, 0.66), (0.06, 0.06, 0.11), "cow_black", around=6, down=4)
    legs(mesh, shown, (-0.74, 0.58), 0.22, 0.82, 0.125, ("cow_white", "cow_black"))
    grounded(mesh)


def sheep(mesh: MeshBuilder, shown: Appearance) -> None:
    """A woolly sheep with a black face."""
    for index, (x, z, size) in enumerate(
        ((-0.36, 0.64, 0.3), (0.0, 0.66, 0.33), (0.32, 0.66, 0.3))
    ):
        mesh.ball(
            (x, 0, z),
            (size, 0.27, size * 0.95),
            "wool",
            around=9,
            down=6,
            jitter=0.06,
            key=300 + index,
        )
    mesh.ball((0.5, 0, 0.82), (0.16, 0.15, 0.16), "wool", around=8, down=5, jitter=0.06, key=305)
    mesh.cylinder((0.5, 0, 0.84), (0.8, 0, 0.70), 0.11, "cow_black", sides=8, end_radius=0.07)
    mesh.ball((0.8, 0, 0.70), (0.05, 0.07, 0.06), "cow_black", around=6, down=4)
    _eyes(mesh, 0.66, 0.09, 0.82, 0.018)
    for side in (-1.0, 1.0):
        mesh.beam(
            (0.54, side * 0.08, 0.88), (0.5, side * 0.24, 0.84), 0.07, "cow_black", end_width=0.02
        )
    mesh.ball((-0.64, 0, 0.68), (0.07, 0.07, 0.1), "wool", around=6, down=4)
    legs(mesh, shown, (-0.34, 0.3), 0.13, 0.46, 0.06, ("cow_black", "black"))
    grounded(mesh)


def wild_boar(mesh: MeshBuilder, shown: Appearance) -> None:
    """A dark wild boar with bristles and tusks."""
    mesh.column(
        [
            ((-0.62, 0, 0.54), 0.12, 0.16),
            ((-0.46, 0, 0.55), 0.2, 0.25),
            ((0.0, 0, 0.58), 0.23, 0.29),
            ((0.34, 0, 0.62), 0.22, 0.32),
            ((0.56, 0, 0.58), 0.16, 0.22),
            ((0.82, 0, 0.46), 0.085, 0.10),
            ((0.98, 0, 0.40), 0.06, 0.065),
        ],
        ("boar", "boar", "boar", "boar", "boar", "hair"),
        axis="x",
        sides=8,
    )
    mesh.box((0.985, 0, 0.40), (0.03, 0.12, 0.11), "cow_pink")
    mesh.hull((-0.4, 0.52, -0.04, 0.04, 0.72), (-0.1, 0.36, -0.01, 0.01, 0.98), "black")
    _eyes(mesh, 0.68, 0.115, 0.6, 0.02)
    for side in (-1.0, 1.0):
        mesh.beam((0.54, side * 0.12, 0.76), (0.5, side * 0.18, 0.92), 0.1, "hair", end_width=0.02)
        mesh.beam(
            (0.86, side * 0.07, 0.40), (0.92, side * 0.11, 0.54), 0.035, "white", end_width=0.01
        )
    mesh.beam((-0.62, 0, 0.6), (-0.72, 0, 0.4), 0.04, "black", end_width=0.05)
    legs(mesh, shown, (-0.38, 0.32), 0.12, 0.42, 0.075, ("boar", "black"))
    grounded(mesh)


def bear(mesh: MeshBuilder, shown: Appearance) -> None:
    """A brown bear on all fours."""
    mesh.column(
        [
            ((-0.92, 0, 0.82), 0.2, 0.26),
            ((-0.7, 0, 0.84), 0.36, 0.4),
            ((-0.1, 0, 0.82), 0.4, 0.42),
            ((0.36, 0, 0.90), 0.38, 0.46),
            ((0.66, 0, 0.92), 0.25, 0.32),
        ],
        "bear",
        axis="x",
        sides=10,
    )
    mesh.ball((0.84, 0, 1.02), (0.28, 0.24, 0.26), "bear", around=10, down=6)
    mesh.cylinder((0.98, 0, 0.98), (1.24, 0, 0.91), 0.14, "deer", sides=8, end_radius=0.09)
    mesh.ball((1.25, 0, 0.93), (0.045, 0.06, 0.05), "black", around=6, down=4)
    _eyes(mesh, 1.05, 0.11, 1.11, 0.025)
    for side in (-1.0, 1.0):
        mesh.ball((0.78, side * 0.19, 1.24), (0.05, 0.09, 0.09), "bear", around=7, down=5)
    legs(mesh, shown, (-0.58, 0.46), 0.24, 0.72, 0.2, ("bear", "hair"), half=0.3)
    grounded(mesh)


def dog(mesh: MeshBuilder, shown: Appearance) -> None:
    """A brown dog the size of a shepherd, with its tail up."""
    mesh.column(
        [
            ((-0.42, 0, 0.50), 0.07, 0.08),
            ((-0.32, 0, 0.50), 0.115, 0.13),
            ((0.0, 0, 0.50), 0.11, 0.12),
            ((0.22, 0, 0.50), 0.135, 0.165),
            ((0.36, 0, 0.56), 0.09, 0.12),
        ],
        "dog",
        axis="x",
    )
    mesh.ball((-0.03, 0, 0.565), (0.34, 0.10, 0.09), "dog_dark", around=8, down=5)
    mesh.cylinder((0.28, 0, 0.55), (0.42, 0, 0.70), 0.10, "dog", sides=7, end_radius=0.075)
    mesh.ball((0.46, 0, 0.74), (0.12, 0.09, 0.09), "dog", around=8, down=5)
    mesh.cylinder((0.52, 0, 0.73), (0.67, 0, 0.69), 0.055, "dog_dark", sides=7, end_radius=0.04)
    mesh.ball((0.68, 0, 0.70), (0.025, 0.025, 0.02), "black", around=6, down=4)
    _eyes(mesh, 0.545, 0.055, 0.775, 0.014)
    for side in (-1.0, 1.0):
        mesh.beam(
            (0.41, side * 0.06, 0.79), (0.39, side * 0.08, 0.92), 0.07, "dog_dark", end_width=0.015
        )
    mesh.beam((-0.38, 0, 0.54), (-0.55, 0, 0.70), 0.07, "dog_dark", end_width=0.06)
    mesh.beam((-0.55, 0, 0.70), (-0.60, 0, 0.86), 0.06, "dog_dark", end_width=0.02)
    legs(mesh, shown, (-0.29, 0.25), 0.08, 0.47, 0.06, ("dog", "dog_dark"))
    mesh.cylinder((0.33, 0, 0.60), (0.36, 0, 0.635), 0.105, "red", sides=8)
    grounded(mesh)


def cat(mesh: MeshBuilder, shown: Appearance) -> None:
    """A ginger cat with its tail up."""
    mesh.column(
        [
            ((-0.24, 0, 0.25), 0.04, 0.05),
            ((-0.17, 0, 0.25), 0.075, 0.085),
            ((0.06, 0, 0.245), 0.075, 0.085),
            ((0.17, 0, 0.265), 0.06, 0.075),
        ],
        ("cat", "cat_dark", "cat"),
        axis="x",
    )
    mesh.ball((0.23, 0, 0.34), (0.08, 0.075, 0.075), "cat", around=8, down=6)
    mesh.ball((0.29, 0, 0.32), (0.035, 0.045, 0.035), "white", around=6, down=4)
    mesh.ball((0.32, 0, 0.335), (0.012, 0.014, 0.01), "cow_pink", around=6, down=4)
    _eyes(mesh, 0.295, 0.035, 0.365, 0.012)
    for side in (-1.0, 1.0):
        mesh.beam(
            (0.21, side * 0.045, 0.39), (0.21, side * 0.055, 0.47), 0.05, "cat", end_width=0.008
        )
    tail = [(-0.23, 0, 0.28), (-0.33, 0, 0.38), (-0.35, 0, 0.5), (-0.3, 0, 0.58)]
    for one, two, colour in zip(tail, tail[1:], ("cat", "cat_dark", "cat"), strict=False):
        mesh.beam(one, two, 0.04, colour)
    legs(mesh, shown, (-0.16, 0.13), 0.045, 0.22, 0.034, ("cat", "white"))
    grounded(mesh)


def goose(mesh: MeshBuilder, shown: Appearance) -> None:
    """A white goose with an orange bill."""
    mesh.column(
        [
            ((-0.42, 0, 0.46), 0.03, 0.02),
            ((-0.24, 0, 0.40), 0.13, 0.12),
            ((0.0, 0, 0.36), 0.17, 0.16),
            ((0.2, 0, 0.40), 0.12, 0.14),
            ((0.28, 0, 0.46), 0.06, 0.08),
        ],
        "white",
        axis="x",
        sides=10,
    )
    for side in (-1.0, 1.0):
        mesh.ball((-0.1, side * 0.13, 0.42), (0.26, 0.05, 0.11), "light_grey", around=8, down=5)
    mesh.cylinder((0.22, 0, 0.46), (0.3, 0, 0.78), 0.065, "white", sides=8, end_radius=0.045)
    mesh.ball((0.33, 0, 0.82), (0.09, 0.06, 0.06), "white", around=8, down=5)
    mesh.cylinder((0.38, 0, 0.81), (0.52, 0, 0.78), 0.045, "orange", sides=8, end_radius=0.02)
    _eyes(mesh, 0.36, 0.052, 0.84, 0.012)
    phase, _ = shown.gait or (0.0, False)
    for side in (-1.0, 1.0):
        ahead, up = side * 0.02, 0.0
        if shown.gait is not None:
            ahead, up = stride(phase + 0.25 * (1 + side), 0.1, 0.06, 0.6)
        mesh.cylinder(
            (0.0, side * 0.08, 0.26), (ahead, side * 0.08, 0.03 + up), 0.022, "orange", sides=6
        )
        mesh.hull(
            (ahead - 0.03, ahead + 0.12, side * 0.08 - 0.06, side * 0.08 + 0.06, up),
            (ahead - 0.02, ahead + 0.06, side * 0.08 - 0.02, side * 0.08 + 0.02, up + 0.04),
            "orange",
        )
    grounded(mesh)


VARIED = (deer, moose, horse, cow, sheep, wild_boar, bear, dog, cat, goose)
