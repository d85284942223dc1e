"""The marking prompt: the unusual actors of a scene that another tool wrote."""

from typing import ClassVar

from pydantic import BaseModel, ConfigDict, Field

from oodscen._display import Brief
from oodscen.data._base import Data
from oodscen.errors import Issue
from oodscen.prompts._base import Prompt


class ActorLine(Data):
    """One actor of the scene."""

    id: str
    what: str
    """The thing itself: `a deer`."""
    does: str
    """The name of its behaviour, and its meaning after a colon."""
    ahead_m: float
    """Distance ahead of the ego at the start, m."""
    left_m: float
    """Offset to the left of the ego's lane at the start, m."""


class MarkedHazard(Brief, BaseModel):
    """Answer: the unusual actors, with a reason."""

    model_config = ConfigDict(extra="forbid")

    reasoning: str = Field(max_length=2_000, description="the comparison with ordinary traffic")
    actors: list[str] = Field(
        min_length=1,
        max_length=200,
        description="ids of the unusual actors, the first one foremost",
    )


class MarkHazard(Prompt[MarkedHazard]):
    """Name the actors of a scene that make it unusual; the others are ordinary traffic."""

    purpose: ClassVar[str] = "mark-hazard"
    template: ClassVar[str] = "mark_hazard.md"
    answer: ClassVar[type[BaseModel]] = MarkedHazard

    title: str
    """The scenario's name and description in its file."""
    actors: tuple[ActorLine, ...]

    def check(self, answer: MarkedHazard) -> list[Issue]:
        """Return faults: actors that the scene does not have, or named twice."""
        known = {actor.id for actor in self.actors}
        issues = [
            Issue(f"actors[{index}]", f"there is no actor {name!r}")
            for index, name in enumerate(answer.actors)
            if name not in known
        ]
        if len(set(answer.actors)) < len(answer.actors):
            issues.append(Issue("actors", "name each actor once"))
        return issues
