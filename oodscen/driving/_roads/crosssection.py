"""The strips of a corridor: lanes followed through sections, roads and junctions."""

from collections.abc import Mapping, Sequence
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
from oodscen.numerics._exact import Floats

MarkChange = tuple[int, str, str]
"""Index of a sample, and the left and right marks from there on."""

_BRIDGED = frozenset({"driving", "shoulder", "median"})
"""Kinds of strips that continue through a junction even if its connecting road lacks them."""
_MAX_WIDTH_M = 100.0
_MAX_STRIPS = 150
_MAX_EDGES = 2_500_000
"""Maximum number of strips times samples."""


class Places(NamedTuple):
    """Positions of a corridor's samples on its legs."""

    legs: NDArray[np.int64]
    """[n], index of the leg under each sample."""
    own: Floats
    """[n], s of each sample along its road's own reference line, m."""
    shifts: list[float]
    """For each leg, t of the corridor's line relative to the leg's own line, m."""


class _SectionStage(NamedTuple):
    """One lane section of one leg."""

    leg: int
    section: int
    """Index of the section in driving order."""


class _Run(NamedTuple):
    """The samples of one stage."""

    leg: Leg
    section: int
    """Index of the section in driving order."""
    number: int
    """Number of the stage."""
    part: slice


@dataclass(eq=False)
class _Chain:
    """One lane followed through the stages; its width is 0 where it does not exist."""

    type: str
    reversed: bool
    mark: str
    side: int
    """+1 to the left of the corridor's line, -1 to the right."""
    lanes: dict[int, Lane] = field(default_factory=dict)
    """The lane in each stage, by the stage's number."""
    right: Floats = field(default_factory=lambda: np.empty(0))
    """[n], t of the right edge at every sample, m; NaN while it is not known."""
    left: Floats = field(default_factory=lambda: np.empty(0))
    """[n], t of the left edge."""

    @property
    def kind(self) -> StripKind:
        """The kind of strip."""
        return KINDS.get(self.type, "none")


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
    sides = {side: _chains(network, legs, stages, side) for side in (-1, 1)}
    chains = sides[-1][::-1] + sides[1]
    count = len(places.own)
    if len(chains) * count > _MAX_EDGES:
        raise ValueError("has too many lanes for its length")
    for chain in chains:
        chain.right, chain.left = np.full(count, np.nan), np.full(count, np.nan)
    numbers = {stage: number for number, stage in enumerate(stages)}
    runs = [
        _Run(legs[stage.leg], stage.section, numbers[stage], part)
        for stage, part in _parts(legs, places)
    ]
    for run in runs:
        _measure(run, places, sides)
    edges_through = [_drawn_through(chain, in_junction) for chain in chains]
    for run in runs:
        _fill(chains, edges_through, run.part)
    marks = _marks(sides[-1], -1, runs)[::-1] + _marks(sides[1], 1, runs)
    left_hand = legs[0].road.left_hand
    return [
        _strip(chain, changes, left_hand=left_hand, step=step, start=start)
        for chain, changes in zip(chains, marks, strict=True)
    ]


def _strip(
    chain: _Chain, changes: Sequence[MarkChange], *, left_hand: bool, step: float, start: float
) -> LaneStrip:
    """Return the strip of a chain whose edges are known."""
    direction = 0
    if chain.kind in ("driving", "shoulder", "parking"):
        direction = chain.side if left_hand else -chain.side
        if chain.reversed:
            direction = -direction
    spans = tuple((round(index * step, 6), left, right) for index, left, right in changes)
    _, mark, right_mark = next((span for span in spans[::-1] if span[0] <= start), spans[0])
    return LaneStrip(
        kind=chain.kind,
        direction=direction,
        right=freeze(chain.right),
        left=freeze(chain.left),
        mark=mark,
        right_mark=right_mark,
        mark_changes=spans if len(spans) > 1 else (),
    )


def _marks(chains: Sequence[_Chain], side: int, runs: Sequence[_Run]) -> list[list[MarkChange]]:
    """Return the changes of marks of every chain on one side."""
    changes_of: list[list[MarkChange]] = [[] for _ in chains]
    for run in runs:
        section = run.leg.sections[run.section]
        inner = _mark(next(lane.mark for lane in section.lanes if lane.id == 0))
        for chain, changes in zip(chains, changes_of, strict=True):
            lane = chain.lanes.get(run.number)
            if lane is None:
                continue
            outer = _mark(lane.mark)
            pair = (inner, outer) if side < 0 else (outer, inner)
            if not changes or changes[-1][1:] != pair:
                changes.append((run.part.start, *pair))
            inner = outer
    for chain, changes in zip(chains, changes_of, strict=True):
        if not changes:
            mark = _mark(chain.mark)
            changes.append((0, mark, mark))
    return changes_of


def freeze(array: Floats) -> Floats:
    """Return a contiguous read-only copy without negative zeros."""
    copy = np.ascontiguousarray(array, dtype=np.float64) + 0.0
    copy.setflags(write=False)
    return copy


def _chains(
    network: Network, legs: Sequence[Leg], stages: Sequence[_SectionStage], side: int
) -> list[_Chain]:
    """Return the chains on one side of the route, from the inside out."""
    chains: list[_Chain] = []
    expected: dict[int, _Chain] = {}
    last_by_lane: dict[tuple[int, str], _Chain] = {}
    for number, stage in enumerate(stages):
        leg = legs[stage.leg]
        lanes = [lane for lane in leg.sections[stage.section].lanes if leg.id_of(lane) * side > 0]
        innermost = 0
        current: dict[int, _Chain] = {}
        for lane in sorted(lanes, key=lambda lane: abs(lane.id)):
            lane_id = leg.id_of(lane)
            earlier = last_by_lane.get((lane_id, lane.type))
            if earlier in expected.values():
                earlier = None
            chain = next(
                (
                    offer
                    for offer in (expected.get(lane_id), earlier)
                    if offer is not None
                    and offer.type == lane.type
                    and number not in offer.lanes
                    and offer in chains[innermost:]
                ),
                None,
            )
            if chain is None:
                chain = _Chain(lane.type, lane.reversed, lane.mark, side)
                chains.insert(innermost, chain)
                if len(chains) > _MAX_STRIPS:
                    raise ValueError("has too many lanes that do not continue each other")
            innermost = chains.index(chain) + 1
            chain.lanes[number] = lane
            current[lane_id] = chain
            if not leg.road.junction:
                last_by_lane[lane_id, lane.type] = chain
        if number + 1 < len(stages):
            pairs = _links(network, legs, stage, stages[number + 1], side)
            if not pairs:
                pairs = [(lane_id, lane_id) for lane_id in current]
            expected = {}
            for before, after in pairs:
                if before in current:
                    expected.setdefault(after, current[before])
    return chains


def _links(
    network: Network,
    legs: Sequence[Leg],
    stage: _SectionStage,
    following: _SectionStage,
    side: int,
) -> list[tuple[int, int]]:
    """Return pairs of lane ids on one side that continue each other from one stage to the next."""
    if following.leg == stage.leg:
        pairs = section_links(legs[stage.leg], stage.section)
    else:
        pairs = lane_links(network, legs[stage.leg], legs[following.leg])
    return [pair for pair in pairs if pair[0] * side > 0 and pair[1] * side > 0]


def _parts(legs: Sequence[Leg], places: Places) -> list[tuple[_SectionStage, slice]]:
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


def _measure(run: _Run, places: Places, sides: Mapping[int, Sequence[_Chain]]) -> None:
    """Set the edges of the lanes that exist in one stage."""
    part, own = run.part, places.own[run.part]
    turn = 1.0 if run.leg.forward else -1.0
    shift = places.shifts[int(places.legs[part.start])]
    offsets = turn * _values(run.leg.road.lane_offset, own) - shift
    along = own - run.leg.sections[run.section].s
    for side, chains in sides.items():
        edge = rounded(offsets) + 0.0
        for chain in chains:
            lane = chain.lanes.get(run.number)
            if lane is None:
                continue
            width = np.clip(_values(lane.widths, along), 0.0, _MAX_WIDTH_M)
            outer = rounded(edge + side * width) + 0.0
            chain.right[part], chain.left[part] = (outer, edge) if side < 0 else (edge, outer)
            edge = outer


def _values(pieces: tuple[Cubic, ...], along: Floats) -> Floats:
    first = pieces[0] if len(pieces) == 1 else None
    if first and first.start <= 0.0 and first.b == first.c == first.d == 0.0:
        return np.full_like(along, first.a)
    return piecewise_all(pieces, along)


def _drawn_through(chain: _Chain, in_junction: NDArray[np.bool_]) -> Floats:
    """Return [2, n] edges of a strip across junctions where it is missing, NaN elsewhere."""
    missing = np.isnan(chain.right)
    drawn = np.full((2, len(missing)), np.nan)
    if chain.kind not in _BRIDGED:
        return drawn
    changes = np.flatnonzero(np.diff(np.concatenate(([0], missing.astype(np.int8), [0]))))
    for first, last in zip(changes[::2].tolist(), changes[1::2].tolist(), strict=True):
        if first == 0 or last == len(missing) or not in_junction[first:last].all():
            continue
        part = np.arange(1, last - first + 1) / (last - first + 1)
        for row, edge in zip(drawn, (chain.right, chain.left), strict=True):
            row[first:last] = edge[first - 1] + part * (edge[last] - edge[first - 1])
    return np.round(drawn, 6)


def _fill(chains: Sequence[_Chain], edges_through: Sequence[Floats], part: slice) -> None:
    """Set the edges of the strips that are missing in one stage; `edges_through` are those across junctions."""
    is_missing = [bool(np.isnan(chain.right[part.start])) for chain in chains]
    first, last = is_missing.index(False), len(chains) - 1 - is_missing[::-1].index(False)
    for index in range(first + 1, last):
        if is_missing[index]:
            chains[index].right[part] = chains[index].left[part] = chains[index - 1].left[part]
    cursor = chains[first].right[part]
    for index in range(first - 1, -1, -1):
        chains[index].left[part] = cursor
        cursor = np.fmin(cursor, edges_through[index][0][part])
        chains[index].right[part] = cursor
    cursor = chains[last].left[part]
    for index in range(last + 1, len(chains)):
        chains[index].right[part] = cursor
        cursor = np.fmax(cursor, edges_through[index][1][part])
        chains[index].left[part] = cursor


def _mark(word: str) -> str:
    """Return a corridor's name for an OpenDRIVE mark."""
    if word in ("none", "curb"):
        return word
    return "broken" if word in ("broken", "broken broken", "botts dots") else "solid"
