"""What a call takes: estimated before it is sent, and believed afterwards as far as it can be true."""

import json
from typing import Any

from oodscen.protocols import Request, Usage

IMAGE_TOKENS = 1_500
"""What a picture of a study costs at most with the known providers."""

MOST_ADDED = 10_000
"""Most tokens that a provider adds to a question of its own."""

MOST_PER_IMAGE = 100_000
"""Most tokens that any provider counts for a picture; some multiply what they count to adjust the price."""

MOST_ANSWERED = 500_000
"""Most tokens of one answer, hidden thoughts included; several times what any model writes."""

MOST_USD = 500.0
"""Highest cost of one call: the longest answer of the dearest model."""


def estimate_tokens(request: Request) -> int:
    """Estimate the input tokens of a request from its characters, rather too many than too few."""
    texts = sum(len(message.text) for message in request.messages)
    return (texts + len(json.dumps(request.schema))) // 3 + IMAGE_TOKENS * _images(request)


def count(value: Any) -> int:
    """Read a number of tokens from a response: 0 where there is none, -1 where it is no such number."""
    if value is None:
        return 0
    is_whole = (
        isinstance(value, (int, float)) and not isinstance(value, bool) and value == value // 1
    )
    return int(value) if is_whole else -1


def believed(usage: Usage, request: Request) -> Usage:
    """Return what a model says that a call took; nothing at all where it cannot be true.

    A token of the input is at least one byte of what was sent, the schema counted twice as some providers
    get it in words as well; `MOST_ADDED`, `MOST_PER_IMAGE`, `MOST_ANSWERED` and `MOST_USD` bound the rest.
    """
    texts = sum(len(message.text.encode("utf-8", "replace")) for message in request.messages)
    schema = 2 * len(json.dumps(request.schema).encode())
    most = texts + schema + MOST_ADDED + MOST_PER_IMAGE * _images(request)
    if not (0 <= usage.input_tokens <= most and 0 <= usage.output_tokens <= MOST_ANSWERED):
        return Usage()
    is_cost = usage.cost_usd is not None and 0 <= usage.cost_usd <= MOST_USD
    return Usage(
        input_tokens=usage.input_tokens,
        output_tokens=usage.output_tokens,
        cached_tokens=min(max(0, usage.cached_tokens), usage.input_tokens),
        cost_usd=usage.cost_usd if is_cost else None,
    )


def _images(request: Request) -> int:
    return sum(len(message.images) for message in request.messages)
