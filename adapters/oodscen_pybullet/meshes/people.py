"""People, on foot and on two wheels."""

from dataclasses import dataclass

from oodscen_pybullet.meshes.bodywork import RED, Lights
from oodscen_pybullet.meshes.builder import MeshBuilder, Point


@dataclass(frozen=True)
class Clothes:
    """What a person wears: colours by name."""

    top: str
    legs: str
    hair: str = "hair"
    skin: str = "skin"
    hat: str = ""


WARDROBE: tuple[Clothes, ...] = (
    Clothes("shirt_red", "jeans"),
    Clothes("shirt", "trousers", "hair_fair"),
    Clothes("coat", "jeans", "hair", "skin_dark"),
    Clothes("shirt_white", "navy"),
    Clothes("shirt_green", "trousers", "hair", "skin_dark"),
    Clothes("yellow", "jeans", "hair_fair"),
)


def _limb(
    mesh: MeshBuilder, start: Point, middle: Point, end: Point, thick: float, colour: str
) -> None:
    mesh.cylinder(start, middle, thick, colour, sides=6, end_radius=thick * 0.85)
    mesh.cylinder(middle, end, thick * 0.85, colour, sides=6, end_radius=thick * 0.65)


def figure(
    mesh: MeshBuilder, clothes: Clothes, *, swing: float = 0.2, stop_sign: bool = False
) -> None:
    """Add a walking adult of 1.75 m who faces x."""
    for side in (-1.0, 1.0):
        y, step = side * 0.10, side * swing
        knee = (step * 0.6 + 0.05, y, 0.47)
        _limb(mesh, (0, y, 0.90), knee, (step - 0.02, y, 0.09), 0.085, clothes.legs)
        mesh.box((step + 0.05, y, 0.045), (0.26, 0.10, 0.09), "shoe")
        shoulder, elbow = (0.0, side * 0.235, 1.38), (-step * 0.5, side * 0.30, 1.12)
        hand = (-step * 0.8 + 0.12, side * 0.28, 0.90)
        if stop_sign and side < 0:
            elbow, hand = (0.22, -0.30, 1.30), (0.34, -0.28, 1.58)
        _limb(mesh, shoulder, elbow, hand, 0.058, clothes.top)
        mesh.ball(hand, (0.05, 0.045, 0.065), clothes.skin, around=6, down=4)
    mesh.hull((-0.11, 0.11, -0.17, 0.17, 0.84), (-0.12, 0.12, -0.20, 0.20, 1.15), clothes.top)
    mesh.hull((-0.12, 0.12, -0.20, 0.20, 1.15), (-0.10, 0.10, -0.24, 0.24, 1.42), clothes.top)
    mesh.cylinder((0, 0, 1.40), (0.01, 0, 1.52), 0.055, clothes.skin, sides=7)
    mesh.ball((0.02, 0, 1.61), (0.10, 0.085, 0.125), clothes.skin)
    if clothes.hat:
        mesh.ball((0.0, 0, 1.66), (0.135, 0.12, 0.11), clothes.hat)
        mesh.box((0.12, 0, 1.65), (0.10, 0.18, 0.02), clothes.hat)
    else:
        mesh.ball((-0.015, 0, 1.655), (0.105, 0.095, 0.105), clothes.hair)


def adult(lights: Lights, paint: str) -> MeshBuilder:
    """A grown-up pedestrian."""
    mesh = MeshBuilder()
    clothes = WARDROBE[int(paint or 0) % len(WARDROBE)]
    figure(mesh, clothes)
    if int(paint or 0) % 2:
        mesh.box((-0.17, 0, 1.22), (0.14, 0.28, 0.38), "bag")
    return mesh.solid((0, 0, 0.87), (0.45, 0.55, 1.74))


def child(lights: Lights, paint: str) -> MeshBuilder:
    """A child of about seven, with a satchel."""
    mesh = MeshBuilder()
    index = int(paint or 0)
    tops = ("yellow", "shirt_red", "teal")
    figure(
        mesh, Clothes(tops[index % 3], "jeans", "hair_fair" if index % 2 else "hair"), swing=0.26
    )
    mesh.box((-0.18, 0, 1.2), (0.16, 0.32, 0.4), "fluor_orange")
    mesh.ball((0.02, 0, 1.64), (0.12, 0.105, 0.14), "skin")
    mesh.ball((-0.02, 0, 1.68), (0.125, 0.115, 0.12), "hair")
    mesh.shift((0, 0, 0), scale=0.68)
    return mesh.solid((0, 0, 0.6), (0.34, 0.42, 1.2))


def worker(lights: Lights, paint: str) -> MeshBuilder:
    """A road worker in high-visibility clothes, with helmet and shovel."""
    mesh = MeshBuilder()
    figure(mesh, Clothes("fluor_orange", "fluor_orange", skin="skin", hat="yellow"), swing=0.1)
    for z in (1.0, 1.22):
        mesh.hull(
            (-0.125, 0.125, -0.205, 0.205, z),
            (-0.125, 0.125, -0.212, 0.212, z + 0.07),
            "silver",
            caps="",
        )
    for side in (-1.0, 1.0):
        mesh.box((0, side * 0.13, 1.33), (0.235, 0.05, 0.2), "fluor_yellow")
        mesh.cylinder(
            (side * 0.05 - 0.01, side * 0.1, 0.38),
            (side * 0.06, side * 0.1, 0.30),
            0.092,
            "silver",
            sides=6,
        )
    mesh.cylinder((0.18, -0.36, 0.05), (0.12, -0.30, 1.35), 0.022, "wood", sides=6)
    mesh.box((0.18, -0.36, 0.13), (0.04, 0.2, 0.26), "metal")
    return mesh.solid((0.03, 0, 0.88), (0.4, 0.6, 1.76))


def police_officer(lights: Lights, paint: str) -> MeshBuilder:
    """A police officer in a yellow vest who holds up a stop disc."""
    mesh = MeshBuilder()
    figure(mesh, Clothes("uniform", "uniform", hat="uniform"), swing=0.08, stop_sign=True)
    mesh.hull(
        (-0.13, 0.13, -0.21, 0.21, 0.92), (-0.125, 0.125, -0.245, 0.245, 1.40), "fluor_yellow"
    )
    mesh.hull(
        (-0.134, 0.134, -0.218, 0.218, 1.0), (-0.134, 0.134, -0.222, 0.222, 1.07), "silver", caps=""
    )
    mesh.picture(
        [(-0.135, 0.2, 1.16), (-0.135, -0.2, 1.16), (-0.132, -0.2, 1.34), (-0.132, 0.2, 1.34)],
        "police_back",
    )
    mesh.picture(
        [(0.135, -0.2, 1.16), (0.135, 0.2, 1.16), (0.132, 0.2, 1.34), (0.132, -0.2, 1.34)],
        "police_back",
    )
    mesh.ball((0.0, 0, 1.72), (0.14, 0.13, 0.045), "uniform")
    mesh.cylinder((0.36, -0.28, 1.5), (0.38, -0.28, 1.74), 0.018, "white", sides=6)
    mesh.cylinder((0.365, -0.28, 1.86), (0.395, -0.28, 1.86), 0.15, "white", sides=12)
    mesh.cylinder((0.36, -0.28, 1.86), (0.40, -0.28, 1.86), 0.11, "red", sides=12)
    return mesh.solid((0.06, 0, 0.88), (0.4, 0.6, 1.76))


def _two_wheeler_rider(
    mesh: MeshBuilder, clothes: Clothes, seat: Point, grip: Point, foot: float
) -> None:
    x, _, z = seat
    chest = (x + 0.28, 0.0, z + 0.48)
    mesh.beam((x, 0, z), chest, 0.32, clothes.top, end_width=0.36)
    head = (chest[0] + 0.10, 0, chest[2] + 0.26)
    mesh.ball(head, (0.11, 0.095, 0.13), clothes.skin)
    mesh.ball((head[0] - 0.02, 0, head[2] + 0.05), (0.15, 0.115, 0.105), clothes.hat)
    for side in (-1.0, 1.0):
        knee = (x + 0.36 + side * 0.06, side * 0.13, z - 0.30 + side * 0.05)
        ankle = (x + 0.16 + side * 0.10, side * 0.13, foot + side * 0.08)
        _limb(mesh, (x, side * 0.1, z), knee, ankle, 0.085, clothes.legs)
        mesh.box((ankle[0] + 0.07, ankle[1], ankle[2] - 0.03), (0.25, 0.09, 0.08), "shoe")
        shoulder = (chest[0], side * 0.19, chest[2])
        elbow = ((chest[0] + grip[0]) / 2, side * 0.27, (chest[2] + grip[2]) / 2 - 0.05)
        _limb(mesh, shoulder, elbow, (grip[0], side * abs(grip[1]), grip[2]), 0.055, clothes.top)


def cyclist(lights: Lights, paint: str) -> MeshBuilder:
    """A person with a helmet on a bicycle."""
    mesh = MeshBuilder()
    colour = ("blue", "red", "teal")[int(paint or 0) % 3]
    for x in (-0.52, 0.53):
        _bicycle_wheel(mesh, x, 0.34)
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
    mesh.box((-0.62, 0, 0.62), (0.05, 0.08, 0.08), "reflector")
    if lights.running:
        mesh.lamp((-0.62, 0, 0.62), RED, (-1, 0, 0), 0.6)
        mesh.lamp((0.5, 0, 0.9), (1, 0.97, 0.86), (1, 0, 0), 1.0)
    index = int(paint or 0)
    top = ("fluor_yellow", "shirt_red", "shirt_white")[index % 3]
    _two_wheeler_rider(
        mesh, Clothes(top, "trousers", hat="white"), (-0.22, 0, 0.98), (0.34, 0.26, 1.04), 0.26
    )
    return mesh.solid((0, 0, 0.4), (1.76, 0.2, 0.8)).solid((0.0, 0, 1.15), (0.7, 0.56, 1.2))


def _bicycle_wheel(mesh: MeshBuilder, x: float, radius: float) -> None:
    from math import cos, pi, sin

    rim = [
        (
            x + radius * 0.95 * cos(2 * pi * i / 14),
            0.0,
            radius + radius * 0.95 * sin(2 * pi * i / 14),
        )
        for i in range(14)
    ]
    for one, two in zip(rim, rim[1:] + rim[:1], strict=True):
        mesh.beam(one, two, 0.045, "tyre")
    for i in range(0, 14, 2):
        mesh.beam((x, 0, radius), rim[i], 0.012, "silver")


def motorcycle(lights: Lights, paint: str) -> MeshBuilder:
    """A motorcycle with its rider."""
    mesh = MeshBuilder()
    colour = paint if paint in ("red", "blue", "green") else "red"
    for x in (-0.68, 0.72):
        mesh.cylinder((x, -0.08, 0.32), (x, 0.08, 0.32), 0.32, "tyre", sides=14)
        for side in (-1.0, 1.0):
            mesh.cylinder((x, side * 0.08, 0.32), (x, side * 0.09, 0.32), 0.19, "hub")
    mesh.box((0.0, 0, 0.46), (0.7, 0.3, 0.36), "dark_grey")
    mesh.hull((-0.1, 0.45, -0.16, 0.16, 0.66), (-0.05, 0.35, -0.12, 0.12, 0.96), colour)
    mesh.hull((-0.85, 0.0, -0.13, 0.13, 0.70), (-0.95, -0.05, -0.11, 0.11, 0.86), "black")
    mesh.hull((-1.0, -0.6, -0.11, 0.11, 0.68), (-1.02, -0.8, -0.08, 0.08, 0.84), colour)
    mesh.hull((0.35, 0.75, -0.16, 0.16, 0.78), (0.45, 0.62, -0.13, 0.13, 1.12), colour)
    mesh.beam((0.72, 0.09, 0.32), (0.5, 0.09, 0.95), 0.05, "metal")
    mesh.beam((0.72, -0.09, 0.32), (0.5, -0.09, 0.95), 0.05, "metal")
    mesh.beam((0.42, -0.36, 1.02), (0.42, 0.36, 1.02), 0.045, "black")
    mesh.cylinder((-0.1, -0.2, 0.36), (-0.9, -0.22, 0.46), 0.06, "metal", sides=8)
    stop = "brake_lit" if lights.brake else "tail_lit" if lights.running else "tail"
    mesh.box((-1.03, 0, 0.76), (0.04, 0.16, 0.09), stop)
    mesh.box((0.74, 0, 0.92), (0.06, 0.18, 0.14), "head_lit" if lights.running else "head")
    if lights.brake or lights.running:
        mesh.lamp((-1.03, 0, 0.76), RED, (-1, 0, 0), 3.0 if lights.brake else 1.0)
    if lights.running:
        mesh.lamp((0.74, 0, 0.92), (1, 0.97, 0.86), (1, 0, 0), 4.0)
    for side, blinks in ((-1.0, lights.right), (1.0, lights.left)):
        mesh.box((-1.0, side * 0.2, 0.72), (0.05, 0.06, 0.05), "amber_lit" if blinks else "amber")
        if blinks:
            mesh.lamp((-1.0, side * 0.2, 0.72), (1, 0.62, 0.08), (-1, 0, 0), 2.0)
    mesh.picture(
        [(-1.05, 0.1, 0.52), (-1.05, -0.1, 0.52), (-1.05, -0.1, 0.64), (-1.05, 0.1, 0.64)],
        "plate_rear",
    )
    _two_wheeler_rider(
        mesh, Clothes("black", "trousers", hat=colour), (-0.3, 0, 0.92), (0.42, 0.34, 1.04), 0.40
    )
    return mesh.solid((0, 0, 0.5), (2.06, 0.4, 1.0)).solid((-0.05, 0, 1.15), (0.8, 0.6, 0.9))
