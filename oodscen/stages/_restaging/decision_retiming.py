"""Moves of a scene's decision to the moment from which a viewer can name the hazard."""

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import NamedTuple

from oodscen.data._claim import Claim
from oodscen.data._scene import MAX_TRIGGER, Scene, Trigger
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
from oodscen.stages._pictures.visibility import sighting
from oodscen.stages._restaging.rerun import Rerunner
from oodscen.stages._restaging.restage import (
    Attempt,
    Restaging,
    changed_scene,
    contradiction,
    fault_of_run,
)
from oodscen.stages._simulate import Simulated, approach

MOST_MOMENTS = 6
"""Largest number of moments that are tried per approach speed."""
SLOWER = (1.0, 0.85, 0.7, 0.55, 0.4)
"""Shares of the approach speed that are tried in turn."""
_MARGIN = 0.8
"""Share of the least size at which the outline of boxes makes a frame worth rendering."""


class _LaterMoment(NamedTuple):
    """A moment after the decision at which the hazard can be named."""

    state: State
    sighting: Sighting


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
    return _Retiming(scene, simulated, rerunner, claims).best()


class _Retiming:
    """The search for a later decision of one scene."""

    def __init__(
        self, scene: Scene, simulated: Simulated, rerunner: Rerunner, claims: Sequence[Claim]
    ) -> None:
        self._scene = scene
        self._simulated = simulated
        self._rerunner = rerunner
        self._claims = claims
        self._was_too_easy = bool(simulated.episode.safe_set) and not simulated.episode.is_decidable
        self._tried: list[Attempt] = []
        self._calm: tuple[Scene, str] | None = None
        """The first variant in which every action is safe, and how it differs."""

    def best(self) -> Restaging:
        """Return what `retime` does."""
        for share in SLOWER if self._scene.ego.speed > 0.0 else SLOWER[:1]:
            if restaging := self._at_speed(share):
                return restaging
        restaging = self._rerun(*self._calm) if self._calm else None
        return restaging or Restaging(self._scene, self._simulated, tuple(self._tried))

    def _at_speed(self, share: float) -> Restaging | None:
        """Try the later decisions at a share of the approach speed."""
        slowed, prefix = self._scene, TO_NAME
        if share < 1.0:
            slowed = _slow_ego(self._scene, share)
            prefix += f"approach speed {self._scene.ego.speed:g} -> {slowed.ego.speed:g} m/s, "
        faults: list[str] = []
        try:
            for variant, distance_m in _decided_later(slowed, self._rerunner):
                change = f"{_words(self._scene.decision)} -> {_words(variant.decision)}"
                how = f"{prefix}decision {change}"
                if fault := self._fault_of(variant, how):
                    faults.append(f"{distance_m:g} m away it can be named, but {fault}")
                elif restaging := self._rerun(variant, how):
                    return restaging
        except OodscenError as error:
            faults.append(fault_of_run(error))
        faults.append("the hazard cannot be named before the ego reaches it")
        self._tried.append(Attempt(f"{prefix}a later decision", faults[0]))
        return None

    def _fault_of(self, variant: Scene, how: str) -> str:
        """Return why a decision that comes later does not help, or an empty string if it may."""
        probe = self._rerunner.probe(variant)
        if not probe.safe_set:
            return "no action is safe"
        catalogue = self._rerunner.simulator.catalogue()
        contradicted = contradiction(self._claims, self._scene, variant, catalogue)
        if contradicted or probe.is_decidable or self._was_too_easy:
            return contradicted
        self._calm = self._calm or (variant, how)
        return "every action is safe"

    def _rerun(self, variant: Scene, how: str) -> Restaging | None:
        """Return the variant and its rendered run, or `None` if the hazard still cannot be named."""
        run = self._rerunner.run(variant, self._simulated)
        if run.episode.is_below_floor:
            return None
        return Restaging(variant, run, tuple(self._tried)).described(how)


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


def _decided_later(scene: Scene, rerunner: Rerunner) -> Iterator[tuple[Scene, float]]:
    """Yield the scene with decisions at which the hazard can be named, each with its distance then, m."""
    corridor = load_corridor(scene.map, rerunner.simulator.catalogue())
    # The variants are run in the same simulator: all moments are found first.
    for moment in list(islice(_later_moments(scene, rerunner, corridor), MOST_MOMENTS)):
        value = value_in(scene.decision, moment.state, corridor)
        if value <= MAX_TRIGGER:
            decision = scene.decision.model_copy(update={"value": value})
            yield changed_scene(scene, decision=decision), moment.sighting.distance_m


def _later_moments(scene: Scene, rerunner: Rerunner, corridor: Corridor) -> Iterator[_LaterMoment]:
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
            outline = drawn(scene, bodies(scene, catalogue, state.poses), corridor, camera)
            if outline is not None and outline.size_px >= _MARGIN * LEAST_SIZE_PX:
                frame = render_checked(simulator, camera, len(state.ids))
                sighted = sighting(scene, state, frame, catalogue, camera)
                if sighted is not None and not sighted.faults:
                    yield _LaterMoment(state, sighted)
        state = simulator.step(driver.act(simulator.observe()))


def _words(trigger: Trigger) -> str:
    return f"{trigger.kind} {trigger.value:g}"
