"""Starts of the entities of an OpenSCENARIO file."""

from oodscen.interchange._reading.positions import EntityPlace, Positions
from oodscen.interchange._reading.tree import Element


def read_starts(root: Element, positions: Positions) -> None:
    """Read where all entities start, each after the entity to which its start is relative."""
    waiting: dict[str, list[tuple[str, list[Element]]]] = {}
    for name, holders in _positions_by_entity(root, positions).items():
        reference = positions.reference(holders[0])
        waiting.setdefault(reference, []).append((name, holders))
    ready = waiting.pop("", [])
    for name, holders in ready:  # It grows by those that wait for an entity.
        for holder in holders:
            place = positions.read(holder)
            if place is not None:
                positions.places[name] = place
        if name in positions.places:
            ready.extend(waiting.pop(name, []))
    for unplaced in waiting.values():
        for _, holders in unplaced:
            positions.read(holders[0])  # Records why it cannot be read.


def _positions_by_entity(root: Element, positions: Positions) -> dict[str, list[Element]]:
    """Return for each entity the `Position` at which it starts, and later ones that are relative to itself.

    The last place counts, as the actions are taken in order.
    """
    holders_by_name: dict[str, list[Element]] = {}
    for private in root.all("Storyboard", "Init", "Actions", "Private"):
        name = private.get("entityRef")
        for holder in private.all("PrivateAction", "TeleportAction", "Position"):
            holders = holders_by_name.setdefault(name, [])
            if positions.reference(holder) != name:
                for replaced in holders:
                    replaced.leave_out(f"{name[:40]!r} is placed again later, which counts")
                holders.clear()
            holders.append(holder)
    return holders_by_name


def centre_of(name: str, entity: Element, positions: Positions) -> EntityPlace | None:
    """Return the pose of an entity's centre, which is ahead of a vehicle's reference point."""
    place = positions.places.get(name)
    centre = next(entity.within("Center"), None)
    if place is None or centre is None:
        return place
    moved = place.moved(centre.number("x", 0.0), centre.number("y", 0.0))
    return moved._replace(road=place.road, direction=place.direction)
