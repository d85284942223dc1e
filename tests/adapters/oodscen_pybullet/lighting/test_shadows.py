import math

import numpy as np
import pytest
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._lighting.shadows import (
    CELLS,
    FAR_CELLS,
    FAR_SIDE_M,
    SIDE_M,
    Shade,
    ShadowMap,
)
from oodscen_pybullet._meshes import Mesh
from oodscen_pybullet._meshes.atlas import draw_atlas
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._rendering.rasteriser import Rasteriser
from oodscen_pybullet._rendering.triangles import Triangles
from oodscen_pybullet._rendering.view import CameraView

from oodscen.protocols import Camera

VIEW = CameraView.of(Camera(width=160, height=120), (0.0, 0.0, 0.0, 0.0))
SUN = (-0.6, 0.0, 0.8)
"""Behind the camera: shadows fall forward, 0.75 m for each metre of height."""


def triangles(mesh: Mesh) -> Triangles:
    return Triangles.of(mesh, draw_atlas(), is_chunked=False)


def tower(x: float, y: float, height: float, width: float = 1.0) -> Mesh:
    return MeshBuilder().box((x, y, height / 2), (width, width, height), "grey").build()


def ground() -> Mesh:
    corners = [(-50, -50, 0), (90, -50, 0), (90, 50, 0), (-50, 50, 0)]
    return MeshBuilder().polygon(corners, "grey").build()


def height(shade: Shade, x: float, y: float) -> float:
    scale = CELLS / SIDE_M
    row, column = (y - shade.corner[1]) * scale, (x - shade.corner[0]) * scale
    return float(shade.heights[round(row), round(column)])


def test_shadows_are_as_long_as_the_sun_is_low_and_the_ground_throws_none() -> None:
    nobody = triangles(tower(-500.0, 0.0, 1.0))
    shade = ShadowMap().draw(VIEW, SUN, 0.0, triangles(ground()), nobody)
    assert (shade.heights < -1e5).all()
    shade = ShadowMap().draw(VIEW, SUN, 0.0, triangles(tower(20.0, 0.0, 4.0)), nobody)
    for x, is_dark in ((19.2, False), (20.8, True), (22.0, True), (23.2, True), (23.9, False)):
        assert (height(shade, x, 0.0) > 0.03) == is_dark
    assert height(shade, 22.0, 0.8) < -1e5
    assert height(shade, 22.0, 0.0) == pytest.approx((22.0 - 20.5) / 0.75, abs=0.2)


def test_tiles_are_never_lower_than_what_they_hold() -> None:
    rng = np.random.Generator(np.random.PCG64(2))
    mesh = MeshBuilder()
    for x, y, a, b in rng.uniform((0, -30, 0.1, 0.2), (70, 30, 3, 9), (40, 4)).tolist():
        mesh.box((x, y, b / 2), (a, a, b), "grey")
    some = triangles(mesh.build())
    shade = ShadowMap().draw(VIEW, (-0.5, 0.5, 0.7), 0.0, some, some)
    side = len(shade.tiles)
    tops = shade.heights.reshape(side, CELLS // side, side, CELLS // side).max(axis=(1, 3))
    assert (shade.tiles >= tops - 1e-5).all()


def test_actors_shadows_move_with_them_and_leave_nothing_behind() -> None:
    shadows, scenery = ShadowMap(), triangles(tower(40.0, 9.0, 6.0))
    actor = triangles(tower(0.0, 0.0, 2.0))
    for x, y in ((12.0, -2.0), (30.0, 4.0), (41.0, 9.5), (-200.0, 0.0)):
        actor.places[0, :2] = (x, y)
        shade = shadows.draw(VIEW, SUN, 0.0, scenery, actor)
        fresh = ShadowMap().draw(VIEW, SUN, 0.0, scenery, actor)
        assert np.array_equal(shade.heights, fresh.heights)
        assert np.array_equal(shade.tiles, fresh.tiles)


def test_shadows_go_on_beyond_the_fine_map() -> None:
    nobody = triangles(tower(-500.0, 0.0, 1.0))
    block = triangles(tower(170.0, 10.0, 12.0, 16.0))
    shade = ShadowMap().draw(VIEW, SUN, 0.0, block, nobody)
    assert (shade.heights < -1e5).all()
    scale = FAR_CELLS / FAR_SIDE_M
    for x, is_dark in ((155.0, False), (180.0, True), (184.0, True), (196.0, False)):
        row, column = (10.0 - shade.far_corner[1]) * scale, (x - shade.far_corner[0]) * scale
        assert (float(shade.far[round(row), round(column)]) > 0.0) == is_dark


def test_tunnels_throw_no_shadow_on_whoever_is_in_them() -> None:
    nobody, roof = triangles(tower(-500.0, 0.0, 1.0)), triangles(tower(20.0, 0.0, 4.0))
    shadows = ShadowMap()
    assert height(shadows.draw(VIEW, SUN, 0.0, roof, nobody), 22.0, 0.0) > 0.0
    roof.shelter(np.ones(len(roof.corners), bool))
    inside = shadows.draw(VIEW, SUN, 0.0, roof, nobody, is_inside=True)
    assert (inside.heights < -1e5).all()
    assert (inside.far < -1e5).all()


def test_a_thin_pole_throws_an_unbroken_shadow() -> None:
    pole = MeshBuilder().cylinder((20, 0, 0), (20, 0, 8), 0.03, "post", sides=6).build()
    shade = ShadowMap().draw(
        VIEW, (-0.5, 0.33, 0.8), 0.0, triangles(pole), triangles(tower(-500.0, 0.0, 1.0))
    )
    for part in np.linspace(0.05, 0.9, 60).tolist():
        x, y = 20 + 8 * part * 0.5 / 0.8, -8 * part * 0.33 / 0.8
        scale = CELLS / SIDE_M
        row, column = int((y - shade.corner[1]) * scale), int((x - shade.corner[0]) * scale)
        assert shade.heights[row - 1 : row + 3, column - 1 : column + 3].max() > 0.1


def test_lit_faces_cast_no_shadow_on_themselves() -> None:
    stage = Rasteriser()
    stage.show_scenery([ground()])
    stage.show_actors([tower(14.0, 0.0, 3.0, 3.0)])
    stage.pose_actors([(0.0, 0.0, 0.0, 0.0)])
    light = Light(SUN, 0.5, 0.5, 1.0, 0.3, (1.0, 1.0, 1.0), (1.0, 1.0, 1.0), SUN, has_glare=False)
    shot = stage.render(VIEW, light, ground=0.0)
    assert shot.shade is not None
    shade = shot.shade
    across, upwards = VIEW.slopes()
    rows, columns = np.nonzero((shot.rows == 0) & (shot.lit > 0))
    assert len(rows) > 200
    scale = CELLS / SIDE_M
    dark = 0
    for row, column in zip(rows.tolist(), columns.tolist(), strict=True):
        far = float(shot.depth[row, column])
        x, y, z = (
            VIEW.eye[i]
            + far * (VIEW.forward[i] + across[column] * VIEW.right[i] + upwards[row] * VIEW.up[i])
            for i in range(3)
        )
        i = math.floor((x - shade.lean[0] * z - shade.corner[0]) * scale)
        j = math.floor((y - shade.lean[1] * z - shade.corner[1]) * scale)
        dark += shade.heights[j : j + 2, i : i + 2].max() > z + 0.05
    assert dark < 0.01 * len(rows)
