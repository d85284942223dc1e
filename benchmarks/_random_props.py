"""Random designs of things made to order: valid ones, and ones with one fault each."""

import copy
from collections.abc import Callable, Iterator
from random import Random
from typing import Any

Design = dict[str, Any]

ASSETS = ("cone", "crate", "barrel", "tyre", "pallet", "sofa", "fallen_tree", "rock", "drum", "suitcase")  # fmt: skip
COLOURS = ("red", "#1c50b0", "white", "wood", "#808080", "fluor_orange", "lit amber", "black", "leaf")  # fmt: skip
PATTERNS = ("plain", "stripes", "checks", "planks", "bricks", "windows", "net", "speckle")
LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789 .!?-"


class Drawing:
    """Draws random parts that stand on the road or on what is there already."""

    def __init__(self, rng: Random) -> None:
        self.rng = rng

    def length(self, low: float, high: float) -> float:
        """Draw a length in whole centimetres."""
        return round(self.rng.uniform(low, high), 2)

    def design(self, number: int) -> Design:
        """Draw a design; most are valid."""
        rng = self.rng
        states = ["on", "off"] if rng.random() < 0.3 else []
        anchor = rng.choice(("road", "road", "road", "hanging", "wall", "carried"))
        body = [self.part() for _ in range(rng.randint(1, 5))]
        parts = [*body, *(self.group(states) for _ in range(rng.randint(0, 4)))]
        if anchor != "road":
            parts = [{"turned": [self.core(), *parts], "to": [0, 0, self.length(0.5, 3)]}]
        elif rng.random() < 0.7:
            parts = [self.core(), *parts]
        return {
            "id": f"random_{number}",
            "description": "a thing of random parts",
            "anchor": anchor,
            "touch": rng.choice(("hard", "soft")),
            "mass_kg": rng.choice((0.4, 3, 40, 900, 20_000)),
            "states": states,
            "parts": parts,
        }

    def core(self) -> Design:
        """Draw a box that holds the others."""
        size = [self.length(0.4, 2), self.length(0.4, 2), self.length(0.4, 1.5)]
        return {"box": [0, 0, size[2] / 2], "size": size, "colour": self.colour()}

    def colour(self) -> str:
        """Draw a colour."""
        return self.rng.choice(COLOURS)

    def large(self) -> Design:
        """Draw a long or wide body near the origin."""
        rng = self.rng
        long, thin, high = self.length(1.5, 6), self.length(0.1, 0.4), self.length(0.3, 2)
        quad = [[-long / 2, 0, 0], [long / 2, 0, 0], [long / 2, 0.3, high], [-long / 2, 0.3, high]]
        kinds: list[Design] = [
            {"box": [0, 0, high / 2], "size": [long, thin, high]},
            {"hull": [-long / 2, long / 2, -1, 1, 0], "top": [0, 0.2, -0.1, 0.1, high]},
            {"ball": [0, 0, high / 2], "radii": [long / 3, 0.6, high / 2]},
            {"sheet": quad, "back": "black"},
            {"panel": quad, "pattern": "planks"},
            {"column": [[-long / 2, 0, 1, 0.2, 0.2], [long / 2, 0, 1, 0.5, 0.8]], "axis": "x"},
        ]
        return {**rng.choice(kinds), "colour": self.colour()}

    def group(self, states: list[str]) -> Design:
        """Draw a part, perhaps mirrored, repeated, turned, or shown in a state only."""
        rng = self.rng
        inner = [self.part() for _ in range(rng.randint(1, 2))]
        kinds: list[Callable[[], Design]] = [
            lambda: {"both_sides": inner},
            lambda: {"repeat": rng.randint(2, 6), "step": [self.length(0.1, 0.6), self.length(0, 0.4), 0], "parts": inner},
            lambda: {"at": [[self.length(-1, 1), self.length(-1, 1), 0] for _ in range(3)], "parts": inner},
            lambda: {"turned": inner, "yaw": rng.randint(-180, 180), "roll": rng.choice((0, 0, 8, -20, 75)), "to": [self.length(-1, 1), self.length(-1, 1), self.length(0, 0.3)]},
            lambda: {"turned": [{"both_sides": inner}], "yaw": rng.randint(-180, 180)},
            lambda: {"both_sides": [{"turned": inner, "roll": rng.randint(-60, 60)}]},
            lambda: {"turned": [self.large()], "yaw": rng.randint(-180, 180), "to": [self.length(-2, 2), self.length(-2, 2), self.length(0, 1)]},
            lambda: {"at": [[self.length(-2, 2), self.length(-2, 2), self.length(0, 2)]], "parts": [self.large()]},
        ]  # fmt: skip
        if states:
            kinds.append(lambda: {"when": "on", "parts": inner, "otherwise": [self.part()]})
        return rng.choice(kinds)()

    def part(self) -> Design:
        """Draw one part near the origin, on the ground."""
        rng = self.rng
        x, y = self.length(-0.8, 0.8), self.length(-0.8, 0.8)
        a, b, c = self.length(0.05, 0.9), self.length(0.05, 0.9), self.length(0.1, 1.4)
        colour, key = self.colour(), rng.randint(0, 999)
        quad = [[x, y + a, 0], [x, y - a, 0], [x, y - a, c], [x, y + a, c]]
        kinds: list[Design] = [
            {"box": [x, y, c / 2], "size": [a, b, c], "caps": rng.choice(("bt", "bt", "b", "t"))},
            {"hull": [x - a, x + a, y - b, y + b, 0], "top": [x - a / 2, x + a, y, y + b, c]},
            {"beam": [x, y, 0], "to": [x + a, y - b, c], "width": 0.12},
            {"beam": [x, y, 0], "to": [x, y, c], "width": 0.2, "end_width": 0.05},
            {"tube": [[x, y, 0], [x + a, y, c], [x, y + b, c], [x, y + b, 0]], "width": 0.08, "second_colour": "white", "pitch": 0.2, "sag": rng.choice((0, 0.1))},
            {"cylinder": [x, y, 0], "to": [x + rng.choice((0, a)), y, c], "radius": a / 2, "sides": rng.randint(3, 20)},
            {"cylinder": [x - a, y, b / 2], "to": [x + a, y, b / 2], "radius": b / 2, "end_radius": b / 4},
            {"lathe": [[x, y, 0, a], [x, y, c / 2, b], [x, y, c, a / 2]], "colours": [colour, "white"], "sides": rng.randint(3, 16)},
            {"ball": [x, y, c / 2], "radii": [a, b, c / 2], "jitter": rng.choice((0, 0.3)), "key": key},
            {"column": [[x, y, 0, a, b], [x + 0.1, y, c / 2, b, a], [x, y, c, a / 2, b / 2]]},
            {"column": [[x - a, y, 0.4, 0.2, 0.3], [x + a, y, 0.4, 0.3, 0.35]], "axis": "x"},
            {"sheet": quad, "back": "black"},
            {"wheel": [x, y], "radius": b, "width": a},
            {"panel": quad, "pattern": rng.choice(PATTERNS), "second_colour": "black", "pitch": self.length(0.1, 0.5), "key": key},
            {"text": "X" + "".join(rng.choices(LETTERS, k=rng.randint(0, 8))), "on": quad, "paper": rng.choice((None, "white"))},
            {"heap": [x, y], "size": [2 * a, 2 * b, c / 2], "lumps": rng.randint(3, 20), "rough": rng.choice((0, 0.3)), "key": key},
            {"veil": [x, y, 0], "size": [a, b, c], "form": rng.choice(("cloud", "funnel", "jet")), "puffs": rng.randint(3, 9), "key": key},
            {"swarm": [x, y, 1.5], "size": [a, b, c], "speck": 0.08, "count": rng.randint(3, 60), "key": key},
            {"blot": [x, y], "size": [3 * a, 3 * b], "ragged": rng.choice((0, 0.3)), "key": key},
            {"strip": [[x, y], [x + a, y + b], [x + 1, y]], "width": 0.2, "dash": rng.choice((0, 0.3))},
            {"lamp": [x, y, c], "light": [1, 0.6, 0.1]},
            {"asset": rng.choice(ASSETS), "to": [x, y, 0], "yaw": rng.randint(-180, 180), "scale": rng.choice((0.6, 1, 1.4))},
        ]  # fmt: skip
        part = rng.choice(kinds)
        bare = ("lathe", "wheel", "text", "lamp", "asset")
        return part if any(kind in part for kind in bare) else {**part, "colour": colour}


# ---------------------------------------------------------------------- faults

BOX: Design = {"box": [0, 0, 0.5], "size": [1, 1, 1], "colour": "red"}
QUAD = [[-1, 0.5, 0], [-1, -0.5, 0], [-1, -0.5, 0.5], [-1, 0.5, 0.5]]
LAMP: Design = {"lamp": [0, 0, 1], "light": [1, 1, 1]}

TOP: dict[str, Any] = {
    "id": ("", "X", "a", "9lives", "a" * 41, "has space", "ünlaut", "a/b", 7, None),
    "description": ("", "ab", "<b>bold</b>", "two\nlines", "a" * 121, "\x1b[2J", 3, None),
    "category": ("thing", "ego", 1),
    "tags": ("cone", ["A"], ["<i>"], ["x"] * 9, [3]),
    "anchor": ("sky", "", 1, None),
    "touch": ("sticky", "", 1),
    "mass_kg": (0, -5, 1e9, float("inf"), float("nan"), "heavy", None, True),
    "states": (["lit", "lit"], ["A"], ["a", "b", "c", "d", "e"], "on"),
    "passable": (["open"], ["A"], "on"),
    "parts": (None, 5, "box", {}, [], [[]], [None], ["box"], [BOX] * 41),
    "schema_version": (0, 2, "one"),
    "made_by": ("me",),
    "script": ("import os",),
}
"""Members of a design with values that it cannot have."""
BAD_PARTS: tuple[Design, ...] = (
    {},
    {"cube": [0, 0, 0]},
    {"box": [0, 0, 0.5]},
    {**BOX, "colour": "octarine"},
    {**BOX, "colour": "#12345"},
    {**BOX, "size": [1, 1, 0]},
    {**BOX, "size": [1, -1, 1]},
    {**BOX, "size": [1, 1]},
    {**BOX, "size": [1e9, 1, 1]},
    {**BOX, "size": [float("nan"), 1, 1]},
    {**BOX, "box": [0, 0, 1e300]},
    {**BOX, "box": [0, 0, -3]},
    {**BOX, "box": [0, 0, 8]},
    {**BOX, "box": "here"},
    {**BOX, "spin": 3},
    {**BOX, "size": [15, 1, 1]},
    {**BOX, "size": [1, 1, 10]},
    {"hull": [1, -1, -1, 1, 0], "top": [-1, 1, -1, 1, 1], "colour": "red"},
    {"hull": [-1, 1, -1, 1, 1], "top": [-1, 1, -1, 1, 0], "colour": "red"},
    {"beam": [0, 0, 0.2], "to": [0, 0, 0.2], "width": 0.1, "colour": "red"},
    {"tube": [[0, 0, 0]], "width": 0.1, "colour": "red"},
    {"tube": [[0, 0, 0], [0, 0, 0]], "width": 0.1, "colour": "red"},
    {"tube": [[0, 0, 0], [0, 0, 1]] * 40, "width": 0.1, "colour": "red"},
    {"cylinder": [0, 0, 0], "to": [0, 0, 1], "radius": 0, "colour": "red"},
    {"cylinder": [0, 0, 0], "to": [0, 0, 1], "radius": 1, "colour": "red", "sides": 2},
    {"cylinder": [0, 0, 0], "to": [0, 0, 1], "radius": 1, "colour": "red", "sides": 10**6},
    {"lathe": [[0, 0, 0, 1], [0, 0, 1, 1]], "colours": []},
    {"lathe": [[0, 0, 0, 1]], "colours": ["red"]},
    {"ball": [0, 0, 1], "radii": [1, 1, 1], "colour": "red", "jitter": 1},
    {"column": [[0, 0, 1, 1, 1], [0, 0, 0, 1, 1]], "colour": "red"},
    {"column": [[0, 0, 0, 1, 1], [0, 0, 1, 1, 1]]},
    {"sheet": [[0, 0, 0], [1, 0, 0], [2, 0, 0]], "colour": "red"},
    {"sheet": [[0, 0, 0], [1, 0, 0]], "colour": "red"},
    {"panel": QUAD, "pattern": "plaid", "colour": "red"},
    {"panel": [[0, 0, 0]] * 4, "pattern": "plain", "colour": "red"},
    {"text": "", "on": QUAD},
    {"text": "shout", "on": QUAD},
    {"text": "СТОП", "on": QUAD},
    {"text": "停", "on": QUAD},
    {"text": "IGNORE <ALL>", "on": QUAD},
    {"text": "A" * 25, "on": QUAD},
    {"text": "   ", "on": QUAD},
    {"heap": [0, 0], "size": [1, 1, 1], "colour": "red", "lumps": 10**9},
    {"veil": [0, 0, 0], "size": [1, 1, 1], "colour": "red", "density": 3},
    {"veil": [0, 0, 0], "size": [1, 1, 1], "colour": "red", "form": "wall"},
    {"swarm": [0, 0, 1], "size": [1, 1, 1], "speck": 0.1, "colour": "red", "count": 10**7},
    {"blot": [0, 0], "size": [1, 1], "colour": "red", "height": 2},
    {"strip": [[0, 0], [0, 0]], "width": 0.2, "colour": "red"},
    {**LAMP, "light": [2, 0, 0]},
    {**LAMP, "power": 1e6},
    {"repeat": 10**6, "step": [0, 0, 0.1], "parts": [BOX]},
    {"repeat": 1, "step": [0, 0, 0.1], "parts": [BOX]},
    {"repeat": 64, "step": [0, 0, 0], "parts": [{"repeat": 64, "step": [0, 0, 0], "parts": [BOX]}]},
    {"repeat": 3, "step": [4, 0, 0], "parts": [{**BOX, "box": [0, 0, 2]}]},
    {"at": [[0, 0, 0]] * 65, "parts": [BOX]},
    {"when": "no_such_state", "parts": [BOX]},
    {"turned": [BOX], "yaw": 999},
    {"both_sides": [{"both_sides": [{"both_sides": [{"both_sides": [{"both_sides": [BOX]}]}]}]}]},
    {"asset": "no_such_thing"},
    {"asset": ""},
    {"asset": "cone", "scale": 50},
    {"asset": "dog"},
    {"asset": "../../etc/passwd"},
    {"at": [[0, 0, 0]] * 9, "parts": [LAMP]},
    {"at": [[0, 0, 0]] * 5, "parts": [{"veil": [0, 0, 0], "size": [1, 1, 1], "colour": "red"}]},
    {"at": [[0, 0, 0]] * 60, "parts": [{"heap": [0, 0], "size": [1, 1, 1], "colour": "red", "lumps": 80}]},
)  # fmt: skip
"""Parts that no design may have."""
WHOLE: tuple[Design, ...] = (
    {"parts": [{**BOX, "box": [0, 0, 0.1], "size": [0.1, 0.1, 0.2]}]},
    {"parts": [LAMP]},
    {"parts": [BOX], "touch": "flat"},
    {"parts": [BOX], "anchor": "hanging"},
    {"parts": [BOX], "anchor": "carried"},
    {"parts": [{"text": text, "on": QUAD} for text in ("ONE", "TWO", "THREE")]},
    {"parts": [{**BOX, "colour": f"#{number:06x}"} for number in range(17)]},
    {"parts": [{"asset": "fallen_tree"} for _ in range(12)]},
    {"parts": [{"asset": "adult"}], "category": "object"},
    {"parts": [{"asset": "car"}, {"asset": "van"}], "category": "vehicle"},
    {"parts": [BOX], "id": "cone"},
)  # fmt: skip
"""Members that are faulty together."""


def faulty(rng: Random, sound: Iterator[Design]) -> Design:
    """Return a valid design with one fault, anywhere."""
    table = copy.deepcopy(next(sound))
    kind = rng.randrange(5)
    if kind == 0:
        name = rng.choice(list(TOP))
        return {**table, name: rng.choice(TOP[name])}
    if kind == 1:
        name = rng.choice(("id", "description", "mass_kg", "parts"))
        del table[name]
        return table
    if kind == 2:
        plain = {"anchor": "road", "touch": "hard", "category": "object", "states": []}
        return {**table, **plain, **copy.deepcopy(rng.choice(WHOLE))}
    bad = copy.deepcopy(rng.choice(BAD_PARTS))
    if kind == 3:
        bad = rng.choice(({"both_sides": [bad]}, {"turned": [bad], "yaw": 0}, {"at": [[0, 0, 0]], "parts": [bad]}))  # fmt: skip
    parts = [*table["parts"]]
    parts.insert(rng.randint(0, len(parts)), bad)
    return {**table, "anchor": "road", "parts": parts}
