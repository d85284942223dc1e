"""Re-staging of scenes in which all or no actions are safe: these cannot tell drivers apart."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple, Self

from oodscen.claims._checking import check_claims, mismatches
from oodscen.data._catalogue import Catalogue
from oodscen.data._claim import Claim
from oodscen.data._episode import Episode
from oodscen.data._scene import Actor, Behaviour, Placement, Scene
from oodscen.errors import OodscenError
from oodscen.stages._rerun import Rerunner
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

    Other actors keep their behaviour: an actor that did not yield before does not yield now. If no variant helps, the scene and its
    run are returned unchanged, with the rejected variants and the reasons.
    """
    if not simulated.episode.is_deterministic:
        why = "replaying the approach gave another trace, so that no action can be called safe"
        return Restaging(scene, simulated, (Attempt("nothing", why),))
    tried: list[Attempt] = []
    catalogue = rerunner.simulator.catalogue()
    for variant, how in variants(scene, catalogue, bool(simulated.episode.safe_set)):
        try:
            why = _refusal(rerunner.probe(variant), simulated.episode)
            if why := why or contradiction(claims, scene, variant, catalogue):
                tried.append(Attempt(how, why))
                continue
            again = rerunner.run(variant, simulated)
        except OodscenError as error:
            tried.append(Attempt(how, fault_of_run(error)))
            continue
        if simulated.episode.hazard_visible and not again.episode.hazard_visible:
            tried.append(Attempt(how, "the hazard would be in no frame"))
        elif again.episode.is_below_floor and not simulated.episode.is_below_floor:
            tried.append(Attempt(how, "the hazard could not be named"))
        else:
            return Restaging(variant, again, tuple(tried)).described(how)
    return Restaging(scene, simulated, tuple(tried))


def fault_of_run(error: OodscenError) -> str:
    """Return why a variant cannot be run."""
    return f"it cannot be run: {str(error).strip().splitlines()[-1].strip(' -')}"


def _refusal(probe: Episode, before: Episode) -> str:
    """Return the reason why a variant does not help, or an empty string if it does."""
    if not probe.is_decidable:
        if not probe.is_deterministic:
            return "replaying the approach gave another trace"
        return "every action is safe" if probe.safe_set else "no action is safe"
    if probe.decision_fired is not before.decision_fired:
        return "the moment of decision comes about otherwise"
    return ""


def contradiction(
    claims: Sequence[Claim], before: Scene, after: Scene, catalogue: Catalogue
) -> str:
    """Return the first claim that a changed scene contradicts and the scene before did not; empty if none."""
    found = mismatches(check_claims(claims, after, catalogue)) if claims else []
    if not found:
        return ""
    known = {mismatch.claim for mismatch in mismatches(check_claims(claims, before, catalogue))}
    return next((str(one) for one in found if one.claim not in known), "")


def variants(scene: Scene, catalogue: Catalogue, is_too_easy: bool) -> Iterator[tuple[Scene, str]]:
    """Yield changed scenes, the smallest change first, each with a description of the change."""
    later = scene.decision.kind == "time"
    factors = (0.85, 0.7, 0.55) if is_too_easy is not later else (1.2, 1.4, 1.7)
    for factor in factors:
        value = round(scene.decision.value * factor, 2)
        decision = scene.decision.model_copy(update={"value": value})
        how = f"decision {scene.decision.kind} {scene.decision.value:g} -> {value:g}"
        yield changed_scene(scene, decision=decision), how
    for factor in (1.1, 1.2, 1.3) if is_too_easy else (0.9, 0.8, 0.7):
        speed = round(min(scene.ego.speed * factor, 45.0), 2)
        ego = scene.ego.model_copy(update={"speed": speed})
        yield changed_scene(scene, ego=ego), f"approach speed {scene.ego.speed:g} -> {speed:g} m/s"
    has_car = any(asset.id == "car" for asset in catalogue.assets)
    if is_too_easy and has_car and all(actor.id != COMPANION for actor in scene.actors):
        for lane, side in ((1, "left"), (-1, "right")):
            companion = _companion(scene, ahead_m=3.5, lane=lane)
            how = f"a car drives beside the ego in the next lane on the {side}"
            yield changed_scene(scene, actors=(*scene.actors, companion)), how
        for gap in (14.0, 10.0):
            companion = _companion(scene, ahead_m=-gap, lane=0)
            how = f"a car follows {gap:g} m behind"
            yield changed_scene(scene, actors=(*scene.actors, companion)), how


def _companion(scene: Scene, *, ahead_m: float, lane: int) -> Actor:
    return Actor(
        id=COMPANION,
        asset="car",
        placement=Placement(ahead_m=ahead_m, lane=lane),
        behaviour=Behaviour(
            name="follow_lane", parameters={"speed": scene.ego.speed, "headway": 0.3}
        ),
    )


def changed_scene(scene: Scene, **fields: object) -> Scene:
    """Return a scene with other fields, validated again."""
    return Scene.model_validate({**scene.model_dump(), **fields})
