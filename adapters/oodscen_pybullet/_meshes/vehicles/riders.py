"""People on two wheels, facing x; cyclists pedal."""

import itertools
import math

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.living.body import Clothes
from oodscen_pybullet._meshes.living.figure import Posture, figure
from oodscen_pybullet._meshes.living.limbs import joint, limb
from oodscen_pybullet._meshes.look import AMBER, RED, WHITE, Appearance, Lights
from oodscen_pybullet._meshes.shapes import upright
from oodscen_pybullet._types import Point


def _rider(
    mesh: MeshBuilder,
    clothes: Clothes,
    seat: Point,
    grip: Point,
    feet: tuple[Point, Point],
    *,
    lean: float = 0.28,
) -> None:
    """Add a person on a saddle; `feet` are the right and the left foot."""
    x, _, z = seat
    chest = (x + lean, 0.0, z + 0.47)
    mesh.column(
        [
            ((x - 0.02, 0, z - 0.06), 0.15, 0.17),
            ((x + 0.25 * lean, 0, z + 0.14), 0.13, 0.16),
            ((x + 0.75 * lean, 0, z + 0.36), 0.13, 0.19),
            ((chest[0], 0, chest[2] + 0.03), 0.10, 0.19),
            ((chest[0] + 0.03, 0, chest[2] + 0.10), 0.05, 0.07),
        ],
        [clothes.legs, clothes.top, clothes.top, clothes.top],
    )
    head = (chest[0] + 0.09, 0.0, chest[2] + 0.24)
    mesh.cylinder((chest[0] + 0.03, 0, chest[2] + 0.06), head, 0.05, clothes.skin, sides=6)
    mesh.ball(head, (0.105, 0.085, 0.125), clothes.skin)
    mesh.ball((head[0] - 0.02, 0, head[2] + 0.05), (0.15, 0.115, 0.105), clothes.hat)
    for side, foot in ((-1.0, feet[0]), (1.0, feet[1])):
        hip = (x, side * 0.1, z)
        knee, ankle = joint(hip, foot, 0.44, 0.44, (1.0, side * 0.1, 0.3))
        limb(mesh, (hip, knee, ankle), (0.09, 0.065, 0.045), (clothes.legs, clothes.legs))
        mesh.box((ankle[0] + 0.07, ankle[1], ankle[2] - 0.04), (0.25, 0.09, 0.08), clothes.shoes)
        shoulder = (chest[0], side * 0.19, chest[2])
        hand = (grip[0], side * abs(grip[1]), grip[2])
        elbow, hand = joint(shoulder, hand, 0.29, 0.29, (-0.3, side * 0.6, -0.6))
        sleeve = clothes.sleeves or clothes.top
        limb(mesh, (shoulder, elbow, hand), (0.06, 0.048, 0.036), (clothes.top, sleeve))


def _pedals(shown: Appearance, hub: Point) -> tuple[Point, Point]:
    """Return the positions of the ankles on the pedals, right first."""
    phase, _ = shown.gait or (0.0, False)
    x, _, z = hub
    places = []
    for side in (-1.0, 1.0):
        turn = -2 * math.pi * phase + (math.pi if side > 0 else 0.0) + 0.6
        places.append(
            (x - 0.03 + 0.16 * math.cos(turn), side * 0.14, z + 0.1 + 0.16 * math.sin(turn))
        )
    return places[0], places[1]


def _spoked_wheel(mesh: MeshBuilder, x: float, radius: float) -> None:
    turns = [2 * math.pi * i / 14 for i in range(14)]
    rim = [
        (x + 0.95 * radius * math.cos(t), 0.0, radius + 0.95 * radius * math.sin(t)) for t in turns
    ]
    for one, two in itertools.pairwise([*rim, rim[0]]):
        mesh.beam(one, two, 0.05, "tyre")
    for i in range(0, 14, 2):
        mesh.beam((x, 0.0, radius), rim[i], 0.014, "silver")


def _lamps(mesh: MeshBuilder, shown: Appearance, tail: Point, head: Point) -> None:
    lit = shown.lights.running
    mesh.box(tail, (0.05, 0.08, 0.08), "tail_lit" if lit else "reflector")
    mesh.box(head, (0.06, 0.08, 0.08), "head_lit" if lit else "head")
    if lit:
        mesh.lamp(tail, RED, (-1, 0, 0), 0.6)
        mesh.lamp(head, WHITE, (1, 0, 0), 1.0)


def cyclist(mesh: MeshBuilder, shown: Appearance) -> None:
    """A person with a helmet on a bicycle."""
    colour = ("blue", "red", "teal")[shown.index % 3]
    for x in (-0.52, 0.53):
        _spoked_wheel(mesh, x, 0.34)
    tubes = (
        ((-0.52, 0, 0.34), (-0.12, 0, 0.32)),
        ((-0.12, 0, 0.32), (-0.22, 0, 0.92)),
        ((-0.12, 0, 0.32), (0.38, 0, 0.80)),
        ((-0.18, 0, 0.80), (0.38, 0, 0.84)),
        ((-0.52, 0, 0.34), (-0.18, 0, 0.78)),
        ((0.53, 0, 0.34), (0.36, 0, 1.00)),
    )
    for start, end in tubes:
        mesh.beam(start, end, 0.045, colour)
    mesh.beam((0.34, -0.28, 1.02), (0.34, 0.28, 1.02), 0.04, "black")
    mesh.box((-0.22, 0, 0.94), (0.26, 0.16, 0.06), "black")
    mesh.cylinder((-0.12, -0.04, 0.32), (-0.12, -0.06, 0.32), 0.09, "dark_grey", sides=8)
    _lamps(mesh, shown, (-0.62, 0, 0.70), (0.46, 0, 0.94))
    top = ("fluor_yellow", "shirt_red", "shirt_white")[shown.index % 3]
    clothes = Clothes(top, "trousers", hat="white")
    _rider(mesh, clothes, (-0.22, 0, 1.0), (0.34, 0.26, 1.05), _pedals(shown, (-0.12, 0, 0.32)))


def cargo_bike(mesh: MeshBuilder, shown: Appearance) -> None:
    """A person on a long bicycle with a big wooden box in front."""
    _spoked_wheel(mesh, -0.95, 0.31)
    _spoked_wheel(mesh, 1.12, 0.25)
    for start, end in (
        ((-0.95, 0, 0.31), (-0.5, 0, 0.30)),
        ((-0.5, 0, 0.30), (-0.62, 0, 0.90)),
        ((-0.5, 0, 0.30), (-0.12, 0, 0.95)),
        ((-0.5, 0, 0.30), (0.9, 0, 0.22)),
        ((0.9, 0, 0.22), (1.12, 0, 0.6)),
        ((-0.95, 0, 0.31), (-0.6, 0, 0.76)),
    ):
        mesh.beam(start, end, 0.05, "teal")
    mesh.beam((-0.14, -0.3, 1.02), (-0.14, 0.3, 1.02), 0.04, "black")
    mesh.box((-0.62, 0, 0.92), (0.26, 0.18, 0.06), "black")
    mesh.hull((0.0, 0.8, -0.26, 0.26, 0.3), (-0.06, 0.9, -0.33, 0.33, 0.78), "wood", caps="b")
    mesh.hull((0.02, 0.8, -0.24, 0.24, 0.6), (0.02, 0.8, -0.24, 0.24, 0.62), "wood_dark", caps="t")
    mesh.box((0.2, 0.08, 0.78), (0.26, 0.26, 0.36), "cardboard")
    mesh.box((0.52, -0.06, 0.72), (0.3, 0.28, 0.24), "red")
    _lamps(mesh, shown, (-1.12, 0, 0.74), (0.94, 0, 0.66))
    clothes = Clothes("shirt_green", "jeans", hat="white")
    _rider(
        mesh, clothes, (-0.62, 0, 0.98), (-0.14, 0.28, 1.05), _pedals(shown, (-0.5, 0, 0.30)),
        lean=0.12,
    )  # fmt: skip


def e_scooter(mesh: MeshBuilder, shown: Appearance) -> None:
    """A person standing on an electric scooter."""
    top = ("shirt_red", "shirt", "fluor_yellow")[shown.index % 3]
    clothes = Clothes(top, "jeans", hat=("", "white", "black")[shown.index % 3])
    posture = Posture((0.40, 0.22, 1.0), (0.40, -0.22, 1.0), lean=0.04)
    figure(mesh, clothes, Appearance(), posture)
    mesh.shift((-0.1, 0, 0.17))
    for x in (-0.46, 0.5):
        mesh.cylinder((x, -0.03, 0.11), (x, 0.03, 0.11), 0.11, "tyre", sides=12)
    mesh.box((-0.02, 0, 0.13), (0.78, 0.2, 0.06), "black")
    mesh.beam((0.48, 0, 0.12), (0.36, 0, 1.16), 0.05, "silver")
    mesh.beam((0.34, -0.26, 1.17), (0.34, 0.26, 1.17), 0.04, "black")
    _lamps(mesh, shown, (-0.5, 0, 0.26), (0.43, 0, 1.06))


def _signals(mesh: MeshBuilder, lights: Lights, x: float, z: float) -> None:
    for side, blinks in ((-1.0, lights.right), (1.0, lights.left)):
        mesh.box((x, side * 0.2, z), (0.05, 0.07, 0.06), "amber_lit" if blinks else "amber")
        if blinks:
            mesh.lamp((x, side * 0.2, z), AMBER, (1.0 if x > 0 else -1.0, 0, 0), 2.0)


def motorcycle(mesh: MeshBuilder, shown: Appearance) -> None:
    """A motorcycle with its rider."""
    lights = shown.lights
    colour = shown.paint if shown.paint in ("red", "blue", "green") else "red"
    for x in (-0.68, 0.72):
        mesh.cylinder((x, -0.08, 0.32), (x, 0.08, 0.32), 0.32, "tyre", sides=14)
        for side in (-1.0, 1.0):
            mesh.cylinder((x, side * 0.08, 0.32), (x, side * 0.09, 0.32), 0.19, "hub")
    mesh.box((0.0, 0, 0.46), (0.7, 0.3, 0.36), "dark_grey")
    mesh.hull((-0.1, 0.45, -0.16, 0.16, 0.66), (-0.05, 0.35, -0.12, 0.12, 0.96), colour)
    mesh.hull((-0.85, 0.0, -0.13, 0.13, 0.70), (-0.95, -0.05, -0.11, 0.11, 0.86), "black")
    mesh.hull((-1.0, -0.6, -0.11, 0.11, 0.68), (-1.02, -0.8, -0.08, 0.08, 0.84), colour)
    mesh.hull((0.35, 0.75, -0.16, 0.16, 0.78), (0.45, 0.62, -0.13, 0.13, 1.12), colour)
    mesh.hull((0.5, 0.64, -0.14, 0.14, 1.08), (0.42, 0.46, -0.11, 0.11, 1.32), "glass_light")
    for side in (-1.0, 1.0):
        mesh.beam((0.72, side * 0.09, 0.32), (0.5, side * 0.09, 0.95), 0.05, "metal")
        mesh.beam((0.4, side * 0.3, 1.08), (0.38, side * 0.42, 1.24), 0.03, "black")
        mesh.box((0.38, side * 0.42, 1.26), (0.04, 0.13, 0.09), "black")
    mesh.beam((0.42, -0.36, 1.02), (0.42, 0.36, 1.02), 0.045, "black")
    mesh.cylinder((-0.1, -0.2, 0.36), (-0.9, -0.22, 0.46), 0.06, "metal", sides=8)
    stop = "brake_lit" if lights.brake else "tail_lit" if lights.running else "tail"
    mesh.box((-1.03, 0, 0.76), (0.04, 0.18, 0.10), stop)
    mesh.box((0.74, 0, 0.92), (0.06, 0.18, 0.14), "head_lit" if lights.running else "head")
    if lights.brake or lights.running:
        mesh.lamp((-1.03, 0, 0.76), RED, (-1, 0, 0), 3.0 if lights.brake else 1.0)
    if lights.running:
        mesh.lamp((0.74, 0, 0.92), WHITE, (1, 0, 0), 4.0)
    _signals(mesh, lights, -1.0, 0.72)
    _signals(mesh, lights, 0.72, 0.92)
    mesh.textured_quad(upright((-1.05, 0.1), (-1.05, -0.1), 0.52, 0.64), "plate_rear")
    feet = ((-0.06, -0.17, 0.44), (-0.06, 0.17, 0.44))
    clothes = Clothes("black", "trousers", hat=colour)
    _rider(mesh, clothes, (-0.3, 0, 0.94), (0.42, 0.34, 1.04), feet, lean=0.34)


VARIED = (cyclist, cargo_bike, e_scooter, motorcycle)
