"""Strategies of designs of things made to order, and samples."""

from typing import Any

from hypothesis import strategies as st

COLOURS = st.sampled_from(["red", "#1c50b0", "lit amber", "white", "wood", "#808080"])
NEAR = st.integers(-8, 8).map(lambda tenths: tenths / 10)
SIZE = st.integers(2, 12).map(lambda tenths: tenths / 10)

WALL: dict[str, Any] = {
    "id": "low_wall",
    "description": "a low wall of red bricks",
    "mass_kg": 2000,
    "parts": [{"box": [0, 0, 0.5], "size": [0.4, 3, 1], "colour": "red"}],
}
CLOUD: dict[str, Any] = {
    "id": "foam_cloud",
    "description": "a cloud of white foam",
    "mass_kg": 2,
    "touch": "soft",
    "parts": [{"heap": [0, 0], "size": [2, 3, 1], "colour": "white", "lumps": 12}],
}


@st.composite
def _resting(draw: st.DrawFn) -> dict[str, Any]:
    """Draw a part that stands on the road."""
    x, y, a, b, c = draw(NEAR), draw(NEAR), draw(SIZE), draw(SIZE), draw(SIZE)
    colour, key = draw(COLOURS), draw(st.integers(0, 99))
    quad = [[x, y + a, 0], [x, y - a, 0], [x, y - a, c], [x, y + a, c]]
    kinds: dict[str, dict[str, Any]] = {
        "box": {"box": [x, y, c / 2], "size": [a, b, c]},
        "hull": {"hull": [x - a, x + a, y - b, y + b, 0], "top": [x, x + a, y, y + b, c]},
        "beam": {"beam": [x, y, 0], "to": [x + a, y, c], "width": 0.1},
        "tube": {
            "tube": [[x, y, 0], [x, y, c], [x, y + b, c]],
            "width": 0.1, "second_colour": "white", "pitch": 0.2, "sag": draw(st.sampled_from([0, 0.1])),
        },
        "cylinder": {"cylinder": [x, y, 0], "to": [x, y, c], "radius": a},
        "lathe": {"lathe": [[x, y, 0, a], [x, y, c, b]], "colours": [colour]},
        "ball": {"ball": [x, y, c], "radii": [a, b, c], "jitter": draw(st.sampled_from([0, 0.3]))},
        "column": {"column": [[x, y, 0, a, b], [x, y, c, b, a]]},
        "sheet": {"sheet": quad, "back": "black"},
        "wheel": {"wheel": [x, y], "radius": a, "width": b},
        "panel": {
            "panel": quad, "second_colour": "black", "key": key,
            "pattern": draw(st.sampled_from(
                ["stripes", "checks", "planks", "bricks", "windows", "net", "speckle", "plain"]
            )),
        },
        "text": {"text": draw(st.text("AZ09 .!?-", min_size=1, max_size=9)) + "X", "on": quad, "paper": "white"},
        "heap": {"heap": [x, y], "size": [a, b, c], "lumps": 6, "rough": 0.2, "key": key},
        "swarm": {"swarm": [x, y, 2], "size": [a, b, c], "speck": 0.1, "count": 5, "key": key},
        "veil": {
            "veil": [x, y, 0], "size": [a, b, c], "key": key,
            "form": draw(st.sampled_from(["cloud", "funnel", "jet"])), "puffs": 5,
        },
        "blot": {"blot": [x, y], "size": [a, b], "key": key},
        "strip": {"strip": [[x, y], [x + a, y]], "width": 0.1, "dash": draw(st.sampled_from([0, 1]))},
        "asset": {"asset": draw(st.sampled_from(["cone", "crate"])), "to": [x, y, 0], "yaw": 30},
    }  # fmt: skip
    name = draw(st.sampled_from(sorted(kinds)))
    bare = {"sheet", "wheel", "text", "asset", "lathe"}
    coloured = {} if name in bare - {"sheet"} else {"colour": colour}
    return {**kinds[name], **coloured}


def _has_few_assets(parts: list[dict[str, Any]]) -> bool:
    """Return whether parts, each drawn twice, keep within the limit of triangles."""
    return sum("asset" in part for part in parts) <= 1


@st.composite
def designs(draw: st.DrawFn) -> dict[str, Any]:
    """Draw a valid design: things that stand on the road, some of them in groups."""
    parts: list[dict[str, Any]] = [{"box": [0, 0, 0.3], "size": [1, 1, 0.6], "colour": "grey"}]
    resting = st.lists(_resting(), max_size=4).filter(_has_few_assets)
    for part in draw(resting):
        group = draw(st.sampled_from(["", "both_sides", "repeat", "at", "turned", "when"]))
        parts.append(
            {
                "": part,
                "both_sides": {"both_sides": [part]},
                "repeat": {"repeat": 2, "step": [0.5, 0, 0], "parts": [part]},
                "at": {"at": [[0, 0, 0], [1, 0.5, 0]], "parts": [part]},
                "turned": {"turned": [part], "yaw": 40, "to": [0.3, 0, 0]},
                "when": {"when": "on", "parts": [part], "otherwise": []},
            }[group]
        )
    return {
        "id": "thing",
        "description": "a thing of parts",
        "mass_kg": draw(st.sampled_from([0.5, 20, 2000])),
        "touch": draw(st.sampled_from(["hard", "soft"])),
        "states": ["on", "off"],
        "parts": parts,
    }
