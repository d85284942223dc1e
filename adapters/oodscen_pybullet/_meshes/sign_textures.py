"""The faces of signs, placards and lettering, painted into the atlas."""

from collections.abc import Callable

import numpy as np

from oodscen_pybullet._types import U8

Image = U8
Colour = tuple[int, int, int]

RED: Colour = (200, 22, 28)
WHITE: Colour = (248, 248, 244)
BLACK: Colour = (18, 18, 20)
BACK: Colour = (126, 128, 130)


def write(
    patch: Image, words: str, ink: Colour, *, middle: float = 0.5, height: float = 0.7,
    width: float = 0.92, weight: float = 1.8,
) -> None:  # fmt: skip
    """Write one line as large as fits.

    Args:
        patch: The pixels, changed in place.
        words: The line.
        ink: Its colour.
        middle: Its height from the top, as a fraction of the patch's.
        height: Its largest height, as a fraction of the patch's.
        width: Its largest width, as a fraction of the patch's.
        weight: Thickness of the strokes at size 1.
    """
    import cv2

    tall, wide = patch.shape[:2]
    font = cv2.FONT_HERSHEY_DUPLEX
    (span, rise), _ = cv2.getTextSize(words, font, 1.0, round(weight))
    scale = min(width * wide / span, height * tall / rise)
    bold = max(1, round(weight * scale))
    (span, rise), _ = cv2.getTextSize(words, font, scale, bold)
    place = (round((wide - span) / 2), round(tall * middle + rise / 2))
    cv2.putText(patch, words, place, font, scale, ink, bold, cv2.LINE_AA)


def _shape(patch: Image, corners: list[tuple[float, float]], ink: Colour) -> None:
    """Fill a polygon; corners are fractions of width and height from the top left."""
    import cv2

    tall, wide = patch.shape[:2]
    points = np.array([(round(x * (wide - 1)), round(y * (tall - 1))) for x, y in corners])
    cv2.fillPoly(patch, [points.astype(np.int32)], ink, cv2.LINE_AA)


def _octagon(inset: float) -> list[tuple[float, float]]:
    a, b, c, d = inset, 0.293, 0.707, 1.0 - inset
    return [(b, a), (c, a), (d, b), (d, c), (c, d), (b, d), (a, c), (a, b)]


def _stop(patch: Image) -> None:
    _shape(patch, _octagon(0.0), WHITE)
    _shape(patch, _octagon(0.04), RED)
    write(patch, "STOP", WHITE, height=0.34, width=0.8, weight=3)


def _triangle(inset: float, *, is_down: bool) -> list[tuple[float, float]]:
    top, low, side = 0.02 + 0.9 * inset, 0.9 - 0.55 * inset, 0.02 + 0.9 * inset
    rows = [(0.5, top), (1 - side, low), (side, low)]
    return [(x, 1 - y) for x, y in rows] if is_down else rows


def _yield(patch: Image) -> None:
    _shape(patch, _triangle(0.0, is_down=True), RED)
    _shape(patch, _triangle(0.22, is_down=True), WHITE)


def _warn(patch: Image) -> None:
    _shape(patch, _triangle(0.0, is_down=False), RED)
    _shape(patch, _triangle(0.16, is_down=False), WHITE)


def _warning(patch: Image) -> None:
    import cv2

    _warn(patch)
    _shape(patch, [(0.455, 0.38), (0.545, 0.38), (0.525, 0.64), (0.475, 0.64)], BLACK)
    cv2.circle(patch, (48, 69), 4, BLACK, -1, cv2.LINE_AA)


def _works(patch: Image) -> None:
    import cv2

    _warn(patch)
    cv2.circle(patch, (44, 38), 4, BLACK, -1, cv2.LINE_AA)
    cv2.line(patch, (43, 44), (38, 60), BLACK, 6, cv2.LINE_AA)
    cv2.line(patch, (39, 58), (45, 73), BLACK, 4, cv2.LINE_AA)
    cv2.line(patch, (38, 58), (31, 73), BLACK, 4, cv2.LINE_AA)
    cv2.line(patch, (43, 47), (58, 60), BLACK, 3, cv2.LINE_AA)
    cv2.line(patch, (42, 54), (62, 66), BLACK, 2, cv2.LINE_AA)
    _shape(patch, [(0.58, 0.77), (0.66, 0.66), (0.76, 0.77)], BLACK)


def _round(patch: Image, rim: Colour, ground: Colour, share: float) -> None:
    import cv2

    middle, radius = (patch.shape[1] // 2, patch.shape[0] // 2), patch.shape[0] // 2 - 1
    cv2.circle(patch, middle, radius, rim, -1, cv2.LINE_AA)
    cv2.circle(patch, middle, round(radius * share), ground, -1, cv2.LINE_AA)


def _limit(patch: Image) -> None:
    _round(patch, RED, WHITE, 0.76)
    write(patch, "30", BLACK, height=0.38, width=0.62, weight=3)


def _entry(patch: Image) -> None:
    _round(patch, WHITE, RED, 0.95)
    _shape(patch, [(0.18, 0.41), (0.82, 0.41), (0.82, 0.59), (0.18, 0.59)], WHITE)


def _oneway(patch: Image) -> None:
    patch[:] = (28, 82, 168)
    patch[2:-2, 2:4] = patch[2:-2, -4:-2] = WHITE
    patch[2:4, 2:-2] = patch[-4:-2, 2:-2] = WHITE
    arrow = [
        (0.06, 0.36),
        (0.72, 0.36),
        (0.72, 0.14),
        (0.95, 0.5),
        (0.72, 0.86),
        (0.72, 0.64),
        (0.06, 0.64),
    ]
    _shape(patch, arrow, WHITE)
    write(patch[:, :92], "ONE WAY", (28, 82, 168), height=0.2, width=0.85, weight=2)


def _placard(patch: Image) -> None:
    patch[:] = (250, 248, 236)
    patch[:3] = patch[-3:] = patch[:, :3] = patch[:, -3:] = (60, 50, 40)
    write(patch, "STOP", RED, middle=0.28, height=0.3, weight=4, width=0.9)
    write(patch, "THE", BLACK, middle=0.53, height=0.13, weight=2, width=0.9)
    write(patch, "CARS!", BLACK, middle=0.77, height=0.26, weight=4, width=0.9)


def _rail(patch: Image) -> None:
    import cv2

    for one, two in (((8, 20), (88, 76)), ((8, 76), (88, 20))):
        cv2.line(patch, one, two, RED, 22, cv2.LINE_AA)
        cv2.line(patch, one, two, WHITE, 14, cv2.LINE_AA)


def _figure(ink: Colour, spread: int) -> Callable[[Image], None]:
    """Return a painter of a lit person whose legs are spread by some pixels."""

    def paint(patch: Image) -> None:
        import cv2

        patch[:] = BLACK
        cv2.circle(patch, (24, 9), 5, ink, -1, cv2.LINE_AA)
        cv2.line(patch, (24, 16), (24, 28), ink, 8, cv2.LINE_AA)
        for side in (-1, 1):
            foot, hand = (24 + side * (3 + spread), 44), (24 + side * (6 + spread), 29)
            cv2.line(patch, (24, 28), foot, ink, 5, cv2.LINE_AA)
            cv2.line(patch, (24 + side * 3, 17), hand, ink, 3, cv2.LINE_AA)

    return paint


def _board(
    ground: Colour, words: str, ink: Colour, height: float, *, weight: int = 3
) -> Callable[[Image], None]:
    """Return a painter of a board with one line."""

    def paint(patch: Image) -> None:
        patch[:] = ground
        write(patch, words, ink, height=height, width=0.9, weight=weight)

    return paint


def _checks(patch: Image) -> None:
    y, x = np.mgrid[0 : patch.shape[0], 0 : patch.shape[1]]
    dark = (x // 8 + y // 8) % 2 == 0
    patch[:] = np.where(dark[..., None], BLACK, WHITE)


def _danger(patch: Image) -> None:
    _shape(patch, [(0.5, 0.0), (1.0, 0.5), (0.5, 1.0), (0.0, 0.5)], (240, 110, 20))
    write(patch, "3", BLACK, height=0.36, weight=2, width=0.9)


_FACES: dict[str, Callable[[Image], None]] = {
    "stop": _stop,
    "yield": _yield,
    "limit": _limit,
    "entry": _entry,
    "works": _works,
    "warning": _warning,
    "oneway": _oneway,
    "placard": _placard,
    "rail": _rail,
    "checks": _checks,
    "danger": _danger,
    "school": _board((248, 176, 16), "SCHOOL BUS", BLACK, 0.62),
    "taxi": _board((255, 244, 190), "TAXI", BLACK, 0.66),
    "tram": _board((20, 20, 22), "5  CENTRE", (255, 190, 60), 0.6, weight=2),
    "fuel": _board((226, 228, 230), "FLAMMABLE", RED, 0.6),
    "man": _figure((255, 70, 56), 0),
    "walker": _figure((80, 244, 140), 6),
}


def paint_sign(patch: Image, name: str) -> None:
    """Paint one face, in place."""
    patch[:] = BACK
    _FACES[name.removeprefix("sign_")](patch)
