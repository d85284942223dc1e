"""People on foot, facing x; they stand, walk or run."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.living.body import (
    HIP_M,
    SHOULDER_M,
    Clothes,
    add_arm,
    add_head,
    add_leg,
    add_neck,
    add_skirt,
    add_trunk,
    add_vest,
    drop_of,
)
from oodscen_pybullet._meshes.living.poses import pose_of
from oodscen_pybullet._meshes.living.posing import posed_figure
from oodscen_pybullet._meshes.look import Appearance, Direction
from oodscen_pybullet._types import Point

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
Extra = Callable[[MeshBuilder, Point], None]
"""Adds something to a body whose head is at a point."""


def figure(
    mesh: MeshBuilder,
    clothes: Clothes,
    shown: Appearance,
    posture: Posture = UPRIGHT,
    *,
    worn: Extra | None = None,
    on_head: Extra | None = None,
) -> None:
    """Add an adult of 1.75 m who stands, walks or runs, or is in the pose of its details.

    Args:
        mesh: Receives the adult.
        clothes: The colours.
        shown: The step and the details.
        posture: The posture without a pose.
        worn: Adds what moves with the trunk.
        on_head: Adds what moves with the head.
    """
    pose = pose_of(shown.details)
    if pose is not None:
        posed_figure(mesh, clothes, shown, pose, posture.half_step, (worn, on_head))
        return
    gait = shown.gait
    if shown.warned:
        posture = _reacting(posture, shown.warned)
    lean = posture.lean + (0.10 if gait and gait.runs else 0.0)
    drop = posture.crouch + drop_of(gait)
    hip, shoulder = HIP_M - drop, SHOULDER_M - drop
    for side in (-1.0, 1.0):
        own = gait and gait.of(side)
        add_leg(mesh, clothes, side, hip, own, posture.half_step)
        hand = posture.left_hand if side > 0 else posture.right_hand
        add_arm(mesh, clothes, side, (lean, side * 0.225, shoulder), hand, own)
    add_trunk(mesh, clothes, hip, shoulder, lean)
    add_skirt(mesh, clothes, hip)
    head = add_neck(mesh, clothes, shoulder, lean)
    face = MeshBuilder()
    add_head(face, clothes)
    mesh.add_surface(face.build(), head, yaw=_TURNS.get(shown.warned or "", 0.0))
    for extra in (worn, on_head):
        if extra is not None:
            extra(mesh, head)


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


def adult(mesh: MeshBuilder, shown: Appearance) -> None:
    """An adult pedestrian."""

    def worn(body: MeshBuilder, _: Point) -> None:
        if shown.index % 2:
            body.box((-0.12, 0, 1.2), (0.11, 0.28, 0.38), "bag")

    figure(mesh, WARDROBE[shown.index % len(WARDROBE)], shown, worn=worn)
    mesh.grounded()


def child(mesh: MeshBuilder, shown: Appearance) -> None:
    """A child of about seven, with a satchel."""
    tops = ("yellow", "shirt_red", "teal")
    hair = "hair_fair" if shown.index % 2 else "hair"
    clothes = Clothes(tops[shown.index % 3], "jeans", hair, sleeves="skin")

    def worn(body: MeshBuilder, head: Point) -> None:
        x, y, z = head
        body.box((x - 0.22, y, z - 0.42), (0.16, 0.34, 0.42), "fluor_orange")
        body.box((x - 0.31, y, z - 0.5), (0.04, 0.24, 0.2), "navy")

    def on_head(body: MeshBuilder, head: Point) -> None:
        x, y, z = head
        body.ball((x - 0.005, y, z + 0.03), (0.115, 0.105, 0.145), "skin")
        body.ball((x - 0.035, y, z + 0.08), (0.125, 0.12, 0.125), hair)
        for side in (-1.0, 1.0):
            eye = (x + 0.1, y + side * 0.045, z + 0.03)
            body.ball(eye, (0.012, 0.016, 0.018), "hair", around=6, down=4)

    posture = replace(UPRIGHT, half_step=0.36)
    figure(mesh, clothes, shown, posture, worn=worn, on_head=on_head)
    mesh.grounded().shift((0, 0, 0), scale=0.68)


def worker(mesh: MeshBuilder, shown: Appearance) -> None:
    """A road worker in high-visibility clothes, with helmet and shovel."""
    clothes = Clothes("fluor_orange", "fluor_orange", hat="yellow")
    hold = replace(UPRIGHT, half_step=0.28, right_hand=(0.16, -0.30, 1.06))
    figure(mesh, clothes, shown, hold, worn=yellow_vest)
    if has_free_hands(shown):
        mesh.cylinder((0.18, -0.34, 0.08), (0.15, -0.29, 1.38), 0.022, "wood", sides=6)
        mesh.box((0.19, -0.345, 0.15), (0.04, 0.22, 0.28), "metal")
    mesh.grounded()


def yellow_vest(body: MeshBuilder, head: Point) -> None:
    """Add a yellow high-visibility vest."""
    add_vest(body, head)


def has_free_hands(shown: Appearance) -> bool:
    """Return whether a person has the tool of its trade in its hands: no pose takes them."""
    return pose_of(shown.details) is None


def police_officer(mesh: MeshBuilder, shown: Appearance) -> None:
    """A police officer in a yellow vest, holding up a stop disc."""
    hold = replace(UPRIGHT, half_step=0.25, right_hand=(0.36, -0.30, 1.62))
    clothes = Clothes("uniform", "uniform", hat="uniform", gesture_gloves="white")

    def worn(body: MeshBuilder, head: Point) -> None:
        x, _, z = head
        add_vest(body, (x, 0.0, z))
        for side, at in ((-1.0, -0.175), (1.0, 0.135)):
            corners = [
                (x + at, y, z - h)
                for y, h in ((-0.16, 0.35), (0.16, 0.35), (0.16, 0.21), (-0.16, 0.21))
            ]
            if side < 0:
                corners = [corners[1], corners[0], corners[3], corners[2]]
            body.textured_quad(corners, "police_back")

    def on_head(body: MeshBuilder, head: Point) -> None:
        x, _, z = head
        rings = [((x - 0.01, 0.0, z + 0.09), 0.12, 0.11), ((x, 0.0, z + 0.15), 0.15, 0.14)]
        body.column(rings, "uniform")

    figure(mesh, clothes, shown, hold, worn=worn, on_head=on_head)
    if has_free_hands(shown):
        mesh.cylinder((0.37, -0.30, 1.52), (0.39, -0.30, 1.80), 0.018, "white", sides=6)
        mesh.cylinder((0.375, -0.30, 1.90), (0.405, -0.30, 1.90), 0.17, "white", sides=14)
        mesh.cylinder((0.37, -0.30, 1.90), (0.41, -0.30, 1.90), 0.13, "red", sides=14)
    mesh.grounded()


VARIED = (adult, child, worker, police_officer)
