"""Pictures of boxes on a plane, for simulators that draw nothing themselves.

They are ray-cast, so depth and instance ids are exact; the pictures are simple but recognisable.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from oodscen.data._catalogue import Asset
from oodscen.data._category import Category
from oodscen.data._scene import CLEAR_AIR_M, Weather
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._sight.visibility import Eye, Solid
from oodscen.protocols import Camera, Frame

Floats = NDArray[np.float64]

_COLOURS = {
    "vehicle": (0.20, 0.35, 0.70),
    "cyclist": (0.15, 0.60, 0.60),
    "pedestrian": (0.80, 0.35, 0.25),
    "animal": (0.50, 0.33, 0.18),
    "object": (0.72, 0.55, 0.33),
    "work_zone": (0.95, 0.50, 0.10),
    "vegetation": (0.20, 0.42, 0.16),
    "signal": (0.30, 0.30, 0.30),
}
_GROUND = {
    "grass": (0.33, 0.44, 0.24),
    "mark": (0.88, 0.88, 0.86),
    "curb": (0.52, 0.51, 0.50),
    "driving": (0.30, 0.30, 0.32),
    "shoulder": (0.38, 0.37, 0.36),
    "parking": (0.34, 0.33, 0.34),
    "sidewalk": (0.60, 0.59, 0.57),
    "median": (0.45, 0.45, 0.43),
    "border": (0.36, 0.46, 0.26),
    "rail": (0.42, 0.38, 0.34),
    "none": (0.36, 0.46, 0.26),
}
_PALETTE = np.array(list(_GROUND.values()))
_CLASSES = {
    "driving": 1, "shoulder": 1, "parking": 1, "sidewalk": 2, "curb": 2, "mark": 24, "rail": 27,
}  # fmt: skip
_TERRAIN, _SKY_CLASS = 10, 11
_TAGS = np.array([_CLASSES.get(name, _TERRAIN) for name in _GROUND], np.uint8)
"""Semantic class of each ground colour: `Frame.tags`."""
_CODES = {name: code for code, name in enumerate(_GROUND)}
"""Row of each ground colour in the palette."""
_SHADES = (0.72, 0.86, 1.0)
"""Brightness of box faces across x, y and z."""
_ROAD_VIEW_M = 400.0
"""Distance up to which lanes are painted, m."""


def flat_frame(
    camera: Camera,
    road: Corridor,
    weather: Weather,
    assets: Sequence[Asset],
    poses: Sequence[Sequence[float]] | Floats,
    mount: Sequence[float] | None = None,
) -> Frame:
    """Draw a scene as shaded boxes on a plane.

    Args:
        camera: The camera, relative to the ego.
        road: The scene's road.
        weather: The scene's weather.
        assets: The assets of all bodies, the ego's first.
        poses: x, y, z and yaw of all bodies, in the same order; the ego's box is not drawn.
        mount: x, y, z and yaw of what the camera is mounted on; by default the ego's.
    """
    rows = [list(map(float, pose)) for pose in poses]
    bodies = [_solid(pose, asset) for asset, pose in zip(assets, rows, strict=True)]
    eye = Eye(camera, bodies[0] if mount is None else _solid(mount, assets[0]))
    depth = np.full((camera.height, camera.width), np.inf)
    ids = np.zeros((camera.height, camera.width), dtype=np.int32)
    colour = np.empty((camera.height, camera.width, 3))
    colour[:] = _sky(weather)
    tags = np.full((camera.height, camera.width), _SKY_CLASS, np.uint8)
    _paint_ground(eye, bodies[0].z, road, colour, depth, tags)
    if weather.precipitation == "snow":
        colour[np.isfinite(depth)] *= 0.45
        colour[np.isfinite(depth)] += 0.5
    for row in range(1, len(assets)):
        _paint_box(eye, bodies[row], assets[row].category, row + 1, colour, depth, ids)
    rgb = _lit(colour, depth, camera, weather)
    tags[ids > 0] = 0
    return Frame(rgb=rgb, depth=depth.astype(np.float32), ids=ids, tags=tags)


def _solid(pose: Sequence[float] | Floats, asset: Asset) -> Solid:
    x, y, z, yaw = map(float, pose)
    return Solid(x, y, z, yaw, asset.length, asset.width, asset.height)


def tangents(camera: Camera) -> tuple[Floats, Floats]:
    """Return the tangents of the angles to the optical axis: of columns to the right, and of rows down."""
    focal = 0.5 * camera.width / math.tan(0.5 * math.radians(camera.fov_deg))
    u = (np.arange(camera.width, dtype=np.float64) + 0.5 - 0.5 * camera.width) / focal
    v = (np.arange(camera.height, dtype=np.float64) + 0.5 - 0.5 * camera.height) / focal
    return u, v


def _rays(eye: Eye, rows: slice, columns: slice) -> tuple[Floats, Floats, Floats]:
    """Return x, y and z of the rays through pixels, with unit length along the optical axis."""
    us, vs = tangents(eye.camera)
    u, v = us[columns][None, :], vs[rows][:, None]
    x, y, z = (eye.forward[axis] + u * eye.right[axis] + v * eye.down[axis] for axis in range(3))
    return x, y, z


def _window(eye: Eye, body: Solid) -> tuple[slice, slice] | None:
    """Return the rows and columns that contain a body, or `None` if no pixel does."""
    outline = eye.silhouette(body)
    if not outline:
        return None
    us, vs = zip(*outline, strict=True)
    camera = eye.camera
    left, right = max(0, math.floor(min(us))), min(camera.width, math.ceil(max(us)) + 1)
    top, bottom = max(0, math.floor(min(vs))), min(camera.height, math.ceil(max(vs)) + 1)
    return (slice(top, bottom), slice(left, right)) if left < right and top < bottom else None


def _paint_ground(
    eye: Eye,
    height: float,
    road: Corridor,
    colour: Floats,
    depth: Floats,
    tags: NDArray[np.uint8],
) -> None:
    """Paint the ground plane at a height: grass, road strips and lane marks."""
    _, v = tangents(eye.camera)
    below = eye.forward[2] + v * eye.down[2] < -1e-6
    if not below.any():
        return
    rows = slice(int(below.argmax()), None)
    x, y, z = _rays(eye, rows, slice(None))
    distance = (height - eye.place[2]) / z * np.ones_like(x)
    depth[rows] = distance
    codes = np.full(distance.shape, _CODES["grass"], np.uint8)
    near = distance <= _ROAD_VIEW_M
    away = distance[near]
    ground_x, ground_y = eye.place[0] + x[near] * away, eye.place[1] + y[near] * away
    ego_s, _ = road.locate(eye.ego.x, eye.ego.y)
    s, t, index = _locate(road, ground_x, ground_y, ego_s)
    codes[near] = _surface(road, s, t, index, away)
    np.take(_PALETTE, codes, axis=0, out=colour[rows])
    np.take(_TAGS, codes, out=tags[rows])


def _locate(
    road: Corridor, x: Floats, y: Floats, near: float
) -> tuple[Floats, Floats, NDArray[np.intp]]:
    """Return s, t and the nearest sample of many points, searching from one place on the road."""
    last = len(road.s) - 1
    index = np.full(x.shape, min(max(int(near / road.step), 0), last), dtype=np.intp)
    for _ in range(12):
        along = (x - road.x[index]) * road.cos[index] + (y - road.y[index]) * road.sin[index]
        moved = np.clip(index + np.rint(along / road.step).astype(np.intp), 0, last)
        if np.array_equal(moved, index):
            break
        index = moved
    dx, dy = x - road.x[index], y - road.y[index]
    s = road.s[index] + dx * road.cos[index] + dy * road.sin[index]
    return s, dy * road.cos[index] - dx * road.sin[index], index


def _surface(
    road: Corridor, s: Floats, t: Floats, index: NDArray[np.intp], distance: Floats
) -> NDArray[np.uint8]:
    """Return the palette's row for the ground at places on the road."""
    codes = np.full(s.shape, _CODES["grass"], np.uint8)
    half = 0.07 + 0.0004 * distance
    dashed = s - 12.0 * np.floor(s / 12.0) < 4.0
    for number, strip in enumerate(road.strips):
        right, left = strip.right[index], strip.left[index]
        inside = (t >= right) & (t < left)
        codes[inside] = _CODES[strip.kind]
        edges = [(left, strip.mark)]
        if number == 0:
            edges.append((right, strip.right_mark))
        for edge, mark in edges:
            if mark == "none":
                continue
            line = (np.abs(t - edge) < half) & (left > right)
            if mark == "broken":
                line &= dashed
            codes[line] = _CODES["curb" if mark == "curb" else "mark"]
    return codes


def _paint_box(
    eye: Eye,
    body: Solid,
    category: Category,
    identity: int,
    colour: Floats,
    depth: Floats,
    ids: NDArray[np.int32],
) -> None:
    """Paint one box at the pixels where it is nearest so far."""
    window = _window(eye, body)
    if window is None:
        return
    cos, sin = math.cos(body.yaw), math.sin(body.yaw)
    halves = (0.5 * body.length, 0.5 * body.width, 0.5 * body.height)
    ray_x, ray_y, ray_z = _rays(eye, *window)
    x, y, z = body.local(eye.place)
    start = (x, y, z - halves[2])
    rays = (ray_x * cos + ray_y * sin, ray_y * cos - ray_x * sin, ray_z)
    enter, leave = np.full(ray_x.shape, -np.inf), np.full(ray_x.shape, np.inf)
    face = np.zeros(ray_x.shape, dtype=np.intp)
    for axis in range(3):
        ray = np.where(np.abs(rays[axis]) < 1e-9, 1e-9, rays[axis])
        one, two = (-halves[axis] - start[axis]) / ray, (halves[axis] - start[axis]) / ray
        near, far = np.minimum(one, two), np.maximum(one, two)
        face = np.where(near > enter, axis, face)
        enter, leave = np.maximum(enter, near), np.minimum(leave, far)
    hit = (enter <= leave) & (enter > 0.1) & (enter < depth[window])
    height = start[2] + rays[2] * np.where(hit, enter, 0.0) + halves[2]
    shade = np.array(_SHADES)[face]
    if category == "vehicle":
        glass = (height > 0.58 * body.height) & (height < 0.86 * body.height) & (face != 2)
        shade = np.where(glass, 0.35 * shade, shade)
    picture = shade[..., None] * np.array(_COLOURS[category])
    depth[window][hit] = enter[hit]
    ids[window][hit] = identity
    colour[window][hit] = picture[hit]


def _sky(weather: Weather) -> tuple[float, float, float]:
    """Return the colour of the sky by day."""
    grey = weather.cloud_cover
    if weather.precipitation != "none":
        grey = 1.0
    clear, overcast = (0.52, 0.72, 0.92), (0.72, 0.74, 0.77)
    red, green, blue = (a + grey * (b - a) for a, b in zip(clear, overcast, strict=True))
    return red, green, blue


def _lit(colour: Floats, depth: Floats, camera: Camera, weather: Weather) -> NDArray[np.uint8]:
    """Return the picture as bytes after daylight, headlights and fog."""
    day = min(max((weather.sun_elevation_deg + 6.0) / 16.0, 0.05), 1.0)
    is_sky = np.isinf(depth)
    if day < 1.0:
        beam = 40.0 / (40.0 + np.where(is_sky, 0.0, depth))
        beam *= beam * beam * 0.75
        u, _ = tangents(camera)
        off_axis = np.minimum(np.abs(u) / 0.6, 1.0)[None, :]
        light = np.minimum(1.0, day + (1.0 - day) * beam * (1.0 - 0.8 * off_axis * off_axis))
        colour = colour * np.where(is_sky, day, light)[..., None]
    if weather.fog_visual_range_m < CLEAR_AIR_M:
        air = np.array((0.74, 0.76, 0.78)) * day
        clear = _transmittance(np.where(is_sky, 1e6, depth), weather.fog_visual_range_m)[..., None]
        colour = colour * clear + air * (1.0 - clear)
    picture = colour * 255.0
    picture += 0.5
    np.floor(picture, out=picture)
    return np.clip(picture, 0.0, 255.0, out=picture).astype(np.uint8)


def _transmittance(depth: Floats, visual_range: float) -> Floats:
    """Return exp(-3 depth / range), computed by squaring so that the bits do not depend on a library.

    At the visual range, contrast has fallen to 5 % (Koschmieder's law, as in OpenSCENARIO).
    """
    value = 1.0 / (1.0 + 2.9957 * depth / visual_range / 256.0)
    for _ in range(8):
        value = value * value
    return value
