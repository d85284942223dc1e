"""Measures things made to order with random designs: do valid ones hold, and are faulty ones refused?

Usage: python benchmarks/made.py [--json] [--valid N] [--faulty N] [--seed N]

Every valid design is drawn in all its states: its solid parts must face outwards, and nothing may float. Every
faulty design must be refused with the path of a fault. The time of a frame with 300 random designs is divided by
that of a frame with 300 things of the catalogue at the same places, in turns.
"""

import argparse
import json
import math
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from random import Random
from statistics import median

import numpy as np
from _random_props import Design, Drawing, faulty
from numpy.typing import NDArray
from oodscen_pybullet._catalogue import load_catalogue
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._meshes import asset_ids, asset_mesh, register_design
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.designs.parts import Holder, Placing, add, placed_parts
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._meshes.made import insert_turned
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._rendering.appearance import Look
from oodscen_pybullet._rendering.rasteriser import Rasteriser
from oodscen_pybullet._rendering.view import CameraView
from oodscen_pybullet._scenery.roadside import build_scenery
from oodscen_pybullet._types import Pose

from oodscen.data._designs import shapes
from oodscen.data._designs.prop import Prop, check_prop
from oodscen.data._designs.shapes import Part
from oodscen.data._weather import Weather
from oodscen.driving._roads.building import load_corridor
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.errors import DataError
from oodscen.protocols import Camera

CAMERA = Camera(width=640, height=480)
CROWD = 300
ROUNDS = 7
FLOATS_M = 0.35
"""Gap from the road and from everything that is held beyond which a piece floats, m: designs are checked by boxes
of 0.3 m."""
SAMPLE_M = 0.08
"""Distance between the points at which pieces are compared, m."""
SOLID = (
    shapes.Box,
    shapes.Hull,
    shapes.Beam,
    shapes.Tube,
    shapes.Cylinder,
    shapes.Lathe,
    shapes.Ball,
    shapes.Column,
    shapes.Wheel,
    shapes.Heap,
)
"""Parts whose surface is closed."""

Row = dict[str, object]
Points = NDArray[np.float64]


def sound(rng: Random) -> Iterator[tuple[Design, Prop]]:
    """Yield random valid designs without end, each as it was written and as it was read."""
    drawing, assets, number = Drawing(rng), load_catalogue().assets, 0
    while True:
        number += 1
        table = drawing.design(number)
        try:
            prop = Prop.parse(table)
        except DataError:
            continue
        if not check_prop(prop, assets):
            yield table, prop


def faults_of(prop: Prop) -> Iterator[str]:
    """Yield what is wrong with the meshes of a valid design."""
    for state in prop.states or ("",):
        mesh = asset_mesh(register_design(prop), state)
        if not all(np.isfinite(part).all() for part in (mesh.vertices, mesh.normals, mesh.uvs)):
            yield "not finite"
            return
        leaves = list(_leaves(prop.parts, Placing(), Appearance(state)))
        for part, leaf in leaves:
            is_closed = isinstance(part, SOLID) and getattr(part, "caps", "bt") == "bt"
            if is_closed and _volume(leaf) < -1e-9:
                yield f"inside out: {type(part).__name__}"
        if _floats([Piece.of(leaf) for part, leaf in leaves if len(leaf.triangles)], prop.anchor):
            yield "floats"


def _leaves(
    parts: Sequence[Part], place: Placing, shown: Appearance
) -> Iterator[tuple[Part, Mesh]]:
    """Yield every single part in its place with its mesh; what floats by itself is left out."""
    for part in parts:
        if isinstance(part, Holder):
            for one, there in placed_parts(part, place, lambda word, _: word == shown.state):
                yield from _leaves((one,), there, shown)
        elif isinstance(part, shapes.TurnedOf):
            for leaf, mesh in _leaves(part.turned, Placing(), shown):
                yield leaf, _turned(mesh, part, place)
        elif isinstance(part, shapes.AssetPart):
            yield part, _boxed(_turned(asset_mesh(part.asset, part.state), part, place))
        elif not isinstance(part, shapes.Veil | shapes.Swarm | shapes.LampPart):
            whole = MeshBuilder()
            add(part, whole, shown, place)
            yield part, whole.build()


def _turned(mesh: Mesh, part: shapes.TurnedOf | shapes.AssetPart, place: Placing) -> Mesh:
    whole = MeshBuilder()
    insert_turned(whole, mesh, part, place)
    return whole.build()


def _boxed(mesh: Mesh) -> Mesh:
    """Return the box around a thing of the catalogue, of which a design knows no more."""
    low, high = mesh.bounds
    middle, size = (low + high) / 2, high - low
    box = MeshBuilder()
    box.box(tuple(middle.tolist()), tuple(size.tolist()), "grey")
    return box.build()


def _volume(mesh: Mesh) -> float:
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    return float((a * np.cross(b, c)).sum() / 6.0)


@dataclass(frozen=True, eq=False)
class Piece:
    """One part of a design as points on its surface."""

    corners: Points
    """[n, 3, 3] corners of its triangles."""
    points: Points

    @classmethod
    def of(cls, mesh: Mesh) -> "Piece":
        """Sample the surface of a mesh, cut off at the road."""
        corners = mesh.vertices[mesh.triangles]
        corners[..., 2] = np.maximum(corners[..., 2], 0.0)
        sides = corners[:, [1, 2, 0]] - corners
        longest = float(np.sqrt((sides**2).sum(axis=2)).max())
        count = min(max(1, math.ceil(longest / SAMPLE_M)), 30)
        shares = [(i / count, j / count) for i in range(count + 1) for j in range(count + 1 - i)]
        a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
        found = np.concatenate([a + u * (b - a) + v * (c - a) for u, v in shares])
        cells = np.unique(np.round(found / SAMPLE_M), axis=0)
        return cls(corners, cells * SAMPLE_M)

    def is_near(self, other: "Piece") -> bool:
        """Return whether two pieces touch, nearly touch, or lie in one another."""
        apart = np.maximum(self.points.min(axis=0) - other.points.max(axis=0), other.points.min(axis=0) - self.points.max(axis=0))  # fmt: skip
        if (apart > FLOATS_M).any():
            return False
        for start in range(0, len(self.points), 256):
            away = self.points[start : start + 256, None] - other.points[None]
            if ((away**2).sum(axis=2) <= FLOATS_M**2).any():
                return True
        return self._holds(other.points[0]) or other._holds(self.points[0])

    def _holds(self, point: Points) -> bool:
        """Return whether a point lies inside, by the solid angles of the triangles."""
        a, b, c = (self.corners[:, k] - point for k in range(3))
        x, y, z = (np.sqrt((one**2).sum(axis=1)) for one in (a, b, c))
        above = (a * np.cross(b, c)).sum(axis=1)
        below = x * y * z + (a * b).sum(axis=1) * z + (b * c).sum(axis=1) * x + (c * a).sum(axis=1) * y  # fmt: skip
        return bool(abs(np.arctan2(above, below).sum()) > math.pi)


def _floats(pieces: Sequence[Piece], anchor: str) -> bool:
    """Return whether a piece is held by nothing: neither by the road nor by what is held."""
    if not pieces:
        return False
    held = [anchor == "road" and bool(piece.points[:, 2].min() <= FLOATS_M) for piece in pieces]
    if anchor != "road":
        held[0] = True
    front = [one for one, is_held in zip(pieces, held, strict=True) if is_held]
    while front:
        one = front.pop()
        for index, other in enumerate(pieces):
            if not held[index] and one.is_near(other):
                held[index] = True
                front.append(other)
    return not all(held)


# ---------------------------------------------------------------------- measurements


def valid(count: int, seed: int) -> list[Row]:
    """Draw random valid designs and look for faults in their meshes."""
    rng = Random(seed)
    told: Counter[str] = Counter()
    crashes = 0
    for number, (_, prop) in enumerate(sound(rng)):
        if number == count:
            break
        try:
            told.update(set(faults_of(prop)))
        except Exception as error:  # a crash of any kind is what is looked for
            crashes += 1
            print(f"{prop.to_json()}: {error!r}", file=sys.stderr)
    names = ", ".join(f"{what} ({n})" for what, n in told.items())
    return [
        row(f"crashes with {count} valid designs", crashes, "", 0),
        row(f"parts that are inside out, float or are not finite {names}", told.total(), "", 0),
    ]


def refused(count: int, seed: int) -> list[Row]:
    """Count the faulty designs that are taken, or refused without a path."""
    rng = Random(seed + 1)
    tables = (table for table, _ in sound(Random(seed + 2)))
    pool = [next(tables) for _ in range(60)]
    assets = load_catalogue().assets
    taken = pathless = crashes = 0
    for _ in range(count):
        table = faulty(rng, iter([rng.choice(pool)]))
        try:
            issues = check_prop(Prop.parse(table), assets)
        except DataError as error:
            issues = list(error.issues)
        except Exception as error:  # a crash of any kind is what is looked for
            crashes += 1
            print(f"{table}: {error!r}", file=sys.stderr)
            continue
        if not issues:
            taken += 1
            print(f"taken: {json.dumps(table)}", file=sys.stderr)
        pathless += any(not issue.path for issue in issues)
    return [
        row(f"crashes with {count} faulty designs", crashes, "", 0),
        row("faulty designs that are taken", taken, "", 0),
        row("faults without a path", pathless, "", 0),
    ]


def frames(seed: int) -> list[Row]:
    """Compare a frame with many designs with one with as many things of the catalogue."""
    rng = Random(seed + 3)
    props = [prop for _, (_, prop) in zip(range(CROWD), sound(rng), strict=False)]
    shipped = [asset for asset in asset_ids() if asset != "ego_car"]
    corridor = load_corridor(SHIPPED_MAPS[0])
    scenery = build_scenery(corridor, SHIPPED_MAPS[0], seed)
    poses: list[Pose] = [corridor.point(corridor.start, 0.0)]
    for k in range(CROWD):
        x, y, z, heading = corridor.point(corridor.start + 6.0 + 0.4 * k, rng.uniform(-12, 12))
        poses.append((x, y, z, heading + rng.uniform(-3, 3)))
    crowds = (
        [Look(register_design(prop), prop.states[0] if prop.states else "") for prop in props],
        [Look(rng.choice(shipped)) for _ in range(CROWD)],
    )
    light = Light.of(Weather(), 0.0, reflects_snow=False)
    view = CameraView.of(CAMERA, poses[0])
    stages = []
    for looks in crowds:
        stage = Rasteriser()
        stage.show_scenery(scenery.meshes)
        stage.show_actors([Look("ego_car"), *looks])
        stage.pose_actors(poses)
        stage.render(view, light, ground=poses[0][2])
        stages.append(stage)
    times: list[list[float]] = [[], []]
    for _ in range(ROUNDS):
        for stage, found in zip(stages, times, strict=True):
            start = time.process_time()
            stage.render(view, light, ground=poses[0][2])
            found.append(time.process_time() - start)
    ours, theirs = (median(one) for one in times)
    counts = [sum(len(asset_mesh(look.asset, look.state).triangles) for look in looks) for looks in crowds]  # fmt: skip
    return [
        row(f"triangles of {CROWD} designs : of as many shipped things", counts[0] / counts[1], "x", None),
        row(f"frame with {CROWD} shipped things", 1e3 * theirs, "ms", None),
        row(f"frame with {CROWD} designs : with {CROWD} shipped things", ours / theirs, "x", 2.0),
    ]  # fmt: skip


def row(name: str, value: float, unit: str, most: float | None) -> Row:
    """Return one row of the report; a row without a limit is for information."""
    holds = most is None or value <= most
    return {"name": name, "value": round(value, 3), "unit": unit, "most": most, "holds": holds}


def main() -> int:
    """Run the benchmark; return 0 if every limit holds."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--json", action="store_true", help="print the rows as JSON, last line")
    parser.add_argument("--valid", type=int, default=200, help="random valid designs")
    parser.add_argument("--faulty", type=int, default=2000, help="designs with a fault")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    rows = [
        *valid(options.valid, options.seed),
        *refused(options.faulty, options.seed),
        *frames(options.seed),
    ]
    if options.json:
        print(json.dumps(rows))
    else:
        for one in rows:
            limit = "" if one["most"] is None else f"at most {one['most']}"
            print(f"{one['name']:84} {one['value']:>9}{one['unit']:2} {limit}")
    return 0 if all(one["holds"] for one in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
