"""Token usage and cost of calls: estimates before sending, and checks of reported values."""

import json
from typing import Any

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


def plausible_usage(usage: Usage, request: Request) -> Usage:
    """Return the usage that a model reports, or an empty one if it cannot be true.

    Every input token stands for at least one byte that was sent, with the schema counted twice, as some
    providers also put it into words; `MOST_ADDED`, `MOST_PER_IMAGE`, `MOST_ANSWERED` and `MOST_USD` bound the
    rest.
    """
    sent = _text_bytes(request) + 2 * _schema_bytes(request)
    most = sent + MOST_ADDED + MOST_PER_IMAGE * _images(request)
    if not (0 <= usage.input_tokens <= most and 0 <= usage.output_tokens <= MOST_ANSWERED):
        return Usage()
    cost_usd = usage.cost_usd
    if cost_usd is not None and not 0 <= cost_usd <= MOST_USD:
        cost_usd = None
    return Usage(
        input_tokens=usage.input_tokens,
        output_tokens=usage.output_tokens,
        cached_tokens=min(max(0, usage.cached_tokens), usage.input_tokens),
        cost_usd=cost_usd,
    )


def _text_bytes(request: Request) -> int:
    return sum(len(message.text.encode("utf-8", "replace")) for message in request.messages)


def _schema_bytes(request: Request) -> int:
    return len(json.dumps(request.schema))


def _images(request: Request) -> int:
    return sum(len(message.images) for message in request.messages)
