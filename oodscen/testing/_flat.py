"""A complete simulator that needs only NumPy: boxes on a plane.

It is the reference for adapters, and quick tests run on it. Frames are ray-cast, so depth and
instance ids are exact; the pictures are simple but recognisable.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._scene import CLEAR_AIR_M, Scene, Weather
from oodscen.driving._mirror_simulator import MirrorSimulator
from oodscen.driving._roads.corridor import Corridor
from oodscen.protocols import Camera, Frame
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE

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


class FlatSimulator(MirrorSimulator):
    """Renders the kinematic world as shaded boxes on a plane."""

    name = "flat"

    def __init__(self) -> None:
        super().__init__()
        self._road: Corridor | None = None
        self._weather = Weather()
        self._assets: list[Asset] = []
        self._poses: list[list[float]] = []

    def catalogue(self) -> Catalogue:
        """Return the catalogue of all shared assets."""
        return FLAT_CATALOGUE

    def load(self, corridor: Corridor, scene: Scene, seed: int) -> None:
        """Discard the last scene; keep the new road and weather."""
        self._road = corridor
        self._weather = scene.weather
        self._assets, self._poses = [], []

    def spawn(
        self, actor_id: str, asset: Asset, state: str, pose: tuple[float, float, float, float]
    ) -> None:
        """Add one box."""
        self._assets.append(asset)
        self._poses.append(list(pose))

    def place(self, poses: Floats, speeds: Floats) -> None:
        """Move the boxes."""
        self._poses = poses.tolist()

    def release(self) -> None:
        """Discard the scene."""
        self._road = None
        self._assets, self._poses = [], []

    def draw(self, camera: Camera) -> Frame:
        """Cast one ray through the centre of every pixel."""
        assert self._road is not None
        return flat_frame(camera, self._road, self._weather, self._assets, self._poses)

    def draw_from(
        self,
        camera: Camera,
        mount: tuple[float, float, float, float],
        *,
        accelerations: Sequence[float],
        time: float,
        roll_deg: float = 0.0,
    ) -> Frame:
        """Return the picture of a camera anywhere; needs `load`, `spawn` and `place`, but no world.

        Args:
            camera: The camera.
            mount: x, y, z, m, and yaw, rad, of what the camera is mounted on.
            accelerations: Unused: boxes have no lamps.
            time: Unused: nothing flickers.
            roll_deg: Unused: the camera stays level.
        """
        assert self._road is not None
        return flat_frame(camera, self._road, self._weather, self._assets, self._poses, mount)


def flat_frame(
    camera: Camera,
    road: Corridor,
    weather: Weather,
    assets: Sequence[Asset],
    poses: Sequence[Sequence[float]] | Floats,
    mount: Sequence[float] | None = None,
) -> Frame:
    """Draw a scene as shaded boxes on a plane, for simulators that draw nothing themselves.

    Args:
        camera: The camera, relative to the ego.
        road: The scene's road.
        weather: The scene's weather.
        assets: The assets of all bodies, the ego's first.
        poses: x, y, z and yaw of all bodies, in the same order; the ego's box is not drawn.
        mount: x, y, z and yaw of what the camera is mounted on; by default the ego's.
    """
    rows = [list(map(float, pose)) for pose in poses]
    mount = rows[0] if mount is None else mount
    view = _FlatView(camera, mount)
    view.ground = rows[0][2]
    depth = np.full((camera.height, camera.width), np.inf)
    ids = np.zeros((camera.height, camera.width), dtype=np.int32)
    colour = np.empty((camera.height, camera.width, 3))
    colour[:] = _sky(weather)
    tags = np.full((camera.height, camera.width), _SKY_CLASS, np.uint8)
    s, _ = road.locate(mount[0], mount[1])
    _paint_ground(view, road, s, colour, depth, tags)
    if weather.precipitation == "snow":
        colour[np.isfinite(depth)] *= 0.45
        colour[np.isfinite(depth)] += 0.5
    for row in range(1, len(assets)):
        _paint_box(view, assets[row], rows[row], row + 1, colour, depth, ids)
    rgb = _lit(colour, depth, view, weather)
    tags[ids > 0] = 0
    return Frame(rgb=rgb, depth=depth.astype(np.float32), ids=ids, tags=tags)


class _FlatView:
    """The camera in the world: its origin, its axes, and a ray for every pixel."""

    def __init__(self, camera: Camera, ego: Sequence[float]) -> None:
        x, y, z, yaw = ego
        cos, sin = math.cos(yaw), math.sin(yaw)
        turn = yaw + math.radians(camera.yaw_deg)
        ahead, aside = math.cos(turn), math.sin(turn)
        pitch = math.radians(camera.pitch_deg)
        down, level = math.sin(pitch), math.cos(pitch)
        self.width, self.height = camera.width, camera.height
        self.origin = (
            x + camera.x * cos - camera.y * sin,
            y + camera.x * sin + camera.y * cos,
            z + camera.z,
        )
        self.ground = z
        self.forward = (ahead * level, aside * level, -down)
        self.right = (aside, -ahead, 0.0)
        self.down = (-ahead * down, -aside * down, -level)
        self.focal = 0.5 * camera.width / math.tan(0.5 * math.radians(camera.fov_deg))
        self.u = (np.arange(camera.width) + 0.5 - 0.5 * camera.width) / self.focal
        self.v = (np.arange(camera.height) + 0.5 - 0.5 * camera.height) / self.focal

    def rays(self, rows: slice, columns: slice) -> tuple[Floats, Floats, Floats]:
        """Return x, y and z of rays with unit length along the optical axis."""
        u, v = self.u[columns][None, :], self.v[rows][:, None]
        x, y, z = (
            self.forward[axis] + u * self.right[axis] + v * self.down[axis] for axis in range(3)
        )
        return x, y, z

    def window(self, corners: Sequence[tuple[float, float, float]]) -> tuple[slice, slice] | None:
        """Return the rows and columns that contain all corners, or `None` behind the camera."""
        us: list[float] = []
        vs: list[float] = []
        for corner in corners:
            offset = [corner[axis] - self.origin[axis] for axis in range(3)]
            along, across, below = (
                sum(a * b for a, b in zip(offset, axis, strict=True))
                for axis in (self.forward, self.right, self.down)
            )
            if along >= 0.1:
                us.append(across / along * self.focal + 0.5 * self.width)
                vs.append(below / along * self.focal + 0.5 * self.height)
        if not us:
            return None
        if len(us) < len(corners):
            return slice(0, self.height), slice(0, self.width)
        left, right = max(0, math.floor(min(us))), min(self.width, math.ceil(max(us)) + 1)
        top, bottom = max(0, math.floor(min(vs))), min(self.height, math.ceil(max(vs)) + 1)
        if left >= right or top >= bottom:
            return None
        return slice(top, bottom), slice(left, right)


def _paint_ground(
    view: _FlatView,
    road: Corridor,
    ego_s: float,
    colour: Floats,
    depth: Floats,
    tags: NDArray[np.uint8],
) -> None:
    """Paint the ground plane: grass, road strips and lane marks."""
    below = view.forward[2] + view.v * view.down[2] < -1e-6
    if not below.any():
        return
    first = int(below.argmax())
    rows = slice(first, view.height)
    x, y, z = view.rays(rows, slice(0, view.width))
    distance = (view.ground - view.origin[2]) / z * np.ones_like(x)
    depth[rows] = distance
    codes = np.full(distance.shape, _CODES["grass"], np.uint8)
    near = distance <= _ROAD_VIEW_M
    away = distance[near]
    ground_x, ground_y = view.origin[0] + x[near] * away, view.origin[1] + y[near] * away
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
    view: _FlatView,
    asset: Asset,
    pose: Sequence[float],
    identity: int,
    colour: Floats,
    depth: Floats,
    ids: NDArray[np.int32],
) -> None:
    """Paint one box at the pixels where it is nearest so far."""
    x, y, z, yaw = pose
    cos, sin = math.cos(yaw), math.sin(yaw)
    halves = (0.5 * asset.length, 0.5 * asset.width, 0.5 * asset.height)
    corners = [
        (x + a * cos - b * sin, y + a * sin + b * cos, z + c)
        for a in (-halves[0], halves[0])
        for b in (-halves[1], halves[1])
        for c in (0.0, asset.height)
    ]
    window = view.window(corners)
    if window is None:
        return
    ray_x, ray_y, ray_z = view.rays(*window)
    dx, dy = view.origin[0] - x, view.origin[1] - y
    start = (dx * cos + dy * sin, dy * cos - dx * sin, view.origin[2] - z - halves[2])
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
    if asset.category == "vehicle":
        glass = (height > 0.58 * asset.height) & (height < 0.86 * asset.height) & (face != 2)
        shade = np.where(glass, 0.35 * shade, shade)
    picture = shade[..., None] * np.array(_COLOURS[asset.category])
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


def _lit(colour: Floats, depth: Floats, view: _FlatView, weather: Weather) -> NDArray[np.uint8]:
    """Return the picture as bytes after daylight, headlights and fog."""
    day = min(max((weather.sun_elevation_deg + 6.0) / 16.0, 0.05), 1.0)
    is_sky = np.isinf(depth)
    if day < 1.0:
        beam = 40.0 / (40.0 + np.where(is_sky, 0.0, depth))
        beam *= beam * beam * 0.75
        off_axis = np.minimum(np.abs(view.u) / 0.6, 1.0)[None, :]
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
