"""The hazard of a scene that is read: the actors that are unusual, and the moment of choice."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import MAX_TRIGGER, Actor, Trigger
from oodscen.driving._motion.behaviours.table import USUAL
from oodscen.errors import DataError, Issue
from oodscen.interchange._reading.positions import LANE_M
from oodscen.interchange._reading.tree import OpenScenarioFile

if TYPE_CHECKING:
    from oodscen.protocols import LLM

_LONGEST_TITLE = 500
_DECISION_TTC_S = 3.0
"""Time to collision with a hazard that acts at once at which the decision comes, s."""
_DECISION_DELAY_S = 0.5
"""Time from the hazard's action to the decision, s."""
_DECISION_SHARE = 0.9
"""Value of the decision's trigger as a share of that of the hazard's."""


def hazard_actors(
    tree: OpenScenarioFile,
    actors: Sequence[Actor],
    named: Sequence[str],
    ids: Mapping[str, str],
    catalogue: Catalogue,
    llm: "LLM | None",
) -> list[str]:
    """Return the ids of the actors that are the hazard.

    They are those that the caller has named, those that a model names, or the first that does something unusual.

    Args:
        tree: The file.
        actors: The actors of the scene.
        named: Names of entities, or ids of actors; none to choose.
        ids: Ids of actors by the names of their entities.
        catalogue: Describes assets and behaviours to the model.
        llm: The model.

    Raises:
        DataError: If no actor can be the hazard, or there is no actor of a given name.
        LLMError: If the model cannot be reached, or its answer cannot be used.
    """
    known = {**dict(zip(ids.values(), ids.values(), strict=True)), **ids}
    hazards = [known.get(name, name) for name in named]
    present = {actor.id for actor in actors}
    for hazard in hazards:
        if hazard not in present:
            raise _no_hazard(tree, f"there is no entity {hazard!r} beside the ego in the scene")
    if not actors:
        raise _no_hazard(tree, "the file has no entity that can be the hazard")
    if hazards:
        return hazards
    if llm is not None and len(actors) > 1:
        return _hazards_by_model(tree, actors, catalogue, llm)
    acting = [actor for actor in actors if actor.behaviour.name not in USUAL]
    first = (acting or actors)[0].id
    tree.root.note(f"no hazard was named; {first} is taken to be it")
    return [first]


def _no_hazard(tree: OpenScenarioFile, message: str) -> DataError:
    return tree.missing(Issue("hazard", message))


def _hazards_by_model(
    tree: OpenScenarioFile, actors: Sequence[Actor], catalogue: Catalogue, llm: "LLM"
) -> list[str]:
    from oodscen.llm._ask import ask
    from oodscen.prompts._scenario.mark_hazard import ActorLine, MarkHazard

    title = f"{tree.path.stem}. {tree.header().get('description')}"
    described = {kind.id: kind.description for kind in catalogue.behaviours}
    lines = tuple(
        ActorLine(
            id=actor.id,
            what=catalogue.asset(actor.asset).description,
            does=f"{actor.behaviour.name}: {described.get(actor.behaviour.name, '')}",
            ahead_m=actor.placement.ahead_m,
            left_m=actor.placement.offset_m + LANE_M * actor.placement.lane,
        )
        for actor in actors
    )
    answer = ask(llm, MarkHazard(title=title[:_LONGEST_TITLE], actors=lines))
    tree.root.note(
        f"no hazard was named; {llm.name} takes {', '.join(answer.actors)} to be it: {answer.reasoning[:200]}"
    )
    return answer.actors


def decision_for(hazard: Actor) -> Trigger:
    """Return the moment of choice: soon after the hazard acts, or when it is near."""
    trigger = hazard.behaviour.trigger
    if trigger.kind == "time" and trigger.value > 0.0:
        return Trigger(kind="time", value=min(trigger.value + _DECISION_DELAY_S, MAX_TRIGGER))
    if trigger.kind == "time":
        return Trigger(kind="ttc", value=_DECISION_TTC_S, actor=hazard.id)
    value = round(_DECISION_SHARE * trigger.value, 3)
    return Trigger(kind=trigger.kind, value=value, actor=trigger.actor or hazard.id)
