"""Things made to order: designs that a scene carries, for what no catalogue has."""

from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from oodscen.data._base import ROUNDING, Data
from oodscen.data._category import Category
from oodscen.data._designs import shapes
from oodscen.data._designs.description import Description
from oodscen.data._designs.extents import Extent
from oodscen.data._designs.holding import REACH_M, Solid, held
from oodscen.data._designs.lettering import strokes
from oodscen.data._designs.shapes import A_NUMBER, Parts
from oodscen.data._designs.survey import Size, Survey, all_parts, is_deeper, survey
from oodscen.data._issues import MOST_PARTS, IssuesError
from oodscen.errors import Issue

if TYPE_CHECKING:
    from oodscen.data._catalogue import Asset

MADE = "made"
"""Tag of an asset that was made to order."""
MOST_SOLIDS = 400
MOST_TRIANGLES = 8_000
MOST_LAMPS = 8
MOST_PUFFS = 60
MOST_TEXTS = 2
MOST_COLOURS = 16
MOST_DEPTH = 4
LARGEST: Size = (14.0, 14.0, 9.0)
"""Greatest length, width and height, m."""
LEAST_M = 0.3
"""Greatest extent that a thing must have, m: what is smaller cannot be recognised."""
SUNK_M = 0.5
"""Depth by which a part may reach below the road, m: what is there is cut off."""
FLAT_M = 0.08
"""Maximum height of what lies flat on the road, m: others can drive over and stand on it."""
OFF_ROAD_M = 0.1
"""Least height above the road of what hangs, is fixed to a wall or carried, m."""
CLEAR_M = 2.3
"""Height above the road from which cars pass beneath, m."""
LIGHT_KG = 5.0
"""Mass up to which a soft thing gives way, kg; heavier ones block, unless they are airy."""

Anchor = Literal["road", "hanging", "wall", "carried"]
Touch = Literal["hard", "soft", "flat"]
Word = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_ -]{0,30}$")]
_MOVING = frozenset({"vehicle", "cyclist", "pedestrian", "animal"})


class Prop(Data):
    """The design of one thing: its parts, how it stands and how it is touched."""

    noun: ClassVar[str] = "prop"

    schema_version: Literal[1] = 1
    id: str = Field(pattern=r"^[a-z][a-z0-9_]{1,39}$")
    """Its name as an asset."""
    description: Description
    """Visible appearance, e.g. `a white wall of foam, waist-high`."""
    category: Category = "object"
    tags: tuple[Word, ...] = Field(default=(), max_length=8)
    """Further words for it: what others may call it."""
    anchor: Anchor = "road"
    """Its support: it stands or lies on the road, hangs, is fixed to a wall, or is carried."""
    touch: Touch = "hard"
    """`hard` stops a car, `soft` gives way if it is light, `flat` is driven over."""
    mass_kg: Annotated[float, Field(gt=0, le=60_000), A_NUMBER]
    states: tuple[Word, ...] = Field(default=(), max_length=4)
    """States that its parts tell apart by `when`; the first is the default."""
    passable: tuple[Word, ...] = Field(default=(), max_length=4)
    """States in which it does not block although its box does, e.g. `open`."""
    parts: Parts
    """Metres, x away from the approaching driver, y left, z up; the road is z = 0."""

    @model_validator(mode="after")
    def _sound(self) -> Self:
        issues = list(_faults(self))
        if issues:
            raise IssuesError(issues)
        return self

    def space(self, sizes: Mapping[str, Size] | None = None, state: str | None = None) -> Extent:
        """Return the box around it, in the coordinates of its parts.

        Args:
            sizes: Length, width and height of the catalogue's things, for those that are parts.
            state: The state that is shown; by default all of them.
        """
        return survey(self.parts, state, sizes).bounds

    def asset(self, sizes: Mapping[str, Size] | None = None) -> "Asset":
        """Return it as an asset of a catalogue.

        Args:
            sizes: Length, width and height of the catalogue's things, for those that are parts.
        """
        from oodscen.data._catalogue import Asset

        drawn = survey(self.parts, sizes=sizes)
        low, high, _ = drawn.bounds
        tags = [*self.tags, MADE]
        if self.touch == "flat":
            tags.append("flat")
        return Asset(
            id=self.id,
            category=self.category,
            description=self.description,
            length=max(0.05, round(high[0] - low[0], 2)),
            width=max(0.05, round(high[1] - low[1], 2)),
            height=max(0.01, round(high[2], 2)),
            tags=tuple(dict.fromkeys(tags)),
            states=self.states,
            passable=(self.states or ("",)) if _is_passable(self, drawn) else self.passable,
        )


def check_prop(prop: Prop, assets: "Iterable[Asset]") -> list[Issue]:
    """Return the faults of a design in a simulator: unknown parts, and moving things built in.

    Args:
        prop: The design.
        assets: The assets of the simulator.
    """
    catalogue = {asset.id: asset for asset in assets}
    issues = []
    if prop.id in catalogue and MADE not in catalogue[prop.id].tags:
        issues.append(Issue("id", f"the catalogue has {prop.id!r} already"))
    moving = 0
    for path, asset_id in survey(prop.parts).assets:
        asset = catalogue.get(asset_id)
        if asset is None:
            issues.append(Issue(path, f"the catalogue has no {asset_id!r}"))
        elif asset.category in _MOVING:
            moving += 1
            if asset.category != prop.category or moving > 1:
                message = (
                    f"{asset_id!r} moves by itself, so it is an actor of its own and no part; a design of "
                    f"category {asset.category} may have one as its body"
                )
                issues.append(Issue(path, message))
    if not issues:
        sizes = sizes_of(catalogue.values())
        issues += _size_faults(survey(prop.parts, sizes=sizes).bounds)
        issues += _floating(prop, sizes)
    return list(dict.fromkeys(issues))


def sizes_of(assets: "Iterable[Asset]") -> dict[str, Size]:
    """Return length, width and height of assets, by id."""
    return {asset.id: (asset.length, asset.width, asset.height) for asset in assets}


def _is_passable(prop: Prop, drawn: Survey) -> bool:
    """Return whether cars drive over a thing, through it or beneath it in every state."""
    if prop.touch == "flat":
        return True
    if prop.anchor != "road" and drawn.bounds.low[2] >= CLEAR_M:
        return True
    is_airy = not drawn.assets and all(box.is_airy for _, box in drawn.boxes)
    return prop.touch == "soft" and (is_airy or prop.mass_kg <= LIGHT_KG)


def _faults(prop: Prop) -> Iterator[Issue]:
    """Yield the faults of a design as a whole."""
    if is_deeper(prop.parts, MOST_DEPTH):
        yield Issue("parts", f"parts are nested more than {MOST_DEPTH} deep")
        return
    drawn = survey(prop.parts)
    yield from _cost_faults(prop.parts, drawn)
    if not drawn.is_complete or len(drawn.leaves) > MOST_SOLIDS:
        return
    yield from _state_faults(prop)
    if not drawn.boxes:
        if not drawn.assets:
            yield Issue("parts", "nothing of it can be seen")
        return
    yield from _sunk_fault(drawn)
    if drawn.assets:
        return
    bounds = drawn.bounds
    yield from _size_faults(bounds)
    if prop.touch == "flat" and bounds.high[2] >= FLAT_M:
        yield Issue("touch", f"what is flat is lower than {FLAT_M:g} m, not {bounds.high[2]:.2f} m")
    if prop.anchor != "road" and bounds.low[2] < OFF_ROAD_M:
        yield Issue("anchor", f"what is {prop.anchor} does not stand on the road")
        return
    yield from _floating(prop, {})


def _cost_faults(parts: Parts, drawn: Survey) -> Iterator[Issue]:
    """Yield a fault for each limit that a design exceeds, and for words without a visible letter."""
    if not drawn.is_complete:
        yield Issue("parts", f"at most {MOST_SOLIDS:,} parts after repetition")
        return
    limits = (
        (sum(1 for _ in all_parts(parts)), MOST_PARTS, "parts"),
        (len(drawn.leaves), MOST_SOLIDS, "parts after repetition"),
        (drawn.triangles, MOST_TRIANGLES, "triangles"),
        (drawn.lamps, MOST_LAMPS, "lamps"),
        (drawn.puffs, MOST_PUFFS, "puffs"),
        (len(set(drawn.texts.values())), MOST_TEXTS, "different texts"),
        (len(drawn.colours), MOST_COLOURS, "colours"),
    )
    for count, most, noun in limits:
        if count > most:
            yield Issue("parts", f"at most {most:,} {noun}, not {count:,}")
    for path, text in drawn.texts.items():
        if not strokes(text):
            yield Issue(path, "no letter of it can be seen")


def _state_faults(prop: Prop) -> Iterator[Issue]:
    """Yield the faults of the states, and of the words that refer to them."""
    for path, part in all_parts(prop.parts):
        if isinstance(part, shapes.ConditionOf):
            for word in part.when.split():
                if word not in prop.states:
                    yield Issue(f"{path}.when", f"{word!r} is none of its states")
    for word in prop.passable:
        if word not in prop.states:
            yield Issue("passable", f"{word!r} is none of its states")
    if len(set(prop.states)) < len(prop.states):
        yield Issue("states", "a state occurs more than once")


def _sunk_fault(drawn: Survey) -> Iterator[Issue]:
    """Yield a fault for the first part that is too deep below the road, or not above it at all."""
    tops: dict[str, float] = {}
    for path, box in drawn.boxes:
        tops[path] = max(box.high[2], tops.get(path, 0.0))
    for path, box in drawn.boxes:
        if tops[path] <= 0.0:
            yield Issue(path, "nothing of it is above the road, which is z = 0")
            return
        if box.low[2] < -SUNK_M:
            yield Issue(path, f"reaches {-box.low[2]:.2f} m below the road, which is z = 0")
            return


def _size_faults(bounds: Extent) -> Iterator[Issue]:
    """Yield the faults of the size of a thing."""
    adjectives = ("long", "wide", "high")
    size = [bounds.high[0] - bounds.low[0], bounds.high[1] - bounds.low[1], bounds.high[2]]
    for adjective, extent, most in zip(adjectives, size, LARGEST, strict=True):
        if extent > most + ROUNDING:
            yield Issue("parts", f"it is {extent:.1f} m {adjective}; {most:g} m at most")
    if max(size) < LEAST_M:
        yield Issue("parts", f"it is {max(size):.2f} m large; {LEAST_M:g} m at least can be seen")


def _floating(prop: Prop, sizes: Mapping[str, Size]) -> Iterator[Issue]:
    """Yield a fault for the first part that nothing holds, in any state."""
    assets = {asset_id for _, asset_id in survey(prop.parts).assets}
    asset_sizes = tuple(sorted((name, sizes[name]) for name in assets & sizes.keys()))
    for state in prop.states or ("",):
        path = _loose_part(prop.parts, prop.anchor == "road", state, asset_sizes)
        if path is not None:
            condition = f" in the state {state!r}" if state else ""
            holders = "the road or another part" if prop.anchor == "road" else "its other parts"
            yield Issue(path, f"floats{condition}: it is more than {REACH_M:g} m from {holders}")
            return


@lru_cache(maxsize=512)
def _loose_part(
    parts: Parts, is_standing: bool, state: str, asset_sizes: tuple[tuple[str, Size], ...]
) -> str | None:
    """Return the path of the first part that nothing holds, `None` if there is none.

    A design is read again with every scene that carries it, so the answer is kept.
    """
    paths, solids = [], []
    for leaf in survey(parts, state, dict(asset_sizes)).leaves:
        for box in leaf.boxes:
            if not box.is_airy:
                paths.append(leaf.path)
                solids.append(Solid(box, leaf.part, leaf.transform))
    are_held = held(solids, is_standing=is_standing)
    return next((path for path, is_held in zip(paths, are_held, strict=True) if not is_held), None)
