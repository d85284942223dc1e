"""Comparison of a text's claims with a scene and with its trace."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import NamedTuple

from oodscen._arguments import checked
from oodscen.claims._casting import Casting, Subject, cast
from oodscen.claims._findings import ClaimFinding, finding
from oodscen.claims._matching import OF_THE_MAP, Likeness, doubt, fault_of_map, is_of_map
from oodscen.claims._observation import ObservedActor, observe
from oodscen.claims._surroundings import judge_surroundings
from oodscen.claims._things import may_be, thing_named
from oodscen.claims._watching import watch
from oodscen.data._catalogue import Catalogue, RoadMap
from oodscen.data._claim import OF_THINGS, Claim, Mismatch
from oodscen.data._scene import Scene
from oodscen.driving._roads.building import find_map
from oodscen.driving._trace import Trace


class _Staging(NamedTuple):
    """A scene with whatever may show the things of a text."""

    scene: Scene
    actors: Sequence[ObservedActor]
    catalogue: Catalogue
    road: RoadMap | None
    """The scene's map; `None` if its traits are unknown."""
    likeness: Likeness | None
    """Nearness in meaning of nouns and assets, if an encoder tells it."""


@checked
def check_claims(
    claims: Sequence[Claim],
    scene: Scene,
    catalogue: Catalogue,
    trace: Trace | None = None,
    *,
    likeness: Likeness | None = None,
) -> list[ClaimFinding]:
    """Compare every claim of a text with a scene; see `Scene.check_claims`."""
    if not claims:
        return []
    catalogue = catalogue.for_scene(scene)
    if trace is None:
        trace = watch(scene, catalogue)
    road = find_map(scene.map, catalogue)
    staging = _Staging(
        scene=scene,
        actors=observe(scene, catalogue, trace),
        catalogue=catalogue,
        road=road if road.traits else None,
        likeness=likeness,
    )
    by_subject: dict[str, list[Claim]] = {}
    for claim in claims:
        if claim.kind in OF_THINGS:
            by_subject.setdefault(claim.subject, []).append(claim)
    castings: dict[str, Casting] = {}
    for group in _groups(by_subject):
        castings |= cast([_subject(name, by_subject[name], staging) for name in group])
    in_text = {actor_id for casting in castings.values() for actor_id in casting.actor_ids}
    findings = []
    for claim in claims:
        if claim.kind in OF_THINGS:
            findings.append(castings[claim.subject].findings[claim])
        elif claim.kind == "traffic":
            findings.append(_judge_traffic(claim, staging.actors, in_text))
        else:
            judgement = judge_surroundings(claim, scene, staging.road, trace)
            findings.append(finding(claim, *judgement))
    return findings


def mismatches(findings: Iterable[ClaimFinding]) -> list[Mismatch]:
    """Return the claims that a scene contradicts."""
    return [
        Mismatch(claim=finding.claim, found=finding.found, path=finding.path)
        for finding in findings
        if finding.status == "fails"
    ]


def _groups(subjects: Mapping[str, Sequence[Claim]]) -> list[list[str]]:
    """Group the subjects whose names differ only in a trailing number."""
    groups: dict[str, list[str]] = {}
    for subject in subjects:
        thing = thing_named(subject)
        noun = thing.name if thing else subject.rstrip(" 0123456789")
        groups.setdefault(noun, []).append(subject)
    return list(groups.values())


def _subject(name: str, claims: Sequence[Claim], staging: _Staging) -> Subject:
    """Return a thing with the actors that may show it: those that the scene names if they fit, else those its noun fits."""
    stated_ids = staging.scene.stands_for.get(name, ())
    map_fault = fault_of_map(name, staging.scene.map_state)
    misfit = ""
    if stated_ids:
        quotes = tuple(dict.fromkeys(claim.quote for claim in claims))
        stated = [actor for actor in staging.actors if actor.id in stated_ids]
        doubts = [
            doubt(name, quotes, actor.asset, staging.catalogue, staging.likeness)
            for actor in stated
        ]
        candidates = [actor for actor, reason in zip(stated, doubts, strict=True) if not reason]
        if doubts and not candidates:
            misfit = doubts[0]
        is_of_the_map = OF_THE_MAP in stated_ids
    else:
        candidates = [actor for actor in staging.actors if may_be(name, actor.asset)]
        is_of_the_map = bool(map_fault) and not candidates
    thing = thing_named(name)
    if is_of_the_map:
        may_be_scenery = bool(map_fault) or is_of_map(name, staging.road)
    else:
        may_be_scenery = thing is not None and thing.is_scenery(staging.road)
    return Subject(
        name=name,
        claims=claims,
        thing=thing,
        candidates=candidates,
        is_stated=bool(stated_ids),
        misfit=misfit,
        is_of_map=is_of_the_map,
        map_fault=map_fault,
        is_scenery=may_be_scenery and _are_scenic(claims, map_fault),
    )


def _are_scenic(claims: Sequence[Claim], map_fault: str) -> bool:
    """Return whether all claims could be true of something that belongs to the map.

    The distance of the map's own things stays open; it is taken only of those that the scene puts out of order.
    """
    return not any(
        (claim.kind == "distance" and not map_fault)
        or (claim.kind == "motion" and claim.value != "stationary")
        or (claim.kind == "place" and claim.value == "in_lane")
        for claim in claims
    )


def _judge_traffic(
    claim: Claim, actors: Sequence[ObservedActor], in_text: Collection[str]
) -> ClaimFinding:
    """Judge a claim about other road users, none of which may be there or at least two must be."""
    users = [actor for actor in actors if actor.asset.category in ("vehicle", "cyclist")]
    if claim.value == "none":
        others = [user.id for user in users if user.is_traffic and user.id not in in_text]
        return finding(claim, not others, f"there are also {', '.join(others)}", "actors")
    return finding(claim, len(users) >= 2, f"there are {len(users)} other road users", "actors")
