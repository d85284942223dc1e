"""Asks a model how rarely drivers meet the situations of texts."""

from collections.abc import Sequence

import numpy as np

from oodscen.errors import AnswerError, ContentFiltered
from oodscen.llm._ask import ask, speaker
from oodscen.llm._call_log import Call, LoggedLLM
from oodscen.metrics._rarity.anchors import PublishedRate
from oodscen.metrics._rarity.estimates import (
    POPULATION,
    UNTOLD,
    Flag,
    Rarity,
    TextRarity,
    gather_rarity,
)
from oodscen.prompts._scenario.estimate_rarity import EstimateRarity, RarityEstimate
from oodscen.protocols import LLM

PER_CALL = 20
DRAWS = 3
LONGEST = 2_000
"""Characters of a text that are shown to a model."""


def ask_rarity(
    llm: LLM,
    texts: Sequence[str],
    *,
    anchors: Sequence[PublishedRate] | None = None,
    draws: int = DRAWS,
    per_call: int = PER_CALL,
) -> Rarity:
    """Return the rarity of texts by a model: the median over independent draws.

    The interval runs from the median of the low ends to that of the high ends, widened to hold all draws. Texts without
    a valid answer are flagged `not answered`; a flag of half of the draws or more holds.

    Raises:
        LLMError: If the model cannot be reached.
    """
    calls: list[Call] = []
    logged = LoggedLLM(llm, calls.append)
    per_text = _drawn(logged, texts, draws, per_call)
    rates: list[PublishedRate] = []
    own: list[float] = []
    if anchors is not None:
        wordings = [text for rate in anchors for text in rate.texts]
        rarities = iter(_drawn(logged, wordings, draws, per_call))
        groups = [[next(rarities).best for _ in rate.texts] for rate in anchors]
        known = [[one for one in group if one is not None] for group in groups]
        rates = [rate for rate, group in zip(anchors, known, strict=True) if group]
        own = [float(np.mean(group)) for group in known if group]
    costs = [call.cost_usd for call in calls if call.status == "ok"]
    update = {
        "unanswered_rates": len(anchors or ()) - len(rates),
        "input_tokens": sum(call.input_tokens for call in calls),
        "output_tokens": sum(call.output_tokens for call in calls),
        "cost_usd": None if None in costs else sum(filter(None, costs)),
    }
    rarity = gather_rarity(per_text, speaker(llm), rates or None, own)
    return rarity.model_copy(update=update)


def questions(texts: Sequence[str], per_call: int = PER_CALL) -> list[EstimateRarity]:
    """Return the questions about texts, several texts in each."""
    shown = [text[:LONGEST] for text in texts]
    return [
        EstimateRarity(texts=tuple(shown[first : first + per_call]), population=POPULATION)
        for first in range(0, len(shown), per_call)
    ]


def _drawn(llm: LLM, texts: Sequence[str], draws: int, per_call: int) -> list[TextRarity]:
    answers: list[list[RarityEstimate]] = [[] for _ in texts]
    for block, prompt in enumerate(questions(texts, per_call)):
        first = block * per_call
        for sample in range(draws):
            try:
                estimates = ask(llm, prompt, sample)
            except (AnswerError, ContentFiltered):
                continue
            for estimate in estimates.estimates:
                answers[first + estimate.number - 1].append(estimate)
    return [
        _join(rarity_estimates, text) for rarity_estimates, text in zip(answers, texts, strict=True)
    ]


def _join(found: Sequence[RarityEstimate], text: str) -> TextRarity:
    """Return the rarity of one text by its draws."""
    names: dict[str, Flag] = {
        "no driving": "no driving",
        "impossible": "impossible",
        "several events": "several events",
        "not understood": "not answered",
    }
    flags: list[Flag] = ["long"] if len(text) > LONGEST else []
    flags += [
        flag
        for problem, flag in names.items()
        if found and 2 * sum(estimate.problem == problem for estimate in found) >= len(found)
    ]
    known = [
        (estimate.low, estimate.best, estimate.high)
        for estimate in found
        if estimate.low is not None and estimate.best is not None and estimate.high is not None
    ]
    if not known and not UNTOLD & set(flags):
        flags.append("not answered")
    draws = tuple(best for _, best, _ in known)
    if UNTOLD & set(flags):
        return TextRarity(flags=tuple(flags), draws=draws)
    low, best, high = np.median(np.array(known), axis=0).tolist()
    return TextRarity(
        low=min(low, *draws), best=best, high=max(high, *draws), flags=tuple(flags), draws=draws
    )
