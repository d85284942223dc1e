"""The asset sheet: a picture and a table of everything in the catalogue.

Usage: python -m oodscen_pybullet.sheet docs
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from oodscen.catalogue import Asset
from oodscen.protocols import Camera
from oodscen_pybullet.canvas import Canvas
from oodscen_pybullet.cast import Look, mesh_of
from oodscen_pybullet.meshes import Mesh, paints_of
from oodscen_pybullet.meshes.builder import MeshBuilder
from oodscen_pybullet.view import View

Image = NDArray[np.uint8]

CELL = (240, 180)
"""Width and height of one picture, pixels."""
CAPTION = 40
"""Height of the words under it."""
COLUMNS = 5
_FACING: dict[str, float] = {"work_zone": 210.0, "signal": 205.0, "object": 205.0}
"""Degrees from an asset's front to the camera; the others are seen from 35."""


def photograph(look: Look, *, turn_deg: float = 35.0, rise_deg: float = 14.0) -> Image:
    """Take an asset's picture on a plain ground: [height, width, 3].

    Args:
        look: The asset and how it is shown.
        turn_deg: Where the camera stands, counter-clockwise from the asset's front.
        rise_deg: How far above the asset's middle, as an angle.
    """
    mesh = mesh_of(look)
    low, high = mesh.bounds
    if mesh.puffs:
        tops = np.array([(*p.position[:2], p.position[2] + 0.7 * p.radius) for p in mesh.puffs])
        low, high = np.minimum(low, tops.min(axis=0)), np.maximum(high, tops.max(axis=0))
    low[2] = 0.0
    middle = (low + high) / 2
    turn, rise = math.radians(turn_deg), math.radians(rise_deg)
    outward = np.array(
        [math.cos(turn) * math.cos(rise), math.sin(turn) * math.cos(rise), math.sin(rise)]
    )
    camera = Camera(width=CELL[0], height=CELL[1], fov_deg=28.0, x=0.0, pitch_deg=rise_deg)
    corners = np.array(
        [[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    )
    far = 1.0
    for _ in range(60):
        eye = middle + outward * far
        view = _view(camera, eye, turn)
        places = [view.pixel((float(x), float(y), float(z))) for x, y, z in corners]
        if all(p and 8 < p[0] < CELL[0] - 8 and 8 < p[1] < CELL[1] - 8 for p in places):
            break
        far *= 1.06
    canvas = Canvas()
    canvas.show_scenery([_ground()], is_snowy=False)
    canvas.show_actors([look])
    canvas.pose_actors([(0.0, 0.0, 0.0, 0.0)])
    sun = (0.75 * math.cos(turn - 0.6), 0.75 * math.sin(turn - 0.6), 0.66)
    shot = canvas.photograph(view, sun=sun, ambient=0.55, diffuse=0.5)
    rgb = shot.rgb.astype(np.float64)
    share = shot.sky[..., None] / 255.0
    rgb = rgb * (1 - share) + np.array((214.0, 222.0, 230.0)) * share
    return _puffed(rgb, shot.depth, view, mesh)


def _view(camera: Camera, eye: NDArray[np.float64], turn: float) -> View:
    lifted = Camera(
        width=camera.width, height=camera.height, fov_deg=camera.fov_deg, x=0.0,
        z=0.0, pitch_deg=camera.pitch_deg,
    )  # fmt: skip
    return View.of(lifted, (float(eye[0]), float(eye[1]), float(eye[2]), turn + math.pi))


def _ground() -> Mesh:
    corners = [(-200, -200, -0.005), (200, -200, -0.005), (200, 200, -0.005), (-200, 200, -0.005)]
    return MeshBuilder().polygon(corners, "asphalt_light").build(hollow=True)


def _puffed(rgb: NDArray[np.float64], depth: NDArray[np.float32], view: View, mesh: Mesh) -> Image:
    """Lay soft balls over a picture, the farthest first."""
    eye, forward = np.array(view.eye), np.array(view.forward)
    rows = sorted(mesh.puffs, key=lambda p: -float((np.array(p.position) - eye) @ forward))
    y, x = np.mgrid[0 : view.height, 0 : view.width] + 0.5
    for puff in rows:
        near = float((np.array(puff.position) - eye) @ forward)
        place = view.pixel(puff.position)
        if place is None:
            continue
        radius = view.focal * puff.radius / near
        share = np.clip(1 - ((x - place[0]) ** 2 + (y - place[1]) ** 2) / radius**2, 0, 1)
        share = puff.density * share * np.clip((depth - near) / puff.radius + 0.5, 0, 1)
        rgb = rgb * (1 - share[..., None]) + 255 * np.array(puff.colour) * share[..., None]
    return np.clip(rgb, 0, 255).astype(np.uint8)


def sheet(assets: Sequence[Asset], *, columns: int = COLUMNS) -> Image:
    """Return the pictures of some assets with names and sizes under them."""
    cells = []
    for asset in assets:
        look = Look(asset.id, asset.states[0] if asset.states else "", paints_of(asset.id)[0])
        picture = photograph(look, turn_deg=_FACING.get(asset.category, 35.0))
        size = f"{asset.length:.1f} x {asset.width:.1f} x {asset.height:.1f} m"
        cells.append(captioned(picture, asset.id, size))
    return tiled(cells, columns)


def captioned(picture: Image, *lines: str) -> Image:
    """Return a picture with words under it."""
    import cv2

    foot = np.full((CAPTION, picture.shape[1], 3), 255, np.uint8)
    for index, words in enumerate(lines):
        ink = (20, 20, 24) if index == 0 else (96, 98, 104)
        scale = 0.46 if index == 0 else 0.4
        place = (6, 16 + 17 * index)
        cv2.putText(foot, words, place, cv2.FONT_HERSHEY_SIMPLEX, scale, ink, 1, cv2.LINE_AA)
    return np.concatenate([picture, foot])


def tiled(cells: Sequence[Image], columns: int) -> Image:
    """Put pictures of one size side by side, row by row."""
    blank = np.full_like(cells[0], 255)
    rows = []
    for start in range(0, len(cells), columns):
        row = list(cells[start : start + columns])
        row += [blank] * (columns - len(row))
        rows.append(np.concatenate(row, axis=1))
    return np.concatenate(rows)
