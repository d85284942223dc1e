"""Placement of a recipe's actors on the road, each with its ordinary counterpart."""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from oodscen.author._knowledge.base import Drawn, RecipeActor, RecipeTrigger, TrafficActor
from oodscen.author._staging.anchors import marks
from oodscen.author._staging.decision_distances import decisive
from oodscen.author._staging.layout import Cast, Layout
from oodscen.claims._things import Thing
from oodscen.data._catalogue import LANDMARKS
from oodscen.data._details import Details
from oodscen.data._scene import Actor, Behaviour, Placement, Trigger
from oodscen.prompts._digest import CatalogueDigest

_SLOWED = frozenset({"vehicle", "cyclist"})
"""Categories whose speeds decrease with the road's speed limit."""
_FARTHEST_M = 150.0
"""Largest lateral starting distance of crossing traffic, m."""


class _AnchorSpot(NamedTuple):
    """The anchor from which an actor is measured."""

    ahead_m: float
    """Distance ahead of the ego's start, m."""
    lane: int
    offset_m: float


def cast_all(layout: Layout) -> Cast:
    """Place the actors of the recipe."""
    actors: list[Actor] = []
    unusual: dict[str, Actor | None] = {}
    first: dict[str, Actor] = {}
    for part in layout.recipe.actors:
        row = _row(part, layout, first)
        first.setdefault(part.id, row[0][0])
        actors += [actor for actor, _ in row]
        if part.hazard:
            unusual.update((actor.id, counterpart) for actor, counterpart in row)
    return Cast(actors, unusual)


def _row(
    part: RecipeActor, layout: Layout, placed: Mapping[str, Actor]
) -> list[tuple[Actor, Actor | None]]:
    """Draw an actor, or a row of them, each with its ordinary counterpart.

    `placed` holds the actors from which it may be measured, by id in the recipe; of a row, the first.
    """
    first_ahead = _draw_ahead(part, layout)
    first_offset, asset = layout.draw(part.offset), layout.choose(part.asset)
    lane = 0 if part.at in placed else _choose_lane(part.lane, layout)
    row = []
    spots = [spot for spot in _spots(part, layout, placed) for _ in part.names]
    for index, (name, spot) in enumerate(zip(_names(part, len(spots)), spots, strict=True)):
        behaviour = Behaviour(
            name=part.behaviour,
            trigger=_trigger(part.trigger, layout),
            parameters=_parameters(part.behaviour, part.parameters, layout, asset),
            other=part.other,
        )
        heading = layout.draw(part.heading_deg)
        steps = index if part.count > 1 else 0
        ahead = spot.ahead_m + first_ahead + steps * part.spread_ahead
        offset = spot.offset_m + first_offset + steps * part.spread_offset
        if part.meets is not None:
            offset = _crossing_offset(layout, ahead, heading, behaviour, layout.draw(part.meets))
        actor = Actor(
            id=name,
            asset=asset if part.count == 1 else layout.choose(part.asset),
            placement=Placement(
                ahead_m=round(ahead, 2),
                lane=spot.lane + lane,
                offset_m=round(offset, 2),
                heading_deg=heading,
            ),
            behaviour=behaviour,
            state=_state(asset, part.state, layout),
            details=_details(part.details, layout.digest),
        )
        row.append((actor, _ordinary(actor, part, layout)))
    return row


def _names(part: RecipeActor, count: int) -> tuple[str, ...]:
    if count == len(part.names):
        return part.names
    return tuple(f"{part.id}-{number}" for number in range(1, count + 1))


def _draw_ahead(part: RecipeActor, layout: Layout) -> float:
    """Draw the distance of an actor ahead of its anchor; a displacement narrows the range."""
    if part.at != "start" or not layout.shift_m:
        return layout.draw(part.ahead)
    low, high = part.ahead
    middle = 0.5 * (low + high)
    reach = 0.0 if decisive(layout.recipe) is part else 0.25 * (high - low)
    return layout.draw((middle - reach, middle + reach)) + layout.shift_m


def _spots(part: RecipeActor, layout: Layout, placed: Mapping[str, Actor]) -> Iterator[_AnchorSpot]:
    if part.at in LANDMARKS:
        for mark in marks(layout.road, part):
            is_light = part.at == "traffic_light"
            yield _AnchorSpot(mark.ahead_m, -layout.ego_lane if is_light else 0, mark.left_m)
    elif part.at in placed:
        place = placed[part.at].placement
        yield _AnchorSpot(place.ahead_m, place.lane, place.offset_m)
    else:
        yield _AnchorSpot(0.0, 0, 0.0)


def _crossing_offset(
    layout: Layout, ahead: float, heading_deg: float, behaviour: Behaviour, late_s: float
) -> float:
    """Return the lateral start of traffic that crosses some way ahead, `late_s` after the ego, m to the left.

    A positive heading comes from the right.
    """
    seconds = max(ahead / layout.speed + late_s, 0.5)
    distance = min(behaviour.parameters.get("speed", 0.0) * seconds, _FARTHEST_M)
    return -distance if heading_deg > 0.0 else distance


def _choose_lane(options: tuple[int, ...], layout: Layout) -> int:
    """Choose one of the lanes that the road has."""
    fitting = [lane for lane in options if layout.has_lane(lane)] or list(options)
    return fitting[int(layout.rng.integers(len(fitting)))]


def _trigger(trigger: RecipeTrigger, layout: Layout) -> Trigger:
    return Trigger(kind=trigger.kind, value=layout.draw(trigger.value), actor=trigger.actor)


def _ordinary(actor: Actor, part: RecipeActor, layout: Layout) -> Actor | None:
    """Return the counterpart of an actor in the ordinary twin; `None` for plain removal."""
    if part.ordinary == "remove":
        return None
    change, placement, behaviour = part.ordinary, actor.placement, actor.behaviour
    name = change.behaviour or behaviour.name
    trigger = behaviour.trigger if name == behaviour.name else Trigger()
    if change.trigger is not None:
        trigger = _trigger(change.trigger, layout)
    asset = layout.choose(change.asset) if change.asset else actor.asset
    unchanged: dict[str, Drawn] = {
        key: (value, value) for key, value in behaviour.parameters.items()
    }
    parameters = _parameters(name, unchanged, layout)
    parameters.update(_parameters(name, change.parameters or {}, layout, asset))
    state = actor.state if change.state is None else change.state
    offset = placement.offset_m if change.offset is None else layout.draw(change.offset)
    if part.meets is not None:
        offset = abs(offset) if placement.offset_m > 0.0 else -abs(offset)
    return Actor(
        id=actor.id,
        asset=asset,
        placement=Placement(
            ahead_m=placement.ahead_m if change.ahead is None else layout.draw(change.ahead),
            lane=placement.lane if change.lane is None else _lane_on_road(change.lane, layout),
            offset_m=offset,
            heading_deg=(
                placement.heading_deg
                if change.heading_deg is None
                else layout.draw(change.heading_deg)
            ),
        ),
        behaviour=Behaviour(
            name=name,
            trigger=trigger,
            parameters=parameters,
            other=behaviour.other if name == behaviour.name else None,
        ),
        state=_state(asset, state, layout),
    )


def _lane_on_road(lane: int, layout: Layout) -> int:
    """Return a lane that the road has; if there is none on this side of the ego, one on the other."""
    return lane if layout.has_lane(lane) else -lane


def _parameters(
    name: str, limits: Mapping[str, Drawn], layout: Layout, asset: str = ""
) -> dict[str, float]:
    """Draw the parameters that a behaviour has, within the limits of the catalogue; others are ignored.

    The speed of an asset is scaled down if the road's limit slows the ego down.
    """
    is_slowed = asset in layout.assets and layout.assets[asset].category in _SLOWED
    lines = (line.limits for line in layout.digest.behaviours if line.id == name)
    allowed = next(lines, {})
    parameters = {}
    for key, limit in limits.items():
        value = layout.draw((layout.speed, layout.speed) if limit == "ego" else limit)
        if key not in allowed:
            continue
        if key == "speed" and limit != "ego" and is_slowed:
            value = round(value * layout.slowed, 2)
        low, high = allowed[key]
        parameters[key] = min(max(value, low), high)
    return parameters


def _state(asset: str, state: str, layout: Layout) -> str:
    """Return a state if the asset has it, or else the empty state."""
    return state if asset in layout.assets and state in layout.assets[asset].states else ""


def _details(wanted: Details | None, digest: CatalogueDigest) -> Details | None:
    """Return the details of an actor, `None` if the simulator cannot show all of them."""
    if wanted is None:
        return None
    is_posed = not wanted.pose or wanted.pose in digest.poses
    return wanted if is_posed and set(wanted.parts) <= set(digest.parts) else None


def named_traffic(part: TrafficActor, layout: Layout, named: tuple[Thing, ...]) -> list[Actor]:
    """Return the ordinary road user that the text mentions, if the road has a lane for it."""
    first_oncoming = layout.road.lanes - layout.ego_lane
    if part.side == "oncoming":
        lane, has_lane = first_oncoming, layout.road.oncoming_lanes >= 1
    else:
        lane, has_lane = 1, first_oncoming >= 2
    if not has_lane:
        return []
    return [
        Actor(
            id=part.id,
            asset=layout.choose(part.asset, named),
            placement=Placement(ahead_m=layout.draw(part.ahead), lane=lane),
            behaviour=Behaviour(
                name=part.behaviour, parameters=_parameters(part.behaviour, part.parameters, layout)
            ),
        )
    ]
