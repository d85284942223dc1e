"""The printed regions of the atlas: plates, signs, liveries, surfaces and facades."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from oodscen_pybullet._meshes.sign_textures import paint_sign

Image = NDArray[np.uint8]
Colour = tuple[int, int, int]


def paint_regions(
    image: Image, regions: Mapping[str, tuple[int, int, int, int]], colours: dict[str, Colour]
) -> None:
    """Paint every region into the atlas, in place."""
    rng = np.random.Generator(np.random.PCG64(7))
    for name, (x, y, width, height) in regions.items():
        tile = image[y : y + height, x : x + width]
        tile[:] = 200
        kind = name.split("_")[0]
        if kind in _PAINTERS:
            patch = np.ascontiguousarray(tile)
            _PAINTERS[kind](patch, name, colours, rng)
            tile[:] = patch


def _text(
    patch: Image, words: str, colour: Colour, *, middle: float = 0.5, size: float = 0.7
) -> None:
    """Write one line as large as fits, centred at a fraction of the height."""
    import cv2

    height, width = patch.shape[:2]
    font = cv2.FONT_HERSHEY_DUPLEX
    (wide, tall), _ = cv2.getTextSize(words, font, 1.0, 2)
    scale = min(0.92 * width / wide, size * height / tall)
    weight = max(1, round(1.8 * scale))
    (wide, tall), _ = cv2.getTextSize(words, font, scale, weight)
    origin = (round((width - wide) / 2), round(height * middle + tall / 2))
    cv2.putText(patch, words, origin, font, scale, colour, weight, cv2.LINE_AA)


def _plate(patch: Image, name: str, _: dict[str, Colour], __: np.random.Generator) -> None:
    patch[:] = (246, 246, 240) if name == "plate" else (250, 214, 60)
    patch[[0, 1, -2, -1]] = 20
    patch[:, [0, 1, -2, -1]] = 20
    _text(patch, "OD 53 SCN", (20, 20, 24), size=0.6)


def _livery(patch: Image, name: str, colours: dict[str, Colour], _: np.random.Generator) -> None:
    words, ground, ink = {
        "police": ("POLICE", colours["navy"], (250, 250, 250)),
        "police_back": ("POLICE", (224, 240, 60), (24, 30, 60)),
        "ambulance": ("AMBULANCE", (246, 246, 240), (196, 20, 24)),
        "fire": ("FIRE", (244, 208, 40), (170, 16, 20)),
    }[name]
    patch[:] = ground
    _text(patch, words, ink)


def _checks(patch: Image, _: str, colours: dict[str, Colour], __: np.random.Generator) -> None:
    cell = patch.shape[0] // 2
    for row in range(2):
        for column in range(patch.shape[1] // cell):
            shade = colours["fluor_yellow"] if (row + column) % 2 else colours["blue"]
            patch[row * cell : (row + 1) * cell, column * cell : (column + 1) * cell] = shade


def _chevrons(patch: Image, _: str, __: dict[str, Colour], ___: np.random.Generator) -> None:
    height, width = patch.shape[:2]
    y, x = np.mgrid[0:height, 0:width]
    is_red = ((x + np.abs(y - height // 2)) // 16) % 2 == 0
    patch[:] = np.where(is_red[..., None], (214, 30, 30), (246, 214, 40))


def _stripes(patch: Image, _: str, __: dict[str, Colour], ___: np.random.Generator) -> None:
    height, width = patch.shape[:2]
    y, x = np.mgrid[0:height, 0:width]
    is_red = ((x + y) // 16) % 2 == 0
    patch[:] = np.where(is_red[..., None], (214, 30, 30), (246, 246, 240))


def _box(patch: Image, _: str, colours: dict[str, Colour], __: np.random.Generator) -> None:
    import cv2

    ink = (96, 66, 34)
    patch[:] = colours["cardboard"]
    for x in (26, 48):
        cv2.arrowedLine(patch, (x, 44), (x, 14), ink, 4, cv2.LINE_AA, 0, 0.42)
    cv2.line(patch, (14, 50), (60, 50), ink, 3)
    _text(patch, "THIS SIDE UP", ink, middle=0.68, size=0.14)
    _text(patch, "FRAGILE", ink, middle=0.84, size=0.15)


def _road(patch: Image, _: str, __: dict[str, Colour], ___: np.random.Generator) -> None:
    import cv2

    patch[:] = (248, 248, 244)
    height, width = patch.shape[:2]
    cv2.rectangle(patch, (5, 5), (width - 6, height - 6), (200, 20, 24), 7)
    _text(patch[:, 24:-24], "ROAD", (16, 16, 18), middle=0.31, size=0.28)
    _text(patch[:, 24:-24], "CLOSED", (16, 16, 18), middle=0.70, size=0.28)


def _detour(patch: Image, _: str, __: dict[str, Colour], ___: np.random.Generator) -> None:
    import cv2

    patch[:] = (248, 132, 20)
    height, width = patch.shape[:2]
    cv2.rectangle(patch, (5, 5), (width - 6, height - 6), (16, 16, 18), 5)
    _text(patch[:, 20:-20], "DETOUR", (16, 16, 18), middle=0.3, size=0.3)
    start, end = (44, round(height * 0.72)), (width - 40, round(height * 0.72))
    cv2.arrowedLine(patch, start, end, (16, 16, 18), 14, cv2.LINE_AA, 0, 0.2)


def _arrow(patch: Image, name: str, colours: dict[str, Colour], _: np.random.Generator) -> None:
    import cv2

    height, width = patch.shape[:2]
    patch[:] = (22, 22, 24)
    lit = colours["amber_lit"]
    points = [(0.18 + 0.09 * i, 0.5) for i in range(8)]
    points += [(0.27, 0.30), (0.36, 0.14), (0.27, 0.70), (0.36, 0.86)]
    for across, down in points:
        x = across if name == "arrow_left" else 1 - across
        cv2.circle(patch, (round(x * width), round(down * height)), 9, lit, -1, cv2.LINE_AA)


def _grille(patch: Image, _: str, __: dict[str, Colour], ___: np.random.Generator) -> None:
    patch[:] = (34, 34, 38)
    patch[4::6] = (112, 114, 118)
    patch[:, 47:49] = (170, 172, 176)


def _grain(patch: Image, colour: Colour, spread: float, rng: np.random.Generator) -> None:
    noise = rng.normal(0.0, spread, (*patch.shape[:2], 1))
    patch[:] = np.clip(np.array(colour) + noise, 0, 255)


def _asphalt(patch: Image, name: str, colours: dict[str, Colour], rng: np.random.Generator) -> None:
    import cv2

    _grain(patch, colours["asphalt"], 4.0, rng)
    if name == "asphalt_worn":
        for _ in range(3):
            points = np.cumsum(rng.integers(-9, 10, (14, 2)), axis=0) + 64
            cv2.polylines(patch, [points.astype(np.int32)], False, colours["asphalt_dark"], 1)


def _paving(patch: Image, _: str, colours: dict[str, Colour], rng: np.random.Generator) -> None:
    _grain(patch, colours["pavement"], 3.0, rng)
    for k in range(0, 128, 32):
        patch[k : k + 2] = colours["pavement_dark"]
        patch[:, k : k + 2] = colours["pavement_dark"]


def _turf(patch: Image, _: str, colours: dict[str, Colour], rng: np.random.Generator) -> None:
    _grain(patch, colours["grass"], 7.0, rng)


def _gravel(patch: Image, _: str, colours: dict[str, Colour], rng: np.random.Generator) -> None:
    _grain(patch, colours["gravel"], 9.0, rng)


def _window(
    patch: Image, box: tuple[float, float, float, float], glass: Colour, frame: Colour, lean: float
) -> None:
    """Draw one window; `box` is left, top, right, bottom as fractions of the patch."""
    height, width = patch.shape[:2]
    x0, x1 = round(box[0] * width), round(box[2] * width)
    y0, y1 = round(box[1] * height), round(box[3] * height)
    patch[y0 - 2 : y1 + 3, x0 - 2 : x1 + 2] = frame
    shade = np.linspace(1.35, 0.8, y1 - y0)[:, None, None] * lean
    patch[y0:y1, x0:x1] = np.clip(np.array(glass) * shade, 0, 255)
    middle = (x0 + x1) // 2
    patch[y0:y1, middle : middle + 1] = frame


_FACADES: tuple[tuple[Colour, Colour, Colour], ...] = (
    ((164, 98, 76), (58, 72, 88), (226, 220, 210)),
    ((200, 190, 168), (70, 88, 104), (122, 112, 102)),
    ((122, 130, 136), (92, 118, 136), (70, 74, 78)),
    ((208, 200, 192), (46, 56, 66), (238, 236, 230)),
    ((186, 160, 128), (56, 70, 84), (232, 226, 214)),
    ((150, 86, 66), (64, 80, 96), (214, 206, 194)),
)


def _facade(patch: Image, name: str, _: dict[str, Colour], rng: np.random.Generator) -> None:
    wall, glass, frame = _FACADES[int(name[-1])]
    _grain(patch, wall, 4.0, rng)
    if name[-1] in "05":
        patch[::4] = np.clip(patch[::4].astype(int) - 12, 0, 255)
    patch[-5:] = np.clip(patch[-5:].astype(int) - 26, 0, 255)
    for left in (0.12, 0.58):
        _window(patch, (left, 0.2, left + 0.3, 0.78), glass, frame, float(rng.uniform(0.8, 1.25)))


_HOUSES: tuple[tuple[Colour, Colour], ...] = (
    ((168, 102, 80), (236, 232, 224)),
    ((228, 214, 180), (120, 84, 58)),
    ((226, 224, 218), (70, 84, 96)),
)


def _house(patch: Image, name: str, _: dict[str, Colour], rng: np.random.Generator) -> None:
    wall, frame = _HOUSES[int(name[-1])]
    _grain(patch, wall, 4.0, rng)
    if name[-1] == "0":
        patch[::4] = np.clip(patch[::4].astype(int) - 12, 0, 255)
    for left in (0.12, 0.62):
        _window(patch, (left, 0.22, left + 0.26, 0.76), (62, 78, 92), frame, 1.0)


def _door(patch: Image, name: str, colours: dict[str, Colour], rng: np.random.Generator) -> None:
    wall, frame = _HOUSES[int(name[-1])]
    _grain(patch, wall, 4.0, rng)
    if name[-1] == "0":
        patch[::4] = np.clip(patch[::4].astype(int) - 12, 0, 255)
    _window(patch, (0.10, 0.22, 0.36, 0.76), (62, 78, 92), frame, 1.0)
    patch[16:, 116:152] = (240, 238, 230)
    patch[20:, 120:148] = (colours["door"], (46, 84, 70), (40, 58, 96))[int(name[-1])]
    patch[56:60, 142:146] = (220, 200, 120)


def _limit(patch: Image, _: str, __: dict[str, Colour], ___: np.random.Generator) -> None:
    import cv2

    patch[:] = (126, 128, 130)
    cv2.circle(patch, (32, 32), 31, (206, 24, 28), -1, cv2.LINE_AA)
    cv2.circle(patch, (32, 32), 23, (248, 248, 244), -1, cv2.LINE_AA)
    _text(patch[:, 12:-12], "50", (16, 16, 18), size=0.4)


def _gantry(patch: Image, _: str, __: dict[str, Colour], ___: np.random.Generator) -> None:
    import cv2

    patch[:] = (24, 84, 164)
    cv2.rectangle(patch, (4, 4), (251, 91), (246, 246, 246), 2)
    _text(patch[:, 10:-90], "NORTH", (250, 250, 250), middle=0.33, size=0.26)
    _text(patch[:, 10:-90], "AIRPORT", (250, 250, 250), middle=0.68, size=0.26)
    cv2.arrowedLine(patch, (206, 78), (206, 20), (250, 250, 250), 8, cv2.LINE_AA, 0, 0.4)


_SHOPS: tuple[tuple[str, Colour], ...] = (
    ("B A K E R Y", (40, 92, 84)),
    ("B O O K S", (126, 44, 50)),
    ("C A F E", (62, 62, 70)),
    ("P H A R M A C Y", (46, 110, 60)),
)


def _shop(patch: Image, name: str, __: dict[str, Colour], rng: np.random.Generator) -> None:
    _grain(patch, (112, 104, 98), 3.0, rng)
    words, ground = _SHOPS[int(name[-1])]
    patch[6:26] = ground
    _text(patch[6:26], words, (240, 232, 200), size=0.6)
    for left in (0.05, 0.68):
        _window(patch, (left, 0.36, left + 0.27, 0.94), (96, 116, 128), (60, 52, 46), 1.0)
    patch[36:, 78:114] = (58, 46, 40)
    patch[42:88, 84:108] = (110, 130, 140)


_PAINTERS = {
    "plate": _plate,
    "police": _livery,
    "ambulance": _livery,
    "fire": _livery,
    "checks": _checks,
    "chevrons": _chevrons,
    "stripes": _stripes,
    "box": _box,
    "road": _road,
    "detour": _detour,
    "arrow": _arrow,
    "grille": _grille,
    "asphalt": _asphalt,
    "paving": _paving,
    "turf": _turf,
    "gravel": _gravel,
    "facade": _facade,
    "house": _house,
    "door": _door,
    "limit": _limit,
    "gantry": _gantry,
    "shop": _shop,
    "sign": paint_sign,
}
