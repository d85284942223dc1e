"""Typed questions, one per file beside its template, in the order of the pipeline."""

from typing import Any

from oodscen.prompts._base import Prompt
from oodscen.prompts._digest import CatalogueDigest
from oodscen.prompts._judging.choose_action import ActionOption, ChooseAction, ChosenAction
from oodscen.prompts._judging.choose_aspect import ChooseAspect, ChosenAspect
from oodscen.prompts._judging.describe_frame import DescribeFrame, FrameDescription
from oodscen.prompts._judging.judge_aspect import AspectJudgement, JudgeAspect
from oodscen.prompts._judging.name_aspect import NameAspect, OodAspect
from oodscen.prompts._judging.name_ood_aspect import NamedAspect, NameOodAspect
from oodscen.prompts._scenario.describe_ordinary import DescribeOrdinary, OrdinaryText
from oodscen.prompts._scenario.describe_path import STYLES, DescribePath, Descriptions, Style
from oodscen.prompts._scenario.extract_claims import Claims, ExtractClaims
from oodscen.prompts._scenario.stage_scene import SceneDraft, StageScene
from oodscen.prompts._tree.classify_examples import (
    Classification,
    ClassifiedExample,
    ClassifyExamples,
)
from oodscen.prompts._tree.give_examples import Examples, GiveExamples
from oodscen.prompts._tree.imagine_scenario import ImaginedScenario, ImagineScenario
from oodscen.prompts._tree.judge_branch import BranchJudgement, JudgeBranch
from oodscen.prompts._tree.place_scenario import PlacedScenario, PlaceScenario
from oodscen.prompts._tree.propose_tree import ProposedNode, ProposedTree, ProposeTree

QUESTIONS: tuple[type[Prompt[Any]], ...] = (
    GiveExamples,
    ClassifyExamples,
    ProposeTree,
    ImagineScenario,
    PlaceScenario,
    JudgeBranch,
    DescribePath,
    DescribeOrdinary,
    ExtractClaims,
    StageScene,
    DescribeFrame,
    NameAspect,
    NameOodAspect,
    ChooseAspect,
    JudgeAspect,
    ChooseAction,
)
"""Every question, in the order of the pipeline."""


def prompt_versions() -> dict[str, str]:
    """Return the version of every question, by purpose."""
    return {question.purpose: question.version() for question in QUESTIONS}


__all__ = [
    "QUESTIONS",
    "STYLES",
    "ActionOption",
    "AspectJudgement",
    "BranchJudgement",
    "CatalogueDigest",
    "ChooseAction",
    "ChooseAspect",
    "ChosenAction",
    "ChosenAspect",
    "Claims",
    "Classification",
    "ClassifiedExample",
    "ClassifyExamples",
    "DescribeFrame",
    "DescribeOrdinary",
    "DescribePath",
    "Descriptions",
    "Examples",
    "ExtractClaims",
    "FrameDescription",
    "GiveExamples",
    "ImagineScenario",
    "ImaginedScenario",
    "JudgeAspect",
    "JudgeBranch",
    "NameAspect",
    "NameOodAspect",
    "NamedAspect",
    "OodAspect",
    "OrdinaryText",
    "PlaceScenario",
    "PlacedScenario",
    "Prompt",
    "ProposeTree",
    "ProposedNode",
    "ProposedTree",
    "SceneDraft",
    "StageScene",
    "Style",
    "prompt_versions",
]
