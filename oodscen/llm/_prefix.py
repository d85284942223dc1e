"""The part of a request that an earlier request of the same kind began with, for which providers charge less."""

from collections.abc import Sequence

from oodscen._words.text import CHARACTERS_PER_TOKEN
from oodscen.data._messages import Message
from oodscen.llm._remote.usage import IMAGE_TOKENS
from oodscen.protocols import Request

LEAST_TOKENS = 1_024
"""Shortest prefix that the large providers cache, in tokens."""


def cacheable_share(request: Request) -> float:
    """Return the share of a request's input tokens that a provider can have cached, in [0, 1].

    That is the system's turn, and in a conversation or a repair everything up to the question before the last;
    0 if it is shorter than what providers cache. The first request of a kind in a run has to fill the cache.
    """
    prefix = _tokens(request.messages[: _shared_turns(request.messages)])
    return prefix / _tokens(request.messages) if prefix >= LEAST_TOKENS else 0.0


def _shared_turns(messages: Sequence[Message]) -> int:
    """Return the number of turns before the first question, or up to the question before the last."""
    questions = [index for index, message in enumerate(messages) if message.role == "user"]
    if len(questions) > 1:
        return questions[-2] + 1
    return questions[0] if questions else 0


def _tokens(messages: Sequence[Message]) -> float:
    return sum(
        len(message.text) / CHARACTERS_PER_TOKEN + IMAGE_TOKENS * len(message.images)
        for message in messages
    )
