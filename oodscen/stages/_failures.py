"""Failure of a whole stage: every question that it asked failed."""

from collections.abc import Sequence
from typing import Protocol

from oodscen.errors import LLMError


class Asked(Protocol):
    """The outcome of a question, as a stage reports it."""

    @property
    def status(self) -> str: ...
    @property
    def error(self) -> str | None: ...
    @property
    def retryable(self) -> bool: ...


def refuse_if_all_failed(outcomes: Sequence[Asked], fault: str, model: str) -> None:
    """Refuse the outcomes of a stage of which none is an answer; no outcome at all is none of its faults.

    Raises:
        LLMError: If all failed, with the last error.
    """
    if outcomes and all(outcome.status == "failed" for outcome in outcomes):
        is_retryable = any(outcome.retryable for outcome in outcomes)
        raise LLMError(f"{fault}: {outcomes[-1].error}", model=model, retryable=is_retryable)
