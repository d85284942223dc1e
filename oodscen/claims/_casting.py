"""Casting: the actors, or parts of the map, that show the things of a text, so that the fewest claims fail."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from oodscen.claims._actors import judge_actor
from oodscen.claims._assignment import cheapest_assignment
from oodscen.claims._findings import ClaimFinding, failures, finding
from oodscen.claims._observation import ObservedActor
from oodscen.claims._things import Thing
from oodscen.data._claim import Claim

_UNFITTING = 1000
"""Number of failed claims that a thing without a fitting actor counts as."""
_OUT_OF_ORDER = frozenset({"off", "all_on", "flashing"})
"""States that a map's own signals never show."""


class Subject(NamedTuple):
    """A thing of the text, with its claims and whatever may show it."""

    name: str
    claims: Sequence[Claim]
    thing: Thing | None
    """The kind of thing; `None` for an unknown noun."""
    candidates: Sequence[ObservedActor]
    """The actors that may show it, in the scene's order."""
    is_stated: bool
    """True if the scene names the actors that show it."""
    misfit: str
    """Reason why none of those actors can be it; empty if one can."""
    is_of_map: bool
    """True if the scene says that the road itself shows it."""
    map_fault: str
    """Fault of those of the map; empty if they are in order."""
    is_scenery: bool
    """True if the map may show it, and all of its claims could be true of that."""

    @property
    def is_single(self) -> bool:
        """True if the thing is one particular actor, which no other thing is."""
        if self.thing is not None and self.thing.vague:
            return False
        if any(claim.kind == "count" and int(claim.value) > 1 for claim in self.claims):
            return False
        return not self.is_stated or len(self.candidates) <= 1


class Casting(NamedTuple):
    """The findings about a thing, and the actors that show it."""

    findings: Mapping[Claim, ClaimFinding]
    actor_ids: Sequence[str] = ()


def cast(subjects: Sequence[Subject]) -> dict[str, Casting]:
    """Assign the things of one noun to actors, and return their castings by name."""
    castings = {
        subject.name: _judge_several(subject) for subject in subjects if not subject.is_single
    }
    singles = [subject for subject in subjects if subject.is_single]
    findings = {
        (subject.name, actor.id): _judge_for(actor, subject.claims)
        for subject in singles
        for actor in subject.candidates
    }

    indexed = {actor.index: actor for subject in subjects for actor in subject.candidates}
    pool = [indexed[index] for index in sorted(indexed)]
    choices = [*pool, *[None] * (len(singles) - len(pool))]

    def cost(subject: Subject, actor: ObservedActor | None) -> int:
        """Return the number of claims that fail; a thing without a fitting actor counts as many."""
        judged = None if actor is None else findings.get((subject.name, actor.id))
        return _UNFITTING if judged is None else failures(judged.values())

    best = cheapest_assignment([[cost(one, actor) for actor in choices] for one in singles])
    for subject, column in zip(singles, best, strict=True):
        actor = choices[column]
        judged = None if actor is None else findings.get((subject.name, actor.id))
        without = _judge_without_actor(subject, has_others=bool(pool))
        if actor is None or judged is None or _is_rather_the_maps(subject, without, judged):
            castings[subject.name] = Casting(without)
        else:
            castings[subject.name] = Casting(judged, [actor.id])
    return castings


def _is_rather_the_maps(
    subject: Subject, without: Mapping[Claim, ClaimFinding], judged: Mapping[Claim, ClaimFinding]
) -> bool:
    """Return whether fewer claims fail without an actor; a signal that is placed replaces the map's own."""
    if subject.thing is not None and subject.thing.group == "signal":
        return False
    return failures(without.values()) < failures(judged.values())


def _judge_for(actor: ObservedActor, claims: Sequence[Claim]) -> dict[Claim, ClaimFinding]:
    findings = {}
    for claim in claims:
        holds, found = judge_actor(claim, actor, claims)
        found = f"for {actor.id!r} ({actor.asset.id}) {found}"
        findings[claim] = finding(claim, holds, found, f"actors[{actor.index}]")
    return findings


def _judge_several(subject: Subject) -> Casting:
    """Judge claims about several things: each must hold for at least one of them."""
    actors, thing = subject.candidates, subject.thing
    if not actors:
        return Casting(_judge_without_actor(subject, has_others=False))
    ids = [actor.id for actor in actors]
    by_actor = [_judge_for(actor, subject.claims) for actor in actors]
    findings: dict[Claim, ClaimFinding] = {}
    for claim in subject.claims:
        if claim.kind == "count":
            are_enough = len(actors) >= int(claim.value) or (thing is not None and thing.many)
            found = f"there are {len(actors)}: {', '.join(ids)}"
            findings[claim] = finding(claim, are_enough, found, "actors")
        else:
            options = [judged[claim] for judged in by_actor]
            findings[claim] = min(options, key=_shortfall)
    return Casting(findings, ids)


def _shortfall(found: ClaimFinding) -> int:
    """Return how far a finding is from showing that a claim holds: 0 if it does, 2 if the claim fails."""
    return ("holds", "open", "fails").index(found.status)


def _judge_without_actor(subject: Subject, *, has_others: bool) -> dict[Claim, ClaimFinding]:
    """Return the findings about a thing that no actor represents."""
    if subject.is_scenery:
        return {claim: _judge_scenery(claim, subject.map_fault) for claim in subject.claims}
    if subject.misfit:
        found = subject.misfit
    elif subject.is_of_map:
        found = (
            "the road has none that could be one, or none that could do this; how far away the road's own things are is not "
            "measured, so an actor must show it"
        )
    else:
        found = f"there is no{' other' if has_others else ''} actor that is one"
    return {claim: finding(claim, False, found, "actors") for claim in subject.claims}


def _judge_scenery(claim: Claim, map_fault: str) -> ClaimFinding:
    """Judge a claim about a thing that only the map shows; it is stationary, and in order without a fault."""
    if map_fault and claim.kind == "thing":
        return finding(claim, map_fault != "missing", f"the map's own: {map_fault}", "map_state")
    if map_fault and claim.kind == "state":
        holds = _shows_state(claim.value, map_fault)
        return finding(claim, holds, f"the map's own: {map_fault}", "map_state")
    if claim.kind == "state" and claim.value in _OUT_OF_ORDER:
        return finding(claim, False, "the map's own is in order", "map")
    return finding(claim, True if claim.kind == "thing" else None, "the map has it", "map")


def _shows_state(state: str, map_fault: str) -> bool:
    """Return whether things of the map with a fault show a state, such as the amber of flashing lights."""
    if map_fault in ("bent", "turned"):
        return state not in _OUT_OF_ORDER
    return state == map_fault or (map_fault == "flashing" and state == "amber")
