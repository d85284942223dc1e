"""Makes corridors from OpenDRIVE files."""

import math
from functools import lru_cache
from importlib.resources import files
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from oodscen.catalogue import Catalogue, RoadMap
from oodscen.driving.corridor import Corridor, LaneStrip, StripKind
from oodscen.driving.geometry import piecewise
from oodscen.driving.opendrive import MAX_BYTES, Lane, LaneSection, Road, read_road
from oodscen.errors import DataError, Issue, UnknownComponent

SAMPLE_STEP = 0.5
"""Metres between two samples of a corridor, at most."""

_KINDS: dict[str, StripKind] = {
    **dict.fromkeys(("driving", "entry", "exit", "onRamp", "offRamp", "slipLane"), "driving"),
    **dict.fromkeys(("connectingRamp", "bidirectional", "bus", "taxi", "HOV"), "driving"),
    **dict.fromkeys(("shoulder", "stop", "biking"), "shoulder"),
    **dict.fromkeys(("sidewalk", "walking"), "sidewalk"),
    **dict.fromkeys(("border", "curb", "restricted"), "border"),
    "parking": "parking",
    "median": "median",
}
"""OpenDRIVE's lane types; whatever is missing here is `none`."""

_DEFAULT_SPEED_LIMIT = 13.9


def load_corridor(road_map: RoadMap) -> Corridor:
    """Return the road that the ego of a map drives; the same file is read once per process.

    Args:
        road_map: Where the OpenDRIVE file is, and where in it the ego starts.

    Raises:
        DataError: With every fault of the file, or when the start is not on the road.
    """
    data = _read(road_map.file)
    return _corridor(data, road_map.road, road_map.start_m, road_map.forward, road_map.file)


def find_map(name: str, catalogue: Catalogue) -> RoadMap:
    """Return a map of the catalogue, or describe the OpenDRIVE file that a scene names.

    Args:
        name: `Scene.map`: a map's id, or the path of an `.xodr` file. In a file of one's own the
            ego starts on the first road, 160 m after its beginning or a quarter along.
        catalogue: Of the simulator.

    Raises:
        UnknownComponent: When there is no such map.
        DataError: When the file cannot be used.
    """
    if not name.endswith(".xodr"):
        try:
            return catalogue.map(name)
        except KeyError:
            known = [road.id for road in catalogue.maps]
            raise UnknownComponent("map", name, known) from None
    road = read_road(_read(name), source=name)
    start = min(160.0, 0.25 * road.length)
    corridor = _corridor(_read(name), "", start, True, name)
    directions = [corridor.strips[index].direction for index in corridor.driving]
    forward = any(direction > 0 for direction in directions)
    if not forward:
        start = road.length - start
        corridor = _corridor(_read(name), "", start, False, name)
    kinds = {strip.kind for strip in corridor.strips}
    return RoadMap(
        id=Path(name).stem,
        description=f"the road of {Path(name).name}",
        file=name,
        start_m=start,
        forward=forward,
        lanes=max(1, len(corridor.ego_lanes)),
        oncoming_lanes=len(corridor.driving) - len(corridor.ego_lanes),
        has_shoulder="shoulder" in kinds,
        speed_limit=corridor.speed_limit,
        length_m=max(1.0, corridor.length - corridor.start),
    )


def _read(file: str) -> bytes:
    """Return the bytes of `package:path/inside.xodr` or of a path."""
    package, _, inside = file.partition(":")
    is_packaged = inside and all(part.isidentifier() for part in package.split("."))
    try:
        if is_packaged and len(package) > 1:
            return files(package).joinpath(inside).read_bytes()
        path = Path(file)
        if path.stat().st_size > MAX_BYTES:
            message = f"the file has more than {MAX_BYTES} bytes"
            raise DataError("OpenDRIVE file", [Issue("", message)], source=file)
        return path.read_bytes()
    except (OSError, ValueError, ModuleNotFoundError) as error:
        raise DataError("OpenDRIVE file", [Issue("", str(error))], source=file) from None


@lru_cache(maxsize=32)
def _corridor(data: bytes, road_id: str, start: float, forward: bool, source: str) -> Corridor:
    road = read_road(data, road_id, source=source)
    if not 0.0 <= start <= road.length:
        message = f"{start:g} m is not on the road, which is {road.length:g} m long"
        raise DataError("OpenDRIVE file", [Issue("start_m", message)], source=source)
    corridor = build_corridor(road, start_m=start, forward=forward)
    if not corridor.driving:
        issue = Issue("", f"road {road.id!r} has no driving lane where the ego starts")
        raise DataError("OpenDRIVE file", [issue], source=source)
    return corridor


def build_corridor(road: Road, *, start_m: float = 0.0, forward: bool = True) -> Corridor:
    """Sample one road in the ego's driving direction.

    Args:
        road: As read from a file.
        start_m: Where along the road's own reference line the ego starts.
        forward: Whether the ego drives along the reference line or against it.
    """
    end = road.curves[-1].s + road.curves[-1].length
    length = min(road.length, end)
    count = max(2, math.ceil(length / SAMPLE_STEP - 1e-9) + 1)
    along = [length * index / (count - 1) for index in range(count)]
    columns: list[list[float]] = [[], [], [], [], [], []]
    piece = 0
    for s in along:
        while piece + 1 < len(road.curves) and s >= road.curves[piece + 1].s:
            piece += 1
        curve = road.curves[piece]
        place = curve.at(min(max(s - curve.s, 0.0), curve.length))
        values = (
            place.x,
            place.y,
            piecewise(road.elevation, s),
            math.cos(place.heading),
            math.sin(place.heading),
            place.curvature,
        )
        for column, value in zip(columns, values, strict=True):
            column.append(round(value, 6))
    strips = _strips(road, along)
    x, y, z, cos, sin, curvature = (np.array(column) + 0.0 for column in columns)
    start = start_m
    if not forward:
        x, y, z, cos, sin, curvature = (
            x[::-1],
            y[::-1],
            z[::-1],
            -cos[::-1],
            -sin[::-1],
            -curvature[::-1],
        )
        strips = [_mirrored(strip, before) for before, strip in _with_right_neighbour(strips)]
        start = length - start_m
    return Corridor(
        s=_frozen(np.array([round(s, 6) for s in along])),
        x=_frozen(x),
        y=_frozen(y),
        z=_frozen(z),
        cos=_frozen(cos),
        sin=_frozen(sin),
        curvature=_frozen(curvature),
        strips=tuple(strips),
        start=start,
        speed_limit=road.speed_limit or _DEFAULT_SPEED_LIMIT,
    )


def _frozen(array: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a contiguous read-only copy without negative zeros."""
    copy = np.ascontiguousarray(array, dtype=np.float64) + 0.0
    copy.setflags(write=False)
    return copy


class _Chain:
    """One lane followed through the lane sections; it has no width where it does not exist."""

    def __init__(self, lane: Lane) -> None:
        self.type = lane.type
        self.reversed = lane.reversed
        self.mark = lane.mark
        self.lanes: dict[int, Lane] = {}


def _chains(sections: tuple[LaneSection, ...], sign: int) -> list[_Chain]:
    """Return the chains of one side of the road, from the inside out."""
    chains: list[_Chain] = []
    expected: dict[int, _Chain] = {}
    for number, section in enumerate(sections):
        inner: _Chain | None = None
        current: dict[int, _Chain] = {}
        for lane in sorted((x for x in section.lanes if x.id * sign > 0), key=lambda x: abs(x.id)):
            chain = expected.get(lane.id)
            after = 0 if inner is None else chains.index(inner) + 1
            fits = chain is not None and chains.index(chain) >= after
            if chain is None or not fits or chain.type != lane.type or number in chain.lanes:
                chain = _Chain(lane)
                chains.insert(after, chain)
            chain.lanes[number] = lane
            current[lane.id] = inner = chain
        has_links = any(chain.lanes[number].successor is not None for chain in current.values())
        expected = {}
        for identity, chain in current.items():
            following = chain.lanes[number].successor if has_links else identity
            if following is not None:
                expected[following] = chain
    return chains


def _strips(road: Road, along: list[float]) -> list[LaneStrip]:
    """Return the cross-section from right to left along the road's own direction."""
    starts = [section.s for section in road.sections]
    owner, current = [], 0
    for s in along:
        while current + 1 < len(starts) and s >= starts[current + 1]:
            current += 1
        owner.append(current)
    offsets = [piecewise(road.lane_offset, s) for s in along]
    centre = next(lane for lane in road.sections[0].lanes if lane.id == 0)
    forward = -1 if road.left_hand else 1
    sides: list[list[LaneStrip]] = []
    for sign in (-1, 1):
        edge = [round(offset, 6) + 0.0 for offset in offsets]
        strips: list[LaneStrip] = []
        inner_mark = _mark(centre.mark)
        for chain in _chains(road.sections, sign):
            outer = []
            for index, s in enumerate(along):
                lane = chain.lanes.get(owner[index])
                width = 0.0 if lane is None else piecewise(lane.widths, s - starts[owner[index]])
                outer.append(round(edge[index] + sign * min(max(width, 0.0), 100.0), 6) + 0.0)
            kind = _KINDS.get(chain.type, "none")
            direction = 0
            if kind in ("driving", "shoulder", "parking"):
                direction = -sign * forward * (-1 if chain.reversed else 1)
            right, left = (outer, edge) if sign < 0 else (edge, outer)
            mark = _mark(chain.mark)
            strips.append(
                LaneStrip(
                    kind=kind,
                    direction=direction,
                    right=_frozen(np.array(right)),
                    left=_frozen(np.array(left)),
                    mark=inner_mark if sign < 0 else mark,
                    right_mark=mark if sign < 0 else inner_mark,
                )
            )
            edge, inner_mark = outer, mark
        sides.append(strips)
    return sides[0][::-1] + sides[1]


def _mark(word: str) -> str:
    """Return the mark as corridors name it."""
    if word in ("none", "curb"):
        return word
    return "broken" if word in ("broken", "broken broken", "botts dots") else "solid"


def _with_right_neighbour(strips: list[LaneStrip]) -> list[tuple[LaneStrip | None, LaneStrip]]:
    """Pair the strips, in mirrored order, with what was on their right."""
    before = [None, *strips[:-1]]
    return list(zip(before, strips, strict=True))[::-1]


def _mirrored(strip: LaneStrip, before: LaneStrip | None) -> LaneStrip:
    """Return a strip as a driver of the other direction sees it."""
    return LaneStrip(
        kind=strip.kind,
        direction=-strip.direction,
        right=_frozen(-strip.left[::-1]),
        left=_frozen(-strip.right[::-1]),
        mark=strip.right_mark if before is None else before.mark,
        right_mark=strip.mark,
    )
