"""Making movements that a catalogue lacks, so that dropped branches can be shown after all."""

from collections.abc import Iterable, Mapping, Sequence

from oodscen._io.study_files import MOTIONS
from oodscen._words.text import one_line
from oodscen.data._catalogue import Catalogue
from oodscen.data._designs.motion import ABILITIES, Motion
from oodscen.data._scene import Actor, Behaviour, Ego, Hazard, Placement, Scene, Trigger
from oodscen.errors import Issue, LLMError, OodscenError
from oodscen.llm._ask import ask, speaker
from oodscen.prompts._scenario.design_motion import DesignedMotion, DesignMotion
from oodscen.protocols import LLM, Control, Simulator
from oodscen.stages._making.making import Made
from oodscen.stages._making.wanted import WantedMotion

_TRIAL_S = 3.0
"""Time for which a movement is tried in the simulator, s."""


class MadeMotion(Made):
    """A movement that was to be made: its design, or the reason why there is none."""

    motion: Motion | None = None
    """`None` if it could not be made."""


class MotionMaker:
    """Asks for the designs of movements that a catalogue lacks, and tries them.

    A design that the simulator refuses is sent back with its faults.

    Args:
        llm: The model that designs.
        simulator: Plays the designs.
    """

    def __init__(self, llm: LLM, simulator: Simulator) -> None:
        self.llm = llm
        self.simulator = simulator
        self.catalogue: Catalogue = simulator.catalogue()

    def make(self, wanted: WantedMotion) -> MadeMotion:
        if not getattr(self.simulator, "plays_motions", True):
            reason = f"{self.simulator.name} moves bodies by itself and plays no motions"
            return MadeMotion(id=wanted.name, reason=reason)
        question = DesignMotion(**wanted._asdict())
        provenance = {"model": speaker(self.llm), "prompt": question.citation()}
        try:
            answer = ask(self.llm, question, check=self._faults)
        except LLMError as error:
            return MadeMotion.failed(wanted.name, error, **provenance)
        reason = "" if answer.motion else one_line(answer.cannot_make)
        return MadeMotion(id=wanted.name, motion=answer.motion, reason=reason, **provenance)

    def _faults(self, answer: DesignedMotion) -> Sequence[Issue]:
        motion = answer.motion
        scene = None if motion is None else trial_scene(motion, self.catalogue)
        if scene is None:
            return []
        try:
            self.simulator.reset(scene, 0)
            for _ in range(round(_TRIAL_S / self.simulator.dt)):
                self.simulator.step(Control())
        except OodscenError as error:
            return [Issue("motion", f"the simulator cannot play it: {one_line(str(error))}")]
        return []


def trial_scene(motion: Motion, catalogue: Catalogue) -> Scene | None:
    """Return a scene on the longest road in which one actor moves so, or `None` if the catalogue has none that can."""
    able = ABILITIES[motion.body].categories
    mover = next((asset for asset in catalogue.assets if asset.category in able), None)
    carrier = next((asset for asset in catalogue.assets if asset.category == "vehicle"), None)
    if mover is None or (carrier is None and motion.frame == "other"):
        return None
    other = "carrier" if motion.frame == "other" else None
    does = Behaviour(name=motion.id, other=other)
    actors = [Actor(id="mover", asset=mover.id, placement=Placement(ahead_m=30.0), behaviour=does)]
    if carrier is not None and other:
        actors.append(Actor(id=other, asset=carrier.id, placement=Placement(ahead_m=50.0)))
    return Scene(
        id="trial",
        scenario_id="trial",
        map=max(catalogue.maps, key=lambda road: road.length_m).id,
        ego=Ego(speed=0.0),
        actors=tuple(actors),
        hazard=Hazard(actors=dict.fromkeys(actor.id for actor in actors)),
        decision=Trigger(kind="time", value=1.0),
        motions=(motion,),
    )


def made_motions(rows: Iterable[Mapping[str, object]]) -> dict[str, Motion]:
    """Return the movements that were made, by id, from lines of `motions.jsonl`."""
    lines = (MadeMotion.parse(row, source=MOTIONS) for row in rows)
    return {line.id: line.motion for line in lines if line.motion is not None}
