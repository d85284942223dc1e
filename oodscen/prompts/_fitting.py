"""Shortening of catalogue questions for models with a small context window."""

import re
from typing import Any, TypeVar

from oodscen._text import CHARACTERS_PER_TOKEN, stem
from oodscen.prompts._base import Prompt
from oodscen.prompts._digest import AssetLine, BehaviourLine, CatalogueDigest

Question = TypeVar("Question", bound=Prompt[Any])


ANSWER_TOKENS = 800
"""Tokens reserved for the answer."""

_OF_LANES = frozenset({"two_lane", "three_lane", "four_lane", "oncoming"})
"""Traits of maps that their numbers of lanes tell as well."""
_COMMON = frozenset("a an and at by from in into is its of off on onto or that the to with".split())


def fitted(question: Question, context: int | None) -> Question:
    """Return a question that fits the context window of a model together with its answer.

    The layouts of the roads, traits that only tell of lanes, poses, and the parts of vehicles and maps go first.
    Then the assets and behaviours of its catalogue that share the most words
    with the question's texts stay as they are, and of the others as many as necessary are reduced to their ids.

    Args:
        question: A question with a field `catalogue`.
        context: Context window of the model in tokens, for prompt and answer; `None` leaves the
            question as it is.
    """
    if context is None or tokens_of(question) <= context - ANSWER_TOKENS:
        return question
    whole: CatalogueDigest = question.catalogue  # type: ignore[attr-defined]
    maps = tuple(
        road.model_copy(
            update={"layout": "", "traits": tuple(t for t in road.traits if t not in _OF_LANES)}
        )
        for road in whole.maps
    )
    catalogue = whole.model_copy(update={"maps": maps, "map_parts": (), "poses": (), "parts": ()})
    ranked = _ranked(catalogue, _about(question))
    low, high = 0, len(ranked)
    while low < high:
        middle = (low + high + 1) // 2
        if tokens_of(_with(question, catalogue, ranked[:middle])) <= context - ANSWER_TOKENS:
            low = middle
        else:
            high = middle - 1
    return _with(question, catalogue, ranked[:low])


def tokens_of(question: Prompt[Any]) -> int:
    """Estimate the tokens of a rendered question from its characters."""
    return sum(len(message.text) for message in question.messages()) // CHARACTERS_PER_TOKEN


def _with(question: Question, catalogue: CatalogueDigest, kept: list[tuple[str, str]]) -> Question:
    """Return the question with all lines that are not kept reduced to their ids."""
    whole = set(kept)
    short = catalogue.model_copy(
        update={
            "assets": tuple(
                line
                if ("asset", line.id) in whole
                else AssetLine(id=line.id, category=line.category, description="")
                for line in catalogue.assets
            ),
            "behaviours": tuple(
                line
                if ("behaviour", line.id) in whole
                else BehaviourLine(id=line.id, description="", categories=line.categories)
                for line in catalogue.behaviours
            ),
        }
    )
    return question.model_copy(update={"catalogue": short})


def _about(question: Prompt[Any]) -> set[str]:
    """Return the words of a question's own texts."""
    texts: list[str] = []
    for name in type(question).model_fields:
        value = getattr(question, name)
        texts += [value] if isinstance(value, str) else []
        texts += [one for one in value if isinstance(one, str)] if isinstance(value, tuple) else []
    return _words(" ".join(texts))


def _ranked(catalogue: CatalogueDigest, about: set[str]) -> list[tuple[str, str]]:
    """Return the kind and id of all lines, those with the most shared words first; ties keep catalogue order."""
    lines = [
        *(
            ("behaviour", line.id, f"{line.id} {line.description}", position)
            for position, line in enumerate(catalogue.behaviours)
        ),
        *(
            ("asset", line.id, f"{line.id} {line.description} {' '.join(line.names)}", position)
            for position, line in enumerate(catalogue.assets)
        ),
    ]
    lines.sort(key=lambda line: (-len(_words(line[2]) & about), line[3]))
    return [(kind, name) for kind, name, _, _ in lines]


def _words(text: str) -> set[str]:
    """Return the stems of the content words."""
    return {stem(word) for word in re.findall(r"[a-z]+", text.casefold()) if word not in _COMMON}
