"""Shortening of questions about a catalogue for models with a small context window."""

import re
from collections.abc import Sequence
from typing import Any, TypeVar

from oodscen._words.text import CHARACTERS_PER_TOKEN, stem
from oodscen.prompts._base import Prompt
from oodscen.prompts._digest import AssetLine, BehaviourLine, CatalogueDigest

Question = TypeVar("Question", bound=Prompt[Any])

ANSWER_TOKENS = 800
"""Tokens reserved for the answer."""
_OF_LANES = frozenset({"two_lane", "three_lane", "four_lane", "oncoming"})
"""Traits of maps that their numbers of lanes tell as well."""
_COMMON = frozenset("a an and at by from in into is its of off on onto or that the to with".split())


def fitted(question: Question, context: int | None) -> Question:
    """Return a question that fits the context window of a model together with its answer, or else the shortest.

    The layouts of the roads, traits that only tell of lanes, poses, and the parts of vehicles and maps go first, and
    so do maps that the question's claims rule out.
    Then as many assets and behaviours of its catalogue as necessary are reduced to their ids; those that share the
    most words with the question's texts stay as they are.

    Args:
        question: A question with a field `catalogue`.
        context: Context window of the model in tokens, for prompt and answer; `None` leaves the
            question as it is.
    """
    if context is None:
        return question
    room = context - ANSWER_TOKENS
    if tokens_of(question) <= room:
        return question
    catalogue = _without_layouts(question.catalogue, getattr(question, "roads", ()))  # type: ignore[attr-defined]
    ranked = _ranked(catalogue, _words_of(question))
    fewest, most = 0, len(ranked)
    while fewest < most:
        middle = (fewest + most + 1) // 2
        shorter = _shortened(question, catalogue, ranked[:middle])
        if tokens_of(shorter) <= room:
            fewest = middle
        else:
            most = middle - 1
    return _shortened(question, catalogue, ranked[:fewest])


def tokens_of(question: Prompt[Any]) -> int:
    """Estimate the tokens of a rendered question from its characters."""
    return sum(len(message.text) for message in question.messages()) // CHARACTERS_PER_TOKEN


def _without_layouts(catalogue: CatalogueDigest, roads: Sequence[str]) -> CatalogueDigest:
    """Return a catalogue of the maps that are possible, or all if none is named, without what goes first."""
    maps = tuple(
        road.model_copy(
            update={
                "layout": "",
                "traits": tuple(trait for trait in road.traits if trait not in _OF_LANES),
            }
        )
        for road in catalogue.maps
        if not roads or road.id in roads
    )
    return catalogue.model_copy(update={"maps": maps, "map_parts": (), "poses": (), "parts": ()})


def _shortened(
    question: Question, catalogue: CatalogueDigest, whole_lines: list[tuple[str, str]]
) -> Question:
    """Return the question with all but some lines of a catalogue reduced to their ids."""
    whole = set(whole_lines)
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


def _words_of(question: Prompt[Any]) -> set[str]:
    """Return the stems of the words in a question's own texts."""
    texts: list[str] = []
    for name in type(question).model_fields:
        value = getattr(question, name)
        if isinstance(value, str):
            texts.append(value)
        elif isinstance(value, tuple):
            texts += [item for item in value if isinstance(item, str)]
    return _stems(" ".join(texts))


def _ranked(catalogue: CatalogueDigest, words: set[str]) -> list[tuple[str, str]]:
    """Return the kind and id of all lines, those with the most shared words first.

    Ties keep catalogue order, in which behaviours and assets take turns.
    """
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
    lines.sort(key=lambda line: (-len(_stems(line[2]) & words), line[3]))
    return [(kind, line_id) for kind, line_id, _, _ in lines]


def _stems(text: str) -> set[str]:
    """Return the stems of the content words."""
    return {stem(word) for word in re.findall(r"[a-z]+", text.casefold()) if word not in _COMMON}
