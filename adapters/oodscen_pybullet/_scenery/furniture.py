"""Roadside furniture: lamps, posts, rails, benches, fences, parked cars."""

from functools import lru_cache

from oodscen_pybullet._meshes.builder import Mesh, MeshBuilder


@lru_cache(maxsize=8)
def street_lamp(reach: float, height: float, *, is_night: bool) -> Mesh:
    """Return a street lamp whose arm reaches towards -y."""
    mesh = MeshBuilder()
    mesh.beam((0, 0, -0.2), (0, 0, height), 0.15, "post", end_width=0.1)
    mesh.beam((0, 0, height - 0.05), (0, -reach, height + 0.1), 0.08, "post")
    mesh.box((0, -reach, height + 0.08), (0.34, 0.8, 0.12), "dark_grey")
    glass = "lamp_on" if is_night else "lamp_glass"
    mesh.box((0, -reach, height - 0.01), (0.26, 0.62, 0.06), glass)
    return mesh.build()


LIMITS = frozenset(range(10, 140, 10))
"""Speed limits that have signs, km/h."""
_STROKES = ("abcdef", "bc", "abged", "abgcd", "fgbc", "afgcd", "afgedc", "abc", "abcdefg", "abcdfg")
_BARS = {
    "a": (0.0, 1.0, True), "g": (0.0, 0.0, True), "d": (0.0, -1.0, True),
    "f": (-1.0, 0.5, False), "b": (1.0, 0.5, False),
    "e": (-1.0, -0.5, False), "c": (1.0, -0.5, False),
}  # fmt: skip


@lru_cache(maxsize=32)
def speed_sign(limit: int) -> Mesh:
    """Return a speed limit sign that faces -x; the limit is in km/h."""
    mesh = MeshBuilder()
    mesh.beam((0, 0, -0.3), (0, 0, 2.2), 0.06, "post")
    for out, radius, colour in ((0.0, 0.36, "red"), (-0.014, 0.27, "white")):
        turns = ((c * radius, s * radius) for c, s in _RIM)
        mesh.polygon([(out, -y, 2.4 + z) for y, z in turns], colour)
    back = [(0.06, 0.36 * c, 2.4 + 0.36 * s) for c, s in _RIM]
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
    return mesh.build()


_RIM = tuple(
    (c * p - s * q, s * p + c * q)
    for p, q in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
    for c, s in ((1.0, 0.0), (0.9239, 0.3827), (0.7071, 0.7071), (0.3827, 0.9239))
)


@lru_cache(maxsize=4)
def front(style: int) -> Mesh:
    """Return the front of a garden, ten metres along x: hedge, pickets or wall."""
    mesh = MeshBuilder()
    if style == 0:
        mesh.box((0, 0, 0.4), (10.0, 0.6, 1.3), "hedge", caps="t")
    elif style == 1:
        for index in range(6):
            mesh.box((-5.0 + 2.0 * index, 0, 0.4), (0.12, 0.12, 1.3), "wall_white", caps="t")
        for z in (0.3, 0.6, 0.9):
            mesh.box((0, 0, z), (10.0, 0.05, 0.14), "wall_white", caps="t")
    else:
        mesh.box((0, 0, 0.2), (10.0, 0.25, 0.9), "wall_brick", caps="")
        mesh.box((0, 0, 0.67), (10.0, 0.32, 0.06), "concrete", caps="t")
    return mesh.build()


@lru_cache(maxsize=2)
def side_hedge() -> Mesh:
    """Return a hedge of nine metres along y, between two gardens."""
    return MeshBuilder().box((0, 4.5, 0.35), (0.6, 9.0, 1.4), "hedge", caps="t").build()


@lru_cache(maxsize=2)
def drive(length: float) -> Mesh:
    """Return a paved drive along y, starting at the origin."""
    mesh = MeshBuilder()
    mesh.polygon(
        [(-1.5, 0, 0.03), (1.5, 0, 0.03), (1.5, length, 0.03), (-1.5, length, 0.03)], "concrete"
    )
    return mesh.build()


_HEXAGON = ((1, 0), (0.5, 0.866), (-0.5, 0.866), (-1, 0), (-0.5, -0.866), (0.5, -0.866))


@lru_cache(maxsize=16)
def parked_car(paint: str) -> Mesh:
    """Return a car with few triangles, for drives and yards."""
    mesh = MeshBuilder()
    mesh.hull(
        (-2.1, 2.1, -0.85, 0.85, 0.3),
        (-2.15, 2.05, -0.88, 0.88, 0.62),
        paint,
        caps="b",
        cap_colour="underbody",
    )
    mesh.hull((-2.15, 2.05, -0.88, 0.88, 0.62), (-2.05, 1.95, -0.8, 0.8, 0.88), paint, caps="t")
    mesh.hull(
        (-1.75, 0.95, -0.78, 0.78, 0.88),
        (-1.25, 0.25, -0.6, 0.6, 1.42),
        "glass",
        caps="t",
        cap_colour=paint,
    )
    for x in (-1.3, 1.3):
        for y in (-0.9, 0.9):
            disc = [(x + 0.32 * a, y, 0.32 + 0.32 * b) for a, b in _HEXAGON]
            mesh.polygon(disc if y < 0 else disc[::-1], "tyre")
    for y in (-0.6, 0.6):
        mesh.box((2.06, y, 0.62), (0.06, 0.34, 0.14), "head", caps="")
        mesh.box((-2.14, y, 0.68), (0.06, 0.3, 0.14), "tail", caps="")
    return mesh.build()


@lru_cache(maxsize=1)
def bench() -> Mesh:
    """Return a bench that faces -y."""
    mesh = MeshBuilder()
    for x in (-0.7, 0.7):
        mesh.box((x, 0, 0.22), (0.08, 0.4, 0.44), "post", caps="")
    mesh.box((0, 0, 0.46), (1.7, 0.42, 0.05), "wood")
    mesh.box((0, 0.22, 0.72), (1.7, 0.05, 0.32), "wood")
    return mesh.build()


@lru_cache(maxsize=1)
def litter_bin() -> Mesh:
    """Return a litter bin."""
    return MeshBuilder().cylinder((0, 0, 0), (0, 0, 0.95), 0.24, "bin_green", sides=7).build()


@lru_cache(maxsize=1)
def hydrant() -> Mesh:
    """Return a fire hydrant."""
    mesh = MeshBuilder()
    mesh.cylinder((0, 0, 0), (0, 0, 0.62), 0.13, "fire_red", sides=7)
    mesh.cylinder((0, 0, 0.62), (0, 0, 0.76), 0.12, "fire_red", sides=7, end_radius=0.03)
    mesh.beam((0, -0.22, 0.45), (0, 0.22, 0.45), 0.13, "fire_red")
    return mesh.build()


@lru_cache(maxsize=2)
def bus_stop(*, is_night: bool) -> Mesh:
    """Return a bus shelter with a sign, open towards -y."""
    mesh = MeshBuilder()
    mesh.box((0, 0.75, 1.2), (4.0, 0.05, 2.0), "glass_light", caps="")
    mesh.box((-2.0, 0.15, 1.2), (0.05, 1.2, 2.0), "lit_window_cool" if is_night else "wall_blue")
    for x in (-2.0, 2.0):
        for y in (-0.5, 0.75):
            mesh.box((x, y, 1.15), (0.08, 0.08, 2.3), "dark_grey", caps="")
    mesh.box((0, 0.1, 2.35), (4.4, 1.7, 0.12), "dark_grey")
    mesh.box((0.4, 0.5, 0.45), (2.4, 0.36, 0.06), "wood")
    mesh.beam((3.0, -0.6, 0), (3.0, -0.6, 2.7), 0.07, "post")
    mesh.box((3.0, -0.6, 2.55), (0.08, 0.55, 0.55), "awning_green")
    mesh.box((3.0, -0.6, 2.55), (0.09, 0.3, 0.3), "yellow")
    return mesh.build()


@lru_cache(maxsize=1)
def bollard() -> Mesh:
    """Return a bollard."""
    mesh = MeshBuilder().cylinder((0, 0, 0), (0, 0, 0.9), 0.09, "dark_grey", sides=6)
    return mesh.cylinder((0, 0, 0.7), (0, 0, 0.78), 0.1, "white", sides=6).build()


@lru_cache(maxsize=1)
def mailbox() -> Mesh:
    """Return a letter box on a post."""
    mesh = MeshBuilder().beam((0, 0, 0), (0, 0, 1.0), 0.08, "fence")
    return mesh.box((0, 0, 1.12), (0.42, 0.2, 0.24), "red").build()


@lru_cache(maxsize=1)
def delineator() -> Mesh:
    """Return a delineator post."""
    mesh = MeshBuilder()
    mesh.box((0, 0, 0.4), (0.1, 0.14, 1.2), "white", caps="t")
    mesh.box((0, 0, 0.78), (0.11, 0.15, 0.22), "black", caps="")
    mesh.box((0, 0, 0.78), (0.12, 0.06, 0.16), "reflector", caps="")
    return mesh.build()


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
        mesh.picture([(0.06, u, z) for u, z in board], "gantry")
    return mesh.build()


@lru_cache(maxsize=1)
def field_fence() -> Mesh:
    """Return four metres of fence along x."""
    mesh = MeshBuilder()
    mesh.box((0, 0, 0.4), (0.12, 0.12, 1.4), "fence", caps="")
    for z in (0.45, 0.85):
        mesh.box((0, 0, z), (4.0, 0.05, 0.1), "fence", caps="t")
    return mesh.build()


@lru_cache(maxsize=1)
def power_pole() -> Mesh:
    """Return a power pole with its arm along y."""
    mesh = MeshBuilder()
    mesh.beam((0, 0, -0.5), (0, 0, 8.5), 0.26, "bark", end_width=0.18)
    mesh.beam((0, -1.0, 8.0), (0, 1.0, 8.0), 0.12, "bark")
    for y in (-0.9, 0.9):
        mesh.box((0, y, 8.12), (0.08, 0.08, 0.16), "white", caps="")
    return mesh.build()


@lru_cache(maxsize=1)
def hay_bale() -> Mesh:
    """Return a round bale of straw."""
    return MeshBuilder().cylinder((0, -0.6, 0.65), (0, 0.6, 0.65), 0.65, "straw", sides=9).build()


@lru_cache(maxsize=1)
def rail_post() -> Mesh:
    """Return the post of a guard rail whose traffic side is -y."""
    return MeshBuilder().box((0, 0.12, 0.3), (0.1, 0.12, 0.9), "post", caps="").build()
