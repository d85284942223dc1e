"""The augmenting prompt: turn a text into a scene."""

from typing import ClassVar

from pydantic import BaseModel, ConfigDict, Field

from oodscen.data._scene import Actor, Ego, Hazard, Trigger, Weather
from oodscen.prompts._base import Prompt
from oodscen.prompts._digest import CatalogueDigest


class SceneDraft(BaseModel):
    """Answer: a scene without the ids that it gets later."""

    model_config = ConfigDict(extra="forbid")

    reasoning: str = Field(default="", description="how the text was read, in a sentence or two")
    map: str = Field(description="id of a map")
    ego: Ego
    weather: Weather = Weather()
    actors: list[Actor] = []
    hazard: Hazard
    decision: Trigger
    """Where it names no actor, a distance or time to collision is that to the first of `hazard.actors`."""
    horizon_s: float = Field(default=8.0, gt=0, le=60)


class StageScene(Prompt[SceneDraft]):
    """Choose map, weather, actors, places and motion (paper, section III-B, augmenter-LLM)."""

    purpose: ClassVar[str] = "stage-scene"
    template: ClassVar[str] = "stage_scene.md"
    answer: ClassVar[type[BaseModel]] = SceneDraft

    text: str
    path: tuple[str, ...]
    """Labels from the root down to the leaf."""
    catalogue: CatalogueDigest
