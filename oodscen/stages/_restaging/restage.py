"""Re-staging of scenes in which all or no actions are safe: these cannot tell drivers apart."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple, Self

from oodscen.claims._checking import check_claims, mismatches
from oodscen.data._catalogue import Catalogue
from oodscen.data._claim import Claim
from oodscen.data._episode import Episode
from oodscen.data._scene import (
    MAX_ACTORS,
    MAX_SPEED,
    MAX_TRIGGER,
    Actor,
    Behaviour,
    Placement,
    Scene,
)
from oodscen.errors import OodscenError
from oodscen.stages._restaging.rerun import Rerunner
from oodscen.stages._simulate import Simulated

COMPANION = "companion"
"""Id of the car that re-staging adds beside or behind the ego."""


class Attempt(NamedTuple):
    """A rejected variant of a scene, and the reason."""

    how: str
    why: str


class Restaging(NamedTuple):
    """The outcome of re-staging a scene."""

    scene: Scene
    """The variant that was taken, or the original scene."""
    simulated: Simulated
    tried: tuple[Attempt, ...] = ()
    """Variants that were rejected."""

    def described(self, how: str) -> Self:
        """Return the outcome with another description of the change."""
        episode = self.simulated.episode.model_copy(update={"restaged": how})
        return self._replace(simulated=replace(self.simulated, episode=episode))


def restage(
    scene: Scene, simulated: Simulated, rerunner: Rerunner, claims: Sequence[Claim] = ()
) -> Restaging:
    """Return the first variant of a scene that tells actions apart, and its run.

    Other actors keep their behaviour: an actor that did not yield before does not yield now. If no variant helps,
    the scene and its run are returned unchanged, with the rejected variants and the reasons.
    """
    if not simulated.episode.is_deterministic:
        why = "replaying the approach gave another trace, so that no action can be called safe"
        return Restaging(scene, simulated, (Attempt("nothing", why),))
    tried: list[Attempt] = []
    catalogue = rerunner.simulator.catalogue()
    for variant, how in variants(scene, catalogue, is_too_easy=bool(simulated.episode.safe_set)):
        try:
            fault = _fault_of_probe(rerunner.probe(variant), simulated.episode)
            fault = fault or contradiction(claims, scene, variant, catalogue)
            if not fault:
                rerun = rerunner.run(variant, simulated)
                fault = _fault_of_pictures(rerun.episode, simulated.episode)
        except OodscenError as error:
            fault = fault_of_run(error)
        if not fault:
            return Restaging(variant, rerun, tuple(tried)).described(how)
        tried.append(Attempt(how, fault))
    return Restaging(scene, simulated, tuple(tried))


def fault_of_run(error: OodscenError) -> str:
    """Return why a variant cannot be run."""
    return f"it cannot be run: {str(error).strip().splitlines()[-1].strip(' -')}"


def _fault_of_probe(probe: Episode, before: Episode) -> str:
    """Return why a variant does not tell actions apart at the same moment, or an empty string if it does."""
    if not probe.is_decidable:
        if not probe.is_deterministic:
            return "replaying the approach gave another trace"
        return "every action is safe" if probe.safe_set else "no action is safe"
    if probe.decision_fired is not before.decision_fired:
        return "the moment of decision comes about otherwise"
    return ""


def _fault_of_pictures(rerun: Episode, before: Episode) -> str:
    """Return why the hazard of a variant can be seen less well than before, or an empty string if it cannot."""
    if before.hazard_visible and not rerun.hazard_visible:
        return "the hazard would be in no frame"
    if rerun.is_below_floor and not before.is_below_floor:
        return "the hazard could not be named"
    return ""


def contradiction(
    claims: Sequence[Claim], before: Scene, after: Scene, catalogue: Catalogue
) -> str:
    """Return the first claim that a changed scene contradicts and the scene before did not; empty if none."""
    contradicted = mismatches(check_claims(claims, after, catalogue)) if claims else []
    if not contradicted:
        return ""
    earlier = {mismatch.claim for mismatch in mismatches(check_claims(claims, before, catalogue))}
    new = (str(mismatch) for mismatch in contradicted if mismatch.claim not in earlier)
    return next(new, "")


def variants(
    scene: Scene, catalogue: Catalogue, *, is_too_easy: bool
) -> Iterator[tuple[Scene, str]]:
    """Yield changed scenes, each once, the smallest change first, with a description of the change."""
    earlier = [scene]
    for variant, how in _variants(scene, catalogue, is_too_easy=is_too_easy):
        if variant not in earlier:
            earlier.append(variant)
            yield variant, how


def _variants(
    scene: Scene, catalogue: Catalogue, *, is_too_easy: bool
) -> Iterator[tuple[Scene, str]]:
    """Yield scenes as `variants` does; one at a limit may be as it was."""
    yield from _other_decisions(scene, is_too_easy=is_too_easy)
    yield from _other_speeds(scene, is_too_easy=is_too_easy)
    if is_too_easy and (car := catalogue.by_name.get("car")) is not None:
        yield from _with_companion(scene, car.id)


def _other_decisions(scene: Scene, *, is_too_easy: bool) -> Iterator[tuple[Scene, str]]:
    """Yield the scene decided later if it is too easy, and else earlier: distances and times to collision shrink."""
    is_smaller = is_too_easy is not (scene.decision.kind == "time")
    for factor in (0.85, 0.7, 0.55) if is_smaller else (1.2, 1.4, 1.7):
        value = min(round(scene.decision.value * factor, 2), float(MAX_TRIGGER))
        decision = scene.decision.model_copy(update={"value": value})
        how = f"decision {scene.decision.kind} {scene.decision.value:g} -> {value:g}"
        yield changed_scene(scene, decision=decision), how


def _other_speeds(scene: Scene, *, is_too_easy: bool) -> Iterator[tuple[Scene, str]]:
    """Yield the scene with a faster ego if it is too easy, and else with a slower one."""
    for factor in (1.1, 1.2, 1.3) if is_too_easy else (0.9, 0.8, 0.7):
        speed = round(min(scene.ego.speed * factor, float(MAX_SPEED)), 2)
        ego = scene.ego.model_copy(update={"speed": speed})
        yield changed_scene(scene, ego=ego), f"approach speed {scene.ego.speed:g} -> {speed:g} m/s"


def _with_companion(scene: Scene, car: str) -> Iterator[tuple[Scene, str]]:
    """Yield the scene with a car beside or behind the ego, unless it has one or is full."""
    if len(scene.actors) >= MAX_ACTORS or any(actor.id == COMPANION for actor in scene.actors):
        return
    for lane, side in ((1, "left"), (-1, "right")):
        companion = _companion(scene, car, ahead_m=3.5, lane=lane)
        how = f"a car drives beside the ego in the next lane on the {side}"
        yield changed_scene(scene, actors=(*scene.actors, companion)), how
    for gap_m in (14.0, 10.0):
        companion = _companion(scene, car, ahead_m=-gap_m, lane=0)
        how = f"a car follows {gap_m:g} m behind"
        yield changed_scene(scene, actors=(*scene.actors, companion)), how


def _companion(scene: Scene, car: str, *, ahead_m: float, lane: int) -> Actor:
    return Actor(
        id=COMPANION,
        asset=car,
        placement=Placement(ahead_m=ahead_m, lane=lane),
        behaviour=Behaviour(
            name="follow_lane", parameters={"speed": scene.ego.speed, "headway": 0.3}
        ),
    )


def changed_scene(scene: Scene, **fields: object) -> Scene:
    """Return a scene with other fields, validated again.

    Raises:
        DataError: If it is no scene.
    """
    return Scene.parse({**scene.model_dump(), **fields})
