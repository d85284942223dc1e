"""Strategies of motions made to order, and samples."""

from typing import Any

from hypothesis import strategies as st

from oodscen.data._designs.motion import ABILITIES, Motion
from oodscen.errors import DataError

TOPPLE: dict[str, Any] = {
    "id": "topple",
    "description": "toppling over ahead",
    "body": "loose",
    "keys": [{"at": 0}, {"at": 0.8, "pitch": 30}, {"at": 1.2, "pitch": 90}],
}
STREAM: dict[str, Any] = {
    "id": "stream",
    "description": "walking across with pauses",
    "body": "person",
    "facing": "along",
    "delay": 2,
    "pace": 0.2,
    "walk": {"distance": 9, "pauses": 2, "pause_s": 1},
}

_WHOLE = st.integers(-6, 6)
_COURSES: list[dict[str, Any]] = [
    {"walk": {"distance": 6, "back": True}},
    {"roll": {"distance": 12, "speed": 3}},
    {"circle": {"radius": 3, "speed": 2}, "then": "repeat", "facing": "along"},
    {"circle": {"radius": 2, "speed": 2, "clockwise": True}},
    {"circle": {"radius": 9, "speed": 7}, "then": "repeat"},
]
_AIRY: list[dict[str, Any]] = [
    {"drift": {"seconds": 10, "height": 2}},
    {"swing": {"angle_deg": 15}, "pivot_m": 1.5},
    {"swing": {"fades": False, "sideways": False, "up": 2}, "then": "repeat"},
    {"roll": {"distance": 8, "radius": 0.4, "stops": False}, "then": "go_on", "pivot_m": 0.4},
]


@st.composite
def _keys(draw: st.DrawFn) -> dict[str, Any]:
    """Draw key poses with room between them, and an end that fits."""
    is_airy = draw(st.booleans())
    at, pose = 0.0, {"ahead": 0.0, "left": 0.0}
    wide = draw(st.sampled_from([1 / 3, 1 / 3, 1.0, 3.0]))
    keys: list[dict[str, float]] = [{"at": 0.0}]
    for _ in range(draw(st.integers(1, 8))):
        at += draw(st.sampled_from([1.0, 2.5, 6.0]))
        if draw(st.booleans()):
            pose = {
                "ahead": pose["ahead"] + draw(_WHOLE) * wide,
                "left": pose["left"] + draw(_WHOLE) * wide,
            }
        turn = {"up": draw(st.integers(0, 2)) / 2, "yaw": 15 * draw(_WHOLE)} if is_airy else {}
        tilt = {"pitch": 10 * draw(_WHOLE), "roll": 10 * draw(_WHOLE)} if is_airy else {}
        keys.append({"at": at, **pose, **turn, **tilt})
    ending = draw(st.sampled_from(["stay", "repeat", "go_on"]))
    if ending == "repeat":
        keys.append({"at": at + 6.0})
    return {"keys": keys, "then": ending}


@st.composite
def motions(draw: st.DrawFn, **fixed: str) -> dict[str, Any]:
    """Draw a motion that its body can do, mostly, with some fields as given."""
    body = draw(st.sampled_from(sorted(ABILITIES)))
    shapes = st.one_of(_keys(), st.sampled_from(_COURSES), st.sampled_from(_AIRY))
    return {
        "id": "moves",
        "description": "moving somehow",
        "body": body,
        "frame": draw(st.sampled_from(["start", "lane", "other", "ego"])),
        "by": draw(st.sampled_from(["time", "ego"])),
        "delay": draw(st.sampled_from([0, 1.5])),
        "pace": draw(st.sampled_from([0, 0.3])),
        "begins": draw(st.sampled_from(["rest", "rest", "moving"])),
        **draw(shapes),
        **fixed,
    }


def is_sound(table: dict[str, Any]) -> bool:
    """Return whether a motion is valid."""
    try:
        Motion.parse(table)
    except DataError:
        return False
    return True


def sound_motions(**fixed: str) -> st.SearchStrategy[Motion]:
    """Draw a motion that its body can do, with some fields as given."""
    return motions(**fixed).filter(is_sound).map(Motion.parse)
