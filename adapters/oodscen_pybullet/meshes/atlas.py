"""The one texture that everything shares: a palette of colours, printed faces and facades."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

SIZE = 1024
"""Width and height of the atlas, pixels."""
SWATCH = 16
"""Width and height of one colour, pixels."""

COLOURS: dict[str, tuple[int, int, int]] = {
    "white": (238, 238, 234),
    "black": (26, 26, 29),
    "grey": (126, 128, 130),
    "dark_grey": (66, 68, 72),
    "light_grey": (186, 188, 188),
    "silver": (172, 178, 184),
    "red": (186, 28, 34),
    "blue": (36, 74, 164),
    "navy": (32, 42, 84),
    "green": (38, 118, 62),
    "yellow": (244, 200, 28),
    "orange": (242, 104, 20),
    "fluor_orange": (255, 112, 28),
    "fluor_yellow": (214, 244, 40),
    "teal": (38, 128, 132),
    "sand": (196, 178, 140),
    "burgundy": (112, 26, 40),
    "glass": (44, 56, 70),
    "glass_light": (96, 118, 138),
    "tyre": (26, 26, 28),
    "hub": (160, 162, 166),
    "dirty_hub": (84, 80, 74),
    "underbody": (48, 46, 44),
    "exhaust": (120, 96, 76),
    "tail": (150, 14, 20),
    "tail_lit": (255, 40, 36),
    "brake_lit": (255, 72, 60),
    "head": (226, 232, 236),
    "head_lit": (255, 252, 232),
    "amber": (206, 120, 20),
    "amber_lit": (255, 184, 40),
    "beacon": (30, 70, 190),
    "beacon_lit": (90, 160, 255),
    "beacon_red": (190, 24, 30),
    "beacon_red_lit": (255, 80, 70),
    "reflector": (238, 60, 40),
    "skin": (216, 168, 134),
    "skin_dark": (128, 86, 62),
    "hair": (50, 36, 26),
    "hair_fair": (186, 150, 92),
    "jeans": (48, 66, 108),
    "trousers": (64, 60, 56),
    "coat": (84, 40, 60),
    "shirt": (66, 132, 150),
    "shirt_red": (176, 52, 46),
    "shirt_green": (74, 120, 66),
    "shirt_white": (224, 222, 214),
    "uniform": (28, 36, 66),
    "shoe": (34, 30, 30),
    "bag": (112, 70, 38),
    "deer": (150, 102, 62),
    "deer_dark": (108, 74, 48),
    "deer_pale": (222, 202, 172),
    "antler": (204, 184, 150),
    "dog": (146, 96, 52),
    "dog_dark": (84, 54, 32),
    "cow_white": (232, 228, 220),
    "cow_black": (38, 34, 34),
    "cow_pink": (220, 166, 156),
    "cardboard": (192, 150, 98),
    "cardboard_dark": (158, 118, 72),
    "cardboard_inside": (122, 90, 56),
    "tape": (222, 198, 150),
    "terracotta": (184, 96, 60),
    "soil": (70, 50, 36),
    "leaf": (64, 118, 50),
    "leaf_dark": (44, 90, 40),
    "leaf_light": (98, 146, 62),
    "needle": (38, 78, 52),
    "bark": (98, 74, 54),
    "bark_dark": (72, 54, 40),
    "wood": (198, 158, 104),
    "wood_dark": (152, 112, 68),
    "wood_fresh": (228, 196, 142),
    "mattress": (236, 232, 222),
    "mattress_edge": (150, 172, 204),
    "mattress_stripe": (176, 194, 220),
    "sofa": (156, 60, 52),
    "sofa_dark": (120, 42, 38),
    "rock": (134, 128, 120),
    "rock_dark": (104, 100, 96),
    "rust": (140, 78, 46),
    "metal": (148, 154, 160),
    "bin_green": (44, 96, 58),
    "bin_dark": (32, 70, 42),
    "snow": (240, 244, 250),
    "snow_shade": (206, 216, 232),
    "water": (92, 112, 136),
    "water_light": (146, 168, 190),
    "machine": (240, 176, 20),
    "machine_dark": (176, 124, 16),
    "fire_red": (196, 24, 24),
    "asphalt": (82, 83, 86),
    "asphalt_dark": (72, 73, 76),
    "asphalt_light": (94, 95, 97),
    "mark": (236, 236, 230),
    "mark_worn": (176, 176, 172),
    "pavement": (166, 163, 156),
    "pavement_dark": (148, 145, 139),
    "kerb": (192, 190, 184),
    "kerb_side": (140, 138, 134),
    "gravel": (160, 148, 128),
    "grass": (104, 140, 66),
    "grass_dark": (88, 124, 56),
    "field": (172, 160, 92),
    "earth": (126, 104, 76),
    "concrete": (176, 174, 168),
    "concrete_dark": (140, 138, 134),
    "rail": (188, 194, 198),
    "post": (110, 114, 118),
    "lamp_glass": (250, 238, 200),
    "fence": (138, 104, 70),
    "roof_red": (150, 70, 52),
    "roof_grey": (92, 90, 92),
    "roof_brown": (112, 82, 66),
    "wall_brick": (162, 94, 72),
    "wall_cream": (224, 208, 174),
    "wall_white": (226, 224, 216),
    "wall_grey": (146, 150, 154),
    "door": (92, 50, 36),
    "hedge": (58, 98, 46),
    "hill": (116, 138, 112),
    "bear": (84, 60, 42),
    "boar": (70, 60, 52),
    "horse": (122, 70, 38),
    "wool": (226, 220, 204),
    "cat": (216, 138, 62),
    "cat_dark": (172, 96, 36),
    "pink": (230, 120, 160),
    "purple": (112, 56, 140),
    "sky_blue": (96, 160, 216),
    "lime": (150, 200, 60),
    "char": (40, 36, 34),
    "ash": (98, 94, 90),
    "flame": (255, 176, 60),
    "ember": (232, 88, 28),
    "oil": (22, 20, 26),
    "oil_sheen": (74, 52, 104),
    "hole": (34, 32, 32),
    "mud": (112, 96, 72),
    "flood": (138, 112, 70),
    "flood_light": (172, 150, 108),
    "school_bus": (248, 176, 16),
    "taxi": (250, 204, 28),
    "garbage": (60, 120, 76),
    "red_lit": (255, 64, 52),
    "green_lit": (70, 240, 130),
    "lens_red": (88, 18, 20),
    "lens_amber": (96, 66, 16),
    "lens_green": (18, 70, 42),
    "screen_lit": (250, 196, 70),
    "balloon": (230, 40, 50),
    "leaf_autumn": (200, 112, 34),
    "leaf_yellow": (214, 168, 52),
    "straw": (206, 178, 96),
    "sack": (186, 160, 118),
    "plastic": (216, 226, 232),
    "lit_window": (255, 212, 132),
    "lit_window_cool": (226, 232, 214),
    "lamp_on": (255, 240, 200),
    "tunnel": (58, 58, 60),
    "tunnel_dark": (40, 40, 43),
    "tunnel_light": (92, 90, 84),
    "asphalt_tunnel": (46, 46, 48),
    "mark_tunnel": (150, 150, 144),
    "crop": (120, 150, 62),
    "wall_blue": (150, 170, 186),
    "wall_ochre": (206, 168, 104),
    "awning_red": (176, 52, 48),
    "awning_green": (52, 110, 78),
}
"""Red, green, blue of every colour by name."""

SNOWED: dict[str, tuple[int, int, int]] = {
    "asphalt": (198, 204, 212),
    "asphalt_dark": (176, 182, 190),
    "asphalt_light": (216, 221, 228),
    "mark": (212, 216, 222),
    "mark_worn": (206, 211, 218),
    "pavement": (230, 234, 240),
    "pavement_dark": (220, 225, 232),
    "kerb": (234, 238, 243),
    "kerb_side": (190, 196, 204),
    "gravel": (228, 232, 238),
    "grass": (240, 243, 248),
    "grass_dark": (230, 235, 242),
    "field": (242, 245, 250),
    "earth": (222, 226, 232),
    "leaf": (176, 190, 188),
    "leaf_light": (214, 222, 226),
    "leaf_dark": (148, 168, 160),
    "concrete": (214, 217, 222),
    "hedge": (196, 206, 206),
    "needle": (120, 144, 140),
    "roof_red": (234, 238, 244),
    "roof_grey": (236, 240, 246),
    "roof_brown": (232, 236, 242),
    "hill": (206, 214, 224),
    "crop": (238, 242, 247),
}
"""What lying snow makes of the colours that it covers."""

_NAMES = tuple(COLOURS)

EMISSIVE: frozenset[str] = frozenset(
    {
        "tail_lit", "brake_lit", "head_lit", "red_lit", "green_lit", "screen_lit", "flame", "ember", "amber_lit", "beacon_lit", "beacon_red_lit",
        "arrow_left", "arrow_right", "lit_window", "lit_window_cool", "lamp_on",
    }
)  # fmt: skip
"""Colours and regions that shine by themselves: night does not darken them."""

REGIONS: dict[str, tuple[int, int, int, int]] = {
    "plate": (0, 64, 96, 24),
    "plate_rear": (100, 64, 96, 24),
    "police": (200, 64, 160, 36),
    "ambulance": (364, 64, 200, 36),
    "fire": (568, 64, 120, 36),
    "checks": (692, 64, 128, 32),
    "chevrons": (824, 64, 128, 32),
    "box_print": (0, 112, 96, 96),
    "road_closed": (100, 112, 256, 128),
    "detour": (360, 112, 256, 128),
    "arrow_left": (620, 112, 192, 128),
    "arrow_right": (816, 112, 192, 128),
    "grille": (0, 216, 96, 24),
    "asphalt": (0, 256, 128, 128),
    "asphalt_worn": (132, 256, 128, 128),
    "paving": (264, 256, 128, 128),
    "turf": (396, 256, 128, 128),
    "gravel": (528, 256, 128, 128),
    "police_back": (664, 256, 128, 64),
    "shop_0": (796, 256, 192, 96),
    "shop_1": (796, 400, 192, 96),
    "shop_2": (460, 660, 192, 96),
    "shop_3": (0, 780, 192, 96),
    "facade_0": (0, 400, 128, 128),
    "facade_1": (132, 400, 128, 128),
    "facade_2": (264, 400, 128, 128),
    "facade_3": (396, 400, 128, 128),
    "facade_4": (528, 400, 128, 128),
    "facade_5": (660, 400, 128, 128),
    "house_0": (0, 540, 192, 96),
    "house_1": (196, 540, 192, 96),
    "house_2": (392, 540, 192, 96),
    "door_0": (588, 540, 192, 96),
    "door_1": (784, 540, 192, 96),
    "door_2": (784, 640, 192, 96),
    "limit": (132, 660, 64, 64),
    "gantry": (200, 660, 256, 96),
    "stripes": (0, 660, 128, 16),
    "sign_stop": (200, 780, 96, 96),
    "sign_yield": (300, 780, 96, 96),
    "sign_limit": (400, 780, 96, 96),
    "sign_entry": (500, 780, 96, 96),
    "sign_works": (600, 780, 96, 96),
    "sign_warning": (700, 780, 96, 96),
    "sign_oneway": (800, 740, 128, 48),
    "sign_placard": (800, 792, 160, 112),
    "sign_school": (0, 884, 192, 36),
    "sign_taxi": (200, 884, 96, 32),
    "sign_rail": (300, 884, 96, 96),
    "sign_tram": (400, 884, 160, 32),
    "sign_fuel": (564, 884, 160, 40),
    "sign_parcel": (400, 920, 160, 60),
    "sign_man": (0, 924, 48, 48),
    "sign_walker": (52, 924, 48, 48),
    "sign_checks": (104, 924, 96, 16),
    "sign_danger": (104, 944, 48, 48),
}
"""x, y, width, height of every printed region, pixels from the top left."""


def swatch_uv(colour: str) -> NDArray[np.float64]:
    """Return where the middle of a colour is: [2], v upwards."""
    index = _NAMES.index(colour)
    column, row = index % (SIZE // SWATCH), index // (SIZE // SWATCH)
    return np.array([(column + 0.5) * SWATCH / SIZE, 1 - (row + 0.5) * SWATCH / SIZE])


def region_uv(name: str) -> NDArray[np.float64]:
    """Return the corners of a region: [4, 2], from the bottom left counter-clockwise."""
    x, y, width, height = REGIONS[name]
    left, right = (x + 0.5) / SIZE, (x + width - 0.5) / SIZE
    top, bottom = 1 - (y + 0.5) / SIZE, 1 - (y + height - 0.5) / SIZE
    return np.array([[left, bottom], [right, bottom], [right, top], [left, top]])


@lru_cache(maxsize=2)
def draw_atlas(is_snowy: bool) -> NDArray[np.uint8]:
    """Paint the atlas: [SIZE, SIZE, 3] RGB; the same bytes on every call."""
    from oodscen_pybullet.meshes.prints import paint_regions

    image = np.zeros((SIZE, SIZE, 3), np.uint8)
    colours = {**COLOURS, **SNOWED} if is_snowy else COLOURS
    for index, name in enumerate(_NAMES):
        row, column = divmod(index, SIZE // SWATCH)
        image[row * SWATCH : (row + 1) * SWATCH, column * SWATCH : (column + 1) * SWATCH] = colours[
            name
        ]
    paint_regions(image, colours)
    image.flags.writeable = False
    return image
