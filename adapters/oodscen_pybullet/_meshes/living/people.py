"""People on foot, facing x; they stand, walk or run."""

import math
from dataclasses import dataclass, replace

from oodscen_pybullet._meshes.builder import MeshBuilder, Point
from oodscen_pybullet._meshes.living.limbs import joint, limb, stride
from oodscen_pybullet._meshes.look import Appearance, Direction


@dataclass(frozen=True)
class Clothes:
    """A person's clothes: colours by name."""

    top: str
    legs: str
    hair: str = "hair"
    skin: str = "skin"
    hat: str = ""
    shoes: str = "shoe"
    sleeves: str = ""
    """Colour of the forearms below short sleeves."""
    shins: str = ""
    """Colour of the shins below short trousers."""
    has_long_hair: bool = False
    skirt: str = ""


WARDROBE: tuple[Clothes, ...] = (
    Clothes("shirt_red", "jeans"),
    Clothes("shirt", "trousers", "hair_fair", has_long_hair=True),
    Clothes("coat", "jeans", "hair", "skin_dark"),
    Clothes("shirt_white", "navy", sleeves="skin"),
    Clothes("shirt_green", "skin_dark", "hair", "skin_dark", has_long_hair=True, skirt="burgundy"),
    Clothes("yellow", "jeans", "hair_fair"),
)


@dataclass(frozen=True)
class Posture:
    """The posture of a body."""

    left_hand: Point | None = None
    """Position of the hand; `None` swings it with the legs."""
    right_hand: Point | None = None
    lean: float = 0.0
    """Distance by which the shoulders are ahead of the hips, m."""
    half_step: float = 0.33
    """Distance ahead of the hip at which a walking foot lands, m."""
    crouch: float = 0.0
    """Distance by which the hips are lowered, m."""


UPRIGHT = Posture()
HIP = 0.90
SHOULDER = 1.40


def figure(
    mesh: MeshBuilder, clothes: Clothes, shown: Appearance, posture: Posture = UPRIGHT
) -> tuple[float, float, float]:
    """Add an adult of 1.75 m who stands, walks or runs; return the centre of the head."""
    phase, runs = shown.gait or (0.0, False)
    moves = shown.gait is not None
    if shown.warned:
        posture = _reacting(posture, shown.warned)
    lean = posture.lean + (0.10 if runs else 0.0)
    drop = posture.crouch + (0.05 if runs else 0.03 if moves else 0.0)
    hip, shoulder = HIP - drop, SHOULDER - drop
    for side in (-1.0, 1.0):
        own = phase + (0.5 if side > 0 else 0.0)
        _leg(mesh, clothes, side, hip, own, posture.half_step, moves=moves, runs=runs)
        hand = posture.left_hand if side > 0 else posture.right_hand
        _arm(mesh, clothes, side, (lean, side * 0.225, shoulder), hand, own, moves, runs)
    waist = (0.4 * lean, 0.0, hip + 0.20)
    mesh.column(
        [
            ((0.0, 0.0, hip - 0.08), 0.105, 0.155),
            ((0.0, 0.0, hip + 0.06), 0.115, 0.165),
            (waist, 0.105, 0.15),
            ((0.8 * lean, 0.0, hip + 0.38), 0.125, 0.19),
            ((lean, 0.0, shoulder + 0.02), 0.10, 0.215),
            ((lean, 0.0, shoulder + 0.08), 0.055, 0.09),
        ],
        [clothes.legs, clothes.legs, clothes.top, clothes.top, clothes.top],
    )
    if clothes.skirt:
        mesh.column(
            [((0, 0, 0.48), 0.2, 0.26), ((0, 0, hip + 0.1), 0.12, 0.165)], clothes.skirt, caps="b"
        )
    head = (lean + 0.02, 0.0, shoulder + 0.215)
    mesh.cylinder((lean, 0, shoulder + 0.05), (head[0], 0, head[2]), 0.05, clothes.skin, sides=6)
    face = MeshBuilder()
    _head(face, clothes, (0.0, 0.0, 0.0))
    mesh.add(face.build(), head, yaw=_TURNS.get(shown.warned or "", 0.0))
    return head


_TURNS = {"left": 1.0, "right": -1.0}
"""Angle by which the head turns towards a vehicle, rad."""


def _reacting(posture: Posture, direction: Direction) -> Posture:
    """Return a posture that reacts to a vehicle: free hands up, those that hold something stay."""
    left, right, lean = posture.left_hand, posture.right_hand, posture.lean
    if direction in ("ahead", "left"):
        left = left or (0.14, 0.44, 1.76)
    if direction in ("ahead", "right"):
        right = right or (0.14, -0.44, 1.76)
    return replace(
        posture, left_hand=left, right_hand=right, lean=lean - 0.1 if direction == "ahead" else lean
    )


def _leg(
    mesh: MeshBuilder,
    clothes: Clothes,
    side: float,
    hip: float,
    phase: float,
    half: float,
    *,
    moves: bool,
    runs: bool,
) -> None:
    y, ankle = side * 0.095, 0.09
    ahead, up = side * -0.03, 0.0
    if moves:
        half = 1.3 * half if runs else half
        ahead, up = stride(phase, half, 0.42 if runs else 0.13, 0.42 if runs else 0.6)
    foot = (ahead - 0.03, y, ankle + up)
    knee, foot = joint((0.0, y, hip), foot, 0.425, 0.41, (1.0, side * 0.05, 0.1))
    shin = clothes.shins or clothes.legs
    limb(mesh, ((0.0, y, hip), knee, foot), (0.09, 0.065, 0.045), (clothes.legs, shin))
    x, z = foot[0], foot[2] - ankle
    tip = 0.6 * up
    mesh.hull(
        (x - 0.08, x + 0.19, y - 0.048, y + 0.048, z),
        (x - 0.07, x + 0.11, y - 0.04, y + 0.04, z + 0.1),
        clothes.shoes,
    ) if tip < 0.03 else mesh.beam(
        (x - 0.02, y, z + 0.1), (x + 0.15, y, z + 0.08 - min(tip, 0.06)), 0.095, clothes.shoes
    )


def _arm(
    mesh: MeshBuilder,
    clothes: Clothes,
    side: float,
    shoulder: Point,
    hand: Point | None,
    phase: float,
    moves: bool,
    runs: bool,
) -> None:
    x, _y, z = shoulder
    if hand is None:
        swing = -math.cos(2 * math.pi * phase) if moves else 0.0
        reach = 0.42 if runs else 0.26
        hand = (x + 0.05 + reach * swing, side * 0.27, z - 0.51 + 0.06 * abs(swing))
        if runs:
            hand = (x + 0.14 + 0.26 * swing, side * 0.2, z - 0.26 + 0.16 * swing)
    elbow, hand = joint(shoulder, hand, 0.28, 0.27, (-1.0, side * 0.5, -0.2))
    lower = clothes.sleeves or clothes.top
    limb(mesh, (shoulder, elbow, hand), (0.062, 0.048, 0.034), (clothes.top, lower))
    mesh.ball(hand, (0.045, 0.04, 0.06), clothes.skin, around=6, down=4)


def _head(mesh: MeshBuilder, clothes: Clothes, head: Point) -> None:
    x, y, z = head
    mesh.ball(head, (0.10, 0.082, 0.125), clothes.skin)
    mesh.box((x + 0.10, y, z - 0.015), (0.03, 0.025, 0.04), clothes.skin, caps="b")
    for side in (-1.0, 1.0):
        eye = side * 0.036
        mesh.polygon(
            [
                (x + 0.094, y + eye - 0.014, z + 0.012),
                (x + 0.094, y + eye + 0.014, z + 0.012),
                (x + 0.092, y + eye + 0.014, z + 0.034),
                (x + 0.092, y + eye - 0.014, z + 0.034),
            ],
            "hair",
        )
    if clothes.hat:
        mesh.ball((x - 0.01, y, z + 0.055), (0.125, 0.11, 0.105), clothes.hat)
        mesh.box((x + 0.10, y, z + 0.05), (0.10, 0.17, 0.02), clothes.hat)
        return
    mesh.ball((x - 0.025, y, z + 0.045), (0.105, 0.095, 0.105), clothes.hair)
    if clothes.has_long_hair:
        mesh.hull(
            (x - 0.13, x - 0.02, y - 0.09, y + 0.09, z - 0.2),
            (x - 0.12, x + 0.02, y - 0.095, y + 0.095, z + 0.06),
            clothes.hair,
        )


def grounded(mesh: MeshBuilder) -> MeshBuilder:
    """Move everything so that the lowest foot touches the ground."""
    low, _ = mesh.bounds
    return mesh.shift((0.0, 0.0, -float(low[2])))


def adult(mesh: MeshBuilder, shown: Appearance) -> None:
    """An adult pedestrian."""
    figure(mesh, WARDROBE[shown.index % len(WARDROBE)], shown)
    if shown.index % 2:
        mesh.box((-0.12, 0, 1.2), (0.11, 0.28, 0.38), "bag")
    grounded(mesh)


def child(mesh: MeshBuilder, shown: Appearance) -> None:
    """A child of about seven, with a satchel."""
    tops = ("yellow", "shirt_red", "teal")
    hair = "hair_fair" if shown.index % 2 else "hair"
    clothes = Clothes(tops[shown.index % 3], "jeans", hair, sleeves="skin")
    x, y, z = figure(mesh, clothes, shown, replace(UPRIGHT, half_step=0.36))
    mesh.box((x - 0.22, y, z - 0.42), (0.16, 0.34, 0.42), "fluor_orange")
    mesh.box((x - 0.31, y, z - 0.5), (0.04, 0.24, 0.2), "navy")
    mesh.ball((x - 0.005, y, z + 0.03), (0.115, 0.105, 0.145), "skin")
    mesh.ball((x - 0.035, y, z + 0.08), (0.125, 0.12, 0.125), hair)
    for side in (-1.0, 1.0):
        mesh.ball(
            (x + 0.1, y + side * 0.045, z + 0.03), (0.012, 0.016, 0.018), "hair", around=6, down=4
        )
    grounded(mesh).shift((0, 0, 0), scale=0.68)


def vest(mesh: MeshBuilder, colour: str, head: Point) -> None:
    """Add a high-visibility vest with two reflective bands around the chest, below a given head."""
    x, _, z = head
    rings = (
        ((x - 0.05, 0.0, z - 0.70), 0.13, 0.178),
        ((x - 0.04, 0.0, z - 0.45), 0.128, 0.178),
        ((x - 0.02, 0.0, z - 0.24), 0.142, 0.214),
        ((x - 0.02, 0.0, z - 0.17), 0.10, 0.19),
    )
    mesh.column(rings, colour, caps="")
    for low, high in ((-0.62, -0.56), (-0.42, -0.36)):
        mesh.column(
            [((x - 0.04, 0, z + low), 0.140, 0.192), ((x - 0.04, 0, z + high), 0.140, 0.194)],
            "silver",
            caps="",
        )


def worker(mesh: MeshBuilder, shown: Appearance) -> None:
    """A road worker in high-visibility clothes, with helmet and shovel."""
    clothes = Clothes("fluor_orange", "fluor_orange", hat="yellow")
    hold = replace(UPRIGHT, half_step=0.28, right_hand=(0.16, -0.30, 1.06))
    head = figure(mesh, clothes, shown, hold)
    vest(mesh, "fluor_yellow", head)
    mesh.cylinder((0.18, -0.34, 0.08), (0.15, -0.29, 1.38), 0.022, "wood", sides=6)
    mesh.box((0.19, -0.345, 0.15), (0.04, 0.22, 0.28), "metal")
    grounded(mesh)


def police_officer(mesh: MeshBuilder, shown: Appearance) -> None:
    """A police officer in a yellow vest, holding up a stop disc."""
    hold = replace(UPRIGHT, half_step=0.25, right_hand=(0.36, -0.30, 1.62))
    x, _, z = figure(mesh, Clothes("uniform", "uniform", hat="uniform"), shown, hold)
    vest(mesh, "fluor_yellow", (x, 0.0, z))
    for side, at in ((-1.0, -0.175), (1.0, 0.135)):
        corners = [
            (x + at, y, z - h)
            for y, h in ((-0.16, 0.35), (0.16, 0.35), (0.16, 0.21), (-0.16, 0.21))
        ]
        if side < 0:
            corners = [corners[1], corners[0], corners[3], corners[2]]
        mesh.picture(corners, "police_back")
    mesh.column([((x - 0.01, 0, z + 0.09), 0.12, 0.11), ((x, 0, z + 0.15), 0.15, 0.14)], "uniform")
    mesh.cylinder((0.37, -0.30, 1.52), (0.39, -0.30, 1.80), 0.018, "white", sides=6)
    mesh.cylinder((0.375, -0.30, 1.90), (0.405, -0.30, 1.90), 0.17, "white", sides=14)
    mesh.cylinder((0.37, -0.30, 1.90), (0.41, -0.30, 1.90), 0.13, "red", sides=14)
    grounded(mesh)


VARIED = (adult, child, worker, police_officer)
