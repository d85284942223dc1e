"""Validation of a knowledge base: all faults of its entries, each with file and path."""

from collections import Counter
from collections.abc import Collection, Iterable, Sequence
from pathlib import Path

from oodscen._words.wording import wording_fault
from oodscen.author._knowledge.base import Clash, Driving, HazardKind, Knowledge, Recipe
from oodscen.author._knowledge.loading import file_of, gather, own_files
from oodscen.author._writing.agreement import Agreement, PlaceAndTime
from oodscen.data._weather import Weather
from oodscen.errors import DataError, Issue
from oodscen.prompts._tree.kind_labels import kind_fault
from oodscen.tree._labels import same_words


def validate_knowledge(path: str | Path | None = None) -> list[Issue]:
    """Find all faults of the shipped knowledge base and a user's own.

    Besides unreadable entries, these are dangling references, duplicate labels, phrasings that
    break the rules of composition, and recipes that cannot be staged.

    Args:
        path: As for `load_knowledge`.

    Returns:
        One issue per fault, with file and path; empty if there are none.
    """
    try:
        shelf, knowledge = gather(path, salvaged=True)
    except DataError as error:
        return list(error.issues)
    issues = list(shelf.issues)
    if knowledge is None:
        return issues
    faults = list(_repetitions(shelf.hazards))
    if path is not None:
        own = own_files(Path(path))
        faults += _replaced([entry for entry in shelf.hazards if file_of(entry[0]) in own])
    for table in ("clash", "driving"):
        for where, entry in shelf.entries[table]:
            faults += _located(where, _unknown_keys(entry, knowledge))
    for where, place in shelf.entries["place"]:
        unknown = place.told.keys() - set(place.traits)
        faults += _located(where, (Issue(f"told.{key}", "is no trait of it") for key in unknown))
    agreement = Agreement(knowledge)
    for where, hazard in shelf.hazards:
        faults += _located(where, _faults(hazard, knowledge))
        faults += _located(where, _unsuitable_clauses(hazard, agreement))
    return [*issues, *(fault for fault in faults if not shelf.is_broken(fault))]


def _located(where: str, issues: Iterable[Issue]) -> list[Issue]:
    """Return issues with the file and line of their entry."""
    return [Issue(f"{where}: {issue.path}", issue.message) for issue in issues]


def _repetitions(entries: Sequence[tuple[str, HazardKind]]) -> list[Issue]:
    issues = []
    latest = {hazard.id: hazard for _, hazard in entries}
    labels = Counter(
        same_words(label)
        for hazard in latest.values()
        for label in (hazard.label, hazard.wider)
        if label
    )
    classes: dict[str, str] = {}
    for where, hazard in entries:
        issues += [
            Issue(f"{where}: {field}", "another hazard has the same")
            for field in ("label", "wider")
            if labels[same_words(getattr(hazard, field))] > 1
        ]
        if labels[same_words(hazard.family)]:
            issues.append(Issue(f"{where}: family", "is the label of a hazard as well"))
        if classes.setdefault(hazard.family, hazard.class_name) != hazard.class_name:
            issues.append(Issue(f"{where}: family", "belongs to the other class elsewhere"))
    return issues


def _replaced(own: Sequence[tuple[str, HazardKind]]) -> list[Issue]:
    """Return the hazards of a user that another of theirs replaces, since a later one with the id of an earlier does."""
    ids = Counter(hazard.id for _, hazard in own)
    return [
        Issue(f"{where}: id", f"{hazard.id!r} occurs twice; only the last one counts")
        for where, hazard in own
        if ids[hazard.id] > 1
    ]


def _faults(hazard: HazardKind, knowledge: Knowledge) -> Iterable[Issue]:
    for field in ("label", "wider", "family"):
        if (label := getattr(hazard, field)) and (fault := kind_fault(label)):
            yield Issue(field, fault)
    yield from _unknown_keys(hazard, knowledge)
    yield from _kin_faults(hazard, knowledge)
    yield from _event_faults(hazard.events)
    if hazard.stage is not None:
        yield from _recipe_faults(hazard.stage)


def _unknown_keys(entry: Clash | Driving | HazardKind, knowledge: Knowledge) -> Iterable[Issue]:
    """Yield references to unknown places, conditions or traffic."""
    traffic = {one.key for one in knowledge.traffic}
    for field, noun, named, known in (
        ("places", "place", entry.places, set(knowledge.place_keys)),
        ("conditions", "condition", entry.conditions, set(knowledge.condition_keys)),
        ("traffic", "traffic", entry.traffic if isinstance(entry, Clash) else (), traffic),
    ):
        for index, key in enumerate(named):
            if key not in known:
                yield Issue(f"{field}[{index}]", f"unknown {noun} {key!r}")


def _kin_faults(hazard: HazardKind, knowledge: Knowledge) -> Iterable[Issue]:
    """Yield kin that are not of the hazard's class, or that no wider label covers."""
    for index, name in enumerate(hazard.kin):
        other = knowledge.by_id.get(name)
        if other is None:
            yield Issue(f"kin[{index}]", f"unknown hazard {name!r}")
        elif other.class_name != hazard.class_name:
            yield Issue(f"kin[{index}]", f"{name!r} belongs to the other class")
    if hazard.kin and not hazard.wider:
        yield Issue("wider", "kin can be covered only by a wider label")


def _event_faults(events: Sequence[str]) -> Iterable[Issue]:
    """Yield phrasings that break the rules of composition, repeat others, or are too few."""
    if len(events) < 5:
        yield Issue("events", f"{len(events)} phrasings; at least 5 are wanted")
    for index, event in enumerate(events):
        for message in _phrasing_faults(event):
            yield Issue(f"events[{index}]", message)
    if len(set(events)) < len(events):
        yield Issue("events", "a phrasing occurs twice")


def _unsuitable_clauses(hazard: HazardKind, agreement: Agreement) -> Iterable[Issue]:
    """Yield clauses that do not suit the places and conditions of their hazard."""
    settings = [
        PlaceAndTime(place=place, conditions=(key,) if key else ())
        for place in hazard.places
        for key in hazard.conditions or ("",)
    ]
    for index, event in enumerate(hazard.events):
        if not any(agreement.suits(event, setting) for setting in settings):
            clash = agreement.clashes(event, settings[0])[0]
            yield Issue(f"events[{index}]", f"suits none of its places and conditions: {clash}")
    for setting in settings:
        where = " ".join((setting.place, *setting.conditions))
        for field, clauses in (("events", hazard.events), ("ordinary", hazard.ordinary)):
            if not agreement.suiting(clauses, setting):
                clash = agreement.clashes(clauses[0], setting)[0]
                yield Issue(field, f"none suits {where}: {clash}")


def _phrasing_faults(event: str) -> Iterable[str]:
    if not event[:1].isupper():
        yield "must start with a capital letter"
    if event.rstrip()[-1:] in ".!?":
        yield "must end without a full stop"
    if event.count("{where}") > 1 or "{" in event.replace("{where}", ""):
        yield "the only placeholder is {where}, at most once"
    if not 20 <= len(event) <= 260:
        yield "must have 20 to 260 characters"
    if fault := wording_fault(event.replace("{where}", "")):
        yield fault


def _recipe_faults(recipe: Recipe) -> Iterable[Issue]:
    names = [name for actor in recipe.actors for name in actor.names]
    if len(set(names)) < len(names):
        yield Issue("stage.actors", "two actors have the same id")
    if not recipe.hazards and not recipe.ordinary_weather:
        yield Issue("stage", "name a hazard actor, or the ordinary weather")
    if recipe.decision.actor is not None and recipe.decision.actor not in names:
        yield Issue("stage.decision.actor", f"unknown actor {recipe.decision.actor!r}")
    if recipe.decision.kind != "time" and recipe.decision.actor is None and not recipe.hazards:
        yield Issue("stage.decision.actor", "say to which actor it is measured")
    yield from _actor_faults(recipe, names)
    ids = {actor.id for actor in recipe.actors}
    for index, variant in enumerate(recipe.variants):
        for name in sorted(set(variant.actors) - ids):
            yield Issue(f"stage.variants[{index}].actors", f"unknown actor {name!r}")
    for field in ("weather", "ordinary_weather"):
        for key in getattr(recipe, field):
            if key not in Weather.model_fields:
                yield Issue(f"stage.{field}.{key}", "is not a field of the weather")


def _actor_faults(recipe: Recipe, names: Collection[str]) -> Iterable[Issue]:
    """Yield references of actors to others that are unknown, and missing speeds."""
    for index, actor in enumerate(recipe.actors):
        where = f"stage.actors[{index}]"
        for field, target in (("trigger.actor", actor.trigger.actor), ("other", actor.other)):
            if target is not None and target not in names:
                yield Issue(f"{where}.{field}", f"unknown actor {target!r}")
        if actor.meets is not None and "speed" not in actor.parameters:
            yield Issue(f"{where}.meets", "needs the parameter 'speed'")
