"""Asks a model how rarely drivers meet the situations of texts."""

from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np

from oodscen.errors import AnswerError, ContentFiltered, LLMError
from oodscen.llm._accounting import account
from oodscen.llm._ask import ask, speaker
from oodscen.llm._call_log import Call, LoggedLLM
from oodscen.metrics._rarity.estimates import (
    POPULATION,
    UNTOLD,
    Flag,
    Rarity,
    TextRarity,
    gather_rarity,
)
from oodscen.metrics._rarity.rates import PublishedRate
from oodscen.prompts._scenario.estimate_rarity import EstimateRarity, RarityEstimate
from oodscen.protocols import LLM

PER_CALL = 20
"""Texts of a question."""
DRAWS = 3
"""Independent draws of a model, unless a caller wants others."""
LONGEST = 2_000
"""Characters of a text that are shown to a model."""
_FLAG_OF_PROBLEM: dict[str, Flag] = {
    "no driving": "no driving",
    "impossible": "impossible",
    "several events": "several events",
    "not understood": "not answered",
}
"""The flags of a text, by the problem that a model names."""


def ask_rarity(
    llm: LLM,
    texts: Sequence[str],
    *,
    anchors: Sequence[PublishedRate] | None = None,
    clusters: Sequence[str] | None = None,
    seed: int = 0,
    draws: int,
    per_call: int = PER_CALL,
) -> Rarity:
    """Return the rarity of texts by a model: the median over independent draws.

    The interval runs from the median of the low ends to that of the high ends, widened to hold all draws. Texts without
    a valid answer are flagged `not answered`; a flag of half of the draws or more holds.

    Raises:
        LLMError: If the model can answer none of the questions about texts.
    """
    calls: list[Call] = []
    logged = LoggedLLM(llm, calls.append)
    per_text, failures = _ask_all(logged, texts, draws, per_call)
    if failures and not any(call.status == "ok" for call in calls):
        raise failures[0]
    answered, estimates = [], []
    for rate, estimate in _rate_estimates(logged, anchors or (), draws, per_call):
        if estimate is not None:
            answered.append(rate)
            estimates.append(estimate)
    used = account((), [call.model_dump() for call in calls])
    rarity = gather_rarity(per_text, speaker(llm), answered or None, estimates, clusters, seed=seed)
    return rarity.model_copy(
        update={
            "unanswered_rates": len(anchors or ()) - len(answered),
            "input_tokens": used.input_tokens,
            "output_tokens": used.output_tokens,
            "cost_usd": used.cost_usd,
        }
    )


def _rate_estimates(
    llm: LLM, rates: Sequence[PublishedRate], draws: int, per_call: int
) -> Iterator[tuple[PublishedRate, float | None]]:
    """Yield each rate with the model's mean estimate over its wordings, `None` if it gives none of one of them."""
    wordings = [text for rate in rates for text in rate.texts]
    rarities, _ = _ask_all(llm, wordings, draws, per_call)
    waiting = iter(rarities)
    for rate in rates:
        figures = [next(waiting).best for _ in rate.texts]
        known = [figure for figure in figures if figure is not None]
        yield rate, float(np.mean(known)) if len(known) == len(figures) else None


def questions(texts: Sequence[str], per_call: int = PER_CALL) -> list[EstimateRarity]:
    """Return the questions about texts, several texts in each."""
    shown = [text[:LONGEST] for text in texts]
    return [
        EstimateRarity(texts=tuple(shown[first : first + per_call]), population=POPULATION)
        for first in range(0, len(shown), per_call)
    ]


def _ask_all(
    llm: LLM, texts: Sequence[str], draws: int, per_call: int
) -> tuple[list[TextRarity], list[LLMError]]:
    """Return the rarity of each text by the draws of a model that it answered, and what kept it from answering."""
    answers: list[list[RarityEstimate]] = [[] for _ in texts]
    failures: list[LLMError] = []
    for block, prompt in enumerate(questions(texts, per_call)):
        first = block * per_call
        for sample in range(draws):
            try:
                answer = ask(llm, prompt, sample)
            except (AnswerError, ContentFiltered):
                continue
            except LLMError as error:
                failures.append(error)
                continue
            for estimate in answer.estimates:
                answers[first + estimate.number - 1].append(estimate)
    rarities = [_join(estimates, text) for estimates, text in zip(answers, texts, strict=True)]
    return rarities, failures


def _join(estimates: Sequence[RarityEstimate], text: str) -> TextRarity:
    """Return the rarity of one text by its draws."""
    flags: list[Flag] = ["long"] if len(text) > LONGEST else []
    problems: Counter[str] = Counter(estimate.problem for estimate in estimates)
    flags += [
        flag
        for problem, flag in _FLAG_OF_PROBLEM.items()
        if problems[problem] and 2 * problems[problem] >= len(estimates)
    ]
    figures = [
        (estimate.low, estimate.best, estimate.high)
        for estimate in estimates
        if estimate.low is not None and estimate.best is not None and estimate.high is not None
    ]
    if not figures and not UNTOLD & set(flags):
        flags.append("not answered")
    draws = tuple(best for _, best, _ in figures)
    if UNTOLD & set(flags):
        return TextRarity(flags=tuple(flags), draws=draws)
    low, best, high = np.median(np.array(figures), axis=0).tolist()
    return TextRarity(
        low=min(low, *draws), best=best, high=max(high, *draws), flags=tuple(flags), draws=draws
    )
