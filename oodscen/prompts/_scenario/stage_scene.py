"""The augmenting prompt: turn a text into a scene."""

import math
from collections.abc import Mapping
from typing import Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from oodscen._display import Brief
from oodscen.data._claim import Claim
from oodscen.data._map_state import MapState
from oodscen.data._scene import Actor, Ego, Hazard, Trigger
from oodscen.data._weather import Weather
from oodscen.errors import Issue
from oodscen.prompts._base import Prompt, without_blanks
from oodscen.prompts._digest import CatalogueDigest

_BLANK: Mapping[str, Any] = {"map": "", "ego": {"speed": 0}, "hazard": {}, "decision": {}}
"""Placeholders for the required fields of a draft whose text cannot be shown."""
_MOST_TURNED_DEG = 1e6
"""Heading from which a number is no turn, degrees."""


class SceneDraft(Brief, BaseModel):
    """Answer: a scene without the ids that it gets later, or the reason why there is none."""

    model_config = ConfigDict(extra="forbid")

    reasoning: str = Field(default="", description="how the text was read, in a sentence or two")
    map: str = Field(description="id of a map")
    ego: Ego
    weather: Weather = Weather()
    actors: list[Actor] = []
    stands_for: dict[str, list[str]] = Field(
        default={},
        description="for each thing in the claims the ids of the actors that show it, or `map`",
    )
    hazard: Hazard
    decision: Trigger
    """A distance or time to collision without an actor refers to the first of `hazard.actors`."""
    horizon_s: float = Field(default=8.0, gt=0, le=60)
    map_state: MapState | None = None
    cannot_show: str = Field(
        default="",
        max_length=400,
        description="why no scene here can show the text; else left out",
    )

    @model_validator(mode="before")
    @classmethod
    def _plain(cls, value: object) -> object:
        """Leave out what is blank, and turn headings into the range from -180 to 180 degrees."""
        if not isinstance(value, Mapping):
            return value
        draft = without_blanks({name: value[name] for name in value if name != "hazard"})
        assert isinstance(draft, dict)
        if str(draft.get("cannot_show", "")).strip():
            return {**_BLANK, "cannot_show": draft["cannot_show"]}
        hazard = value.get("hazard")
        if hazard is not None:
            draft["hazard"] = _hazard_without_blanks(hazard)
        _fold_headings(draft)
        return draft

    @field_validator("stands_for", mode="before")
    @classmethod
    def _listed(cls, value: object) -> object:
        """Accept a single id in place of a list of one."""
        if not isinstance(value, Mapping):
            return value
        return {thing: [ids] if isinstance(ids, str) else ids for thing, ids in value.items()}


def _hazard_without_blanks(hazard: object) -> object:
    """Leave out what is blank, except actors: null stands for one that ordinary traffic does not have."""
    if not isinstance(hazard, Mapping):
        return hazard
    rest = without_blanks({name: hazard[name] for name in hazard if name != "actors"})
    assert isinstance(rest, dict)
    actors = hazard.get("actors")
    if isinstance(actors, Mapping):
        rest["actors"] = {key: without_blanks(actors[key]) or None for key in actors}
    elif actors:
        rest["actors"] = actors
    return rest


def _fold_headings(draft: dict[str, Any]) -> None:
    """Replace the headings of a draft's actors by equal ones within -180 to 180 degrees."""
    actors: list[object] = []
    if isinstance(draft.get("actors"), list):
        actors += draft["actors"]
    hazard = draft.get("hazard")
    if isinstance(hazard, Mapping) and isinstance(hazard.get("actors"), Mapping):
        actors += hazard["actors"].values()
    for actor in actors:
        placement = actor.get("placement") if isinstance(actor, Mapping) else None
        if not isinstance(placement, dict):
            continue
        heading = placement.get("heading_deg")
        if isinstance(heading, int | float) and 180 < abs(heading) < _MOST_TURNED_DEG:
            placement["heading_deg"] = math.remainder(heading, 360.0)


class StageScene(Prompt[SceneDraft]):
    """Choose map, weather, actors, places and motion (paper, section III-B, augmenter-LLM)."""

    purpose: ClassVar[str] = "stage-scene"
    template: ClassVar[str] = "stage_scene.md"
    answer: ClassVar[type[BaseModel]] = SceneDraft

    text: str
    path: tuple[str, ...]
    """Labels from the root down to the leaf."""
    claims: tuple[Claim, ...] = ()
    """Claims of the text that the scene will be checked against."""
    roads: tuple[str, ...] = ()
    """Ids of the maps for which all claims about the road hold; empty if there are none."""
    catalogue: CatalogueDigest

    @property
    def things(self) -> tuple[str, ...]:
        """The things that the claims name, in their order."""
        return tuple(dict.fromkeys(claim.subject for claim in self.claims if claim.subject))

    def variables(self) -> dict[str, Any]:
        """Return the fields and the things that the claims name."""
        return {**super().variables(), "things": self.things}

    def check(self, answer: SceneDraft) -> list[Issue]:
        """Return faults of `stands_for`: actors that do not exist. Without claims nothing reads it."""
        if answer.cannot_show or not self.claims:
            return []
        ids = {actor.id for actor in answer.actors} | {"map"}
        issues = []
        for thing, names in answer.stands_for.items():
            issues += [
                Issue(
                    f"stands_for.{thing}",
                    f"there is no actor {name!r}; the scene has {sorted(ids)}",
                )
                for name in names
                if name not in ids
            ]
        return issues
