"""What stands beside the road: houses, trees, lamps, rails, fields."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from oodscen.driving import Corridor
from oodscen.seeding import stream
from oodscen_pybullet.buildings import city_block, house
from oodscen_pybullet.meshes import asset_mesh, paints_of, plants
from oodscen_pybullet.meshes.builder import Mesh, MeshBuilder, Point
from oodscen_pybullet.road import Array, Course, Ribbons, extents, lay_road

SHORT_M = 130.0
"""Scenery ends so far before the road does: it is small by then."""


@dataclass(frozen=True, eq=False)
class Scenery:
    """Everything that stands still."""

    meshes: tuple[Mesh, ...]
    lamps: tuple[Point, ...]
    """Heads of the street lamps, m."""


@dataclass
class _Site:
    """Where roadside things are put while they are collected."""

    corridor: Corridor
    course: Course
    right: Array
    left: Array
    rng: np.random.Generator
    mesh: MeshBuilder
    lamps: list[Point]

    @property
    def end(self) -> float:
        """Where along the road scenery ends, m."""
        return float(self.course.s[-1]) - SHORT_M

    def put(
        self, mesh: Mesh, s: float, side: int, out: float, *, yaw: float = 0.0, lift: float = 0.0
    ) -> Point:
        """Place a mesh `out` metres beyond the road's edge, its x axis along the road.

        Args:
            mesh: What.
            s: Where along the road.
            side: +1 left, -1 right; things on the right are turned by half a circle.
            out: From the edge of the cross-section, m.
            yaw: Further turn, rad.
            lift: Above the road, m.
        """
        edge = np.interp(s, self.course.s, self.left if side > 0 else self.right)
        x, y, z, heading = self.corridor.point(s, float(edge) + side * out)
        turn = heading + yaw + (0.0 if side > 0 else np.pi)
        self.mesh.add(mesh, (x, y, z + lift), yaw=turn)
        return (x, y, z + lift)

    def spots(self, spacing: float, *, jitter: float = 0.0, first: float = 0.0) -> list[float]:
        """Return places along the road at about equal distances."""
        start, end = float(self.course.s[0]) + first, self.end
        count = int((end - start) / spacing)
        shifts = self.rng.uniform(-jitter, jitter, count) if jitter else np.zeros(count)
        return [start + spacing * (i + 0.5) + float(shifts[i]) for i in range(count)]


def build_scenery(corridor: Corridor, traits: frozenset[str], seed: int, name: str) -> Scenery:
    """Build the road and what is beside it.

    Args:
        corridor: The road.
        traits: Of the map; they choose between city, suburb, highway and country.
        seed: The run's.
        name: Of the map.
    """
    course = Course.of(corridor)
    ribbons = Ribbons(course)
    lay_road(corridor, ribbons, traits)
    right, left = extents(corridor, course)
    rng = stream(seed, "scenery", name)
    site = _Site(corridor, course, right, left, rng, MeshBuilder(), [])
    if "residential" in traits:
        _residential(site, ribbons)
    elif "urban" in traits:
        _urban(site, ribbons)
    elif "highway" in traits:
        _highway(site, ribbons)
    else:
        _rural(site, ribbons)
    return Scenery((ribbons.mesh(), site.mesh.build(hollow=True)), tuple(site.lamps))


def _ground(
    ribbons: Ribbons,
    right: Array,
    left: Array,
    bands: list[tuple[float, float, str, bool]],
    height: float,
) -> None:
    """Add bands of ground on both sides, each by its distances from the edge of the road."""
    for near, far, surface, is_region in bands:
        heights = (height, height)
        ribbons.band(left + near, left + far, surface, heights=heights, is_region=is_region)
        ribbons.band(right - far, right - near, surface, heights=heights, is_region=is_region)


@lru_cache(maxsize=64)
def _tree(kind: str, key: int) -> Mesh:
    maker = {"broad": plants.broad_tree, "conifer": plants.conifer, "bush": plants.bush}[kind]
    return maker(key).build(hollow=True)


@lru_cache(maxsize=4)
def _street_lamp(reach: float, height: float) -> Mesh:
    """Return a street lamp whose arm reaches towards -y."""
    mesh = MeshBuilder()
    mesh.cylinder((0, 0, 0), (0, 0, height), 0.09, "post", sides=6, end_radius=0.06)
    mesh.beam((0, 0, height - 0.05), (0, -reach, height + 0.1), 0.08, "post")
    mesh.box((0, -reach, height + 0.06), (0.3, 0.7, 0.12), "dark_grey")
    mesh.box((0, -reach, height - 0.01), (0.22, 0.55, 0.04), "lamp_glass")
    return mesh.build(hollow=True)


def _lamps(
    site: _Site, spacing: float, out: float, *, height: float, sides: tuple[int, ...]
) -> None:
    reach = 1.6
    for index, s in enumerate(site.spots(spacing)):
        side = sides[index % len(sides)]
        site.put(_street_lamp(reach, height), s, side, out, lift=0.1)
        edge = np.interp(s, site.course.s, site.left if side > 0 else site.right)
        x, y, z, _ = site.corridor.point(s, float(edge) + side * (out - reach))
        site.lamps.append((x, y, z + height + 0.1))


@lru_cache(maxsize=8)
def _speed_sign() -> Mesh:
    """Return a speed limit sign that faces -x."""
    mesh = MeshBuilder()
    mesh.cylinder((0, 0, 0), (0, 0, 2.2), 0.035, "post", sides=6)
    mesh.box((0.03, 0, 2.4), (0.02, 0.62, 0.62), "grey")
    mesh.picture([(0.0, 0.3, 2.1), (0.0, -0.3, 2.1), (0.0, -0.3, 2.7), (0.0, 0.3, 2.7)], "limit")
    return mesh.build(hollow=True)


def _residential(site: _Site, ribbons: Ribbons) -> None:
    _ground(
        ribbons,
        site.right,
        site.left,
        [(0.0, 7.0, "turf", True), (7.0, 120.0, "grass_dark", False)],
        0.1,
    )
    for side in (1, -1):
        for index, s in enumerate(site.spots(15.5, jitter=0.8)):
            kind = int(site.rng.integers(0, 3))
            setback = 5.2 + float(site.rng.uniform(0, 1.2))
            site.put(house(kind, int(site.rng.integers(0, 3))), s, side, setback + 4.0, lift=0.1)
            _garden(site, s, side, index)
    _lamps(site, 26.0, -0.5, height=5.6, sides=(1, -1))
    for s in site.spots(180.0, first=70.0):
        site.put(_speed_sign(), s, -1, -0.4, yaw=np.pi, lift=0.1)


def _garden(site: _Site, s: float, side: int, index: int) -> None:
    """Add a hedge or fence, a drive with or without a car, and trees before one house."""
    rng = site.rng
    style = int(rng.integers(0, 3))
    site.put(_front(style), s - 1.8, side, 0.35, lift=0.1)
    site.put(_drive(), s + 6.0, side, 2.6, lift=0.1)
    if rng.uniform() < 0.3:
        paint = paints_of("car")[int(rng.integers(0, 7))]
        out_wards = np.pi / 2 if rng.uniform() < 0.5 else -np.pi / 2
        site.put(
            asset_mesh("car", "off", paint), s + 6.0, side, 3.4, yaw=float(out_wards), lift=0.13
        )
    if rng.uniform() < 0.7:
        key = int(rng.integers(0, 6))
        site.put(
            _tree("broad" if key < 4 else "conifer", key),
            s - 4.5 * float(rng.uniform(0.6, 1)),
            side,
            2.8,
            yaw=float(rng.uniform(0, 6)),
            lift=0.1,
        )
    for _ in range(2):
        site.put(
            _tree("bush", int(rng.integers(0, 4))),
            s + float(rng.uniform(-4, 4)),
            side,
            3.8 + float(rng.uniform(0, 0.8)),
            lift=0.0,
        )
    if index % 2:
        site.put(_tree("broad", int(rng.integers(0, 4))), s + 7.5, side, 16.0, lift=0.1)


@lru_cache(maxsize=4)
def _front(style: int) -> Mesh:
    """Return a garden's front, ten metres along x."""
    mesh = MeshBuilder()
    if style == 0:
        mesh.box((0, 0, 0.5), (10.0, 0.6, 1.0), "hedge")
    elif style == 1:
        for index in range(13):
            mesh.box((-5.0 + 0.83 * index, 0, 0.45), (0.6, 0.05, 0.9), "fence", caps="t")
        mesh.box((0, 0.05, 0.7), (10.0, 0.05, 0.08), "fence")
    else:
        mesh.box((0, 0, 0.3), (10.0, 0.25, 0.6), "wall_brick")
        mesh.box((0, 0, 0.63), (10.0, 0.32, 0.06), "concrete")
    return mesh.build(hollow=True)


@lru_cache(maxsize=1)
def _drive() -> Mesh:
    return (
        MeshBuilder()
        .polygon(
            [(-1.5, -2.6, 0.03), (1.5, -2.6, 0.03), (1.5, 4.0, 0.03), (-1.5, 4.0, 0.03)], "concrete"
        )
        .build(hollow=True)
    )


def _urban(site: _Site, ribbons: Ribbons) -> None:
    _ground(
        ribbons,
        site.right,
        site.left,
        [(0.0, 3.0, "paving", True), (3.0, 120.0, "concrete_dark", False)],
        0.1,
    )
    for side in (1, -1):
        s = float(site.course.s[0])
        while s < site.end:
            width = 6.0 * int(site.rng.integers(2, 5))
            floors = int(site.rng.integers(3, 8))
            block = city_block(
                int(width), floors, int(site.rng.integers(0, 6)), bool(site.rng.uniform() < 0.6)
            )
            site.put(block, s + width / 2, side, 2.2 + 6.0, lift=0.1)
            s += width + (7.0 if site.rng.uniform() < 0.12 else 0.06)
    for index, s in enumerate(site.spots(17.0, jitter=1.0)):
        for side in (1, -1):
            key = (index * 5 + side + 1) % 4
            if site.rng.uniform() < 0.75:
                site.put(
                    _tree("broad", key), s, side, -0.6, yaw=float(site.rng.uniform(0, 6)), lift=0.0
                )
    _lamps(site, 28.0, -1.9, height=7.5, sides=(1, -1))
    for s in site.spots(200.0, first=60.0):
        site.put(_speed_sign(), s, -1, -2.2, yaw=np.pi, lift=0.1)


@lru_cache(maxsize=1)
def _rail_post() -> Mesh:
    mesh = MeshBuilder()
    mesh.box((0, 0.12, 0.35), (0.1, 0.12, 0.7), "post", caps="")
    return mesh.build(hollow=True)


def _guard_rails(site: _Site, ribbons: Ribbons, inwards: float) -> None:
    """Add a rail with posts on both sides, so far inside the edge of the cross-section."""
    for t, side in ((site.left - inwards, 1), (site.right + inwards, -1)):
        for low, high, colour in ((0.44, 0.56, "rail"), (0.56, 0.60, "post"), (0.60, 0.72, "rail")):
            if side > 0:
                ribbons.band(t, t + 1e-4, colour, heights=(low, high))
            else:
                ribbons.band(t - 1e-4, t, colour, heights=(high, low))
        ribbons.band(t - 0.05, t + 0.05, "rail", heights=(0.72, 0.72))
    for s in site.spots(4.0):
        for side in (1, -1):
            site.put(_rail_post(), s, side, -inwards)


@lru_cache(maxsize=2)
def _post() -> Mesh:
    """Return a delineator post."""
    mesh = MeshBuilder()
    mesh.box((0, 0, 0.5), (0.1, 0.14, 1.0), "white")
    mesh.box((0, 0, 0.78), (0.11, 0.15, 0.22), "black")
    mesh.box((0, 0, 0.78), (0.12, 0.06, 0.16), "reflector")
    return mesh.build(hollow=True)


@lru_cache(maxsize=2)
def _gantry(span: float) -> Mesh:
    """Return a sign gantry across one carriageway of `span` metres, from y = 0 towards -y."""
    mesh = MeshBuilder()
    for y in (0.0, -span):
        mesh.beam((0, y, 0), (0, y, 7.4), 0.3, "post")
    for z in (6.6, 7.4):
        mesh.beam((0, 0, z), (0, -span, z), 0.2, "post")
    for y in (-span * 0.32, -span * 0.72):
        mesh.box((0.0, y, 7.0), (0.1, 4.4, 1.9), "grey")
        mesh.picture(
            [
                (0.06, y - 2.1, 6.15),
                (0.06, y + 2.1, 6.15),
                (0.06, y + 2.1, 7.85),
                (0.06, y - 2.1, 7.85),
            ],
            "gantry",
        )
    return mesh.build(hollow=True)


def _highway(site: _Site, ribbons: Ribbons) -> None:
    _ground(
        ribbons,
        site.right,
        site.left,
        [(0.0, 14.0, "turf", True), (14.0, 70.0, "grass", False), (70.0, 190.0, "field", False)],
        0.0,
    )
    for strip in site.corridor.strips:
        if strip.kind == "median":
            middle = np.interp(site.course.s, site.corridor.s, strip.left)
            if strip.direction >= 0:
                _concrete_barrier(ribbons, middle)
            break
    _guard_rails(site, ribbons, 2.5)
    for s in site.spots(50.0):
        for side in (1, -1):
            site.put(_post(), s, side, -1.2)
    edges = float(site.right[0])
    for s in site.spots(420.0, first=20.0):
        site.put(_gantry(abs(edges) - 1.0), s, -1, -1.0)
    _woods(site, 17.0, (6.0, 40.0))


def _concrete_barrier(ribbons: Ribbons, t: Array) -> None:
    for side in (-1, 1):
        steps = ((0.32, 0.0, 0.14, 0.3), (0.14, 0.3, 0.1, 0.85))
        for out0, z0, out1, z1 in steps:
            if side < 0:
                ribbons.band(t - out0, t - out1, "concrete", heights=(z0, z1))
            else:
                ribbons.band(t + out1, t + out0, "concrete", heights=(z1, z0))
    ribbons.band(t - 0.1, t + 0.1, "light_grey", heights=(0.85, 0.85))


def _woods(site: _Site, spacing: float, reach: tuple[float, float]) -> None:
    """Add scattered trees and bushes on both sides."""
    near, far = reach
    for side in (1, -1):
        for s in site.spots(spacing, jitter=spacing * 0.4):
            out = near + (far - near) * float(site.rng.uniform()) ** 2
            key = int(site.rng.integers(0, 6))
            kind = "conifer" if key >= 4 else "broad"
            site.put(_tree(kind, key), s, side, out, yaw=float(site.rng.uniform(0, 6)))
            if site.rng.uniform() < 0.4:
                site.put(_tree("bush", key), s + 3.0, side, max(near, out - 3.0))
    _forest_edge(site, 110.0)


def _forest_edge(site: _Site, out: float) -> None:
    """Add the dark line of a wood at the horizon."""
    for side in (1, -1):
        for s in site.spots(26.0):
            height = 9.0 + 6.0 * float(site.rng.uniform())
            mesh = MeshBuilder().hull(
                (-14, 14, -4, 4, 0),
                (-9, 9, -2, 2, height),
                "needle" if site.rng.uniform() < 0.5 else "leaf_dark",
            )
            site.put(mesh.build(hollow=True), s, side, out + 12.0 * float(site.rng.uniform()))


def _rural(site: _Site, ribbons: Ribbons) -> None:
    bands = [
        (0.0, 8.0, "turf", True),
        (8.0, 45.0, "field", False),
        (45.0, 190.0, "grass_dark", False),
    ]
    _ground(ribbons, site.right, site.left, bands, 0.0)
    for s in site.spots(25.0):
        for side in (1, -1):
            site.put(_post(), s, side, -2.2)
    for s in site.spots(4.0):
        site.put(_fence(), s, 1, 4.0)
    for s in site.spots(40.0):
        site.put(_power_pole(), s, -1, 7.0)
    for s in site.spots(330.0, first=60.0):
        site.put(house(0, 0), s, 1, 24.0)
        site.put(_barn(), s + 18.0, 1, 28.0)
    _woods(site, 15.0, (1.0, 32.0))


@lru_cache(maxsize=1)
def _fence() -> Mesh:
    mesh = MeshBuilder()
    mesh.box((0, 0, 0.55), (0.12, 0.12, 1.1), "fence")
    for z in (0.45, 0.85):
        mesh.box((0, 0, z), (4.0, 0.05, 0.1), "fence")
    return mesh.build(hollow=True)


@lru_cache(maxsize=1)
def _power_pole() -> Mesh:
    mesh = MeshBuilder()
    mesh.cylinder((0, 0, 0), (0, 0, 8.5), 0.14, "bark", sides=6, end_radius=0.1)
    mesh.beam((0, -1.0, 8.0), (0, 1.0, 8.0), 0.12, "bark")
    for y in (-0.9, 0.9):
        mesh.beam((-20.0, y, 8.15), (20.0, y, 8.15), 0.03, "dark_grey")
    return mesh.build(hollow=True)


@lru_cache(maxsize=1)
def _barn() -> Mesh:
    mesh = MeshBuilder()
    mesh.hull((-9, 9, -5, 5, 0), (-9, 9, -5, 5, 4.2), "burgundy")
    mesh.polygon([(-9.4, -5.4, 4.0), (9.4, -5.4, 4.0), (9.4, 0, 7.4), (-9.4, 0, 7.4)], "roof_grey")
    mesh.polygon([(9.4, 5.4, 4.0), (-9.4, 5.4, 4.0), (-9.4, 0, 7.4), (9.4, 0, 7.4)], "roof_grey")
    for x, sign in ((-9.0, -1), (9.0, 1)):
        gable = [(x, -5, 4.2), (x, 5, 4.2), (x, 0, 7.3)]
        mesh.polygon(gable if sign > 0 else gable[::-1], "burgundy")
    return mesh.build(hollow=True)
