"""Answers of a vision-language model that a person has labelled, to measure a judge by."""

from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any

from oodscen._io.files import bundled
from oodscen.data._base import Data
from oodscen.judging._aspects.opinions import Opinion, opinion_id


class LabelledAnswer(Data):
    """An open answer, and whether it names what its path is about."""

    answer: str
    path: tuple[str, ...]
    """Labels from the root to the leaf."""
    is_right: bool
    """True if it names the thing and what is wrong with it, or lacks only what cannot be seen."""


@cache
def labelled_answers() -> tuple[LabelledAnswer, ...]:
    """Return the shipped answers."""
    lines = bundled("labelled.jsonl", "oodscen.judging._aspects").splitlines()
    return tuple(LabelledAnswer.model_validate_json(line) for line in lines)


def agreement(opinions: Iterable[Opinion], judge: str) -> tuple[int, int]:
    """Return how many labelled answers a judge sees as the person did, and how many it gave an opinion on.

    `judge` is the judge's label.
    """
    judgements = {
        opinion.id: opinion.is_same for opinion in opinions if opinion.is_same is not None
    }
    agrees = [
        judgements[name] == example.is_right
        for example in labelled_answers()
        if (name := opinion_id(judge, example.answer, example.path)) in judgements
    ]
    return sum(agrees), len(agrees)


def agreement_in_words(info: Mapping[str, Any]) -> str:
    """Return the agreement of a study's judge as a sentence; empty if `study.json` has none."""
    counts = info.get("counts")
    judged = counts.get("judged") if isinstance(counts, Mapping) else None
    if not isinstance(judged, Mapping) or not judged.get("labelled"):
        return ""
    agrees, labelled = judged.get("agrees", 0), judged["labelled"]
    return f"The judge agrees with a person on {agrees} of {labelled} labelled answers."
