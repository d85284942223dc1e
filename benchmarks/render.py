"""Measures the speed and accuracy of the rasteriser against PyBullet's own software camera.

Usage: python benchmarks/render.py [--json] [--scenes N]

Every ratio is the other renderer's CPU time over all threads divided by the rasteriser's, on the same bodies from
the same camera, alternating, in one run. moderngl, MuJoCo and Panda3D are measured if they are installed:
`pip install moderngl mujoco panda3d`.
"""

import argparse
import json
import sys
import time
from collections.abc import Callable
from importlib.util import find_spec
from statistics import median

import numpy as np
from _other_renderers import RENDERERS, soup_of
from oodscen_pybullet._engine import load_pybullet
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._meshes import asset_ids, asset_mesh, paints_of
from oodscen_pybullet._rendering.appearance import Look
from oodscen_pybullet._rendering.bullet_camera import BulletRenderer
from oodscen_pybullet._rendering.picture import develop
from oodscen_pybullet._rendering.rasteriser import Rasteriser
from oodscen_pybullet._rendering.stage import RawPicture, Shot, Stage
from oodscen_pybullet._rendering.view import CameraView
from oodscen_pybullet._scenery.roadside import Scenery, build_scenery
from oodscen_pybullet._simulator import DARK
from oodscen_pybullet._types import Pose

from oodscen.data._weather import Weather
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.protocols import Camera

CAMERA = Camera(width=640, height=480)
SMALLEST_TRIANGLES = 9_000
SMALLEST_INSTANCE = 25
ROUNDS = 5
ACTORS = 8
OTHERS_MAPS = (0, 4, 8)
"""Indices of the maps on which other renderers are measured."""

Row = dict[str, object]


class Set:
    """The scenery of one map with random actors."""

    def __init__(self, index: int, seed: int) -> None:
        road = SHIPPED_MAPS[index % len(SHIPPED_MAPS)]
        self.corridor: Corridor = load_corridor(road)
        self.scenery: Scenery = build_scenery(self.corridor, road, seed)
        self.rng = np.random.Generator(np.random.PCG64([seed, index]))
        self.looks: list[Look] = []
        self.poses: list[Pose] = []
        self.shuffle()

    def shuffle(self) -> None:
        """Place new random actors."""
        start = self.corridor.start + float(self.rng.uniform(0, 60))
        self.looks = [Look("ego_car")]
        self.poses = [self.corridor.point(start, 0.0)]
        ids = [asset for asset in asset_ids() if asset != "ego_car"]
        for _ in range(ACTORS):
            asset = ids[int(self.rng.integers(len(ids)))]
            paints = paints_of(asset)
            paint = paints[int(self.rng.integers(len(paints)))]
            ahead, aside, yaw = self.rng.uniform((7, -6, -3), (60, 6, 3)).tolist()
            x, y, z, heading = self.corridor.point(start + ahead, aside)
            self.looks.append(Look(asset, paint=paint))
            self.poses.append((x, y, z, heading + yaw))

    def dress(self, stage: Stage) -> None:
        """Put the scenery and the actors on a stage."""
        stage.show_scenery(self.scenery.meshes)
        self.cast(stage)

    def cast(self, stage: Stage) -> None:
        """Put the actors on a stage."""
        stage.show_actors(self.looks)
        stage.pose_actors(self.poses)

    @property
    def triangles(self) -> int:
        """The total number of triangles."""
        scenery = sum(len(mesh.triangles) for mesh in self.scenery.meshes)
        return scenery + sum(len(asset_mesh(look[0]).triangles) for look in self.looks)

    def shoot(self, stage: Stage, light: Light, *, has_shadows: bool = False) -> Shot:
        """Take the raw picture."""
        return stage.render(
            CameraView.of(CAMERA, self.poses[0]),
            light,
            ground=self.poses[0][2] if has_shadows else None,
        )

    def finish(self, stage: Stage, weather: Weather, light: Light) -> None:
        """Take the fully postprocessed picture."""
        picture = RawPicture(
            shot=self.shoot(stage, light, has_shadows=light.daylight > DARK),
            view=CameraView.of(CAMERA, self.poses[0]),
            weather=weather,
            light=light,
            lamps=self.scenery.lamps,
            time=0.5,
            seed=1,
            road_height=self.poses[0][2],
        )
        develop(picture)


def turn_about(ours: Callable[[], object], theirs: Callable[[], object]) -> float:
    """Return the ratio of CPU times, theirs to ours: the median over rounds."""
    ours(), theirs()
    ratios = []
    for _ in range(ROUNDS):
        marks = [time.process_time()]
        for call in (ours, ours, ours, theirs):
            call()
            marks.append(time.process_time())
        ratios.append((marks[4] - marks[3]) / ((marks[3] - marks[0]) / 3))
    return median(ratios)


def speeds() -> list[Row]:
    """Compare both cameras on every map."""
    engine = load_pybullet()
    plain, whole, ready = [], [], []
    weather = Weather()
    for index in range(len(SHIPPED_MAPS)):
        one = Set(index, 1)
        assert one.triangles >= SMALLEST_TRIANGLES
        light = Light.of(weather, one.corridor.heading(one.corridor.start), reflects_snow=False)
        quick, fine = Rasteriser(detail=1), Rasteriser()
        bare, shaded = BulletRenderer(engine), BulletRenderer(engine, casts_shadows=True)
        for stage in (quick, fine, bare, shaded):
            one.dress(stage)
        shoot = one.shoot
        plain.append(turn_about(lambda: shoot(quick, light), lambda: shoot(bare, light)))  # noqa: B023
        whole.append(turn_about(lambda: shoot(fine, light), lambda: shoot(bare, light)))  # noqa: B023
        ready.append(
            turn_about(lambda: one.finish(fine, weather, light), lambda: shoot(shaded, light))  # noqa: B023
        )
        for stage in (quick, fine, bare, shaded):
            stage.close()
    return [
        *weathers(),
        *others(),
        row(
            "camera, one sample per pixel : TinyRenderer without shadows", median(plain), "x", 15.0
        ),
        row(
            "frame with smooth edges, shadows, sky : TinyRenderer with shadows",
            median(ready),
            "x",
            8.0,
        ),
        row("camera with smooth edges : TinyRenderer without shadows", median(whole), "x", None),
    ]


def weathers() -> list[Row]:
    """Measure a fully postprocessed frame in several kinds of weather, on the first map."""
    one, stage = Set(0, 1), Rasteriser()
    one.dress(stage)
    kinds = {
        "clear": Weather(),
        "fog": Weather(fog_visual_range_m=80.0),
        "rain": Weather(precipitation="rain", precipitation_mm_h=20.0),
        "snow": Weather(precipitation="snow", precipitation_mm_h=5.0),
        "night": Weather(sun_elevation_deg=-20.0),
    }
    rows = []
    for name, weather in kinds.items():
        light = Light.of(weather, one.corridor.heading(one.corridor.start), reflects_snow=False)
        one.finish(stage, weather, light)
        times = []
        for _ in range(ROUNDS):
            start = time.process_time()
            one.finish(stage, weather, light)
            times.append(time.process_time() - start)
        rows.append(row(f"frame with everything on, {name}", 1e3 * median(times), "ms", None))
    return rows


def others() -> list[Row]:
    """Measure other renderers with the same triangles, if they are installed."""
    rows = []
    sets = [Set(index, 1) for index in OTHERS_MAPS]
    for module, (name, kind) in RENDERERS.items():
        if find_spec(module) is None:
            rows.append(row(f"{name} (not run: not installed here)", None, "", None))
            continue
        ratios: dict[int, list[float]] = {1: [], 2: []}
        try:
            for texts in sets:
                soup = soup_of(texts.scenery.meshes, texts.looks, texts.poses)
                drawing = kind(soup, CameraView.of(CAMERA, texts.poses[0]))
                light = Light.of(Weather(), 0.0, reflects_snow=False)
                for detail, found in ratios.items():
                    stage = Rasteriser(detail=detail)
                    texts.dress(stage)
                    found.append(turn_about(lambda: texts.shoot(stage, light), drawing.draw))  # noqa: B023
                drawing.close()
        except Exception as reason:  # libraries raise anything if OpenGL is missing
            rows.append(row(f"{name} (not run: {reason})", None, "", None))
            continue
        how = f"{name} ({drawing.name}), colours alone"
        rows.append(row(f"camera, one sample per pixel : {how}", median(ratios[1]), "x", None))
        rows.append(row(f"camera with smooth edges : {how}", median(ratios[2]), "x", None))
    return rows


def agreement(scenes: int) -> list[Row]:
    """Compare what both cameras see in random scenes."""
    engine = load_pybullet()
    light = Light.of(Weather(), 0.0, reflects_snow=False)
    overlaps: list[float] = []
    depths: list[float] = []
    for index in range(len(SHIPPED_MAPS)):
        one = Set(index, 2)
        ours, theirs = Rasteriser(), BulletRenderer(engine)
        for stage in (ours, theirs):
            one.dress(stage)
        for _ in range(-(-scenes // len(SHIPPED_MAPS))):
            one.shuffle()
            for stage in (ours, theirs):
                one.cast(stage)
            a, b = one.shoot(ours, light), one.shoot(theirs, light)
            for label in np.unique(b.rows[b.rows >= 0]):
                mine, other = a.rows == label, b.rows == label
                if other.sum() >= SMALLEST_INSTANCE:
                    overlaps.append(float((mine & other).sum() / (mine | other).sum()))
            seen = np.isfinite(a.depth) & np.isfinite(b.depth)
            gap = np.abs(a.depth[seen] - b.depth[seen])
            depths.append(float(((gap <= 0.02) | (gap <= 0.01 * b.depth[seen])).mean()))
        theirs.close()
    return [
        row("mean IoU of instances", float(np.mean(overlaps)), "", 0.99),
        row("pixels with depth within 1 % or 2 cm, least of all scenes", min(depths), "", 0.99),
    ]


def row(name: str, value: float | None, unit: str, target: float | None) -> Row:
    """Return one row of the report; a row without a target is for information."""
    return {
        "name": name,
        "value": None if value is None else round(value, 4),
        "unit": unit,
        "target": target,
        "holds": target is None or (value is not None and value >= target),
    }


def main() -> int:
    """Run the benchmark; return 0 if every target holds."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--json", action="store_true", help="print the rows as JSON, last line")
    parser.add_argument("--scenes", type=int, default=50, help="random scenes that are compared")
    options = parser.parse_args()
    rows = speeds() + agreement(options.scenes)
    if options.json:
        print(json.dumps(rows))
    else:
        for one in rows:
            target = "" if one["target"] is None else f"target {one['target']}"
            value = "" if one["value"] is None else one["value"]
            print(f"{one['name']:84} {value:>9}{one['unit']:2} {target}")
    return 0 if all(one["holds"] for one in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
