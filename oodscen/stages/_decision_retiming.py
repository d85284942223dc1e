"""Moves of a scene's decision to the moment from which a viewer can name the hazard."""

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import NamedTuple

from oodscen.data._claim import Claim
from oodscen.data._scene import Scene, Trigger
from oodscen.data._sighting import LEAST_SIZE_PX, TO_NAME, Sighting
from oodscen.driving._base_simulator import render_checked
from oodscen.driving._motion.actions import Cruise
from oodscen.driving._motion.triggers import value_in
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._sight.decision_view import drawn
from oodscen.driving._sight.scene_checks import bodies
from oodscen.driving._sight.staging_advice import LATEST_S, LOOK_S
from oodscen.errors import OodscenError
from oodscen.protocols import State, camera_for
from oodscen.stages._rerun import Rerunner
from oodscen.stages._restage import (
    Attempt,
    Restaging,
    changed_scene,
    contradiction,
    fault_of_run,
)
from oodscen.stages._simulate import Simulated, approach
from oodscen.stages._visibility import sighting

MOST_MOMENTS = 6
"""Largest number of moments that are tried per approach speed."""
SLOWER = (1.0, 0.85, 0.7, 0.55, 0.4)
"""Shares of the approach speed that are tried in turn."""
_MARGIN = 0.8
"""Share of the least size at which the outline of boxes makes a frame worth rendering."""


class _Later(NamedTuple):
    """A later moment at which the hazard can be named."""

    state: State
    seen: Sighting


def retime(
    scene: Scene, simulated: Simulated, rerunner: Rerunner, claims: Sequence[Claim] = ()
) -> Restaging:
    """Return the scene with the first later decision at which a viewer can name the hazard, and its run.

    The blind approach does not depend on the decision. It is driven on, and the first moments at which the
    hazard can be named are tried, until some action is safe and another is not; where all were safe, all may
    stay safe. If there is none, the ego approaches more slowly. If that does not help either, the first moment at
    which every action is safe is taken: the scene still asks what is there. If nothing helps, the scene and its run
    are returned unchanged, with the reasons.
    """
    tried: list[Attempt] = []
    before, catalogue = simulated.episode, rerunner.simulator.catalogue()
    is_too_easy = bool(before.safe_set) and not before.is_decidable
    easy: tuple[Scene, str] | None = None

    def rerun(variant: Scene, how: str) -> Restaging | None:
        """Return the variant and its rendered run, or `None` if the hazard still cannot be named."""
        again = rerunner.run(variant, simulated)
        if again.episode.is_below_floor:
            return None
        return Restaging(variant, again, tuple(tried)).described(how)

    for share in SLOWER if scene.ego.speed > 0.0 else SLOWER[:1]:
        slowed, how = scene, TO_NAME
        if share < 1.0:
            slowed = _slow_ego(scene, share)
            how += f"approach speed {scene.ego.speed:g} -> {slowed.ego.speed:g} m/s, "
        whys: list[str] = []
        try:
            for variant, distance in _later(slowed, rerunner):
                probe = rerunner.probe(variant)
                what = f"{how}decision {_said(scene.decision)} -> {_said(variant.decision)}"
                is_usable = probe.is_decidable or (is_too_easy and probe.safe_set)
                why = "" if probe.safe_set else "no action is safe"
                why = why or contradiction(claims, scene, variant, catalogue)
                if not (is_usable or why):
                    easy = easy or (variant, what)
                    why = "every action is safe"
                if why:
                    whys.append(f"{distance:g} m away it can be named, but {why}")
                elif done := rerun(variant, what):
                    return done
        except OodscenError as error:
            whys.append(fault_of_run(error))
        why = whys[0] if whys else "the hazard cannot be named before the ego reaches it"
        tried.append(Attempt(f"{how}a later decision", why))
    done = rerun(*easy) if easy else None
    return done or Restaging(scene, simulated, tuple(tried))


def _slow_ego(scene: Scene, share: float) -> Scene:
    """Return the scene with a slower ego; ordinary traffic that starts behind it slows alike."""
    actors = []
    for actor in scene.actors:
        parameters = actor.behaviour.parameters
        is_behind = actor.placement.ahead_m < 0.0 and actor.id not in scene.hazard.actors
        if is_behind and "speed" in parameters:
            slower = {**parameters, "speed": round(parameters["speed"] * share, 2)}
            behaviour = actor.behaviour.model_copy(update={"parameters": slower})
            actor = actor.model_copy(update={"behaviour": behaviour})
        actors.append(actor)
    ego = scene.ego.model_copy(update={"speed": round(scene.ego.speed * share, 2)})
    return changed_scene(scene, ego=ego, actors=actors)


def _later(scene: Scene, rerunner: Rerunner) -> Iterator[tuple[Scene, float]]:
    """Yield the scene with decisions at which the hazard can be named, each with the distance from there, m."""
    corridor = load_corridor(scene.map, rerunner.simulator.catalogue())
    # The variants are run in the same simulator: all moments are found first.
    for later in list(islice(_moments(scene, rerunner, corridor), MOST_MOMENTS)):
        value = value_in(scene.decision, later.state, corridor)
        decision = scene.decision.model_copy(update={"value": value})
        yield changed_scene(scene, decision=decision), later.seen.distance_m


def _moments(scene: Scene, rerunner: Rerunner, corridor: Corridor) -> Iterator[_Later]:
    """Drive blindly on from the decision and yield the moments at which the hazard can be named."""
    simulator = rerunner.simulator
    catalogue = simulator.catalogue()
    camera = camera_for(catalogue, rerunner.camera)
    driver = Cruise()
    state = approach(scene, simulator, rerunner.seed)[0][-1]
    steps = max(1, round(LOOK_S / simulator.dt))
    for step in range(round(LATEST_S / simulator.dt)):
        if state.contacts or state.off_road:
            return
        if step % steps == 0:
            guess = drawn(scene, bodies(scene, catalogue, state.poses), corridor, camera)
            if guess is not None and guess.size_px >= _MARGIN * LEAST_SIZE_PX:
                frame = render_checked(simulator, camera, len(state.ids))
                seen = sighting(scene, state, frame, catalogue, camera)
                if seen is not None and not seen.faults:
                    yield _Later(state, seen)
        state = simulator.step(driver.act(simulator.observe()))


def _said(trigger: Trigger) -> str:
    return f"{trigger.kind} {trigger.value:g}"
