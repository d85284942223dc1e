"""The printed regions of the atlas: plates, liveries, surfaces and facades; signs are beside."""

from collections.abc import Callable, Mapping

import numpy as np

from oodscen_pybullet._meshes.sign_textures import Colour, Image, paint_sign, write

Rng = np.random.Generator
Painter = Callable[[Image, dict[str, Colour], Rng], None]

_RED: Colour = (214, 30, 30)
_SIGN_BLACK: Colour = (16, 16, 18)


def paint_regions(
    image: Image, regions: Mapping[str, tuple[int, int, int, int]], colours: dict[str, Colour]
) -> None:
    """Paint every region into the atlas, in place."""
    rng = np.random.Generator(np.random.PCG64(7))
    for name, (x, y, width, height) in regions.items():
        tile = image[y : y + height, x : x + width]
        tile[:] = 200
        patch = np.ascontiguousarray(tile)
        if name.startswith("sign_"):
            paint_sign(patch, name)
        else:
            _PAINTERS[name](patch, colours, rng)
        tile[:] = patch


def _plate(ground: Colour) -> Painter:
    def paint(patch: Image, colours: dict[str, Colour], rng: Rng) -> None:
        patch[:] = ground
        patch[[0, 1, -2, -1]] = 20
        patch[:, [0, 1, -2, -1]] = 20
        write(patch, "OD 53 SCN", (20, 20, 24), height=0.6)

    return paint


def _livery(words: str, ground: Colour | str, ink: Colour) -> Painter:
    """Return a painter of a word on a ground, which may be a colour of the atlas."""

    def paint(patch: Image, colours: dict[str, Colour], rng: Rng) -> None:
        patch[:] = colours[ground] if isinstance(ground, str) else ground
        write(patch, words, ink)

    return paint


def _checks(patch: Image, colours: dict[str, Colour], rng: Rng) -> None:
    y, x = np.mgrid[0 : patch.shape[0], 0 : patch.shape[1]]
    cell = patch.shape[0] // 2
    is_yellow = (y // cell + x // cell) % 2 == 1
    patch[:] = np.where(is_yellow[..., None], colours["fluor_yellow"], colours["blue"])


def _chevrons(patch: Image, colours: dict[str, Colour], rng: Rng) -> None:
    y, x = np.mgrid[0 : patch.shape[0], 0 : patch.shape[1]]
    is_red = ((x + np.abs(y - patch.shape[0] // 2)) // 16) % 2 == 0
    patch[:] = np.where(is_red[..., None], _RED, (246, 214, 40))


def _stripes(patch: Image, colours: dict[str, Colour], rng: Rng) -> None:
    y, x = np.mgrid[0 : patch.shape[0], 0 : patch.shape[1]]
    is_red = ((x + y) // 16) % 2 == 0
    patch[:] = np.where(is_red[..., None], _RED, (246, 246, 240))


def _box(patch: Image, colours: dict[str, Colour], rng: Rng) -> None:
    import cv2

    ink = (96, 66, 34)
    patch[:] = colours["cardboard"]
    for x in (26, 48):
        cv2.arrowedLine(patch, (x, 44), (x, 14), ink, 4, cv2.LINE_AA, 0, 0.42)
    cv2.line(patch, (14, 50), (60, 50), ink, 3)
    write(patch, "THIS SIDE UP", ink, middle=0.68, height=0.14)
    write(patch, "FRAGILE", ink, middle=0.84, height=0.15)


def _road_closed(patch: Image, colours: dict[str, Colour], rng: Rng) -> None:
    import cv2

    patch[:] = (248, 248, 244)
    height, width = patch.shape[:2]
    cv2.rectangle(patch, (5, 5), (width - 6, height - 6), (200, 20, 24), 7)
    write(patch[:, 24:-24], "ROAD", _SIGN_BLACK, middle=0.31, height=0.28)
    write(patch[:, 24:-24], "CLOSED", _SIGN_BLACK, middle=0.70, height=0.28)


def _detour(patch: Image, colours: dict[str, Colour], rng: Rng) -> None:
    import cv2

    patch[:] = (248, 132, 20)
    height, width = patch.shape[:2]
    cv2.rectangle(patch, (5, 5), (width - 6, height - 6), _SIGN_BLACK, 5)
    write(patch[:, 20:-20], "DETOUR", _SIGN_BLACK, middle=0.3, height=0.3)
    start, end = (44, round(height * 0.72)), (width - 40, round(height * 0.72))
    cv2.arrowedLine(patch, start, end, _SIGN_BLACK, 14, cv2.LINE_AA, 0, 0.2)


def _arrow(*, is_left: bool) -> Painter:
    """Return a painter of an arrow of lamps."""

    def paint(patch: Image, colours: dict[str, Colour], rng: Rng) -> None:
        import cv2

        height, width = patch.shape[:2]
        patch[:] = (22, 22, 24)
        points = [(0.18 + 0.09 * i, 0.5) for i in range(8)]
        points += [(0.27, 0.30), (0.36, 0.14), (0.27, 0.70), (0.36, 0.86)]
        for across, down in points:
            x = across if is_left else 1 - across
            spot = (round(x * width), round(down * height))
            cv2.circle(patch, spot, 9, colours["amber_lit"], -1, cv2.LINE_AA)

    return paint


def _grille(patch: Image, colours: dict[str, Colour], rng: Rng) -> None:
    patch[:] = (34, 34, 38)
    patch[4::6] = (112, 114, 118)
    patch[:, 47:49] = (170, 172, 176)


def _grain(patch: Image, colour: Colour, spread: float, rng: Rng) -> None:
    noise = rng.normal(0.0, spread, (*patch.shape[:2], 1))
    patch[:] = np.clip(np.array(colour) + noise, 0, 255)


def _grained(colour: str, spread: float) -> Painter:
    """Return a painter of a rough surface."""

    def paint(patch: Image, colours: dict[str, Colour], rng: Rng) -> None:
        _grain(patch, colours[colour], spread, rng)

    return paint


def _asphalt_worn(patch: Image, colours: dict[str, Colour], rng: Rng) -> None:
    import cv2

    _grain(patch, colours["asphalt"], 4.0, rng)
    for _ in range(3):
        points = np.cumsum(rng.integers(-9, 10, (14, 2)), axis=0) + 64
        cv2.polylines(patch, [points.astype(np.int32)], False, colours["asphalt_dark"], 1)


def _paving(patch: Image, colours: dict[str, Colour], rng: Rng) -> None:
    _grain(patch, colours["pavement"], 3.0, rng)
    for k in range(0, 128, 32):
        patch[k : k + 2] = colours["pavement_dark"]
        patch[:, k : k + 2] = colours["pavement_dark"]


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


def _wall(patch: Image, colour: Colour, rng: Rng, *, is_brick: bool) -> None:
    _grain(patch, colour, 4.0, rng)
    if is_brick:
        patch[::4] = np.clip(patch[::4].astype(int) - 12, 0, 255)


def _facade(wall: Colour, glass: Colour, frame: Colour, *, is_brick: bool = False) -> Painter:
    """Return a painter of one storey with two windows."""

    def paint(patch: Image, colours: dict[str, Colour], rng: Rng) -> None:
        _wall(patch, wall, rng, is_brick=is_brick)
        patch[-5:] = np.clip(patch[-5:].astype(int) - 26, 0, 255)
        for left in (0.12, 0.58):
            lean = float(rng.uniform(0.8, 1.25))
            _window(patch, (left, 0.2, left + 0.3, 0.78), glass, frame, lean)

    return paint


_PANE: Colour = (62, 78, 92)


def _house(wall: Colour, frame: Colour, *, is_brick: bool = False) -> Painter:
    """Return a painter of a house's side with two windows."""

    def paint(patch: Image, colours: dict[str, Colour], rng: Rng) -> None:
        _wall(patch, wall, rng, is_brick=is_brick)
        for left in (0.12, 0.62):
            _window(patch, (left, 0.22, left + 0.26, 0.76), _PANE, frame, 1.0)

    return paint


def _door(
    wall: Colour, frame: Colour, door: Colour | None = None, *, is_brick: bool = False
) -> Painter:
    """Return a painter of a house's front with a window and a door."""

    def paint(patch: Image, colours: dict[str, Colour], rng: Rng) -> None:
        _wall(patch, wall, rng, is_brick=is_brick)
        _window(patch, (0.10, 0.22, 0.36, 0.76), _PANE, frame, 1.0)
        patch[16:, 116:152] = (240, 238, 230)
        patch[20:, 120:148] = door or colours["door"]
        patch[56:60, 142:146] = (220, 200, 120)

    return paint


def _limit(patch: Image, colours: dict[str, Colour], rng: Rng) -> None:
    import cv2

    patch[:] = (126, 128, 130)
    cv2.circle(patch, (32, 32), 31, (206, 24, 28), -1, cv2.LINE_AA)
    cv2.circle(patch, (32, 32), 23, (248, 248, 244), -1, cv2.LINE_AA)
    write(patch[:, 12:-12], "50", _SIGN_BLACK, height=0.4)


def _gantry(patch: Image, colours: dict[str, Colour], rng: Rng) -> None:
    import cv2

    white = (250, 250, 250)
    patch[:] = (24, 84, 164)
    cv2.rectangle(patch, (4, 4), (251, 91), (246, 246, 246), 2)
    write(patch[:, 10:-90], "NORTH", white, middle=0.33, height=0.26)
    write(patch[:, 10:-90], "AIRPORT", white, middle=0.68, height=0.26)
    cv2.arrowedLine(patch, (206, 78), (206, 20), white, 8, cv2.LINE_AA, 0, 0.4)


def _shop(words: str, ground: Colour) -> Painter:
    """Return a painter of a shop front with its name."""

    def paint(patch: Image, colours: dict[str, Colour], rng: Rng) -> None:
        _grain(patch, (112, 104, 98), 3.0, rng)
        patch[6:26] = ground
        write(patch[6:26], words, (240, 232, 200), height=0.6)
        for left in (0.05, 0.68):
            _window(patch, (left, 0.36, left + 0.27, 0.94), (96, 116, 128), (60, 52, 46), 1.0)
        patch[36:, 78:114] = (58, 46, 40)
        patch[42:88, 84:108] = (110, 130, 140)

    return paint


_BRICK, _CREAM, _PLASTER = (168, 102, 80), (228, 214, 180), (226, 224, 218)

_PAINTERS: dict[str, Painter] = {
    "plate": _plate((246, 246, 240)),
    "plate_rear": _plate((250, 214, 60)),
    "police": _livery("POLICE", "navy", (250, 250, 250)),
    "police_back": _livery("POLICE", (224, 240, 60), (24, 30, 60)),
    "ambulance": _livery("AMBULANCE", (246, 246, 240), (196, 20, 24)),
    "fire": _livery("FIRE", (244, 208, 40), (170, 16, 20)),
    "checks": _checks,
    "chevrons": _chevrons,
    "stripes": _stripes,
    "box_print": _box,
    "road_closed": _road_closed,
    "detour": _detour,
    "arrow_left": _arrow(is_left=True),
    "arrow_right": _arrow(is_left=False),
    "grille": _grille,
    "asphalt": _grained("asphalt", 4.0),
    "asphalt_worn": _asphalt_worn,
    "paving": _paving,
    "turf": _grained("grass", 7.0),
    "gravel": _grained("gravel", 9.0),
    "facade_0": _facade((164, 98, 76), (58, 72, 88), (226, 220, 210), is_brick=True),
    "facade_1": _facade((200, 190, 168), (70, 88, 104), (122, 112, 102)),
    "facade_2": _facade((122, 130, 136), (92, 118, 136), (70, 74, 78)),
    "facade_3": _facade((208, 200, 192), (46, 56, 66), (238, 236, 230)),
    "facade_4": _facade((186, 160, 128), (56, 70, 84), (232, 226, 214)),
    "facade_5": _facade((150, 86, 66), (64, 80, 96), (214, 206, 194), is_brick=True),
    "house_0": _house(_BRICK, (236, 232, 224), is_brick=True),
    "house_1": _house(_CREAM, (120, 84, 58)),
    "house_2": _house(_PLASTER, (70, 84, 96)),
    "door_0": _door(_BRICK, (236, 232, 224), is_brick=True),
    "door_1": _door(_CREAM, (120, 84, 58), (46, 84, 70)),
    "door_2": _door(_PLASTER, (70, 84, 96), (40, 58, 96)),
    "limit": _limit,
    "gantry": _gantry,
    "shop_0": _shop("B A K E R Y", (40, 92, 84)),
    "shop_1": _shop("B O O K S", (126, 44, 50)),
    "shop_2": _shop("C A F E", (62, 62, 70)),
    "shop_3": _shop("P H A R M A C Y", (46, 110, 60)),
}
