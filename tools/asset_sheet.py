"""Draws the asset sheet: pictures and a table of everything in the catalogue.

Usage: python -m tools.asset_sheet docs
"""

import math
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from oodscen_pybullet._catalogue import load_catalogue
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._meshes import Mesh, paints_of
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._rendering.appearance import Look, mesh_of
from oodscen_pybullet._rendering.picture import develop
from oodscen_pybullet._rendering.rasteriser import Rasteriser
from oodscen_pybullet._rendering.stage import PlacedPuff, RawPicture
from oodscen_pybullet._rendering.view import CameraView

from oodscen.data._catalogue import Asset
from oodscen.data._category import Category
from oodscen.data._weather import Weather
from oodscen.protocols import Camera

Image = NDArray[np.uint8]

CELL = (208, 156)
"""Width and height of one picture, in pixels."""
COLUMNS = 5
SHEETS: dict[str, tuple[Category, ...]] = {
    "vehicles": ("vehicle",),
    "people_and_animals": ("cyclist", "pedestrian", "animal"),
    "objects": ("object",),
    "work_zones_signals_vegetation": ("work_zone", "signal", "vegetation"),
}
"""File name of each sheet and the categories it shows."""
_FACES_BACK = ("work_zone", "signal", "object")
"""Categories whose printed faces look along -x, towards an approaching driver."""
_CAPTION = 36
_DAY, _NIGHT = Weather(), Weather(sun_elevation_deg=-12.0)
_PAGE = """\
# Assets

<!-- Written by `python -m tools.asset_sheet docs`; edit the catalogue or that module. -->

Look up the {count} assets that the PyBullet adapter can place in a scene, all made of plain polygons. Sizes are length (along x, the direction of
travel), width and height of the mesh in metres at rest. A scene names an asset by its id; `state` is one of its states, the first by default.
The vehicle under test is {ego}.

- Brake lamps light up below -1 m/s². Head and tail lamps are on in the dark, in fog and in rain, unless a vehicle stands with its lamps off or is
  `unlit`, which also turns off its brake lamps. Indicators, hazard lamps, beacons, arrow boards and amber signals flash at 1.5 Hz.
- Legs and arms swing with the distance covered, in eight steps per stride, at a walk and at a run; pedals and a wheelchair's wheels turn likewise.
- Signs, signals and work-zone boards face the traffic that drives along their own heading: place them with heading 0.
- Assets tagged `flat` are driven over and collide with nothing; `car_door` turns about its front edge.
- The scene's seed chooses the paint or clothes of these assets: {painted}.

![A walk and a run](pictures/assets/gaits.jpg)

![Lamps by day and by night](pictures/assets/lights.jpg)
"""


def render(
    look: Look, *, turn_deg: float = 35.0, rise_deg: float = 13.0, is_night: bool = False
) -> Image:
    """Render an asset on plain ground: [height, width, 3].

    Args:
        look: The asset and its appearance.
        turn_deg: Position of the camera, counter-clockwise from the asset's front.
        rise_deg: Angle by which the camera looks down.
        is_night: Whether the sun has set.
    """
    mesh = mesh_of(look)
    view = _framing(mesh, turn_deg, rise_deg)
    weather = _NIGHT if is_night else _DAY
    light = Light.of(weather, math.radians(turn_deg) + math.pi, reflects_snow=False)
    canvas = Rasteriser()
    canvas.show_scenery([_ground()])
    canvas.show_actors([MeshBuilder().box((0, 0, -9), (1, 1, 1), "grey").build(), look])
    canvas.pose_actors([(0.0, 0.0, 0.0, 0.0)] * 2)
    shot = canvas.render(view, light, ground=None if is_night else 0.0)
    picture = RawPicture(
        shot=shot,
        view=view,
        weather=weather,
        light=light,
        lamps=mesh.lamps,
        time=0.0,
        seed=0,
        road_height=0.0,
        balls=[PlacedPuff(puff, 1) for puff in mesh.puffs],
    )
    return develop(picture)


def _framing(mesh: Mesh, turn_deg: float, rise_deg: float) -> CameraView:
    """Return the closest view that contains a mesh and its smoke."""
    low, high = mesh.bounds
    for puff in mesh.puffs:
        middle = np.array(puff.position)
        low = np.minimum(low, middle - 0.7 * puff.radius)
        high = np.maximum(high, middle + 0.7 * puff.radius)
    middle = (low + high) / 2
    corners = [
        (float(x), float(y), float(z))
        for x in (low[0], high[0])
        for y in (low[1], high[1])
        for z in (low[2], high[2])
    ]
    turn, rise = math.radians(turn_deg), math.radians(rise_deg)
    away = (math.cos(turn) * math.cos(rise), math.sin(turn) * math.cos(rise), math.sin(rise))
    camera = Camera(width=CELL[0], height=CELL[1], fov_deg=28.0, x=0.0, z=0.0, pitch_deg=rise_deg)
    far = 1.0
    while True:
        x, y, z = (float(m) + far * a for m, a in zip(middle, away, strict=True))
        view = CameraView.of(camera, (x, y, z, turn + math.pi))
        places = [view.pixel(corner) for corner in corners]
        if all(p and 6 < p[0] < CELL[0] - 6 and 6 < p[1] < CELL[1] - 6 for p in places):
            return view
        far *= 1.05


def _ground() -> Mesh:
    corners = [(-400, -400, 0.0), (400, -400, 0.0), (400, 400, 0.0), (-400, 400, 0.0)]
    mesh = MeshBuilder().polygon(corners, "asphalt_light").build()
    return replace(mesh, is_ground=True)


def captioned(picture: Image, *lines: str) -> Image:
    """Return a picture with a caption below it."""
    import cv2

    foot = np.full((_CAPTION, picture.shape[1], 3), 255, np.uint8)
    for index, words in enumerate(lines):
        ink = (20, 20, 24) if index == 0 else (96, 98, 104)
        place = (5, 14 + 16 * index)
        cv2.putText(foot, words, place, cv2.FONT_HERSHEY_SIMPLEX, 0.4, ink, 1, cv2.LINE_AA)
    return np.concatenate([picture, foot])


def tiled(cells: Sequence[Image], columns: int = COLUMNS) -> Image:
    """Arrange pictures of equal size in rows."""
    blank = np.full_like(cells[0], 255)
    rows = []
    for start in range(0, len(cells), columns):
        row = list(cells[start : start + columns])
        rows.append(np.concatenate(row + [blank] * (columns - len(row)), axis=1))
    return np.concatenate(rows)


def rest_look(asset: Asset) -> Look:
    """Return the asset's look in the sheet: its first state and first paint."""
    return Look(asset.id, asset.states[0] if asset.states else "", paints_of(asset.id)[0])


def best_side(asset: Asset) -> float:
    """Return the best viewing direction of an asset, in degrees counter-clockwise from its front."""
    return 205.0 if asset.category in _FACES_BACK else 35.0


def sheet(assets: Sequence[Asset]) -> Image:
    """Return the pictures of the assets, captioned with names and sizes."""
    cells = []
    for asset in assets:
        picture = render(rest_look(asset), turn_deg=best_side(asset))
        size = f"{asset.length:g} x {asset.width:g} x {asset.height:g} m"
        cells.append(captioned(picture, asset.id, size))
    return tiled(cells)


def gaits() -> Image:
    """Return a walk, a run and a gallop, frame by frame."""
    rows = (("adult", 1), ("adult", 9), ("deer", 9), ("cyclist", 1))
    cells = [
        render(Look(name, "", paints_of(name)[0], frame=start + step), turn_deg=70.0)
        for name, start in rows
        for step in range(0, 8, 2)
    ]
    return tiled(cells, 4)


def lights() -> Image:
    """Return the lamps by day and by night."""
    shown = (
        ("car", "brake", False, 0),
        ("car", "indicate_left", False, 0),
        ("car", "hazard", True, 0),
        ("police_car", "beacon", True, 0),
        ("police_car", "beacon", True, 1),
        ("traffic_light", "red", False, 0),
        ("traffic_light", "green", True, 0),
        ("traffic_light", "flashing", True, 0),
        ("arrow_board", "right", True, 0),
        ("burning_car", "", True, 0),
    )
    cells = []
    for name, state, is_night, frame in shown:
        look = Look(name, state, paints_of(name)[0], is_night, frame)
        turn = 205.0 if name in ("traffic_light", "arrow_board") else 152.0
        words = f"{name} {state}" + (", second half" if frame else "")
        cells.append(captioned(render(look, turn_deg=turn, is_night=is_night), words))
    return tiled(cells)


def page() -> str:
    """Return the Markdown page that lists every asset."""
    catalogue = load_catalogue()
    painted = [asset.id for asset in catalogue.assets if len(paints_of(asset.id)) > 1]
    text = _PAGE.format(
        count=len(catalogue.assets),
        ego=catalogue.ego.description.removeprefix("the vehicle under test: "),
        painted=", ".join(f"`{name}`" for name in painted),
    )
    for name, categories in SHEETS.items():
        title = name.replace("_", " ")
        text += f"\n## {title.capitalize()}\n\n![{title}](pictures/assets/{name}.jpg)\n\n"
        text += "| id | description | size, m | tags | states |\n| --- | --- | --- | --- | --- |\n"
        for asset in _members(categories):
            size = f"{asset.length:g} x {asset.width:g} x {asset.height:g}"
            words = (asset.description, size, ", ".join(asset.tags), ", ".join(asset.states))
            text += f"| `{asset.id}` | " + " | ".join(words) + " |\n"
    return text


def _members(categories: Sequence[Category]) -> list[Asset]:
    order = {category: index for index, category in enumerate(categories)}
    some = [asset for asset in load_catalogue().assets if asset.category in order]
    return sorted(some, key=lambda asset: order[asset.category])


def pictures() -> Iterator[tuple[str, Image]]:
    """Yield every picture of the page with its file name."""
    for name, categories in SHEETS.items():
        yield f"{name}.jpg", sheet(_members(categories))
    yield "gaits.jpg", gaits()
    yield "lights.jpg", lights()


def main(folder: Path) -> None:
    """Write `assets.md` and its pictures to a folder."""
    import cv2

    into = folder / "pictures" / "assets"
    into.mkdir(parents=True, exist_ok=True)
    (folder / "assets.md").write_text(page(), encoding="utf-8")
    for name, image in pictures():
        cv2.imwrite(str(into / name), image[:, :, ::-1], [cv2.IMWRITE_JPEG_QUALITY, 82])


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "docs"))
