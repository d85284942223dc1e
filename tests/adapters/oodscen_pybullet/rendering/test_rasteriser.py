"""The rasteriser against PyBullet's own camera on the same bodies."""

import hashlib
import subprocess
import sys
from collections.abc import Iterator

import numpy as np
import pytest
from oodscen_pybullet._engine import load_pybullet
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._meshes import Mesh, asset_ids, paints_of
from oodscen_pybullet._meshes.atlas import Snow
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._rendering.appearance import Look
from oodscen_pybullet._rendering.bullet_camera import BulletRenderer
from oodscen_pybullet._rendering.rasteriser import Rasteriser
from oodscen_pybullet._rendering.stage import Shot, Stage
from oodscen_pybullet._rendering.triangles import MIRROR, PLAIN, SHINING
from oodscen_pybullet._rendering.view import CameraView
from oodscen_pybullet._types import Pose

from oodscen.protocols import Camera

CAMERA = Camera(width=200, height=150)
WHITE, UP = (1.0, 1.0, 1.0), (0.0, 0.0, 1.0)
IDS = [asset for asset in asset_ids() if asset != "ego_car"]


def shoot(stage: Stage, view: CameraView) -> Shot:
    return stage.render(
        view, Light((-0.6, 0.48, 0.64), 0.6, 0.4, 1.0, 0.3, WHITE, WHITE, UP, has_glare=False)
    )


def scenery(rng: np.random.Generator) -> Mesh:
    mesh = MeshBuilder()
    for x in range(-20, 200, 10):
        corners = [(x, -30, 0), (x + 10, -30, 0), (x + 10, 30, 0), (x, 30, 0)]
        mesh.textured_quad(corners, "asphalt")
    for x, y, a, b, c in rng.uniform((10, -25, 1, 1, 1), (150, 25, 6, 6, 12), (12, 5)):
        y += 8.0 if y > 0 else -8.0
        mesh.box((x, y, c / 2), (a, b, c), "wall_cream")
    return mesh.build()


def cast(rng: np.random.Generator) -> tuple[list[Look], list[Pose]]:
    looks: list[Look] = [Look("ego_car")]
    poses: list[Pose] = [(0.0, 0.0, 0.0, float(rng.uniform(-0.1, 0.1)))]
    for _ in range(7):
        asset = IDS[int(rng.integers(len(IDS)))]
        looks.append(Look(asset, paint=paints_of(asset)[0]))
        x, y, yaw = rng.uniform((6, -6, -3), (45, 6, 3)).tolist()
        poses.append((x, y, 0.0, yaw))
    return looks, poses


@pytest.fixture(scope="module")
def bullet() -> Iterator[BulletRenderer]:
    stage = BulletRenderer(load_pybullet())
    yield stage
    stage.close()


@pytest.mark.parametrize("seed", range(6))
def test_it_sees_what_pybullet_sees(seed: int, bullet: BulletRenderer) -> None:
    rng = np.random.Generator(np.random.PCG64(seed))
    mesh, (looks, poses) = scenery(rng), cast(rng)
    shots = []
    for stage in (bullet, Rasteriser()):
        stage.show_scenery([mesh], snow=Snow.ROADS if seed == 5 else Snow.NONE)
        stage.show_actors(looks)
        stage.pose_actors(poses)
        shots.append(shoot(stage, CameraView.of(CAMERA, poses[0])))
    theirs, ours = shots
    overlaps = []
    for row in np.unique(theirs.rows):
        one, two = ours.rows == row, theirs.rows == row
        if row >= 0 and two.sum() >= 25:
            overlaps.append((one & two).sum() / (one | two).sum())
    assert len(overlaps) >= 2
    assert np.mean(overlaps) >= 0.99
    seen = np.isfinite(theirs.depth) & np.isfinite(ours.depth)
    assert (np.isfinite(theirs.depth) == np.isfinite(ours.depth)).mean() > 0.999
    gap = np.abs(theirs.depth[seen] - ours.depth[seen])
    assert ((gap < 0.02) | (gap < 0.01 * theirs.depth[seen])).mean() >= 0.99
    apart = np.abs(ours.rgb[seen].astype(int) - theirs.rgb[seen])
    assert apart.mean() < 6.0


def test_pictures_are_the_same_twice_after_others_and_in_another_process() -> None:
    code = """
import hashlib
import numpy as np
from oodscen_pybullet._rendering.rasteriser import Rasteriser
from oodscen_pybullet._rendering.appearance import Look
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._rendering.view import CameraView
from oodscen.protocols import Camera

def render(stage):
    white, up = (1.0, 1.0, 1.0), (0.0, 0.0, 1.0)
    mesh = MeshBuilder().textured_quad([(-9, -9, 0), (90, -9, 0), (90, 9, 0), (-9, 9, 0)], "paving")
    stage.show_scenery([mesh.build()])
    stage.show_actors([Look("ego_car"), Look("cow")])
    stage.pose_actors([(0.0, 0.0, 0.0, 0.1), (9.0, 1.0, 0.0, 2.0)])
    shot = stage.render(
        CameraView.of(Camera(120, 90), (0.0, 0.0, 0.0, 0.1)),
        Light((0.0, 0.6, 0.8), 0.5, 0.5, 1.0, 0.3, white, white, up, has_glare=False),
    )
    parts = (shot.rgb, shot.depth, shot.rows, shot.reach, shot.sky)
    return hashlib.sha256(b"".join(part.tobytes() for part in parts)).hexdigest()

"""
    scope: dict[str, object] = {}
    exec(code, scope)
    render = scope["render"]
    assert callable(render)
    stage = Rasteriser()
    first = render(stage)
    rng = np.random.Generator(np.random.PCG64(0))
    looks, poses = cast(rng)
    stage.show_scenery([scenery(rng)], snow=Snow.ROADS)
    stage.show_actors(looks)
    stage.pose_actors(poses)
    shoot(stage, CameraView.of(CAMERA, poses[0]))
    assert render(stage) == first == render(Rasteriser())
    ran = subprocess.run(
        [sys.executable, "-c", f"{code}\nprint(render(Rasteriser()))"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert ran.stdout.strip() == first
    assert len(first) == len(hashlib.sha256().hexdigest())


def box(size: float, colour: str = "red", x: float = 10.0, z: float = 1.4) -> Mesh:
    return MeshBuilder().box((x, 0, z), (size, size, size), colour).build()


def empty_road(*meshes: Mesh) -> Rasteriser:
    stage = Rasteriser()
    stage.show_scenery([*meshes])
    stage.show_actors([box(0.01, x=-50.0)])
    stage.pose_actors([(0.0, 0.0, 0.0, 0.0)])
    return stage


def test_edges_before_the_sky_are_partly_sky_and_keep_their_own_colour_and_depth() -> None:
    view = CameraView.of(Camera(99, 75, x=0.0, pitch_deg=7.0), (0.0, 0.0, 0.0, 0.03))
    shot = shoot(empty_road(box(2.0)), view)
    edge = (shot.sky > 0) & (shot.sky < 255)
    assert edge.sum() > 40
    assert np.isfinite(shot.reach[edge]).all()
    assert abs(shot.reach[edge] - 9.0).max() < 0.4
    assert (shot.rgb[edge][:, 0] > 2 * shot.rgb[edge][:, 1]).all()
    assert np.isinf(shot.depth[shot.sky == 255]).all()
    assert np.array_equal(shot.depth[shot.sky == 0], shot.reach[shot.sky == 0])
    share = 1.0 - shot.sky.astype(float) / 255
    width = 2 * view.focal / 9.0
    assert np.sqrt(share.sum()) == pytest.approx(width, rel=0.02)


def test_a_thin_wire_is_seen_along_its_whole_length() -> None:
    wire = MeshBuilder().beam((30, -30, 6), (30, 30, 6), 0.03, "black").build()
    shot = shoot(empty_road(wire), CameraView.of(Camera(pitch_deg=0.0), (0.0, 0.0, 0.0, 0.1)))
    assert (shot.sky < 250).any(axis=0).mean() > 0.98


def test_what_the_near_plane_cuts_is_drawn_up_to_it() -> None:
    floor = MeshBuilder().polygon([(-9, -9, 0), (99, -9, 0), (99, 9, 0), (-9, 9, 0)], "grey")
    view = CameraView.of(Camera(64, 48, z=0.4, pitch_deg=20.0), (0.0, 0.0, 0.0, 0.0))
    shot = shoot(empty_road(floor.build()), view)
    assert np.isfinite(shot.depth[-1]).all()
    _, upwards = view.slopes()
    expected = 0.4 / -(view.forward[2] + upwards[-1] * view.up[2])
    assert shot.depth[-1] == pytest.approx(np.full(64, expected), rel=1e-4)


def test_backs_are_not_drawn_and_far_things_neither() -> None:
    square = [(10, -2, 0), (10, 2, 0), (10, 2, 3), (10, -2, 3)]
    for points, is_seen in ((square, False), (square[::-1], True)):
        stage = empty_road(MeshBuilder().polygon(points, "red").build())
        shot = shoot(stage, CameraView.of(CAMERA, (0.0, 0.0, 0.0, 0.0)))
        assert np.isfinite(shot.depth).any() == is_seen
    assert np.isinf(
        shoot(empty_road(box(9.0, x=500.0)), CameraView.of(CAMERA, (0, 0, 0, 0))).depth
    ).all()


def test_neighbours_leave_no_gap_wherever_the_camera_is() -> None:
    rng = np.random.Generator(np.random.PCG64(3))
    floor = MeshBuilder()
    for x in range(-60, 120, 3):
        for y in range(-60, 60, 20):
            corners = [(x, y, 0), (x + 3, y, 0), (x + 3, y + 20, 0), (x, y + 20, 0)]
            floor.polygon([(a + 700.123, b - 300.7, c) for a, b, c in corners], "grey")
    stage = empty_road(floor.build())
    for x, y, yaw, pitch in rng.uniform((695, -310, -3, 30), (705, -290, 3, 60), (12, 4)).tolist():
        view = CameraView.of(Camera(320, 240, pitch_deg=pitch), (x, y, 0.0, yaw))
        assert np.isfinite(shoot(stage, view).depth).all()


def test_a_body_that_is_partly_hidden_would_fill_more_than_it_does() -> None:
    stage = Rasteriser()
    stage.show_scenery([box(1.0, x=-90.0)])
    stage.show_actors([box(2.0, x=0.0), box(0.8, x=0.0), box(1.0, x=0.0)])
    view = CameraView.of(CAMERA, (0.0, 0.0, 0.0, 0.0))
    stage.pose_actors([(14.0, 0.0, 0.0, 0.2), (7.0, 0.3, 0.0, 0.0), (-20.0, 0.0, 0.0, 0.0)])
    shown = shoot(stage, view)
    visible = [int((shown.rows == row).sum()) for row in range(3)]
    unhidden = stage.unhidden(view)
    assert unhidden is not None
    assert unhidden.dtype == np.int32
    assert unhidden[1] == visible[1] > 0
    assert unhidden[0] > visible[0] > 0
    assert unhidden[2] == visible[2] == 0
    stage.pose_actors([(14.0, 0.0, 0.0, 0.2), (-7.0, 0.3, 0.0, 0.0), (-20.0, 0.0, 0.0, 0.0)])
    alone = shoot(stage, view)
    assert unhidden[0] == (alone.rows == 0).sum()


def test_what_shines_and_what_mirrors_are_told_apart() -> None:
    stage = empty_road(box(1.0, "head_lit"), box(1.0, "water", x=14.0, z=4.4))
    shot = shoot(stage, CameraView.of(CAMERA, (0.0, 0.0, 0.0, 0.0)))
    assert set(np.unique(shot.kinds)) == {PLAIN, SHINING, MIRROR}
    assert (shot.kinds[np.isinf(shot.depth) & (shot.sky == 255)] == PLAIN).all()
