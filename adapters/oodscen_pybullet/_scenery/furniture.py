"""Roadside furniture: lamps, posts, rails, benches, fences, parked cars."""

from functools import cache, lru_cache

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.designs import Design, read_designs
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._meshes.shapes import CIRCLE
from oodscen_pybullet._meshes.tags import Tag, on_posts, tagged

TAGS = {
    "hedge_front": Tag.VEGETATION,
    "side_hedge": Tag.VEGETATION,
    "picket_front": Tag.FENCES,
    "field_fence": Tag.FENCES,
    "wall_front": Tag.WALLS,
    "drive": Tag.GROUND,
    "parked_car": Tag.CAR,
    "bollard": Tag.POLES,
    "delineator": Tag.POLES,
    "power_pole": Tag.POLES,
    "hay_bale": Tag.DYNAMIC,
    "rail_post": Tag.GUARD_RAIL,
}
"""Semantic classes of furniture; the rest is static."""
LIMITS = frozenset(range(10, 140, 10))
"""Speed limits that have signs, km/h."""
_STROKES = ("abcdef", "bc", "abged", "abgcd", "fgbc", "afgcd", "afgedc", "abc", "abcdefg", "abcdfg")
"""The bars of each digit on a seven-segment display."""
_BARS = {
    "a": (0.0, 1.0, True), "g": (0.0, 0.0, True), "d": (0.0, -1.0, True),
    "f": (-1.0, 0.5, False), "b": (1.0, 0.5, False),
    "e": (-1.0, -0.5, False), "c": (1.0, -0.5, False),
}  # fmt: skip
"""Place across and up of each bar, in half widths and heights of a digit, and whether it is level."""


@cache
def load_furniture() -> dict[str, Design]:
    """Return the designs of `furniture.toml` by name."""
    return read_designs("oodscen_pybullet._scenery")


@lru_cache(maxsize=64)
def piece(name: str, *, paint: str = "", is_night: bool = False) -> Mesh:
    """Return a piece of furniture, a design of `furniture.toml`."""
    mesh = load_furniture()[name].assemble(Appearance("night" if is_night else "", paint)).build()
    return tagged(mesh, TAGS.get(name, Tag.STATIC))


@lru_cache(maxsize=8)
def street_lamp(reach: float, height: float, *, is_night: bool) -> Mesh:
    """Return a street lamp whose arm reaches towards -y."""
    mesh = MeshBuilder()
    mesh.beam((0, 0, -0.2), (0, 0, height), 0.15, "post", end_width=0.1)
    mesh.beam((0, 0, height - 0.05), (0, -reach, height + 0.1), 0.08, "post")
    mesh.box((0, -reach, height + 0.08), (0.34, 0.8, 0.12), "dark_grey")
    glass = "lamp_on" if is_night else "lamp_glass"
    mesh.box((0, -reach, height - 0.01), (0.26, 0.62, 0.06), glass)
    return tagged(mesh.build(), Tag.POLES)


@lru_cache(maxsize=32)
def speed_sign(limit: int) -> Mesh:
    """Return a speed limit sign that faces -x; the limit is in km/h."""
    mesh = MeshBuilder()
    mesh.beam((0, 0, -0.3), (0, 0, 2.2), 0.06, "post")
    for out, radius, colour in ((0.0, 0.36, "red"), (-0.014, 0.27, "white")):
        disc = [(out, -radius * c, 2.4 + radius * s) for c, s in CIRCLE]
        mesh.polygon(disc, colour)
    back = [(0.06, 0.36 * c, 2.4 + 0.36 * s) for c, s in CIRCLE]
    mesh.polygon(back, "grey")
    digits = str(limit)
    half, tall, bold = (0.06, 0.11, 0.022) if len(digits) < 3 else (0.04, 0.1, 0.017)
    for index, digit in enumerate(digits):
        middle = (0.5 * (len(digits) - 1) - index) * (2 * half + 0.05)
        for bar in _STROKES[int(digit)]:
            across, up, is_flat = _BARS[bar]
            y, z = middle - across * half, 2.4 + up * tall
            wide, high = (half + bold, bold) if is_flat else (bold, 0.5 * tall + bold)
            corners = ((-wide, -high), (wide, -high), (wide, high), (-wide, high))
            mesh.polygon([(-0.028, y - a, z + b) for a, b in corners], "black")
    return on_posts(mesh.build(), Tag.TRAFFIC_SIGNS)


@lru_cache(maxsize=4)
def gantry(span: float) -> Mesh:
    """Return a sign gantry that spans `span` metres, from y = 0 towards -y, facing +x."""
    mesh = MeshBuilder()
    for y in (0.0, -span):
        mesh.beam((0, y, -0.3), (0, y, 7.4), 0.3, "post")
    for z in (6.6, 7.4):
        mesh.beam((0, 0, z), (0, -span, z), 0.2, "post")
    for y in (-span * 0.32, -span * 0.72):
        mesh.box((0.0, y, 7.0), (0.1, 4.4, 1.9), "grey")
        board = [(y - 2.1, 6.15), (y + 2.1, 6.15), (y + 2.1, 7.85), (y - 2.1, 7.85)]
        mesh.textured_quad([(0.06, u, z) for u, z in board], "gantry")
    return on_posts(mesh.build(), Tag.TRAFFIC_SIGNS)
