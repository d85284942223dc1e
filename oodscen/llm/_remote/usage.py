"""Token usage and cost of calls: estimates before sending, checks of reported values, and the charge."""

import json
from typing import Any, NamedTuple

from oodscen.llm._remote.budget import Price, Spent
from oodscen.protocols import Request, Usage

IMAGE_TOKENS = 1_500
"""Upper estimate of the tokens of a study's picture with the known providers."""

MOST_ADDED = 10_000
"""Maximum number of tokens that a provider adds to a question by itself."""

MOST_PER_IMAGE = 100_000
"""Maximum number of tokens that any provider counts for a picture; some inflate the count to adjust the price."""

MOST_ANSWERED = 500_000
"""Maximum number of tokens of one answer, hidden reasoning included; several times what any model writes."""

MOST_USD = 500.0
"""Highest cost of one call, in USD: the longest answer of the most expensive model."""


def estimate_tokens(request: Request) -> int:
    """Estimate the input tokens of a request from its bytes, erring on the high side in any script."""
    sent = _text_bytes(request) + _schema_bytes(request)
    return sent // 3 + IMAGE_TOKENS * _images(request)


def count(value: Any) -> int:
    """Return a number of tokens from a response: 0 if missing, -1 if invalid."""
    if value is None:
        return 0
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return int(value) if is_number and value == value // 1 else -1


class Charge(NamedTuple):
    """The usage of a call, and what it counts as under the caps."""

    usage: Usage
    """The known part: any other number of tokens is 0, and a cost that is not known is `None`."""
    spent: Spent
    """The usage, with the estimate of what is not known."""


def charge(
    stated: Usage, request: Request, text: str, estimate: Usage, price: Price | None
) -> Charge:
    """Return what a call is charged, whatever kind of model answered.

    No question takes 0 tokens, and no answer but an empty one, so that 0 means that the number is not known. A
    stated cost above 0 counts; otherwise the cost follows from the tokens where a price is known.

    Args:
        stated: The usage that the model states.
        request: The question.
        text: The answer, or the kind of what stood in its place.
        estimate: Tokens to charge where their number is not known.
        price: The model's price.
    """
    usage = plausible_usage(stated, request)
    input_tokens = usage.input_tokens or estimate.input_tokens
    output_tokens = usage.output_tokens
    is_counted = bool(usage.input_tokens)
    if not output_tokens and (text or stated.output_tokens or not is_counted):
        output_tokens, is_counted = estimate.output_tokens, False
    cost = usage.cost_usd
    if not cost and price is not None:
        cost = price.of(input_tokens, output_tokens)
        is_known = is_counted or not any(price)
        usage = usage.model_copy(update={"cost_usd": cost if is_known else None})
    return Charge(usage, Spent(1, input_tokens + output_tokens, cost or 0.0))


def plausible_usage(usage: Usage, request: Request) -> Usage:
    """Return the usage that a model reports, without the numbers that cannot be true.

    Every input token stands for at least one byte that was sent, with the schema counted twice, as some
    providers also put it into words; `MOST_ADDED`, `MOST_PER_IMAGE`, `MOST_ANSWERED` and `MOST_USD` bound the
    rest.
    """
    sent = _text_bytes(request) + 2 * _schema_bytes(request)
    most = sent + MOST_ADDED + MOST_PER_IMAGE * _images(request)
    input_tokens = usage.input_tokens if 0 <= usage.input_tokens <= most else 0
    output_tokens = usage.output_tokens if 0 <= usage.output_tokens <= MOST_ANSWERED else 0
    cost_usd = usage.cost_usd
    if cost_usd is not None and not 0 <= cost_usd <= MOST_USD:
        cost_usd = None
    return Usage(
        input_tokens=input_tokens,
        output_tokens=output_tokens,
        cached_tokens=min(max(0, usage.cached_tokens), input_tokens),
        cost_usd=cost_usd,
    )


def _text_bytes(request: Request) -> int:
    return sum(len(message.text.encode("utf-8", "replace")) for message in request.messages)


def _schema_bytes(request: Request) -> int:
    return len(json.dumps(request.schema))


def _images(request: Request) -> int:
    return sum(len(message.images) for message in request.messages)
