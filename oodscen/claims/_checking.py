"""Comparison of a text's claims with a scene and with its trace."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import permutations
from math import perm
from typing import ClassVar, Literal, NamedTuple

from oodscen._arguments import checked
from oodscen.claims._actors import ObservedActor
from oodscen.claims._matching import OF_THE_MAP, Likeness, doubt, fault_of_map, is_of_map
from oodscen.claims._surroundings import judge_surroundings
from oodscen.claims._things import Thing, may_be, thing_named
from oodscen.claims._watching import watch
from oodscen.data._base import Data
from oodscen.data._catalogue import Catalogue, RoadMap
from oodscen.data._claim import OF_THINGS, Claim, Mismatch
from oodscen.data._scene import Scene
from oodscen.driving._roads.building import find_map
from oodscen.driving._trace import Trace

_CASTS = 2_000
"""Largest number of assignments of subjects to actors to try."""
_UNFITTING = 1000
"""Number of failed claims that a thing without a fitting actor counts as."""
_OUT_OF_ORDER = frozenset({"off", "all_on", "flashing"})
"""States that a map's own signals never show."""

Status = Literal["holds", "fails", "open"]


class ClaimFinding(Data):
    """The verdict on one claim."""

    noun: ClassVar[str] = "finding"

    claim: Claim
    status: Status
    """`open` if neither the scene nor the catalogue decides the claim."""
    found: str
    """Description of the content of the scene."""
    path: str = ""
    """Path of the relevant part of the scene."""


@checked
def check_claims(
    claims: Sequence[Claim],
    scene: Scene,
    catalogue: Catalogue,
    trace: Trace | None = None,
    *,
    likeness: Likeness | None = None,
) -> list[ClaimFinding]:
    """Compare every claim of a text with a scene; `Scene.check_claims` tells arguments and result."""
    if not claims:
        return []
    catalogue = catalogue.for_scene(scene)
    if trace is None:
        trace = watch(scene, catalogue)
    road = _road(scene, catalogue)
    seen = ObservedActor.of(scene, catalogue, trace)
    by_subject: dict[str, list[Claim]] = {}
    for claim in claims:
        if claim.kind in OF_THINGS:
            by_subject.setdefault(claim.subject, []).append(claim)
    findings: dict[str, dict[Claim, ClaimFinding]] = {}
    taken: set[str] = set()
    roles = {
        subject: _role(subject, about, scene, seen, catalogue, likeness)
        for subject, about in by_subject.items()
    }
    for group in _groups(by_subject):
        part = {subject: by_subject[subject] for subject in group}
        for subject, (judged, names) in _settle(part, roles, road).items():
            findings[subject] = judged
            taken |= names
    ordered = []
    for claim in claims:
        if claim.kind in OF_THINGS:
            ordered.append(findings[claim.subject][claim])
        elif claim.kind == "traffic":
            ordered.append(_traffic(claim, seen, taken))
        else:
            ordered.append(_finding(claim, *judge_surroundings(claim, scene, road, trace)))
    return ordered


def mismatches(findings: Iterable[ClaimFinding]) -> list[Mismatch]:
    """Return the claims that a scene contradicts."""
    return [
        Mismatch(claim=finding.claim, found=finding.found, path=finding.path)
        for finding in findings
        if finding.status == "fails"
    ]


def _road(scene: Scene, catalogue: Catalogue) -> RoadMap | None:
    """Return the scene's map, or `None` if its traits are unknown."""
    road = find_map(scene.map, catalogue)
    return road if road.traits else None


def _groups(subjects: Mapping[str, Sequence[Claim]]) -> list[list[str]]:
    """Group the subjects whose names differ only in a trailing number."""
    groups: dict[str, list[str]] = {}
    for subject in subjects:
        thing = thing_named(subject)
        name = thing.name if thing else subject.rstrip(" 0123456789")
        groups.setdefault(name, []).append(subject)
    return list(groups.values())


class _Role(NamedTuple):
    """The actors that may show a thing."""

    fitting: tuple[ObservedActor, ...]
    is_told: bool = False
    """True if the scene names the actors that show it."""
    why_not: str = ""
    """Reason why none of those actors can be it."""
    is_of_map: bool = False
    """True if the scene says that the road itself shows it."""
    map_fault: str = ""
    """Fault of those of the map; empty if they are in order."""


def _role(
    subject: str,
    claims: Sequence[Claim],
    scene: Scene,
    seen: Sequence[ObservedActor],
    catalogue: Catalogue,
    likeness: Likeness | None,
) -> _Role:
    """Return the actors that may show a thing: those named by the scene if they fit, else those that its noun fits."""
    told = scene.stands_for.get(subject)
    fault = fault_of_map(subject, scene.map_state)
    if not told:
        fitting = tuple(actor for actor in seen if may_be(subject, actor.asset))
        return _Role(fitting, is_of_map=bool(fault) and not fitting, map_fault=fault)
    quotes = tuple(dict.fromkeys(claim.quote for claim in claims))
    named_ones = [actor for actor in seen if actor.id in told]
    doubts = {
        actor.id: doubt(subject, quotes, actor.asset, catalogue, likeness) for actor in named_ones
    }
    fitting = tuple(actor for actor in named_ones if not doubts[actor.id])
    why_not = next(filter(None, doubts.values()), "") if not fitting else ""
    return _Role(
        fitting, is_told=True, why_not=why_not, is_of_map=OF_THE_MAP in told, map_fault=fault
    )


def _settle(
    subjects: Mapping[str, Sequence[Claim]], roles: Mapping[str, _Role], road: RoadMap | None
) -> dict[str, tuple[dict[Claim, ClaimFinding], set[str]]]:
    """Assign subjects of one name to actors so that the fewest claims fail."""
    thing = thing_named(next(iter(subjects)))
    fitting = list(dict.fromkeys(actor for name in subjects for actor in roles[name].fitting))
    fitting.sort(key=lambda seen: seen.actor)
    scenery = {name: _is_scenery(name, roles[name], thing, road) for name in subjects}
    # A signal that is placed replaces the map's own.
    is_signal = thing is not None and thing.group == "signal"
    single = [name for name in subjects if _is_single(subjects[name], roles[name], thing)]
    settled = {
        name: _judge_group(claims, roles[name], thing, scenery[name])
        for name, claims in subjects.items()
        if name not in single
    }
    scores = {
        (name, actor.id): _judge_one(subjects[name], actor)
        for name in single
        for actor in roles[name].fitting
    }

    def faults(cast: Sequence[ObservedActor | None]) -> int:
        """Return the number of claims that fail; a thing without a fitting actor counts as many."""
        pairs = [
            (name, actor.id if actor else "") for name, actor in zip(single, cast, strict=True)
        ]
        return sum(_faults(scores[pair]) if pair in scores else _UNFITTING for pair in pairs)

    best = min(_casts(fitting, len(single)), key=faults)
    for name, chosen in zip(single, best, strict=True):
        shown = scenery[name] and _is_scenic(subjects[name], roles[name])
        without = _unstaged(subjects[name], shown, len(fitting), roles[name])
        score = None if chosen is None else scores.get((name, chosen.id))
        is_map_better = not is_signal and _faults(without) < _faults(score or {})
        if chosen is None or score is None or is_map_better:
            settled[name] = without, set()
        else:
            settled[name] = score, {chosen.id}
    return settled


def _casts(
    fitting: Sequence[ObservedActor], count: int
) -> Iterable[tuple[ObservedActor | None, ...]]:
    """Return the assignments of actors to things to try: all, or those of the first actors, or just one."""
    pool = [*fitting, *([None] * max(0, count - len(fitting)))]
    if perm(len(pool), count) > _CASTS:
        pool = pool[: max(count, 12)]
    if perm(len(pool), count) > _CASTS:
        return [tuple(pool[:count])]
    return permutations(pool, count)


def _is_scenery(name: str, role: _Role, thing: Thing | None, road: RoadMap | None) -> bool:
    """Return whether the map may show a thing."""
    if role.is_of_map:
        return bool(role.map_fault) or is_of_map(name, road)
    return thing is not None and thing.is_scenery(road)


def _is_single(claims: Sequence[Claim], role: _Role, thing: Thing | None) -> bool:
    """Return whether a thing is one particular actor, which no other thing is."""
    if thing is not None and thing.vague:
        return False
    if any(claim.kind == "count" and int(claim.value) > 1 for claim in claims):
        return False
    return not role.is_told or len(role.fitting) <= 1


def _judge_one(claims: Sequence[Claim], one: ObservedActor) -> dict[Claim, ClaimFinding]:
    findings = {}
    for claim in claims:
        holds, found = one.judge(claim, claims)
        findings[claim] = _finding(
            claim, holds, f"for {one.id!r} ({one.asset.id}) {found}", f"actors[{one.actor}]"
        )
    return findings


def _judge_group(
    claims: Sequence[Claim], role: _Role, thing: Thing | None, scenery: bool
) -> tuple[dict[Claim, ClaimFinding], set[str]]:
    """Judge claims about several things: each must hold for at least one of them."""
    fitting = role.fitting
    if not fitting:
        return _unstaged(claims, scenery and _is_scenic(claims, role), 0, role), set()
    findings: dict[Claim, ClaimFinding] = {}
    every = [_judge_one(claims, actor) for actor in fitting]
    for claim in claims:
        if claim.kind == "count":
            enough = len(fitting) >= int(claim.value) or (thing is not None and thing.many)
            ids = ", ".join(actor.id for actor in fitting)
            findings[claim] = _finding(claim, enough, f"there are {len(fitting)}: {ids}", "actors")
            continue
        by_actor = [judged[claim] for judged in every]
        findings[claim] = next(
            (finding for finding in by_actor if finding.status != "fails"), by_actor[0]
        )
    return findings, {actor.id for actor in fitting}


def _unstaged(
    claims: Sequence[Claim], scenery: bool, others: int, role: _Role
) -> dict[Claim, ClaimFinding]:
    """Return the findings about a thing that no actor represents."""
    if scenery:
        return {claim: _of_scenery(claim, role.map_fault) for claim in claims}
    rest = " other" if others else ""
    found = role.why_not or f"there is no{rest} actor that is one"
    if role.is_of_map and not role.why_not:
        found = (
            "the road has none that could be one, or none that could do this; how far away the road's own things are is not "
            "measured, so an actor must show it"
        )
    return {claim: _finding(claim, False, found, "actors") for claim in claims}


def _is_scenic(claims: Sequence[Claim], role: _Role) -> bool:
    """Return whether all claims could be true of something that belongs to the map.

    The distance of the map's own things stays open; it is taken only of those that the scene puts out of order.
    """
    return not any(
        (claim.kind == "distance" and not role.map_fault)
        or (claim.kind == "motion" and claim.value != "stationary")
        or (claim.kind == "place" and claim.value == "in_lane")
        for claim in claims
    )


def _of_scenery(claim: Claim, fault: str) -> ClaimFinding:
    """Judge a claim about a thing that only the map shows; it is stationary, and in order without a fault."""
    if fault and claim.kind in ("state", "thing"):
        shown = {"flashing": ("flashing", "amber")}.get(fault, (fault,))
        holds = fault != "missing" if claim.kind == "thing" else claim.value in shown
        if claim.kind == "state" and fault in ("bent", "turned"):
            holds = claim.value not in _OUT_OF_ORDER
        return _finding(claim, holds, f"the map's own: {fault}", "map_state")
    if claim.kind == "state" and claim.value in _OUT_OF_ORDER:
        return _finding(claim, False, "the map's own is in order", "map")
    return _finding(claim, True if claim.kind == "thing" else None, "the map has it", "map")


def _traffic(claim: Claim, seen: Sequence[ObservedActor], taken: set[str]) -> ClaimFinding:
    users = [actor for actor in seen if actor.asset.category in ("vehicle", "cyclist")]
    if claim.value == "none":
        extra = [user.id for user in users if user.id not in taken and user.is_traffic]
        return _finding(claim, not extra, f"there are also {', '.join(extra)}", "actors")
    return _finding(claim, len(users) >= 2, f"there are {len(users)} other road users", "actors")


def _faults(findings: Mapping[Claim, ClaimFinding]) -> int:
    return sum(finding.status == "fails" for finding in findings.values())


def _finding(claim: Claim, holds: bool | None, found: str, path: str) -> ClaimFinding:
    status: Status = "open" if holds is None else "holds" if holds else "fails"
    return ClaimFinding(claim=claim, status=status, found=found, path=path)
