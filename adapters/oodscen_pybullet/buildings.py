"""Houses and city blocks; their front faces -y and their depth goes along y."""

from functools import lru_cache

from oodscen_pybullet.meshes.builder import Mesh, MeshBuilder

STOREY = 3.2
"""Height of one storey, m."""
BAY = 6.0
"""Width of one facade tile, m."""


@lru_cache(maxsize=128)
def city_block(width: int, floors: int, style: int, has_shop: bool) -> Mesh:
    """Return a town building.

    Args:
        width: Along x, a multiple of six metres.
        floors: Storeys.
        style: Which of six facades.
        has_shop: Whether there are shop windows at street level.
    """
    mesh = MeshBuilder()
    half, depth = width / 2, 12.0
    region = f"facade_{style}"
    bays = round(width / BAY)
    for floor in range(floors):
        low, high = floor * STOREY, (floor + 1) * STOREY
        for bay in range(bays):
            x0 = -half + bay * BAY
            x1 = x0 + BAY
            front = [
                (x0, -depth / 2, low),
                (x1, -depth / 2, low),
                (x1, -depth / 2, high),
                (x0, -depth / 2, high),
            ]
            shop = f"shop_{(style + floors) % 4}"
            mesh.picture(front, shop if floor == 0 and has_shop else region)
        for bay in range(2):
            y0 = -depth / 2 + bay * BAY
            y1 = y0 + BAY
            mesh.picture(
                [(half, y0, low), (half, y1, low), (half, y1, high), (half, y0, high)], region
            )
            mesh.picture(
                [(-half, y1, low), (-half, y0, low), (-half, y0, high), (-half, y1, high)], region
            )
    top = floors * STOREY
    mesh.hull(
        (-half - 0.3, half + 0.3, -depth / 2 - 0.3, depth / 2, top),
        (-half - 0.3, half + 0.3, -depth / 2 - 0.3, depth / 2, top + 0.5),
        "concrete",
        cap_colour="roof_grey",
    )
    return mesh.build(hollow=True)


_ROOFS = ("roof_red", "roof_brown", "roof_grey")
_WALLS = ("wall_brick", "wall_cream", "wall_white")


@lru_cache(maxsize=16)
def house(kind: int, roof: int) -> Mesh:
    """Return a detached house of two storeys with a gabled roof.

    Args:
        kind: Which of three walls.
        roof: Which of three roofs.
    """
    mesh = MeshBuilder()
    half, depth, storey = 4.5, 4.0, 2.7
    wall, tile = _WALLS[kind], f"house_{kind}"
    for floor in range(2):
        low, high = floor * storey, (floor + 1) * storey
        front = [
            (-half, -depth, low),
            (half, -depth, low),
            (half, -depth, high),
            (-half, -depth, high),
        ]
        mesh.picture(front, f"door_{kind}" if floor == 0 else tile)
        mesh.picture(
            [(half, -depth, low), (half, depth, low), (half, depth, high), (half, -depth, high)],
            tile,
        )
        mesh.picture(
            [
                (-half, depth, low),
                (-half, -depth, low),
                (-half, -depth, high),
                (-half, depth, high),
            ],
            tile,
        )
    eaves, ridge = 2 * storey, 2 * storey + 3.0
    over, out = half + 0.4, depth + 0.5
    colour = _ROOFS[roof]
    mesh.polygon(
        [
            (-over, -out, eaves - 0.2),
            (over, -out, eaves - 0.2),
            (over, 0, ridge),
            (-over, 0, ridge),
        ],
        colour,
    )
    mesh.polygon(
        [(over, out, eaves - 0.2), (-over, out, eaves - 0.2), (-over, 0, ridge), (over, 0, ridge)],
        colour,
    )
    mesh.polygon([(half, -depth, eaves), (half, depth, eaves), (half, 0, ridge - 0.2)], wall)
    mesh.polygon([(-half, depth, eaves), (-half, -depth, eaves), (-half, 0, ridge - 0.2)], wall)
    mesh.box((-2.2, 0.6, ridge - 0.2), (0.7, 0.7, 1.8), "wall_brick")
    mesh.box((0.85, -depth - 0.5, 2.45), (1.8, 1.0, 0.12), "concrete")
    mesh.box((0.85, -depth - 0.4, 0.08), (1.8, 0.8, 0.16), "concrete")
    return mesh.build(hollow=True)
