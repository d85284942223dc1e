"""The strips of a corridor: lanes followed through sections, roads and junctions."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from oodscen.driving._roads.corridor import LaneStrip
from oodscen.driving._roads.geometry import Cubic, piecewise_all
from oodscen.driving._roads.network import KINDS, Lane, Network, StripKind
from oodscen.driving._roads.routes import Leg, lane_links, section_links
from oodscen.numerics._arrays import rounded

_BRIDGED = frozenset({"driving", "shoulder", "median"})
"""Kinds of strips that continue through a junction even if its connecting road lacks them."""
_MAX_WIDTH = 100.0
_MAX_STRIPS = 150
_MAX_EDGES = 2_500_000
"""Maximum number of strips times samples."""


class Places(NamedTuple):
    """Positions of a corridor's samples on its legs."""

    legs: NDArray[np.int64]
    """[n], index of the leg under each sample."""
    own: NDArray[np.float64]
    """[n], s of each sample along its road's own reference line, m."""
    shifts: list[float]
    """For each leg, t of the corridor's line relative to the leg's own line, m."""


class _SectionStage(NamedTuple):
    """One lane section of one leg."""

    leg: int
    section: int
    """Index of the section in driving order."""


@dataclass
class _Chain:
    """One lane followed through the stages; its width is 0 where it does not exist."""

    type: str
    reversed: bool
    mark: str
    lanes: dict[int, Lane] = field(default_factory=dict)
    """The lane in each stage, by the stage's number."""


def build_strips(
    network: Network,
    legs: Sequence[Leg],
    places: Places,
    in_junction: NDArray[np.bool_],
    *,
    step: float,
    start: float,
) -> list[LaneStrip]:
    """Return the cross-section of a route from right to left.

    A lane that continues another is part of the same strip, through sections, roads and junctions. Lanes
    that exist before and after a junction but not on its connecting road are drawn straight through. Any
    other strip has zero width where its lane is missing.

    Raises:
        ValueError: If there are too many lanes.
    """
    stages = [_SectionStage(k, j) for k, leg in enumerate(legs) for j in range(len(leg.sections))]
    sides = {sign: _chains(network, legs, stages, sign) for sign in (-1, 1)}
    runs = _runs(legs, places)
    count = len(places.own)
    if sum(map(len, sides.values())) * count > _MAX_EDGES:
        raise ValueError("has too many lanes for its length")
    edges = {
        id(chain): (np.full(count, np.nan), np.full(count, np.nan))
        for chains in sides.values()
        for chain in chains
    }
    numbers = {stage: number for number, stage in enumerate(stages)}
    for stage, part in runs:
        _measure(legs, stage, numbers[stage], places, part, sides, edges)
    ordered = sides[-1][::-1] + sides[1]
    columns = [edges[id(chain)] for chain in ordered]
    wanted = [
        _drawn_through(right, left, in_junction, KINDS.get(chain.type, "none"))
        for chain, (right, left) in zip(ordered, columns, strict=True)
    ]
    for _, part in runs:
        _fill(columns, wanted, part)
    keeps = -1 if legs[0].road.left_hand else 1
    strips: list[LaneStrip] = []
    for sign in (1, -1):
        marks = _marks(legs, sides[sign], sign, runs, numbers)
        for chain, rows in zip(sides[sign], marks, strict=True):
            kind = KINDS.get(chain.type, "none")
            direction = 0
            if kind in ("driving", "shoulder", "parking"):
                direction = -sign * keeps * (-1 if chain.reversed else 1)
            spans = tuple((round(index * step, 6), left, right) for index, left, right in rows)
            _, mark, right_mark = next((row for row in spans[::-1] if row[0] <= start), spans[0])
            right, left = edges[id(chain)]
            strip = LaneStrip(
                kind=kind,
                direction=direction,
                right=freeze(right),
                left=freeze(left),
                mark=mark,
                right_mark=right_mark,
                mark_changes=spans if len(spans) > 1 else (),
            )
            strips.insert(0 if sign < 0 else len(strips), strip)
    return strips


def _marks(
    legs: Sequence[Leg],
    chains: Sequence[_Chain],
    sign: int,
    runs: Sequence[tuple[_SectionStage, slice]],
    numbers: dict[_SectionStage, int],
) -> list[list[tuple[int, str, str]]]:
    """Return the changes of marks of every chain on one side: sample index, left and right mark."""
    rows: list[list[tuple[int, str, str]]] = [[] for _ in chains]
    for stage, part in runs:
        section = legs[stage.leg].sections[stage.section]
        inner = _mark(next(lane.mark for lane in section.lanes if lane.id == 0))
        for chain, known in zip(chains, rows, strict=True):
            lane = chain.lanes.get(numbers[stage])
            if lane is None:
                continue
            outer = _mark(lane.mark)
            pair = (inner, outer) if sign < 0 else (outer, inner)
            if not known or known[-1][1:] != pair:
                known.append((part.start, *pair))
            inner = outer
    for chain, known in zip(chains, rows, strict=True):
        if not known:
            mark = _mark(chain.mark)
            known.append((0, mark, mark))
    return rows


def freeze(array: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a contiguous read-only copy without negative zeros."""
    copy = np.ascontiguousarray(array, dtype=np.float64) + 0.0
    copy.setflags(write=False)
    return copy


def _chains(
    network: Network, legs: Sequence[Leg], stages: Sequence[_SectionStage], sign: int
) -> list[_Chain]:
    """Return the chains on one side of the route, from the inside out."""
    chains: list[_Chain] = []
    expected: dict[int, _Chain] = {}
    asleep: dict[tuple[int, str], _Chain] = {}
    for number, stage in enumerate(stages):
        leg = legs[stage.leg]
        lanes = [lane for lane in leg.sections[stage.section].lanes if leg.id_of(lane) * sign > 0]
        inner = -1
        current: dict[int, _Chain] = {}
        for lane in sorted(lanes, key=lambda lane: abs(lane.id)):
            identity = leg.id_of(lane)
            found = None
            again = asleep.get((identity, lane.type))
            if any(one is again for one in expected.values()):
                again = None
            for offer in (expected.get(identity), again):
                if offer is not None and offer.type == lane.type and number not in offer.lanes:
                    place = next(i for i, one in enumerate(chains) if one is offer)
                    if place > inner:
                        found, inner = offer, place
                        break
            if found is None:
                found = _Chain(lane.type, lane.reversed, lane.mark)
                inner += 1
                chains.insert(inner, found)
                if len(chains) > _MAX_STRIPS:
                    raise ValueError("has too many lanes that do not continue each other")
            found.lanes[number] = lane
            current[identity] = found
            if not leg.road.junction:
                asleep[identity, lane.type] = found
        if number + 1 == len(stages):
            break
        following = stages[number + 1]
        if following.leg == stage.leg:
            pairs = section_links(leg, stage.section)
        else:
            pairs = lane_links(network, leg, legs[following.leg])
        pairs = [pair for pair in pairs if pair[0] * sign > 0 and pair[1] * sign > 0]
        if not pairs:
            pairs = [(identity, identity) for identity in current]
        expected = {}
        for before, after in pairs:
            if before in current:
                expected.setdefault(after, current[before])
    return chains


def _runs(legs: Sequence[Leg], places: Places) -> list[tuple[_SectionStage, slice]]:
    """Return every stage that has samples, with their range."""
    sections = np.zeros(len(places.own), dtype=np.int64)
    for number, leg in enumerate(legs):
        here = places.legs == number
        own, begins = places.own[here], [section.s for section in leg.road.sections[1:]]
        passed = np.searchsorted(begins, own, side="right")
        if not leg.forward:
            passed = len(begins) - passed
        # A leg does not return to a section, even where the last bit of s goes back.
        sections[here] = np.maximum.accumulate(passed)
    is_new = (np.diff(places.legs) != 0) | (np.diff(sections) != 0)
    bounds = [0, *(np.flatnonzero(is_new) + 1).tolist(), len(sections)]
    return [
        (_SectionStage(int(places.legs[first]), int(sections[first])), slice(first, last))
        for first, last in pairwise(bounds)
    ]


def _measure(
    legs: Sequence[Leg],
    stage: _SectionStage,
    number: int,
    places: Places,
    part: slice,
    sides: dict[int, list[_Chain]],
    edges: dict[int, tuple[NDArray[np.float64], NDArray[np.float64]]],
) -> None:
    """Set the edges of the lanes that exist in one stage."""
    leg, shift = legs[stage.leg], places.shifts[stage.leg]
    start = leg.sections[stage.section].s
    turn = 1.0 if leg.forward else -1.0
    own = places.own[part]
    offsets = turn * _values(leg.road.lane_offset, own) - shift
    along = own - start
    for sign, chains in sides.items():
        edge = rounded(offsets) + 0.0
        for chain in chains:
            lane = chain.lanes.get(number)
            if lane is None:
                continue
            width = np.clip(_values(lane.widths, along), 0.0, _MAX_WIDTH)
            outer = rounded(edge + sign * width) + 0.0
            right, left = edges[id(chain)]
            right[part], left[part] = (outer, edge) if sign < 0 else (edge, outer)
            edge = outer


def _values(pieces: tuple[Cubic, ...], along: NDArray[np.float64]) -> NDArray[np.float64]:
    first = pieces[0] if len(pieces) == 1 else None
    if first and first.start <= 0.0 and first.b == first.c == first.d == 0.0:
        return np.full_like(along, first.a)
    return piecewise_all(pieces, along)


def _drawn_through(
    right: NDArray[np.float64],
    left: NDArray[np.float64],
    in_junction: NDArray[np.bool_],
    kind: StripKind,
) -> NDArray[np.float64]:
    """Return [2, n] edges of a strip across junctions where it is missing, NaN elsewhere."""
    drawn = np.full((2, len(right)), np.nan)
    if kind not in _BRIDGED:
        return drawn
    missing = np.isnan(right)
    changes = np.flatnonzero(np.diff(np.concatenate(([0], missing.astype(np.int8), [0]))))
    for first, last in zip(changes[::2].tolist(), changes[1::2].tolist(), strict=True):
        if first == 0 or last == len(right) or not in_junction[first:last].all():
            continue
        part = np.arange(1, last - first + 1) / (last - first + 1)
        for row, edge in zip(drawn, (right, left), strict=True):
            row[first:last] = edge[first - 1] + part * (edge[last] - edge[first - 1])
    return np.round(drawn, 6)


def _fill(
    columns: list[tuple[NDArray[np.float64], NDArray[np.float64]]],
    wanted: list[NDArray[np.float64]],
    part: slice,
) -> None:
    """Set the edges of the strips that are missing in one stage."""
    exists = [index for index, (right, _) in enumerate(columns) if not np.isnan(right[part.start])]
    for index in range(exists[0] + 1, exists[-1]):
        right, left = columns[index]
        if np.isnan(right[part.start]):
            right[part] = left[part] = columns[index - 1][1][part]
    cursor = columns[exists[0]][0][part]
    for index in range(exists[0] - 1, -1, -1):
        right, left = columns[index]
        left[part] = cursor
        cursor = np.fmin(cursor, wanted[index][0][part])
        right[part] = cursor
    cursor = columns[exists[-1]][1][part]
    for index in range(exists[-1] + 1, len(columns)):
        right, left = columns[index]
        right[part] = cursor
        cursor = np.fmax(cursor, wanted[index][1][part])
        left[part] = cursor


def _mark(word: str) -> str:
    """Return a corridor's name for an OpenDRIVE mark."""
    if word in ("none", "curb"):
        return word
    return "broken" if word in ("broken", "broken broken", "botts dots") else "solid"
