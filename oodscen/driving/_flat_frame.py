"""Pictures of boxes on a plane, for simulators that draw nothing themselves.

They are ray-cast, so depth and instance ids are exact; the pictures are simple but recognisable.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from oodscen.data._catalogue import Asset
from oodscen.data._category import Category
from oodscen.data._weather import CLEAR_AIR_M, Weather
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._sight.visibility import NEAR_M, Eye, UprightBox
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
"""Red, green and blue of bodies by category, 0 to 1."""
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
"""Red, green and blue of grass, lane marks, and strips by kind."""
_PALETTE = np.array(list(_GROUND.values()))
_CODES = {name: code for code, name in enumerate(_GROUND)}
"""Row of each kind of ground in the palette."""
_CLASSES = {
    "driving": 1, "shoulder": 1, "parking": 1, "sidewalk": 2, "curb": 2, "mark": 24, "rail": 27,
}  # fmt: skip
"""Semantic classes of ground, as in `Frame.tags`; the others are terrain."""
_TERRAIN, _SKY_CLASS = 10, 11
_TAGS = np.array([_CLASSES.get(name, _TERRAIN) for name in _GROUND], np.uint8)
"""Semantic class of each row of the palette."""
_TOP = 2
"""The axis across a box's top."""
_SHADES = (0.72, 0.86, 1.0)
"""Brightness of box faces across x, y and z."""
_WINDOWS, _GLASS = (0.58, 0.86), 0.35
"""Lower and upper edge of a vehicle's windows as shares of its height, and their brightness."""
_SNOW_KEEPS, _SNOW_ADDS = 0.45, 0.5
"""Share of the ground's colour under snow, and the white that it adds."""
_ROAD_VIEW_M = 400.0
"""Distance up to which lanes are painted, m."""
_MOST_STEPS = 12
"""Most steps of the search for the nearest sample of the road."""
_HALF_MARK_M, _MARK_GROWTH = 0.07, 0.0004
"""Half the width of a lane mark, m, and its growth per metre of distance, so that it stays as wide as a pixel."""
_DASH_M, _DASH_PERIOD_M = 4.0, 12.0
"""Length of a dash, and of a dash and its gap, m."""
_DUSK_DEG, _DAY_DEG, _NIGHT = -6.0, 10.0, 0.05
"""Elevations of the sun at which daylight ends and is full, degrees, and the brightness of the night."""
_BEAM, _BEAM_M = 0.75, 40.0
"""Brightness of the headlights at the ego, and the distance at which an eighth of it is left, m."""
_BEAM_EDGE, _BEAM_LOSS = 0.6, 0.8
"""Tangent of the angle at the edge of their beam, and the share of the light that is lost there."""
_CLEAR, _OVERCAST, _AIR = (0.52, 0.72, 0.92), (0.72, 0.74, 0.77), (0.74, 0.76, 0.78)
"""Colours of the sky without and with clouds, and of the air in fog, by day."""
_LN_20, _SQUARINGS = 2.9957, 8
"""Number of extinction lengths over which contrast falls to 5 %, and of the squarings that compute it."""
_FAR_M = 1e6
"""Distance of the sky in fog, m."""
_LEVEL = 1e-6
"""Slope of a ray below the horizon up to which it meets no ground."""
_PARALLEL = 1e-9
"""Component of a ray that stands for none where it is divided by."""


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
    ego, *others = (_solid(pose, asset) for asset, pose in zip(assets, poses, strict=True))
    canvas = _Canvas(Eye(camera, ego if mount is None else _solid(mount, assets[0])), weather)
    canvas.paint_ground(ego.z, road)
    for identity, (body, asset) in enumerate(zip(others, assets[1:], strict=True), start=2):
        canvas.paint_box(body, asset.category, identity)
    return canvas.frame()


def _solid(pose: Sequence[float] | Floats, asset: Asset) -> UprightBox:
    x, y, z, yaw = map(float, pose)
    return UprightBox(x, y, z, yaw, asset.length, asset.width, asset.height)


def tangents(camera: Camera) -> tuple[Floats, Floats]:
    """Return the tangents of the angles to the optical axis: of columns to the right, and of rows down."""
    focal = 0.5 * camera.width / math.tan(0.5 * math.radians(camera.fov_deg))
    u = (np.arange(camera.width, dtype=np.float64) + 0.5 - 0.5 * camera.width) / focal
    v = (np.arange(camera.height, dtype=np.float64) + 0.5 - 0.5 * camera.height) / focal
    return u, v


class _Canvas:
    """The pixels of a frame in some weather, which are painted one thing after another."""

    def __init__(self, eye: Eye, weather: Weather) -> None:
        shape = (eye.camera.height, eye.camera.width)
        self.eye, self.weather = eye, weather
        self.depth = np.full(shape, np.inf)
        self.ids = np.zeros(shape, np.int32)
        self.tags = np.full(shape, _SKY_CLASS, np.uint8)
        self.colour = np.empty((*shape, 3))
        self.colour[:] = _sky(weather)

    def paint_ground(self, height: float, road: Corridor) -> None:
        """Paint the ground plane at a height: grass, road strips and lane marks, and snow on them; nothing from below."""
        eye = self.eye
        _, v = tangents(eye.camera)
        below = eye.forward[2] + v * eye.down[2] < -_LEVEL
        if not below.any() or eye.place[2] <= height:
            return
        rows = slice(int(below.argmax()), None)
        x, y, z = _rays(eye, rows, slice(None))
        distance = (height - eye.place[2]) / z * np.ones_like(x)
        self.depth[rows] = distance
        codes = np.full(distance.shape, _CODES["grass"], np.uint8)
        near = distance <= _ROAD_VIEW_M
        away = distance[near]
        ground_x, ground_y = eye.place[0] + x[near] * away, eye.place[1] + y[near] * away
        ego_s, _ = road.locate(eye.ego.x, eye.ego.y)
        s, t, index = _locate(road, ground_x, ground_y, ego_s)
        codes[near] = _surface(road, s, t, index, away)
        # Without a check of the bounds, which all codes keep, numpy writes where it should at once.
        np.take(_PALETTE, codes, axis=0, out=self.colour[rows], mode="clip")
        np.take(_TAGS, codes, out=self.tags[rows], mode="clip")
        if self.weather.precipitation == "snow":
            self.colour[rows] *= _SNOW_KEEPS
            self.colour[rows] += _SNOW_ADDS

    def paint_box(self, body: UprightBox, category: Category, identity: int) -> None:
        """Paint one box at the pixels where it is nearest so far."""
        window = _window(self.eye, body)
        if window is None:
            return
        face, distance, height = _hits(self.eye, body, window)
        is_nearest = distance < self.depth[window]
        shade = np.array(_SHADES)[face]
        if category == "vehicle":
            low, high = (edge * body.height for edge in _WINDOWS)
            is_glass = (height > low) & (height < high) & (face != _TOP)
            shade = np.where(is_glass, _GLASS * shade, shade)
        colour = shade[..., None] * np.array(_COLOURS[category])
        self.depth[window][is_nearest] = distance[is_nearest]
        self.ids[window][is_nearest] = identity
        self.tags[window][is_nearest] = 0
        self.colour[window][is_nearest] = colour[is_nearest]

    def frame(self) -> Frame:
        """Return the frame after daylight, headlights and fog."""
        colour, is_sky, fog_m = self.colour, np.isinf(self.depth), self.weather.fog_visual_range_m
        daylight = (self.weather.sun_elevation_deg - _DUSK_DEG) / (_DAY_DEG - _DUSK_DEG)
        day = min(max(daylight, _NIGHT), 1.0)
        if day < 1.0:
            beam = _BEAM_M / (_BEAM_M + np.where(is_sky, 0.0, self.depth))
            beam *= beam * beam * _BEAM
            share = _share_of_beam(self.eye.camera)
            light = np.minimum(1.0, day + (1.0 - day) * beam * share)
            colour = colour * np.where(is_sky, day, light)[..., None]
        if fog_m < CLEAR_AIR_M:
            clear = _transmittance(np.where(is_sky, _FAR_M, self.depth), fog_m)[..., None]
            colour = colour * clear + np.array(_AIR) * day * (1.0 - clear)
        picture = colour * 255.0
        picture += 0.5
        np.floor(picture, out=picture)
        rgb = np.clip(picture, 0.0, 255.0, out=picture).astype(np.uint8)
        return Frame(rgb=rgb, depth=self.depth.astype(np.float32), ids=self.ids, tags=self.tags)


def _share_of_beam(camera: Camera) -> Floats:
    """Return the share of the headlights' light in the columns of a camera, which may be turned: [width]."""
    u, _ = tangents(camera)
    yaw = math.radians(camera.yaw_deg)
    ahead, across = math.cos(yaw) + u * math.sin(yaw), u * math.cos(yaw) - math.sin(yaw)
    aside = np.minimum(np.abs(across) / np.maximum(_BEAM_EDGE * ahead, _PARALLEL), 1.0)
    return np.where(ahead > 0.0, 1.0 - _BEAM_LOSS * aside * aside, 0.0)


def _rays(eye: Eye, rows: slice, columns: slice) -> tuple[Floats, Floats, Floats]:
    """Return x, y and z of the rays through pixels, with unit length along the optical axis."""
    us, vs = tangents(eye.camera)
    u, v = us[columns][None, :], vs[rows][:, None]
    x, y, z = (eye.forward[axis] + u * eye.right[axis] + v * eye.down[axis] for axis in range(3))
    return x, y, z


def _window(eye: Eye, body: UprightBox) -> tuple[slice, slice] | None:
    """Return the rows and columns that contain a body, or `None` if no pixel does."""
    outline = eye.silhouette(body)
    if not outline:
        return None
    us, vs = zip(*outline, strict=True)
    camera = eye.camera
    left, right = max(0, math.floor(min(us))), min(camera.width, math.ceil(max(us)) + 1)
    top, bottom = max(0, math.floor(min(vs))), min(camera.height, math.ceil(max(vs)) + 1)
    if left >= right or top >= bottom:
        return None
    return slice(top, bottom), slice(left, right)


def _locate(
    road: Corridor, x: Floats, y: Floats, near: float
) -> tuple[Floats, Floats, NDArray[np.intp]]:
    """Return s, t and the nearest sample of many points, searching from one place on the road."""
    last = len(road.s) - 1
    at: Any = np.intp(min(max(int(near / road.step), 0), last))
    index = np.full(x.shape, at)
    moving, its_x, its_y = np.arange(len(x)), x, y
    for _ in range(_MOST_STEPS):
        along = (its_x - road.x[at]) * road.cos[at] + (its_y - road.y[at]) * road.sin[at]
        moved = np.clip(at + np.rint(along / road.step).astype(np.intp), 0, last)
        # A point that has found its sample stays there.
        still = np.flatnonzero(moved != at)
        if not len(still):
            break
        moving, at, its_x, its_y = moving[still], moved[still], its_x[still], its_y[still]
        index[moving] = at
    cos, sin = road.cos[index], road.sin[index]
    dx, dy = x - road.x[index], y - road.y[index]
    return road.s[index] + dx * cos + dy * sin, dy * cos - dx * sin, index


def _surface(
    road: Corridor, s: Floats, t: Floats, index: NDArray[np.intp], distance: Floats
) -> NDArray[np.uint8]:
    """Return the palette's row for the ground at places on the road."""
    codes = np.full(s.shape, _CODES["grass"], np.uint8)
    half = _HALF_MARK_M + _MARK_GROWTH * distance
    dashed = s - _DASH_PERIOD_M * np.floor(s / _DASH_PERIOD_M) < _DASH_M
    edges: list[tuple[Floats, str, NDArray[np.bool_]]] = []
    for number, strip in enumerate(road.strips):
        right, left = _along(strip.right, index), _along(strip.left, index)
        codes[(t >= right) & (t < left)] = _CODES[strip.kind]
        if number == 0:
            edges.append((right, strip.right_mark, left > right))
        edges.append((left, strip.mark, left > right))
    # Marks lie on both strips beside them.
    for edge, mark, exists in edges:
        if mark == "none":
            continue
        line = (np.abs(t - edge) < half) & exists
        if mark == "broken":
            line &= dashed
        codes[line] = _CODES["curb" if mark == "curb" else "mark"]
    return codes


def _along(edge: Floats, index: NDArray[np.intp]) -> Floats:
    """Return an edge's offsets at samples of the road; a single one if it is the same everywhere."""
    return edge[:1] if (edge == edge[0]).all() else edge[index]


def _hits(
    eye: Eye, body: UprightBox, window: tuple[slice, slice]
) -> tuple[NDArray[np.intp], Floats, Floats]:
    """Return where the rays through a window enter a box.

    Returns:
        The axis across the face; the distance along the optical axis, m, infinite without a hit; and the height
        above the box's underside, m.
    """
    cos, sin = math.cos(body.yaw), math.sin(body.yaw)
    halves = (0.5 * body.length, 0.5 * body.width, 0.5 * body.height)
    ray_x, ray_y, ray_z = _rays(eye, *window)
    x, y, z = body.local(eye.place)
    start = (x, y, z - halves[2])
    rays = (ray_x * cos + ray_y * sin, ray_y * cos - ray_x * sin, ray_z)
    enter, leave = np.full(ray_x.shape, -np.inf), np.full(ray_x.shape, np.inf)
    face = np.zeros(ray_x.shape, dtype=np.intp)
    for axis in range(3):
        ray = np.where(np.abs(rays[axis]) < _PARALLEL, _PARALLEL, rays[axis])
        low, high = (-halves[axis] - start[axis]) / ray, (halves[axis] - start[axis]) / ray
        near, far = np.minimum(low, high), np.maximum(low, high)
        face = np.where(near > enter, axis, face)
        enter, leave = np.maximum(enter, near), np.minimum(leave, far)
    is_hit = (enter <= leave) & (enter > NEAR_M)
    height = start[2] + rays[2] * np.where(is_hit, enter, 0.0) + halves[2]
    return face, np.where(is_hit, enter, np.inf), height


def _sky(weather: Weather) -> tuple[float, float, float]:
    """Return the colour of the sky by day."""
    grey = weather.cloud_cover if weather.precipitation == "none" else 1.0
    red, green, blue = (a + grey * (b - a) for a, b in zip(_CLEAR, _OVERCAST, strict=True))
    return red, green, blue


def _transmittance(depth: Floats, visual_range: float) -> Floats:
    """Return exp(-ln 20 depth / range), computed by squaring so that the bits do not depend on a library.

    At the visual range, contrast has fallen to 5 % (Koschmieder's law, as in OpenSCENARIO).
    """
    value = 1.0 / (1.0 + _LN_20 * depth / visual_range / 2.0**_SQUARINGS)
    for _ in range(_SQUARINGS):
        value = value * value
    return value
