"""All typed questions."""

from collections.abc import Mapping
from typing import Any

from oodscen.prompts._base import Prompt
from oodscen.prompts._judging.choose_action import ChooseAction
from oodscen.prompts._judging.choose_aspect import ChooseAspect
from oodscen.prompts._judging.describe_frame import DescribeFrame
from oodscen.prompts._judging.judge_aspect import JudgeAspect
from oodscen.prompts._judging.name_aspect import NameAspect
from oodscen.prompts._judging.name_ood_aspect import NameOodAspect
from oodscen.prompts._scenario.describe_ordinary import DescribeOrdinary
from oodscen.prompts._scenario.describe_path import DescribePath
from oodscen.prompts._scenario.design_motion import DesignMotion
from oodscen.prompts._scenario.design_prop import DesignProp
from oodscen.prompts._scenario.estimate_rarity import EstimateRarity
from oodscen.prompts._scenario.extract_claims import ExtractClaims
from oodscen.prompts._scenario.mark_hazard import MarkHazard
from oodscen.prompts._scenario.recognise_prop import RecogniseProp
from oodscen.prompts._scenario.stage_scene import StageScene
from oodscen.prompts._tree.classify_examples import (
    ClassifyExamples,
)
from oodscen.prompts._tree.give_examples import GiveExamples
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from oodscen.prompts._tree.judge_branch import JudgeBranch, JudgeBranches
from oodscen.prompts._tree.place_scenario import PlaceScenario
from oodscen.prompts._tree.propose_tree import ProposeTree

QUESTIONS: Mapping[str, type[Prompt[Any]]] = {
    question.purpose: question
    for question in (
        GiveExamples,
        ClassifyExamples,
        ProposeTree,
        ImagineScenario,
        PlaceScenario,
        JudgeBranch,
        JudgeBranches,
        DesignMotion,
        DesignProp,
        RecogniseProp,
        DescribePath,
        DescribeOrdinary,
        EstimateRarity,
        ExtractClaims,
        StageScene,
        MarkHazard,
        DescribeFrame,
        NameAspect,
        NameOodAspect,
        ChooseAspect,
        JudgeAspect,
        ChooseAction,
    )
}
"""Every question by its purpose, in the order of the pipeline."""


def prompt_versions() -> dict[str, str]:
    """Return the version of every question, by purpose."""
    return {purpose: question.version() for purpose, question in QUESTIONS.items()}
