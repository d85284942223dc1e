"""Things made to order: designs that a scene carries, for what no catalogue has."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from oodscen.data import _shapes as shapes
from oodscen.data._base import ROUNDING, Data
from oodscen.data._blocks import REACH_M, Solid, held
from oodscen.data._category import Category
from oodscen.data._description import Description
from oodscen.data._extents import Extent, Measured, Size, measured
from oodscen.data._issues import MOST_PARTS, IssuesError
from oodscen.data._lettering import strokes
from oodscen.data._shapes import A_NUMBER, Part, Parts
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
        return measured(self.parts, state, sizes).bounds

    @property
    def is_passable(self) -> bool:
        """True if cars drive over it, through it or beneath it in every state."""
        found = measured(self.parts)
        is_light = self.mass_kg <= LIGHT_KG or all(box.is_airy for _, box in found.spaces)
        is_above = self.anchor != "road" and found.bounds.low[2] >= CLEAR_M
        return self.touch == "flat" or is_above or (self.touch == "soft" and is_light)

    def asset(self, sizes: Mapping[str, Size] | None = None) -> "Asset":
        """Return it as an asset of a catalogue.

        Args:
            sizes: Length, width and height of the catalogue's things, for those that are parts.
        """
        from oodscen.data._catalogue import Asset

        low, high, _ = self.space(sizes)
        tags = dict.fromkeys((*self.tags, MADE, *(("flat",) if self.touch == "flat" else ())))
        return Asset(
            id=self.id,
            category=self.category,
            description=self.description,
            length=max(0.05, round(high[0] - low[0], 2)),
            width=max(0.05, round(high[1] - low[1], 2)),
            height=max(0.01, round(high[2], 2)),
            tags=tuple(tags),
            states=self.states,
            passable=(self.states or ("",)) if self.is_passable else self.passable,
        )


def check_prop(prop: Prop, assets: "Iterable[Asset]") -> list[Issue]:
    """Return the faults of a design in a simulator: unknown parts, and moving things built in.

    Args:
        prop: The design.
        assets: The assets of the simulator.
    """
    known = {asset.id: asset for asset in assets}
    issues = []
    if prop.id in known and MADE not in known[prop.id].tags:
        issues.append(Issue("id", f"the catalogue has {prop.id!r} already"))
    moving = 0
    for path, name in measured(prop.parts).shipped:
        asset = known.get(name)
        if asset is None:
            issues.append(Issue(path, f"the catalogue has no {name!r}"))
        elif asset.category in _MOVING:
            moving += 1
            if asset.category != prop.category or moving > 1:
                message = (
                    f"{name!r} moves by itself, so it is an actor of its own and no part; a design of "
                    f"category {asset.category} may have one as its body"
                )
                issues.append(Issue(path, message))
    if not issues:
        sizes = sizes_of(known.values())
        issues += _size_faults(measured(prop.parts, None, sizes).bounds)
        issues += _floating(prop, sizes)
    return issues


def sizes_of(assets: "Iterable[Asset]") -> dict[str, Size]:
    """Return length, width and height of assets, by id."""
    return {asset.id: (asset.length, asset.width, asset.height) for asset in assets}


# ---------------------------------------------------------------------- faults


def _faults(prop: Prop) -> Iterator[Issue]:
    """Yield the faults of a design as a whole."""
    if _depth(prop.parts) > MOST_DEPTH:
        yield Issue("parts", f"parts are nested more than {MOST_DEPTH} deep")
        return
    found = measured(prop.parts)
    yield from _cost_faults(found)
    if found.solids > MOST_SOLIDS:
        return
    for path, word in found.words:
        if word not in prop.states:
            yield Issue(path, f"{word!r} is none of its states")
    for word in prop.passable:
        if word not in prop.states:
            yield Issue("passable", f"{word!r} is none of its states")
    if len(set(prop.states)) < len(prop.states):
        yield Issue("states", "a state occurs more than once")
    if not found.spaces:
        if not found.shipped:
            yield Issue("parts", "nothing of it can be seen")
        return
    tops: dict[str, float] = {}
    for path, box in found.spaces:
        tops[path] = max(box.high[2], tops.get(path, 0.0))
    for path, (low, _, _) in found.spaces:
        if low[2] < -SUNK_M or tops[path] <= 0.0:
            yield Issue(path, f"reaches {-low[2]:.2f} m below the road, which is z = 0")
            break
    if found.shipped:
        return
    bounds = found.bounds
    yield from _size_faults(bounds)
    if prop.touch == "flat" and bounds.high[2] >= FLAT_M:
        yield Issue("touch", f"what is flat is lower than {FLAT_M:g} m, not {bounds.high[2]:.2f} m")
    if prop.anchor != "road" and bounds.low[2] < OFF_ROAD_M:
        yield Issue("anchor", f"what is {prop.anchor} does not stand on the road")
        return
    yield from _floating(prop, {})


def _cost_faults(found: Measured) -> Iterator[Issue]:
    limits = (
        (found.parts, MOST_PARTS, "parts"),
        (found.solids, MOST_SOLIDS, "parts after repetition"),
        (found.triangles, MOST_TRIANGLES, "triangles"),
        (found.lamps, MOST_LAMPS, "lamps"),
        (found.puffs, MOST_PUFFS, "puffs"),
        (len({text for _, text in found.texts}), MOST_TEXTS, "different texts"),
        (len(found.colours), MOST_COLOURS, "colours"),
    )
    for count, most, what in limits:
        if count > most:
            yield Issue("parts", f"at most {most:,} {what}, not {count:,}")
    for path, text in dict(found.texts).items():
        if not strokes(text):
            yield Issue(path, "no letter of it can be seen")


def _size_faults(bounds: Extent) -> Iterator[Issue]:
    names = ("long", "wide", "high")
    sizes = [bounds.high[0] - bounds.low[0], bounds.high[1] - bounds.low[1], bounds.high[2]]
    for name, size, most in zip(names, sizes, LARGEST, strict=True):
        if size > most + ROUNDING:
            yield Issue("parts", f"it is {size:.1f} m {name}; {most:g} m at most")
    if max(sizes) < LEAST_M:
        yield Issue("parts", f"it is {max(sizes):.2f} m large; {LEAST_M:g} m at least can be seen")


def _floating(prop: Prop, sizes: Mapping[str, Size]) -> Iterator[Issue]:
    """Yield a fault for the first part that nothing holds, in any state."""
    shipped = {name for _, name in measured(prop.parts).shipped}
    known = tuple(sorted((name, sizes[name]) for name in shipped & sizes.keys()))
    for state in prop.states or ("",):
        loose = _loose(prop.parts, prop.anchor == "road", state, known)
        if loose:
            here = f" in the state {state!r}" if state else ""
            least = "the road or another part" if prop.anchor == "road" else "its other parts"
            yield Issue(loose, f"floats{here}: it is more than {REACH_M:g} m from {least}")
            return


@lru_cache(maxsize=512)
def _loose(parts: Parts, is_standing: bool, state: str, sizes: tuple[tuple[str, Size], ...]) -> str:
    """Return the path of the first part that nothing holds, empty if there is none.

    A design is read again with every scene that carries it, so the answer is kept.
    """
    found = measured(parts, state, dict(sizes))
    named = [
        (path, Solid(box, *made))
        for (path, box), made in zip(found.spaces, found.made_of, strict=True)
        if not box.is_airy
    ]
    are_held = held([solid for _, solid in named], is_standing=is_standing)
    loose = (path for (path, _), is_held in zip(named, are_held, strict=True) if not is_held)
    return next(loose, "")


_INNER = ("parts", "both_sides", "turned", "otherwise")
_GROUPS = (
    shapes.BothSidesOf, shapes.RowOf, shapes.CopiesOf, shapes.ConditionOf, shapes.TurnedOf
)  # fmt: skip


def _depth(parts: Sequence[Part]) -> int:
    """Return how deep parts are nested, without recursion beyond what is allowed."""
    level, depth = list(parts), 0
    while level and depth <= MOST_DEPTH:
        depth += 1
        level = [
            inner
            for part in level
            if isinstance(part, _GROUPS)
            for name in _INNER
            for inner in getattr(part, name, ())
        ]
    return depth
